//! From corners to edge functions and depth: what sixteen triangles need before they are sampled.
//!
//! Coverage is decided by edge functions in integers: a sample (a pixel's centre) is covered where
//! all three are positive, or zero on a top or left edge. Depth is interpolated from the edge
//! functions, rounded once to f32: `n0 + (λ1·(n1 - n0) + λ2·(n2 - n0))`, `λ = edge / area`, clamped
//! to the triangle's own range. Each λ lies in [0, 1] and errs by less than 2 ulps, each
//! difference and product by half an ulp of at most the largest |nearness|, so the sum errs by a
//! few ulps of that. All paths share [`Shading::nearness`]; the same triangle yields the same bits
//! in each of them.

use super::isa::Isa;
use super::vertex::{SUBPIXEL_BITS, SUBPIXELS};

/// The longest side of a triangle's bounding box, in subpixels, that is rasterised in i32: an edge
/// function inside the bounding box is at most its area, 2³⁰, and a block of pixels reaches
/// less than 2²⁸ beyond.
pub(crate) const SMALL_EXTENT: i32 = 128 << SUBPIXEL_BITS;

/// Sixteen triangles on the screen, by snapped corners.
#[derive(Clone, Copy)]
pub(crate) struct Corners<I: Isa> {
    pub(crate) x: [I::I; 3],
    pub(crate) y: [I::I; 3],
    pub(crate) nearness: [I::F; 3],
}

/// Sixteen triangles of at most [`SMALL_EXTENT`] a side, wound clockwise, ready to be sampled.
pub(crate) struct Setup<I: Isa> {
    /// The edge function opposite to each corner, at the first sample.
    pub(crate) edge: [I::I; 3],
    /// Its change from column to column.
    pub(crate) step_x: [I::I; 3],
    /// Its change from row to row.
    pub(crate) step_y: [I::I; 3],
    /// Covered is what is greater: -1 for a top or left edge, 0 for the others.
    pub(crate) limit: [I::I; 3],
    pub(crate) shading: Shading<I>,
}

impl<I: Isa> Setup<I> {
    /// Sets up for the sample in a column and row of each triangle, at most 15 before its bounding
    /// box. Nothing overflows; lanes with anything else yield nonsense.
    #[inline(always)]
    pub(crate) fn new(corners: &Corners<I>, column: I::I, row: I::I) -> Self {
        let Corners { x, y, nearness: n } = *corners;
        let area = cross::<I>(I::sub(x[1], x[0]), I::sub(y[1], y[0]), I::sub(x[2], x[0]), I::sub(y[2], y[0]));
        let zero = I::splat(0);
        let turned = I::gt(zero, area);
        let x = [x[0], I::blend(turned, x[1], x[2]), I::blend(turned, x[2], x[1])];
        let y = [y[0], I::blend(turned, y[1], y[2]), I::blend(turned, y[2], y[1])];
        let n = [n[0], I::blend_f(turned, n[1], n[2]), I::blend_f(turned, n[2], n[1])];
        let (sx, sy) = (centre::<I>(column), centre::<I>(row));
        let dx = [I::sub(x[2], x[1]), I::sub(x[0], x[2]), I::sub(x[1], x[0])];
        let dy = [I::sub(y[2], y[1]), I::sub(y[0], y[2]), I::sub(y[1], y[0])];
        // The edges run along the border of a triangle of positive area, clockwise with y down: a
        // top edge runs right, a left edge up.
        let (mut edge, mut limit) = ([zero; 3], [zero; 3]);
        let (mut step_x, mut step_y) = ([zero; 3], [zero; 3]);
        for k in 0..3 {
            let from = (k + 1) % 3;
            edge[k] = cross::<I>(dx[k], dy[k], I::sub(sx, x[from]), I::sub(sy, y[from]));
            let level = I::gt(I::splat(1), dy[k]) & I::gt(dy[k], I::splat(-1));
            let covers = I::gt(zero, dy[k]) | (level & I::gt(dx[k], zero));
            limit[k] = I::blend(covers, zero, I::splat(-1));
            step_x[k] = I::sub(zero, I::shift_left::<SUBPIXEL_BITS>(dy[k]));
            step_y[k] = I::shift_left::<SUBPIXEL_BITS>(dx[k]);
        }
        let area = I::max(area, I::sub(zero, area));
        let shading = Shading::new(n, I::to_f(area));
        Self { edge, step_x, step_y, limit, shading }
    }
}

#[inline(always)]
fn cross<I: Isa>(ax: I::I, ay: I::I, bx: I::I, by: I::I) -> I::I {
    I::sub(I::mul(ax, by), I::mul(ay, bx))
}

/// The part of depth interpolation that is constant over a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Shading<I: Isa> {
    pub(crate) inverse_area: I::F,
    pub(crate) base: I::F,
    pub(crate) along_1: I::F,
    pub(crate) along_2: I::F,
    pub(crate) least: I::F,
    pub(crate) greatest: I::F,
}

impl<I: Isa> Shading<I> {
    /// From the nearness at the corners and twice the area.
    #[inline(always)]
    pub(crate) fn new(n: [I::F; 3], area: I::F) -> Self {
        Self {
            inverse_area: I::div_f(I::splat_f(1.0), area),
            base: n[0],
            along_1: I::sub_f(n[1], n[0]),
            along_2: I::sub_f(n[2], n[0]),
            least: I::min_f(I::min_f(n[0], n[1]), n[2]),
            greatest: I::max_f(I::max_f(n[0], n[1]), n[2]),
        }
    }

    /// The nearness where the edge functions opposite to corners 1 and 2 have these values.
    #[inline(always)]
    pub(crate) fn nearness(&self, edge_1: I::F, edge_2: I::F) -> I::F {
        let l1 = I::mul_f(edge_1, self.inverse_area);
        let l2 = I::mul_f(edge_2, self.inverse_area);
        let n = I::add_f(self.base, I::add_f(I::mul_f(l1, self.along_1), I::mul_f(l2, self.along_2)));
        I::min_f(I::max_f(n, self.least), self.greatest)
    }
}

/// The first sample column (or row) at or after coordinates in subpixels.
#[inline(always)]
pub(crate) fn first_samples<I: Isa>(v: I::I) -> I::I {
    I::shift_right::<SUBPIXEL_BITS>(I::add(v, I::splat(SUBPIXELS / 2 - 1)))
}

/// The last sample column (or row) at or before coordinates in subpixels.
#[inline(always)]
pub(crate) fn last_samples<I: Isa>(v: I::I) -> I::I {
    I::shift_right::<SUBPIXEL_BITS>(I::sub(v, I::splat(SUBPIXELS / 2)))
}

/// The coordinates of samples in subpixels.
#[inline(always)]
fn centre<I: Isa>(sample: I::I) -> I::I {
    I::add(I::shift_left::<SUBPIXEL_BITS>(sample), I::splat(SUBPIXELS / 2))
}
