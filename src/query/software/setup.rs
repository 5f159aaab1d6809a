//! From corners to edge functions and depth: what sixteen triangles need before they are sampled.
//!
//! Coverage is decided by edge functions in integers: a sample (a pixel's centre) is covered where
//! all three are positive, or zero on a top or left edge. Depth is interpolated from the edge
//! functions, rounded once to f32: `n0 + (edge1·g1 + edge2·g2)`, `gk = (nk - n0) / area`, clamped
//! to the triangle's own range. A product `edge·g` is a share in [0, 1] of a difference of
//! nearness, and six roundings are in it: of the difference, the area, its reciprocal, their
//! product, the edge function and the product with it. So the sum errs by a few ulps of the
//! largest |nearness|. All paths share [`Shading::nearness`]; the same triangle yields the same bits
//! in each of them.

use super::isa::{Isa, LANES, Mask, magnitude, of_lane, splat_each, store_each_f};
use super::layout::{TILE, TILE_BITS};
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
    /// Twice the area: what the three edge functions add up to at every sample.
    pub(crate) area: I::I,
    pub(crate) shading: Shading<I>,
    /// Three times the mean nearness of the corners.
    mean: I::F,
    /// Those that were wound counter-clockwise.
    pub(crate) turned: Mask,
}

impl<I: Isa> Setup<I> {
    /// Which of some triangles, at least one, has the nearest mean.
    #[inline(always)]
    pub(crate) fn nearest(&self, mut lanes: Mask) -> Mask {
        let mean = I::store_f(self.mean);
        let (mut found, mut most) = (0, f32::NEG_INFINITY);
        while lanes != 0 {
            let lane = lanes.trailing_zeros();
            lanes &= lanes - 1;
            if mean[lane as usize] > most {
                (found, most) = (1 << lane, mean[lane as usize]);
            }
        }
        found
    }

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
        let mean = I::add_f(I::add_f(n[0], n[1]), n[2]);
        Self { edge, area, step_x, step_y, limit, shading, mean, turned }
    }
}

/// From tile to tile of sixteen triangles.
pub(crate) struct TileSteps<I: Isa> {
    /// Change of the edge functions from column to column of tiles.
    pub(crate) step_x: [I::I; 3],
    /// The same from row to row.
    pub(crate) step_y: [I::I; 3],
    /// What an edge function at a tile's first pixel is above if the tile has a sample on its inner
    /// side.
    limit: [I::I; 3],
}

impl<I: Isa> TileSteps<I> {
    #[inline(always)]
    pub(crate) fn new(setup: &Setup<I>) -> Self {
        const { assert!(TILE == 4 && TILE_BITS == 2) };
        let zero = I::splat(0);
        let (mut limit, mut step_x, mut step_y) = (setup.limit, setup.step_x, setup.step_y);
        for k in 0..3 {
            // Three pixels on, where the edge function rises.
            let reach = I::add(I::max(step_x[k], zero), I::max(step_y[k], zero));
            let reach = I::add(reach, I::shift_left::<1>(reach));
            limit[k] = I::sub(limit[k], reach);
            step_x[k] = I::shift_left::<TILE_BITS>(step_x[k]);
            step_y[k] = I::shift_left::<TILE_BITS>(step_y[k]);
        }
        Self { step_x, step_y, limit }
    }

    /// The triangles that may cover a sample of a tile, given their edge functions at its first
    /// pixel.
    #[inline(always)]
    pub(crate) fn met(&self, edge: &[I::I; 3]) -> Mask {
        I::gt(edge[0], self.limit[0]) & I::gt(edge[1], self.limit[1]) & I::gt(edge[2], self.limit[2])
    }
}

#[inline(always)]
fn cross<I: Isa>(ax: I::I, ay: I::I, bx: I::I, by: I::I) -> I::I {
    I::sub(I::mul(ax, by), I::mul(ay, bx))
}

/// The part of depth interpolation that is constant over a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Shading<I: Isa> {
    pub(crate) base: I::F,
    /// Change of nearness with the edge function opposite to corner 1.
    pub(crate) gradient_1: I::F,
    /// The same of corner 2.
    pub(crate) gradient_2: I::F,
    pub(crate) least: I::F,
    pub(crate) greatest: I::F,
}

