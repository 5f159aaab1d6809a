//! The six planes of a view: is a box outside all that the view can show?
//!
//! A box is *outside* only if no geometry within it can own a sample of the viewport, whatever
//! rounding the app's vertex shader and the rasteriser's snapping do. Each plane is a linear form
//! `f(p) = n·p + d` that is ≥ 0 for visible points (Gribb and Hartmann, *Fast Extraction of
//! Viewing Frustum Planes*, 2001). It is widened by three amounts:
//!
//! * The side planes are pushed outward by the pixels that snapping can move a vertex: instead
//!   of `x + w ≥ 0`, the left one is `x + (1 + k)·w ≥ 0` with `k` that many pixels in normalised
//!   device coordinates. A clip-space point that fails it and has `w > 0` lies more than that
//!   left of the viewport; one that has `w ≤ 0` is cut off by the near plane.
//! * The app's own float error: each clip coordinate of a point errs by at most
//!   [`View::clip_error`], which is linear in `|p|`. Twice that is allowed, so that the rounding
//!   of clipping and this module's f64 set-up are paid for too.
//! * The f32 error of the test itself: three products and three sums, below `4.1·2⁻²⁴` of the sum
//!   of the magnitudes; `8·2⁻²⁴` is allowed.
//!
//! Together they make a slack `s·|p| + e`, so a box may be called outside only if
//! `Σ max(nᵢpᵢ + sᵢ|pᵢ|) + d + e < 0`, each maximum over the box's interval on axis `i`. Since
//! `nᵢp + sᵢ|p| = max((nᵢ + sᵢ)p, (nᵢ − sᵢ)p)`, the test needs two products an axis and the signs
//! of the two coefficients choose the corners once a plane, not once a box.

use glam::DVec4;

use super::aabb::{f32_above, f32_below};
use super::project::{CLIP_SHARE, UNIT, pixel_slack};
use super::{Aabb, View};

/// Some of a frustum's planes: those that a node's box crosses, which its children must still be
/// tested against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlaneMask(u8);

impl PlaneMask {
    /// All six planes: what a traversal starts with.
    pub const ALL: Self = Self(0b11_1111);
    /// No plane: the box is inside of all of them, and so is everything in it.
    pub const NONE: Self = Self(0);

    /// Whether no plane is left to be tested.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    fn indices(self) -> impl Iterator<Item = usize> {
        (0..6).filter(move |i| self.0 & (1 << i) != 0)
    }
}

/// The six widened planes of a view.
#[derive(Clone, Debug)]
pub struct Frustum {
    planes: [Plane; 6],
}

impl Frustum {
    /// The planes of a view: left, right, bottom, top, and the two of depth. A far plane at
    /// infinity is a form without a normal, which no box is outside of.
    pub fn new(view: &View) -> Self {
        let m = view.clip_from_world();
        let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
        let error = view.clip_error_matrix();
        let (ex, ey, ez, ew) = (error.row(0), error.row(1), error.row(2), error.row(3));
        let viewport = view.viewport();
        let side = |origin: u32, length: u32| {
            let half = 0.5 * f64::from(length);
            1.0 + pixel_slack(origin, length, 0.0) / half
        };
        let (kx, ky) = (side(viewport.x, viewport.width), side(viewport.y, viewport.height));
        // `w − z ≥ 0` is the near plane under reversed z and the far one under standard z: the two
        // are the same planes either way.
        Self {
            planes: [
                Plane::new(w * kx + x, ew * kx + ex),
                Plane::new(w * kx - x, ew * kx + ex),
                Plane::new(w * ky + y, ew * ky + ey),
                Plane::new(w * ky - y, ew * ky + ey),
                Plane::new(w - z, ew + ez),
                Plane::new(z, ez),
            ],
        }
    }

    pub(crate) fn planes(&self) -> &[Plane; 6] {
        &self.planes
    }

    /// Tests a box against the planes of `mask`: `None` if it is outside, else the planes that
    /// it crosses. The planes that are left out have the box entirely inside, hence everything in
    /// it, hence children need only the mask returned.
    ///
    /// An invalid box (NaN, inverted) is never outside.
    pub fn classify(&self, aabb: &Aabb, mask: PlaneMask) -> Option<PlaneMask> {
        let mut crossed = PlaneMask::NONE;
        for i in mask.indices() {
            let plane = &self.planes[i];
            if plane.greatest(aabb) < 0.0 && aabb.is_valid() {
                return None;
            }
            // Not `least < 0`: a box that is not a number stays in the mask.
            let inside = plane.least(aabb) >= 0.0;
            if !inside {
                crossed.0 |= 1 << i;
            }
        }
        Some(crossed)
    }

    /// Whether a box may own a sample: false only if it is certain not to.
    pub fn intersects(&self, aabb: &Aabb) -> bool {
        !(aabb.is_valid() && self.planes.iter().any(|plane| plane.greatest(aabb) < 0.0))
    }

