//! Triangles of some size, one at a time: of each block the tiles that it may cover and that do not
//! hide it, of each of those the pixels.

use super::isa::{ALL, Isa, LANES, of_lane, store_each};
use super::layout::{BLOCK_BITS, LANE_X, LANE_Y, TILE, TILE_BITS, children, tile_of};
use super::setup::{Setup, Shading};
use super::sink::{Id, Sink};

/// Sixteen triangles that are walked one after the other.
pub(crate) struct Stored {
    edge: [[i32; LANES]; 3],
    step_x: [[i32; LANES]; 3],
    step_y: [[i32; LANES]; 3],
    limit: [[i32; LANES]; 3],
    /// See [`Shading::stored`].
    shading: [[f32; LANES]; 5],
    rise: [f32; LANES],
    first: [[i32; LANES]; 2],
    last: [[i32; LANES]; 2],
}

impl Stored {
    #[inline(always)]
    pub(crate) fn new<I: Isa>(setup: &Setup<I>, first: [I::I; 2], last: [I::I; 2]) -> Self {
        Self {
            edge: store_each::<I, 3>(setup.edge),
            step_x: store_each::<I, 3>(setup.step_x),
            step_y: store_each::<I, 3>(setup.step_y),
            limit: store_each::<I, 3>(setup.limit),
            shading: setup.shading.stored(),
            rise: I::store_f(setup.shading.rise(&setup.step_x, &setup.step_y, TILE as f32)),
            first: store_each::<I, 2>(first),
            last: store_each::<I, 2>(last),
        }
    }

    /// Rasterises a triangle: of each block the tiles that it may cover, of each of those the
    /// pixels.
    #[inline(always)]
    pub(crate) fn walk<I: Isa, S: Sink>(&self, lane: usize, id: Id, sink: &mut S) {
        let rows = sink.rows();
        let ([x0, y0], [x1, y1]) = (of_lane(&self.first, lane), of_lane(&self.last, lane));
        let shading = Shading::<I>::of_lane(&self.shading, lane);
        let rise = I::splat_f(self.rise[lane]);
        let (step_x, step_y) = (of_lane(&self.step_x, lane), of_lane(&self.step_y, lane));
        let (lane_x, lane_y) = (I::load(&LANE_X), I::load(&LANE_Y));
        let mut limit = [lane_x; 3];
        // From a tile's first pixel to each of its pixels; four times that, from a block's first
        // tile to each of its tiles.
        let mut across = [lane_x; 3];
        // From a tile's first pixel to its greatest.
        let mut reach = [lane_x; 3];
        for k in 0..3 {
            limit[k] = I::splat(self.limit[k][lane]);
            across[k] = I::add(I::mul(lane_x, I::splat(step_x[k])), I::mul(lane_y, I::splat(step_y[k])));
            reach[k] = I::splat((TILE - 1) * (step_x[k].max(0) + step_y[k].max(0)));
        }
        let mut row_edge = of_lane(&self.edge, lane);
        let mut block_row = rows.block(x0, y0);
        for by in y0 >> BLOCK_BITS..=y1 >> BLOCK_BITS {
            let mut edge = row_edge;
            for (bx, block) in (x0 >> BLOCK_BITS..=x1 >> BLOCK_BITS).zip(block_row..) {
                let mut tiles =
                    children([tile_of(x0, bx), tile_of(y0, by)], [tile_of(x1, bx), tile_of(y1, by)]);
                let mut tile_edge = across;
                for k in 0..3 {
                    tile_edge[k] = I::add(I::splat(edge[k]), I::shift_left::<TILE_BITS>(across[k]));
                    tiles &= I::gt(I::add(tile_edge[k], reach[k]), limit[k]);
                }
                if tiles != 0 {
                    let bound = shading.bound(I::to_f(tile_edge[1]), I::to_f(tile_edge[2]), rise);
                    tiles &= sink.open_tiles::<I>(block, bound);
                }
                if tiles != 0 {
                    let tile_edge = store_each::<I, 3>(tile_edge);
                    while tiles != 0 {
                        let tile = tiles.trailing_zeros() as usize;
                        tiles &= tiles - 1;
                        let mut e = across;
                        let mut covered = ALL;
                        for k in 0..3 {
                            e[k] = I::add(I::splat(tile_edge[k][tile]), across[k]);
                            covered &= I::gt(e[k], limit[k]);
                        }
                        let nearness = shading.nearness(I::to_f(e[1]), I::to_f(e[2]));
                        sink.tile::<I>(block, tile, covered, nearness, id);
                    }
                }
                for k in 0..3 {
                    edge[k] = edge[k].wrapping_add(step_x[k] << BLOCK_BITS);
                }
            }
            for k in 0..3 {
                row_edge[k] = row_edge[k].wrapping_add(step_y[k] << BLOCK_BITS);
            }
            block_row += rows.blocks;
        }
    }
}
