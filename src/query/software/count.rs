//! Answers: how many samples of a proxy are in sight.
//!
//! The plain loop of the contract looks at every sample. Here whole tiles are decided at once, and
//! the result is the same to the sample, by monotonicity: for fixed `dy`, `(a·dx + b·dy) + c` is a
//! chain of correctly rounded f32 operations, each monotone in its argument, so its value is
//! monotone in `dx`, rising or falling with the sign of `a`; likewise in `dy`. Over a rectangle of
//! samples it is therefore least and greatest at the corners that the signs of `a` and `b` name,
//! *including* rounding. The least of several such functions is bounded by the least of their
//! bounds.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays advance together, by index")]

use super::depth::Depth;
use super::hi_z::{HiZ, TILE_HEIGHT, TILE_WIDTH};
use super::raster::LANES;
use crate::geom::{PixelRect, Proxy};

/// The depth that a question is put to.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) depth: &'a Depth,
    pub(crate) hi_z: &'a HiZ,
}

/// Coefficients so large that the evaluation could overflow to NaN are not evaluated. Offsets stay
/// below 2¹⁵, so below this bound all sums of two products are finite.
const LARGEST: f32 = 1e33;

/// Whether a proxy can be evaluated: if not, it must be taken as visible.
pub(crate) fn is_usable(proxy: &Proxy) -> bool {
    let fits = |f: &[f32; 3]| f[0].abs() <= LARGEST && f[1].abs() <= LARGEST && f[2].is_finite();
    proxy.edges.iter().all(fits) && proxy.planes.iter().all(fits) && !proxy.nearest.is_nan()
}

/// Lanes for the six edges; the others are 0 everywhere, which covers.
const EDGES: usize = 8;
/// Lanes of those that a proxy can use.
const USED_EDGES: usize = 6;
/// Lanes for the three planes, and `nearest` as a fourth.
const PLANES: usize = 4;

/// Affine functions, a lane each.
#[derive(Clone, Copy)]
struct Functions<const N: usize> {
    a: [f32; N],
    b: [f32; N],
    c: [f32; N],
}

impl<const N: usize> Functions<N> {
    const ZERO: Self = Self { a: [0.0; N], b: [0.0; N], c: [0.0; N] };

    #[inline(always)]
    fn set(&mut self, i: usize, function: [f32; 3]) {
        (self.a[i], self.b[i], self.c[i]) = (function[0], function[1], function[2]);
    }

    /// The greatest and the least value of each function over the samples of a rectangle, given
    /// by the offsets of its first and last sample.
    #[inline(always)]
    fn extremes(&self, first: [f32; 2], last: [f32; 2]) -> ([f32; N], [f32; N]) {
        let mut greatest = [0.0; N];
        let mut least = [0.0; N];
        for i in 0..N {
            let (a, b, c) = (self.a[i], self.b[i], self.c[i]);
            let high_x = if a >= 0.0 { last[0] } else { first[0] };
            let low_x = if a >= 0.0 { first[0] } else { last[0] };
            let high_y = if b >= 0.0 { last[1] } else { first[1] };
            let low_y = if b >= 0.0 { first[1] } else { last[1] };
            greatest[i] = (a * high_x + b * high_y) + c;
            least[i] = (a * low_x + b * low_y) + c;
        }
        (greatest, least)
    }
}

/// A proxy in lanes.
struct Shape {
    origin: [u32; 2],
    edges: Functions<EDGES>,
    planes: Functions<PLANES>,
}

impl Shape {
    #[inline(always)]
    fn new(proxy: &Proxy) -> Self {
        let mut shape = Self { origin: proxy.origin(), edges: Functions::ZERO, planes: Functions::ZERO };
        for (i, edge) in proxy.edges.iter().enumerate() {
            shape.edges.set(i, *edge);
        }
        for (i, plane) in proxy.planes.iter().enumerate() {
            shape.planes.set(i, *plane);
        }
        shape.planes.set(PLANES - 1, [0.0, 0.0, proxy.nearest]);
        shape
    }