impl<I: Isa> Shading<I> {
    /// Every lane, to be taken up by [`Shading::of_lane`].
    #[inline(always)]
    pub(crate) fn stored(&self) -> [[f32; LANES]; 5] {
        let Self { base, gradient_1, gradient_2, least, greatest } = *self;
        store_each_f::<I, 5>([base, gradient_1, gradient_2, least, greatest])
    }

    /// One triangle's, in all lanes.
    #[inline(always)]
    pub(crate) fn of_lane(stored: &[[f32; LANES]; 5], lane: usize) -> Self {
        let [base, gradient_1, gradient_2, least, greatest] = splat_each::<I, 5>(of_lane(stored, lane));
        Self { base, gradient_1, gradient_2, least, greatest }
    }

    /// From the nearness at the corners and twice the area.
    #[inline(always)]
    pub(crate) fn new(n: [I::F; 3], area: I::F) -> Self {
        let inverse_area = I::div_f(I::splat_f(1.0), area);
        Self {
            base: n[0],
            gradient_1: I::mul_f(I::sub_f(n[1], n[0]), inverse_area),
            gradient_2: I::mul_f(I::sub_f(n[2], n[0]), inverse_area),
            least: I::min_f(I::min_f(n[0], n[1]), n[2]),
            greatest: I::max_f(I::max_f(n[0], n[1]), n[2]),
        }
    }

    /// How much nearer than at its first pixel a tile can be, and a bound on the error of that and
    /// of all sums at samples of the triangle.
    ///
    /// Nearness is linear over the screen, so it grows toward one corner of a tile by its change
    /// along both sides. Each of the terms here is a few roundings of 2⁻²⁴ away from its exact
    /// value, each sum at a sample as many from its own; 2⁻²⁰ of all magnitudes covers both. Below
    /// the least normal number roundings are no shares any more: a gradient may be off by 2⁻¹⁵⁰, at
    /// an edge function of 2³¹; `LEAST` covers that.
    #[inline(always)]
    pub(crate) fn rise(&self, step_x: &[I::I; 3], step_y: &[I::I; 3], side: f32) -> I::F {
        let zero = I::splat_f(0.0);
        let (mut rise, mut all) = (zero, zero);
        for step in [step_x, step_y] {
            let one = I::mul_f(I::to_f(step[1]), self.gradient_1);
            let two = I::mul_f(I::to_f(step[2]), self.gradient_2);
            rise = I::add_f(rise, I::max_f(I::add_f(one, two), zero));
            all = I::add_f(all, I::add_f(magnitude::<I>(one), magnitude::<I>(two)));
        }
        let sides = I::splat_f(side - 1.0);
        // No corner differs more from the first one.
        let corners = I::sub_f(self.greatest, self.least);
        let corners = I::add_f(I::add_f(corners, corners), magnitude::<I>(self.base));
        let all = I::add_f(I::mul_f(all, sides), corners);
        let slack = I::add_f(I::mul_f(all, I::splat_f(SLACK)), I::splat_f(LEAST));
        I::add_f(I::mul_f(rise, sides), slack)
    }

    /// No sample of the triangle in a tile is nearer. The edge functions are those at the tile's
    /// first pixel, `rise` is what [`Shading::rise`] found for it.
    #[inline(always)]
    pub(crate) fn bound(&self, edge_1: I::F, edge_2: I::F, rise: I::F) -> I::F {
        let (one, two) = (I::mul_f(edge_1, self.gradient_1), I::mul_f(edge_2, self.gradient_2));
        let n = I::add_f(self.base, I::add_f(one, two));
        let all = I::add_f(magnitude::<I>(one), magnitude::<I>(two));
        let bound = I::add_f(I::add_f(n, rise), I::mul_f(all, I::splat_f(SLACK)));
        I::min_f(bound, self.greatest)
    }

    /// The nearness where the edge functions opposite to corners 1 and 2 have these values.
    #[inline(always)]
    pub(crate) fn nearness(&self, edge_1: I::F, edge_2: I::F) -> I::F {
        let (one, two) = (I::mul_f(edge_1, self.gradient_1), I::mul_f(edge_2, self.gradient_2));
        I::min_f(I::max_f(I::add_f(self.base, I::add_f(one, two)), self.least), self.greatest)
    }
}

/// 2⁻²⁰.
const SLACK: f32 = 1.0 / 1_048_576.0;
/// More than 2⁻¹¹⁷.
const LEAST: f32 = 1e-35;

