//! Answers: how many samples of a proxy are in sight.
//!
//! The plain loop of the contract looks at every sample. Here whole nodes of the hierarchy are
//! decided at once, sixteen children by sixteen, and the result is the same to the sample, by
//! monotonicity: for fixed `dy`, `(a·dx + b·dy) + c` is a chain of correctly rounded f32
//! operations, each monotone in its argument, so its value is monotone in `dx`, rising or falling
//! with the sign of `a`; likewise in `dy`. Over a rectangle of samples it is therefore least and
//! greatest at the corners that the signs of `a` and `b` name, *including* rounding. The least of
//! several such functions is bounded by the least of their bounds.

use super::depth::Depth;
use super::hi_z::HiZ;
use super::isa::{ALL, Isa, Mask, splat_each};
use super::layout::{BLOCK_BITS, LANE_X, LANE_Y, TILE, TILE_BITS, within};
use crate::geom::{PixelRect, Proxy};

/// The depth that a question is put to.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) depth: &'a Depth,
    pub(crate) hi_z: &'a HiZ,
}

/// Coefficients so large that the evaluation could overflow to NaN are not evaluated. Offsets stay
/// below 2¹⁵, so below this bound all sums of two products are finite.
pub(super) const LARGEST: f32 = 1e33;

/// Whether a proxy can be evaluated: if not, it must be taken as visible.
pub(crate) fn is_usable(proxy: &Proxy) -> bool {
    let fits = |f: &[f32; 3]| f[0].abs() <= LARGEST && f[1].abs() <= LARGEST && f[2].is_finite();
    proxy.edges.iter().all(fits) && proxy.planes.iter().all(fits) && !proxy.nearest.is_nan()
}

/// A proxy of at most so many tiles is counted sample by sample: to judge tiles first takes longer.
const FEW_TILES: u32 = 12;

/// Room for the nodes yet to be looked at: four to begin with, and each level trades one for
/// sixteen.
const STACK: usize = 128;

/// Whether some sample of a proxy is in sight.
#[inline(always)]
pub(crate) fn any<I: Isa>(scene: Scene<'_>, proxy: &Proxy) -> bool {
    let Some(question) = Inquiry::<I>::new(scene, proxy) else { return false };
    let mut found = false;
    question.walk(
        #[inline(always)]
        |visit| {
            found |= match visit {
                Visit::Children { part, far, near } => {
                    part.inside & I::ge_f(part.entry_least, near) != 0 || {
                        part.open &= !I::gt_f(far, part.entry_most);
                        false
                    }
                }
                Visit::Samples { visible, .. } => visible != 0,
            };
            !found
        },
    );
    found
}

/// How many samples of a proxy are in sight, and how many it covers.
#[inline(always)]
pub(crate) fn dual<I: Isa>(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) {
    let Some(question) = Inquiry::<I>::new(scene, proxy) else { return (0, 0) };
    let (mut seen, mut total) = (0, 0);
    question.walk(
        #[inline(always)]
        |visit| {
            match visit {
                Visit::Children { part, far, near } => {
                    let visible = part.inside & I::ge_f(part.entry_least, near);
                    let hidden = part.inside & I::gt_f(far, part.entry_most);
                    if visible | hidden != 0 {
                        let area = part.areas(visible);
                        seen += area;
                        total += area + part.areas(hidden & !visible);
                        part.open &= !(visible | hidden);
                    }
                }
                Visit::Samples { visible, covered, .. } => {
                    seen += visible.count_ones();
                    total += covered.count_ones();
                }
            }
            true
        },
    );
    (seen, total)
}

/// What a walk comes by.
pub(super) enum Visit<'v, I: Isa> {
    /// The children of a node; the walk goes on into those that stay open.
    Children { part: &'v mut Judged<I>, far: I::F, near: I::F },
    /// The samples of the tile at a pixel.
    Samples { at: [u32; 2], visible: Mask, covered: Mask },
}

/// What is known of the samples of sixteen rectangles.
pub(super) struct Judged<I: Isa> {
    /// Some sample may be covered.
    pub(super) open: Mask,
    /// Every sample is covered.
    inside: Mask,
    /// The entry nearness of no sample is above this.
    pub(super) entry_most: I::F,
    /// The entry nearness of no sample is below this.
    entry_least: I::F,
    /// Columns and rows.
    size: [I::I; 2],
}