    /// Tests N boxes at once against the planes of `mask`; `min[axis][lane]`. Bit `lane` of the
    /// result is set if that box is outside. Never set for an invalid box.
    ///
    /// The same arithmetic as [`Frustum::classify`], in loops over lanes that the compiler turns
    /// into vector instructions.
    pub fn outside_lanes<const N: usize>(
        &self,
        min: [&[f32; N]; 3],
        max: [&[f32; N]; 3],
        mask: PlaneMask,
    ) -> u32 {
        const { assert!(N <= 32, "the result has 32 bits") };
        let mut outside = [0u32; N];
        for i in mask.indices() {
            let plane = &self.planes[i];
            let pick = |axis: usize, k: f32| if k >= 0.0 { max[axis] } else { min[axis] };
            let [ux, uy, uz] = plane.upper;
            let [lx, ly, lz] = plane.lower;
            let (xu, yu, zu) = (pick(0, ux), pick(1, uy), pick(2, uz));
            let (xl, yl, zl) = (pick(0, lx), pick(1, ly), pick(2, lz));
            for lane in 0..N {
                let x = greater(ux * xu[lane], lx * xl[lane]);
                let y = greater(uy * yu[lane], ly * yl[lane]);
                let z = greater(uz * zu[lane], lz * zl[lane]);
                outside[lane] |= u32::from(((x + y) + z) + plane.outer < 0.0);
            }
        }
        let mut bits = 0;
        for lane in 0..N {
            // As `Aabb::is_valid`: in order, an end that is infinite is one of these two.
            let valid = (0..3).fold(1, |all, axis| {
                let (low, high) = (min[axis][lane], max[axis][lane]);
                all & u32::from(low <= high) & u32::from(low >= f32::MIN) & u32::from(high <= f32::MAX)
            });
            bits |= (outside[lane] & valid) << lane;
        }
        bits
    }
}

/// A linear form and its slack, scaled so that no sum of three products overflows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// n + s, rounded up.
    pub(crate) upper: [f32; 3],
    /// n − s, rounded down.
    pub(crate) lower: [f32; 3],
    /// d + e, rounded up: for "outside".
    pub(crate) outer: f32,
    /// d − e, rounded down: for "inside".
    pub(crate) inner: f32,
}

impl Plane {
    /// From the coefficients of `n·p + d` and of the app's error in it.
    fn new(form: DVec4, app_error: DVec4) -> Self {
        let slack = app_error * CLIP_SHARE;
        let slack = slack + (form.abs() + slack) * (8.0 * UNIT);
        let largest = (form.abs() + slack).max_element();
        // A power of two, so that the scaling is exact; 1/8 of the largest f32 three times over,
        // plus a constant of 1/8, cannot overflow.
        let scale = 0.125 / power_of_two_below(largest);
        let (form, slack) = (form * scale, slack * scale);
        let (upper, lower) = (form + slack, form - slack);
        let tiny = f64::from(f32::MIN_POSITIVE);
        Self {
            upper: [f32_above(upper.x), f32_above(upper.y), f32_above(upper.z)],
            lower: [f32_below(lower.x), f32_below(lower.y), f32_below(lower.z)],
            outer: f32_above(upper.w + tiny),
            inner: f32_below(lower.w - tiny),
        }
    }

    /// An upper bound of the form over a box. In the order of [`Frustum::outside_lanes`].
    fn greatest(&self, aabb: &Aabb) -> f32 {
        let term = |axis: usize| {
            let corner = |k: f32| if k >= 0.0 { aabb.max[axis] } else { aabb.min[axis] };
            let (u, l) = (self.upper[axis], self.lower[axis]);
            greater(u * corner(u), l * corner(l))
        };
        ((term(0) + term(1)) + term(2)) + self.outer
    }

    /// A lower bound of the form over a box.
    fn least(&self, aabb: &Aabb) -> f32 {
        let term = |axis: usize| {
            let corner = |k: f32| if k >= 0.0 { aabb.min[axis] } else { aabb.max[axis] };
            let (u, l) = (self.upper[axis], self.lower[axis]);
            -greater(-(u * corner(u)), -(l * corner(l)))
        };
        ((term(0) + term(1)) + term(2)) + self.inner
    }
}