/// The first sample column (or row) at or after a coordinate in subpixels.
#[inline(always)]
pub(crate) fn first_sample(v: i32) -> i32 {
    (v + SUBPIXELS / 2 - 1) >> SUBPIXEL_BITS
}

/// The last sample column (or row) at or before a coordinate in subpixels.
#[inline(always)]
pub(crate) fn last_sample(v: i32) -> i32 {
    (v - SUBPIXELS / 2) >> SUBPIXEL_BITS
}

/// [`first_sample`] of sixteen.
#[inline(always)]
pub(crate) fn first_samples<I: Isa>(v: I::I) -> I::I {
    I::shift_right::<SUBPIXEL_BITS>(I::add(v, I::splat(SUBPIXELS / 2 - 1)))
}

/// [`last_sample`] of sixteen.
#[inline(always)]
pub(crate) fn last_samples<I: Isa>(v: I::I) -> I::I {
    I::shift_right::<SUBPIXEL_BITS>(I::sub(v, I::splat(SUBPIXELS / 2)))
}

/// The coordinates of samples in subpixels.
#[inline(always)]
fn centre<I: Isa>(sample: I::I) -> I::I {
    I::add(I::shift_left::<SUBPIXEL_BITS>(sample), I::splat(SUBPIXELS / 2))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::isa::Portable;
    use super::super::layout::{LANE_X, LANE_Y};
    use super::*;

    type Lanes = Corners<Portable>;

    /// Triangles of up to 100 pixels: slivers among them, and depths that are nearly the same, far
    /// apart or below the least normal number.
    fn triangles(dice: &mut ChaCha8Rng) -> Lanes {
        let mut corners = Lanes { x: [[0; LANES]; 3], y: [[0; LANES]; 3], nearness: [[0.0; LANES]; 3] };
        for lane in 0..LANES {
            let side = [3, 300, 4000, 25_600][dice.random_range(0..4)];
            let base = [1e-3, 0.5, 1e-30, 1e-44][dice.random_range(0..4)];
            let spread = [1e-6, 1.0][dice.random_range(0..2)];
            for k in 0..3 {
                corners.x[k][lane] = dice.random_range(0..=side);
                let height = [side, 3][dice.random_range(0..2)];
                corners.y[k][lane] = dice.random_range(0..=height);
                corners.nearness[k][lane] = base * (1.0 + spread * dice.random_range(-1.0..1.0_f32));
            }
        }
        corners
    }

    /// How many samples are nearer than the bound of their tile, and how many there are.
    fn beyond(corners: &Lanes, slack: impl Fn(f32) -> f32) -> (u32, u32) {
        let (mut beyond, mut all) = (0, 0);
        for tile in 0..26 * 26 {
            let at = [tile % 26, tile / 26].map(|t| t * TILE);
            let first = Setup::<Portable>::new(corners, [at[0]; LANES], [at[1]; LANES]);
            let rise = first.shading.rise(&first.step_x, &first.step_y, TILE as f32);
            let edge = first.edge.map(Portable::to_f);
            let bound = first.shading.bound(edge[1], edge[2], rise.map(&slack));
            for pixel in 0..LANES {
                let (x, y) = ([at[0] + LANE_X[pixel]; LANES], [at[1] + LANE_Y[pixel]; LANES]);
                let here = Setup::<Portable>::new(corners, x, y);
                let nearness =
                    here.shading.nearness(Portable::to_f(here.edge[1]), Portable::to_f(here.edge[2]));
                for lane in 0..LANES {
                    if (0..3).all(|k| here.edge[k][lane] > here.limit[k][lane]) {
                        all += 1;
                        beyond += u32::from(nearness[lane] > bound[lane]);
                    }
                }
            }
        }
        (beyond, all)
    }

    #[test]
    fn no_sample_is_nearer_than_the_bound_of_its_tile() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let (mut samples, mut without) = (0, 0);
        for _ in 0..40 {
            let corners = triangles(&mut dice);
            let (beyond_it, all) = beyond(&corners, |rise| rise);
            assert_eq!(beyond_it, 0);
            samples += all;
            // What the bound consists of matters: without the rise, many samples are beyond.
            without += beyond(&corners, |_| 0.0).0;
        }
        assert!(samples > 20_000 && without > 100, "{samples} samples, {without} beyond without the rise");
    }
}