impl<I: Isa> Judged<I> {
    /// The samples of some of the rectangles.
    #[inline(always)]
    fn areas(&self, mut lanes: Mask) -> u32 {
        let areas = I::store(I::mul(self.size[0], self.size[1]));
        let mut sum = 0;
        while lanes != 0 {
            sum += areas[lanes.trailing_zeros() as usize] as u32;
            lanes &= lanes - 1;
        }
        sum
    }
}

/// A proxy that is asked about.
pub(super) struct Inquiry<'a, I: Isa> {
    scene: Scene<'a>,
    proxy: &'a Proxy,
    /// Its pixels in the viewport; not empty.
    rect: PixelRect,
    lane_x: I::I,
    lane_y: I::I,
}

impl<'a, I: Isa> Inquiry<'a, I> {
    #[inline(always)]
    pub(super) fn new(scene: Scene<'a>, proxy: &'a Proxy) -> Option<Self> {
        let image = scene.depth.image();
        let rect = PixelRect {
            x1: proxy.rect.x1.min(image.width()),
            y1: proxy.rect.y1.min(image.height()),
            ..proxy.rect
        };
        let (lane_x, lane_y) = (I::load(&LANE_X), I::load(&LANE_Y));
        (rect.x0 < rect.x1 && rect.y0 < rect.y1).then_some(Self { scene, proxy, rect, lane_x, lane_y })
    }

    /// Walks what the proxy meets, coarse before fine, until `visit` says false.
    #[inline(always)]
    pub(super) fn walk(&self, mut visit: impl FnMut(Visit<'_, I>) -> bool) {
        let rect = &self.rect;
        let (first, last) = nodes(rect, TILE_BITS);
        if (last[0] - first[0] + 1) * (last[1] - first[1] + 1) <= FEW_TILES {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    let at = [x << TILE_BITS, y << TILE_BITS];
                    let (visible, covered) = self.samples(at[0], at[1]);
                    if !visit(Visit::Samples { at, visible, covered }) {
                        return;
                    }
                }
            }
            return;
        }
        // The lowest level where the proxy meets at most 2 × 2 nodes.
        let (mut level, mut bits) = (0, BLOCK_BITS);
        let (mut first, mut last) = nodes(rect, bits);
        while last[0] - first[0] > 1 || last[1] - first[1] > 1 {
            (level, bits) = (level + 1, bits + TILE_BITS);
            (first, last) = nodes(rect, bits);
        }
        let mut stack = [(0_u32, 0_u32, 0_u32); STACK];
        let mut height = 0;
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                stack[height] = (level, x, y);
                height += 1;
            }
        }
        while height > 0 {
            height -= 1;
            let (level, x, y) = stack[height];
            let mut part = self.judge(level, x, y);
            if part.open == 0 {
                continue;
            }
            let (far, near) = self.scene.hi_z.node(level as usize, x, y);
            let (far, near) = (I::load_f(far), I::load_f(near));
            if !visit(Visit::Children { part: &mut part, far, near }) {
                return;
            }
            let mut open = part.open;
            while open != 0 {
                let lane = open.trailing_zeros();
                open &= open - 1;
                let (x, y) = (4 * x + lane % 4, 4 * y + lane / 4);
                if level > 0 {
                    stack[height] = (level - 1, x, y);
                    height += 1;
                    continue;
                }
                let at = [x << TILE_BITS, y << TILE_BITS];
                let (visible, covered) = self.samples(at[0], at[1]);
                if !visit(Visit::Samples { at, visible, covered }) {
                    return;
                }
            }
        }
    }

    /// The contract's `dx` or `dy`. Exact: a viewport's side fits f32 with a half to spare.
    #[inline(always)]
    fn offset(&self, pixel: I::I, axis: usize) -> I::F {
        let origin = I::splat(self.proxy.origin()[axis] as i32);
        I::add_f(I::to_f(I::sub(pixel, origin)), I::splat_f(0.5))
    }

    /// Judges the children of a node.
    #[inline(always)]
    fn judge(&self, level: u32, x: u32, y: u32) -> Judged<I> {
        let side = TILE << (TILE_BITS * level);
        let rect = &self.rect;
        let (x0, x1) = child_pixels::<I>(x, side, self.lane_x, rect.x0, rect.x1);
        let (y0, y1) = child_pixels::<I>(y, side, self.lane_y, rect.y0, rect.y1);
        let first = [self.offset(x0, 0), self.offset(y0, 1)];
        let last = [self.offset(x1, 0), self.offset(y1, 1)];
        let zero = I::splat_f(0.0);
        let (mut outside, mut cut) = (I::gt(x0, x1) | I::gt(y0, y1), 0);
        for edge in &self.proxy.edges {
            let (greatest, least) = extremes::<I>(edge, first, last);
            outside |= I::gt_f(zero, greatest);
            cut |= I::gt_f(zero, least);
        }
        let nearest = I::splat_f(self.proxy.nearest);
        let (mut entry_most, mut entry_least) = (nearest, nearest);
        for plane in &self.proxy.planes {
            let (greatest, least) = extremes::<I>(plane, first, last);
            entry_most = I::min_f(greatest, entry_most);
            entry_least = I::min_f(least, entry_least);
        }
        let one = I::splat(1);
        let size = [I::add(I::sub(x1, x0), one), I::add(I::sub(y1, y0), one)];
        let open = ALL & !outside;
        Judged { open, inside: open & !cut, entry_most, entry_least, size }
    }

    /// The samples of the tile at a pixel: those in sight, and those covered.
    #[inline(always)]
    pub(super) fn samples(&self, x: u32, y: u32) -> (Mask, Mask) {
        let column = I::add(I::splat(x as i32), self.lane_x);
        let row = I::add(I::splat(y as i32), self.lane_y);
        let rect = &self.rect;
        let end = I::gt(I::splat(rect.x1 as i32), column) & I::gt(I::splat(rect.y1 as i32), row);
        let before = I::gt(I::splat(rect.x0 as i32), column) | I::gt(I::splat(rect.y0 as i32), row);
        let in_rect = end & !before;
        let (dx, dy) = (self.offset(column, 0), self.offset(row, 1));
        let zero = I::splat_f(0.0);
        let mut outer = zero;
        for edge in &self.proxy.edges {
            outer = I::min_f(value::<I>(edge, dx, dy), outer);
        }
        let covered = in_rect & I::ge_f(outer, zero);
        let mut entry = I::splat_f(self.proxy.nearest);
        for plane in &self.proxy.planes {
            entry = I::min_f(value::<I>(plane, dx, dy), entry);
        }
        let (tile, _) = within(x, y);
        let block = (y >> BLOCK_BITS) as usize * self.scene.depth.across() + (x >> BLOCK_BITS) as usize;
        let kept = I::load_f(&self.scene.depth.blocks()[block].0[tile]);
        (covered & I::ge_f(entry, kept), covered)
    }
}

