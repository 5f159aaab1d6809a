//! From corners to edge functions and depth: what a triangle needs before it is sampled.
//!
//! Depth is interpolated from the edge functions, rounded once to f32:
//! `n0 + (λ1·(n1 - n0) + λ2·(n2 - n0))`, `λ = edge / area`, clamped to the triangle's own range.
//! Each λ lies in [0, 1] and errs by less than 2 ulps, each difference and product by half an ulp
//! of at most the largest |nearness|, so the sum errs by a few ulps of that. All paths share
//! [`Shading::nearness`]; the same triangle yields the same bits in each of them.

use super::vertex::{SUBPIXEL_BITS, SUBPIXELS};

/// The longest side of a triangle's bounding box, in subpixels, that the i32 paths take.
pub(crate) const SMALL_EXTENT: i32 = 128 << SUBPIXEL_BITS;

/// A triangle of at most [`SMALL_EXTENT`] a side, wound clockwise, ready to be sampled.
#[derive(Clone, Copy)]
pub(crate) struct Small {
    /// The edge function opposite to each corner, at the first sample.
    pub(crate) edge: [i32; 3],
    /// Its change from column to column.
    pub(crate) step_x: [i32; 3],
    /// Its change from row to row.
    pub(crate) step_y: [i32; 3],
    /// See [`bias`].
    pub(crate) bias: [i32; 3],
    /// Nearness at the corners.
    pub(crate) nearness: [f32; 3],
    /// Twice the area, in square subpixels; what the edge functions add up to.
    pub(crate) area: i32,
}

impl Small {
    /// Sets up for the sample in a column and row. Nothing overflows for a triangle of
    /// [`SMALL_EXTENT`] whose bounding box holds the sample; anything else yields nonsense, which
    /// lanes without a triangle may.
    #[inline(always)]
    pub(crate) fn new(x: [i32; 3], y: [i32; 3], n: [f32; 3], column: i32, row: i32) -> Self {
        let area = cross(x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
        let turned = area < 0;
        let (x1, x2) = if turned { (x[2], x[1]) } else { (x[1], x[2]) };
        let (y1, y2) = if turned { (y[2], y[1]) } else { (y[1], y[2]) };
        let (n1, n2) = if turned { (n[2], n[1]) } else { (n[1], n[2]) };
        let (sx, sy) = (centre(column), centre(row));
        let dx = [x2 - x1, x[0] - x2, x1 - x[0]];
        let dy = [y2 - y1, y[0] - y2, y1 - y[0]];
        Self {
            edge: [
                cross(dx[0], dy[0], sx - x1, sy - y1),
                cross(dx[1], dy[1], sx - x2, sy - y2),
                cross(dx[2], dy[2], sx - x[0], sy - y[0]),
            ],
            step_x: dy.map(|d| -(d << SUBPIXEL_BITS)),
            step_y: dx.map(|d| d << SUBPIXEL_BITS),
            bias: [bias(dx[0], dy[0]), bias(dx[1], dy[1]), bias(dx[2], dy[2])],
            nearness: [n[0], n1, n2],
            area: area.wrapping_abs(),
        }
    }
}

#[inline(always)]
fn cross(ax: i32, ay: i32, bx: i32, by: i32) -> i32 {
    ax.wrapping_mul(by).wrapping_sub(ay.wrapping_mul(bx))
}

/// The part of depth interpolation that is constant over a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Shading {
    pub(crate) inverse_area: f32,
    pub(crate) base: f32,
    pub(crate) along_1: f32,
    pub(crate) along_2: f32,
    pub(crate) least: f32,
    pub(crate) greatest: f32,
}

impl Shading {
    #[inline(always)]
    pub(crate) fn new(n: [f32; 3], area: f32) -> Self {
        Self {
            inverse_area: 1.0 / area,
            base: n[0],
            along_1: n[1] - n[0],
            along_2: n[2] - n[0],
            least: least(least(n[0], n[1]), n[2]),
            greatest: greatest(greatest(n[0], n[1]), n[2]),
        }
    }

    /// The nearness where the edge functions opposite to corners 1 and 2 have these values.
    #[inline(always)]
    pub(crate) fn nearness(&self, edge_1: f32, edge_2: f32) -> f32 {
        let l1 = edge_1 * self.inverse_area;
        let l2 = edge_2 * self.inverse_area;
        let n = self.base + (l1 * self.along_1 + l2 * self.along_2);
        least(greatest(n, self.least), self.greatest)
    }
}

// One instruction each, unlike `f32::min` and `max`, which care for NaN.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The first sample column (or row) at or after a coordinate in subpixels.
#[inline(always)]
pub(crate) fn first_sample(v: i32) -> i32 {
    v.wrapping_add(SUBPIXELS / 2 - 1) >> SUBPIXEL_BITS
}

/// The last sample column (or row) at or before a coordinate in subpixels.
#[inline(always)]
pub(crate) fn last_sample(v: i32) -> i32 {
    v.wrapping_sub(SUBPIXELS / 2) >> SUBPIXEL_BITS
}

/// A sample's coordinate in subpixels.
#[inline(always)]
pub(crate) fn centre(sample: i32) -> i32 {
    (sample << SUBPIXEL_BITS) + SUBPIXELS / 2
}

/// What an edge function is lowered by so that `≥ 0` means covered: nothing for a top or left
/// edge, one for the others. `dx`, `dy` run along the edge of a triangle of positive area, which
/// is clockwise with y down: a top edge runs right, a left edge up.
#[inline(always)]
pub(crate) fn bias(dx: i32, dy: i32) -> i32 {
    if dy < 0 || (dy == 0 && dx > 0) { 0 } else { -1 }
}
