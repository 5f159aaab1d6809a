//! Answers: how many samples of a proxy are in sight.
//!
//! The plain loop of the contract looks at every sample. Here whole tiles are decided at once, and
//! the result is the same to the sample, by monotonicity: for fixed `dy`, `(a·dx + b·dy) + c` is a
//! chain of correctly rounded f32 operations, each monotone in its argument, so its value is
//! monotone in `dx`, rising or falling with the sign of `a`; likewise in `dy`. Over a rectangle of
//! samples it is therefore least and greatest at the corners that the signs of `a` and `b` name,
//! *including* rounding. The least of several such functions is bounded by the least of their
//! bounds.

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

/// Nine affine functions with a lane each: six edges, then three planes.
const FUNCTIONS: usize = 16;
const EDGES: usize = 6;
const PLANES: usize = 9;

struct Functions {
    a: [f32; FUNCTIONS],
    b: [f32; FUNCTIONS],
    c: [f32; FUNCTIONS],
}

impl Functions {
    #[inline(always)]
    fn new(proxy: &Proxy) -> Self {
        let mut f = Self { a: [0.0; FUNCTIONS], b: [0.0; FUNCTIONS], c: [0.0; FUNCTIONS] };
        for (i, function) in proxy.edges.iter().chain(&proxy.planes).enumerate() {
            f.a[i] = function[0];
            f.b[i] = function[1];
            f.c[i] = function[2];
        }
        f
    }

    /// The greatest and the least value of each function over the samples of a rectangle, given
    /// by the offsets of its first and last sample.
    #[inline(always)]
    fn extremes(&self, first: [f32; 2], last: [f32; 2]) -> ([f32; FUNCTIONS], [f32; FUNCTIONS]) {
        let mut greatest = [0.0; FUNCTIONS];
        let mut least = [0.0; FUNCTIONS];
        for i in 0..FUNCTIONS {
            let (a, b, c) = (self.a[i], self.b[i], self.c[i]);
            let (high_x, low_x) = if a >= 0.0 { (last[0], first[0]) } else { (first[0], last[0]) };
            let (high_y, low_y) = if b >= 0.0 { (last[1], first[1]) } else { (first[1], last[1]) };
            greatest[i] = (a * high_x + b * high_y) + c;
            least[i] = (a * low_x + b * low_y) + c;
        }
        (greatest, least)
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

#[inline(always)]
fn judge(functions: &Functions, nearest: f32, origin: [u32; 2], part: &PixelRect) -> Verdict {
    let first = [offset(part.x0, origin[0]), offset(part.y0, origin[1])];
    let last = [offset(part.x1 - 1, origin[0]), offset(part.y1 - 1, origin[1])];
    let (greatest, least) = functions.extremes(first, last);
    let (mut outer, mut inner) = (f32::INFINITY, f32::INFINITY);
    for i in 0..EDGES {
        outer = lesser(greatest[i], outer);
        inner = lesser(least[i], inner);
    }
    let (mut entry_most, mut entry_least) = (nearest, nearest);
    for i in EDGES..PLANES {
        entry_most = lesser(greatest[i], entry_most);
        entry_least = lesser(least[i], entry_least);
    }
    Verdict { outside: outer < 0.0, inside: inner >= 0.0, entry_most, entry_least }
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
    walk(scene, proxy, |part, functions, verdict, (farthest, nearest), is_leaf| {
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
        found = samples(scene.depth, proxy, functions, part).0 > 0;
        if found { Step::Stop } else { Step::Over }
    });
    found
}

/// How many samples of a proxy are in sight, and how many it covers.
#[inline(always)]
pub(crate) fn dual(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) {
    let (mut visible, mut total) = (0, 0);
    walk(scene, proxy, |part, functions, verdict, (farthest, nearest), is_leaf| {
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
        let (v, t) = samples(scene.depth, proxy, functions, part);
        visible += v;
        total += t;
        Step::Over
    });
    (visible, total)
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
    mut visit: impl FnMut(&PixelRect, &Functions, &Verdict, (f32, f32), bool) -> Step,
) {
    let image = scene.depth.image();
    let rect = PixelRect {
        x1: proxy.rect.x1.min(image.width()),
        y1: proxy.rect.y1.min(image.height()),
        ..proxy.rect
    };
    if rect.x0 >= rect.x1 || rect.y0 >= rect.y1 {
        return;
    }
    let functions = Functions::new(proxy);
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
        let verdict = judge(&functions, proxy.nearest, [proxy.rect.x0, proxy.rect.y0], &part);
        if verdict.outside {
            continue;
        }
        let tile = scene.hi_z.tile(level as usize, x, y);
        match visit(&part, &functions, &verdict, tile, level == 0) {
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

/// The plain loop over the samples of part of one tile: visible and covered ones.
#[inline(always)]
fn samples(depth: &Depth, proxy: &Proxy, f: &Functions, part: &PixelRect) -> (u32, u32) {
    // Lanes are the tile's columns: those outside the part have their bit of `in_part` cleared.
    let first_column = part.x0 / TILE_WIDTH * TILE_WIDTH;
    let mut dx = [0.0_f32; LANES];
    let mut in_part = [0_i32; LANES];
    for i in 0..LANES {
        let column = first_column + i as u32;
        dx[i] = offset(column, proxy.rect.x0);
        in_part[i] = -i32::from(column >= part.x0 && column < part.x1);
    }
    let mut visible = [0_i32; LANES];
    let mut total = [0_i32; LANES];
    for row in part.y0..part.y1 {
        let dy = offset(row, proxy.rect.y0);
        let start = row as usize * depth.stride() + first_column as usize;
        let Some(nearness) = depth.all()[start..].first_chunk::<LANES>() else { continue };
        let mut outer = [f32::INFINITY; LANES];
        let mut entry = [proxy.nearest; LANES];
        for k in 0..EDGES {
            let by = f.b[k] * dy;
            for i in 0..LANES {
                outer[i] = lesser((f.a[k] * dx[i] + by) + f.c[k], outer[i]);
            }
        }
        for k in EDGES..PLANES {
            let by = f.b[k] * dy;
            for i in 0..LANES {
                entry[i] = lesser((f.a[k] * dx[i] + by) + f.c[k], entry[i]);
            }
        }
        for i in 0..LANES {
            let covered = in_part[i] & -i32::from(outer[i] >= 0.0);
            total[i] -= covered;
            visible[i] -= covered & -i32::from(entry[i] >= nearness[i]);
        }
    }
    (visible.iter().sum::<i32>() as u32, total.iter().sum::<i32>() as u32)
}