    #[inline(always)]
    fn judge(&self, part: &PixelRect) -> Verdict {
        let first = [offset(part.x0, self.origin[0]), offset(part.y0, self.origin[1])];
        let last = [offset(part.x1 - 1, self.origin[0]), offset(part.y1 - 1, self.origin[1])];
        let (greatest, least) = self.edges.extremes(first, last);
        let (mut outside, mut cut) = (0, 0);
        for i in 0..EDGES {
            outside |= i32::from(greatest[i] < 0.0);
            cut |= i32::from(least[i] < 0.0);
        }
        let (greatest, least) = self.planes.extremes(first, last);
        Verdict {
            outside: outside != 0,
            inside: cut == 0,
            entry_most: lesser(lesser(greatest[0], greatest[1]), lesser(greatest[2], greatest[3])),
            entry_least: lesser(lesser(least[0], least[1]), lesser(least[2], least[3])),
        }
    }
}

/// What is known of a rectangle of samples.
struct Verdict {
    /// No sample is covered.
    outside: bool,
    /// Every sample is covered.
    inside: bool,
    /// The entry nearness of no sample is above this.
    entry_most: f32,
    /// The entry nearness of no sample is below this.
    entry_least: f32,
}

/// The contract's `dx` and `dy`. Exact: a viewport's side fits f32 with a half to spare.
#[inline(always)]
fn offset(pixel: u32, origin: u32) -> f32 {
    (pixel as i32 - origin as i32) as f32 + 0.5
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Room for the tiles yet to be looked at: four to begin with, and each level trades one for four.
const STACK: usize = 64;

/// Whether some sample of a proxy is in sight.
#[inline(always)]
pub(crate) fn any(scene: Scene<'_>, proxy: &Proxy) -> bool {
    let mut found = false;
    walk(
        scene,
        proxy,
        #[inline(always)]
        |part, shape, verdict, (farthest, nearest), is_leaf| {
            if verdict.entry_most < farthest {
                return Step::Over;
            }
            if verdict.inside && verdict.entry_least >= nearest {
                found = true;
                return Step::Stop;
            }
            if !is_leaf {
                return Step::Into;
            }
            found = samples(scene.depth, shape, part, tile_column(part)).0 > 0;
            if found { Step::Stop } else { Step::Over }
        },
    );
    found
}

/// A proxy of at most so many rows, and [`LANES`] columns, is counted without a look at the
/// hierarchy.
const FEW_ROWS: u32 = 16;

/// How many samples of a proxy are in sight, and how many it covers.
#[inline(always)]
pub(crate) fn dual(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) {
    let rect = on_screen(scene, proxy);
    if rect.x0 >= rect.x1 || rect.y0 >= rect.y1 {
        return (0, 0);
    }
    if rect.width() <= LANES as u32 && rect.height() <= FEW_ROWS {
        return samples(scene.depth, &Shape::new(proxy), &rect, rect.x0);
    }
    let (mut visible, mut total) = (0, 0);
    walk(
        scene,
        proxy,
        #[inline(always)]
        |part, shape, verdict, (farthest, nearest), is_leaf| {
            let area = (part.x1 - part.x0) * (part.y1 - part.y0);
            if verdict.inside && verdict.entry_most < farthest {
                total += area;
                return Step::Over;
            }
            if verdict.inside && verdict.entry_least >= nearest {
                visible += area;
                total += area;
                return Step::Over;
            }
            if !is_leaf {
                return Step::Into;
            }
            let (v, t) = samples(scene.depth, shape, part, tile_column(part));
            visible += v;
            total += t;
            Step::Over
        },
    );
    (visible, total)
}

/// The pixels of a proxy that the depth buffer has; perhaps none.
#[inline(always)]
fn on_screen(scene: Scene<'_>, proxy: &Proxy) -> PixelRect {
    let image = scene.depth.image();
    PixelRect { x1: proxy.rect.x1.min(image.width()), y1: proxy.rect.y1.min(image.height()), ..proxy.rect }
}

/// Where to go from a tile.
#[derive(PartialEq)]
enum Step {
    Into,
    Over,
    Stop,
}

/// Walks the tiles that a proxy meets, coarse before fine.
#[inline(always)]
fn walk(
    scene: Scene<'_>,
    proxy: &Proxy,
    mut visit: impl FnMut(&PixelRect, &Shape, &Verdict, (f32, f32), bool) -> Step,
) {
    let rect = on_screen(scene, proxy);
    if rect.x0 >= rect.x1 || rect.y0 >= rect.y1 {
        return;
    }
    let shape = Shape::new(proxy);
    let (level, first, last) = scene.hi_z.cover(&rect);
    let mut stack = [(0_u32, 0_u32, 0_u32); STACK];
    let mut height = 0;
    for y in first[1]..=last[1] {
        for x in first[0]..=last[0] {
            stack[height] = (level as u32, x, y);
            height += 1;
        }
    }
    while height > 0 {
        height -= 1;
        let (level, x, y) = stack[height];
        let (width, lines) = (TILE_WIDTH << level, TILE_HEIGHT << level);
        let part = PixelRect {
            x0: (x * width).max(rect.x0),
            y0: (y * lines).max(rect.y0),
            x1: ((x + 1) * width).min(rect.x1),
            y1: ((y + 1) * lines).min(rect.y1),
        };
        if part.x0 >= part.x1 || part.y0 >= part.y1 {
            continue;
        }
        let verdict = shape.judge(&part);
        if verdict.outside {
            continue;
        }
        let tile = scene.hi_z.tile(level as usize, x, y);
        match visit(&part, &shape, &verdict, tile, level == 0) {
            Step::Stop => return,
            Step::Over => {}
            Step::Into => {
                for child in 0..4 {
                    stack[height] = (level - 1, 2 * x + (child & 1), 2 * y + (child >> 1));
                    height += 1;
                }
            }
        }
    }
}

/// The first column of the tile that a part of one lies in.
#[inline(always)]
fn tile_column(part: &PixelRect) -> u32 {
    part.x0 / TILE_WIDTH * TILE_WIDTH
}

/// The plain loop over the samples of a rectangle that lies in the [`LANES`] columns from
/// `first_column` on: visible and covered ones.
#[inline(always)]
fn samples(depth: &Depth, shape: &Shape, part: &PixelRect, first_column: u32) -> (u32, u32) {
    // Lanes are columns; those outside the part have no bit in `in_part`.
    let mut in_part = [0_i32; LANES];
    let mut edges_x = [[0.0_f32; LANES]; EDGES];
    let mut planes_x = [[0.0_f32; LANES]; PLANES];
    for i in 0..LANES {
        let column = first_column + i as u32;
        let dx = offset(column, shape.origin[0]);
        in_part[i] = -(i32::from(column >= part.x0) & i32::from(column < part.x1));
        for k in 0..EDGES {
            edges_x[k][i] = shape.edges.a[k] * dx;
        }
        for k in 0..PLANES {
            planes_x[k][i] = shape.planes.a[k] * dx;
        }
    }
    let mut visible = [0_i32; LANES];
    let mut total = [0_i32; LANES];
    for row in part.y0..part.y1 {
        let dy = offset(row, shape.origin[1]);
        let mut edges_y = [0.0; EDGES];
        let mut planes_y = [0.0; PLANES];
        for k in 0..EDGES {
            edges_y[k] = shape.edges.b[k] * dy;
        }
        for k in 0..PLANES {
            planes_y[k] = shape.planes.b[k] * dy;
        }
        let start = row as usize * depth.stride() + first_column as usize;
        let Some(nearness) = depth.all()[start..].first_chunk::<LANES>() else { continue };
        for i in 0..LANES {
            let (mut outer, mut entry) = (f32::INFINITY, f32::INFINITY);
            for k in 0..USED_EDGES {
                outer = lesser((edges_x[k][i] + edges_y[k]) + shape.edges.c[k], outer);
            }
            for k in 0..PLANES {
                entry = lesser((planes_x[k][i] + planes_y[k]) + shape.planes.c[k], entry);
            }
            let covered = in_part[i] & -i32::from(outer >= 0.0);
            total[i] -= covered;
            visible[i] -= covered & -i32::from(entry >= nearness[i]);
        }
    }
    (visible.iter().sum::<i32>() as u32, total.iter().sum::<i32>() as u32)
}