/// One vector instruction, unlike `f32::max`, which must also sort out NaN; validity is tested
/// apart.
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The greatest power of two that is not above a positive normal number; 1 for others.
fn power_of_two_below(x: f64) -> f64 {
    let exponent = x.to_bits() & f64::INFINITY.to_bits();
    if x.is_normal() { f64::from_bits(exponent) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::geom::{Viewport, projection};

    fn view() -> View {
        View::look_at(Vec3::ZERO, Vec3::NEG_Z, 90.0, 0.1, Viewport::new(100, 100)).unwrap()
    }

    fn cube(x: f32, y: f32, z: f32) -> Aabb {
        Aabb::from_center(Vec3::new(x, y, z), Vec3::splat(0.5))
    }

    #[test]
    fn each_side_is_outside_where_it_should_be() {
        let frustum = Frustum::new(&view());
        let inside =
            [cube(0.0, 0.0, -10.0), cube(9.9, -9.9, -10.0), cube(0.0, 0.0, -0.5), cube(0.0, 0.0, 0.3)];
        let outside = [
            cube(11.6, 0.0, -10.0),
            cube(-11.6, 0.0, -10.0),
            cube(0.0, 11.6, -10.0),
            cube(0.0, -11.6, -10.0),
            cube(0.0, 0.0, 0.5),
            cube(0.0, 0.0, 10.0),
        ];
        assert!(inside.iter().all(|b| frustum.intersects(b)));
        assert!(outside.iter().all(|b| !frustum.intersects(b)));
    }

    #[test]
    fn an_infinite_far_plane_never_culls_and_a_finite_one_does() {
        let far_away = cube(0.0, 0.0, -1e30);
        let frustum = Frustum::new(&view());
        assert!(frustum.intersects(&far_away));
        let largest = Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
        assert_eq!(frustum.classify(&largest, PlaneMask::ALL).map(PlaneMask::is_empty), Some(false));
        for clip_from_view in [
            projection::perspective_finite(1.0, 1.0, 0.1, 100.0),
            projection::perspective_standard(1.0, 1.0, 0.1, 100.0),
        ] {
            let view = View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(100, 100)).unwrap();
            let frustum = Frustum::new(&view);
            assert!(frustum.intersects(&cube(0.0, 0.0, -100.4)));
            assert!(!frustum.intersects(&cube(0.0, 0.0, -101.0)));
            assert!(!frustum.intersects(&far_away));
        }
    }

    #[test]
    fn touching_boxes_are_not_outside() {
        // The left plane is x = z: these boxes touch it with an edge and with a corner's width.
        let frustum = Frustum::new(&view());
        assert!(frustum.intersects(&Aabb::new(Vec3::new(-20.0, -1.0, -10.0), Vec3::new(-10.0, 1.0, -9.0))));
        let point = Vec3::new(-10.0, 10.0, -10.0);
        assert!(frustum.intersects(&Aabb::new(point, point)));
        // The near plane.
        assert!(frustum.intersects(&Aabb::new(Vec3::new(-1.0, -1.0, -0.1), Vec3::ONE)));
    }

    #[test]
    fn masks_shrink_down_a_tree() {
        let frustum = Frustum::new(&view());
        assert_eq!(frustum.classify(&cube(0.0, 0.0, -10.0), PlaneMask::ALL), Some(PlaneMask::NONE));
        let crossing = frustum.classify(&cube(10.0, 0.0, -10.0), PlaneMask::ALL).unwrap();
        assert_eq!(crossing.indices().collect::<Vec<_>>(), [1]);
        // Only the planes of the mask are tested.
        let beyond = cube(20.0, 0.0, -10.0);
        assert_eq!(frustum.classify(&beyond, crossing), None);
        assert_eq!(frustum.classify(&beyond, PlaneMask::NONE), Some(PlaneMask::NONE));
    }

    #[test]
    fn invalid_boxes_are_never_outside() {
        let frustum = Frustum::new(&view());
        let behind = cube(0.0, 0.0, 10.0);
        for axis in 0..3 {
            const INFINITE: f32 = f32::INFINITY;
            for (low, high) in [
                (f32::NAN, 1.0),
                (0.0, f32::NAN),
                (f32::NAN, f32::NAN),
                (1.0, -1.0),
                (1.0, INFINITE),
                (-INFINITE, 1.0),
                (INFINITE, INFINITE),
            ] {
                let mut bad = behind;
                (bad.min[axis], bad.max[axis]) = (low, high);
                assert!(frustum.intersects(&bad), "{bad:?}");
                assert!(frustum.classify(&bad, PlaneMask::ALL).is_some(), "{bad:?}");
                let (min, max) = (bad.min, bad.max);
                let (min, max) = ([&[min.x], &[min.y], &[min.z]], [&[max.x], &[max.y], &[max.z]]);
                assert_eq!(frustum.outside_lanes(min, max, PlaneMask::ALL), 0, "{bad:?}");
            }
        }
    }

    #[test]
    fn lanes_answer_in_their_own_bits() {
        let frustum = Frustum::new(&view());
        let boxes: [Aabb; 4] = std::array::from_fn(|i| cube(i as f32 * 10.0, 0.0, -15.0));
        let [x, y, z] = [0, 1, 2].map(|axis| boxes.map(|b| b.min[axis]));
        let [u, v, w] = [0, 1, 2].map(|axis| boxes.map(|b| b.max[axis]));
        assert_eq!(frustum.outside_lanes([&x, &y, &z], [&u, &v, &w], PlaneMask::ALL), 0b1100);
        assert_eq!(frustum.outside_lanes([&x, &y, &z], [&u, &v, &w], PlaneMask::NONE), 0);
    }
}
