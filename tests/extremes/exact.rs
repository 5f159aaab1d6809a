//! Exact arithmetic: what the f32 numbers of a view and a box say, without any rounding.
//!
//! Every f32 and f64 is a whole number times a power of two, and so are their sums and products.
//! Nothing here divides: a point on the screen is compared after multiplying by its w.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use dashu_int::IBig;
use glam::{Mat4, Vec3};
use tercet::geom::{Aabb, DepthDirection, View};

/// `mantissa · 2^exponent`, of any size.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: IBig,
    exponent: i32,
}

impl Dyadic {
    /// A finite number as it is.
    pub(crate) fn new(x: f64) -> Self {
        assert!(x.is_finite(), "{x} has no exact value");
        let bits = x.to_bits();
        let (field, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
        let (whole, exponent) =
            if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
        // Without trailing zeros a number stays short: an f32 has 24 bits.
        let zeros = if whole == 0 { 0 } else { whole.trailing_zeros() };
        let whole = (whole >> zeros) * if x.is_sign_negative() { -1 } else { 1 };
        Self { mantissa: IBig::from(whole), exponent: exponent + zeros as i32 }
    }

    pub(crate) fn is_negative(&self) -> bool {
        self.mantissa < IBig::ZERO
    }

    pub(crate) fn is_positive(&self) -> bool {
        self.mantissa > IBig::ZERO
    }

    pub(crate) fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// Within two units in the last place, to print and to choose by; nothing is decided by it.
    pub(crate) fn about(&self) -> f64 {
        // Scaled in two steps: 2^exponent alone may be out of range.
        let half = self.exponent / 2;
        let mantissa = self.mantissa.to_f64().value();
        mantissa * 2f64.powi(half) * 2f64.powi(self.exponent - half)
    }
}

impl From<f32> for Dyadic {
    fn from(x: f32) -> Self {
        Self::new(f64::from(x))
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        // A zero's exponent says nothing, and would only lengthen the sum.
        if self.mantissa.is_zero() {
            return other.clone();
        }
        if other.mantissa.is_zero() {
            return self.clone();
        }
        let exponent = self.exponent.min(other.exponent);
        let raised = |n: &Dyadic| &n.mantissa << (n.exponent - exponent) as usize;
        match self.exponent.cmp(&other.exponent) {
            Ordering::Equal => Dyadic { mantissa: &self.mantissa + &other.mantissa, exponent },
            Ordering::Greater => Dyadic { mantissa: raised(self) + &other.mantissa, exponent },
            Ordering::Less => Dyadic { mantissa: &self.mantissa + raised(other), exponent },
        }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        self + &-other.clone()
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for Dyadic {
    type Output = Self;

    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, exponent: self.exponent }
    }
}

/// A view's matrices, multiplied out.
pub(crate) struct ExactView {
    /// Rows of clip from world.
    rows: [[Dyadic; 4]; 4],
    /// Half the viewport's sides, in pixels.
    half: [Dyadic; 2],
    depth: DepthDirection,
}

impl ExactView {
    pub(crate) fn new(view: &View) -> Self {
        let entries = |m: Mat4| m.transpose().to_cols_array().map(Dyadic::from);
        let (clip, from_world) = (entries(view.clip_from_view()), entries(view.view_from_world()));
        let entry = |row: usize, column: usize| {
            (0..4)
                .map(|k| &clip[4 * row + k] * &from_world[4 * k + column])
                .reduce(|a, b| &a + &b)
                .expect("four")
        };
        let viewport = view.viewport();
        Self {
            rows: std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column))),
            half: [viewport.width, viewport.height].map(|side| Dyadic::new(0.5 * f64::from(side))),
            depth: view.depth(),
        }
    }

    /// Where a point of the world lies.
    pub(crate) fn point(&self, p: Vec3) -> Point {
        let p = p.to_array().map(Dyadic::from);
        self.placed(|row| {
            let [x, y, z] = [0, 1, 2].map(|k| &row[k] * &p[k]);
            &(&(&x + &y) + &z) + &row[3]
        })
    }

    /// Where the eight corners of a box lie, in the order of [`Aabb::corners`].
    pub(crate) fn corners(&self, aabb: &Aabb) -> [Point; 8] {
        let ends = [0, 1, 2].map(|axis| [aabb.min[axis], aabb.max[axis]].map(Dyadic::from));
        let terms =
            self.rows.each_ref().map(|row| [0, 1, 2].map(|k| ends[k].each_ref().map(|end| &row[k] * end)));
        std::array::from_fn(|i| {
            let mut row = 0..4;
            self.placed(|coefficients| {
                let [x, y, z] = &terms[row.next().expect("four rows")];
                &(&(&x[i & 1] + &y[i >> 1 & 1]) + &z[i >> 2]) + &coefficients[3]
            })
        })
    }

    fn placed(&self, mut form: impl FnMut(&[Dyadic; 4]) -> Dyadic) -> Point {
        let [x, y, z, w] = self.rows.each_ref().map(&mut form);
        let beyond = &w - &z;
        let (before_near, nearness) = match self.depth {
            DepthDirection::Reversed => (beyond.clone(), z.clone()),
            DepthDirection::Standard => (z.clone(), -z.clone()),
        };
        let [half_x, half_y] = &self.half;
        Point {
            screen: [&(&x + &w) * half_x, &(&w - &y) * half_y],
            sides: [&w + &x, &w - &x, &w + &y, &w - &y, beyond, z],
            before_near,
            nearness,
            w,
        }
    }
}

/// A point in clip space; everything that would be divided by w to be on the screen still is to be.
pub(crate) struct Point {
    /// Pixels right and down, times w.
    pub(crate) screen: [Dyadic; 2],
    /// Nearness, times w.
    pub(crate) nearness: Dyadic,
    /// At least 0 where the point is before the six planes: left, right, bottom, top, and the two of
    /// depth.
    pub(crate) sides: [Dyadic; 6],
    /// At least 0 beyond the near plane.
    pub(crate) before_near: Dyadic,
    pub(crate) w: Dyadic,
}

impl Point {
    /// Whether the point is one that the view shows.
    pub(crate) fn shows(&self) -> bool {
        self.w.is_positive() && !self.sides.iter().any(Dyadic::is_negative)
    }

    /// Whether it lies before the near plane and the eye, where a projection exists.
    pub(crate) fn is_ahead(&self) -> bool {
        self.w.is_positive() && self.before_near.is_positive()
    }

    /// `value·w − limit·w`: its sign is that of `value − limit`, for a value that was multiplied by
    /// w > 0.
    pub(crate) fn beyond(&self, value: &Dyadic, limit: &Dyadic) -> Dyadic {
        value - &(limit * &self.w)
    }

    /// A linear form `a·X + b·Y + c` of the place on the screen relative to a pixel's corner, times
    /// w, lessened by the most that it changes within `r` pixels on either axis.
    pub(crate) fn form(&self, [a, b, c]: [f32; 3], origin: [u32; 2], r: &Dyadic) -> Dyadic {
        let offset = |axis: usize| self.beyond(&self.screen[axis], &Dyadic::new(f64::from(origin[axis])));
        let (a, b, c) = (Dyadic::from(a), Dyadic::from(b), Dyadic::from(c));
        let change = &(&a.clone().abs() + &b.clone().abs()) * r;
        let constant = &(&c - &change) * &self.w;
        &(&(&a * &offset(0)) + &(&b * &offset(1))) + &constant
    }

    /// Pixels right and down, about.
    pub(crate) fn pixel(&self) -> [f64; 2] {
        let w = self.w.about();
        self.screen.each_ref().map(|s| s.about() / w)
    }
}