/// The nodes of `1 << bits` pixels a side that pixels lie in, ends included.
#[inline(always)]
fn nodes(rect: &PixelRect, bits: u32) -> ([u32; 2], [u32; 2]) {
    ([rect.x0 >> bits, rect.y0 >> bits], [(rect.x1 - 1) >> bits, (rect.y1 - 1) >> bits])
}

/// The first and the last pixels, between two, of the children of a node, on one axis.
#[inline(always)]
fn child_pixels<I: Isa>(node: u32, side: i32, lanes: I::I, from: u32, end: u32) -> (I::I, I::I) {
    let start = I::add(I::splat(4 * side * node as i32), I::mul(lanes, I::splat(side)));
    let last = I::add(start, I::splat(side - 1));
    (I::max(start, I::splat(from as i32)), I::min(last, I::splat(end as i32 - 1)))
}

/// A function of the contract, at sixteen places.
#[inline(always)]
pub(super) fn value<I: Isa>(f: &[f32; 3], dx: I::F, dy: I::F) -> I::F {
    let [a, b, c] = splat_each::<I, 3>(*f);
    I::add_f(I::add_f(I::mul_f(a, dx), I::mul_f(b, dy)), c)
}

/// The greatest and the least value of a function over the samples of sixteen rectangles, given by
/// their first and last.
#[inline(always)]
fn extremes<I: Isa>(f: &[f32; 3], first: [I::F; 2], last: [I::F; 2]) -> (I::F, I::F) {
    let (high_x, low_x) = if f[0] >= 0.0 { (last[0], first[0]) } else { (first[0], last[0]) };
    let (high_y, low_y) = if f[1] >= 0.0 { (last[1], first[1]) } else { (first[1], last[1]) };
    (value::<I>(f, high_x, high_y), value::<I>(f, low_x, low_y))
}
