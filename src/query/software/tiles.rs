//! Small triangles: the tiles of sixteen are listed at once, and then sampled one after the other.
//! Loops of few steps, of which nobody can foretell how many, take longer.

use super::isa::{Isa, LANES, Mask, add_each, of_lane, store_each};
use super::large::Triangle;
use super::layout::{BLOCK_PIXELS, LANE_X, LANE_Y, TILE, TILE_BITS};
use super::raster::{Ids, addresses};
use super::setup::{Setup, Shading, TileSteps};
use super::sink::{Id, Sink};

/// The most sample columns or rows of a triangle whose tiles are listed.
pub(crate) const LISTED_SIDE: i32 = 12;
/// Room for the tiles of sixteen of those, at most 4 × 4 each since 12 samples meet at most 4 tiles,
/// and one more register.
const LISTED: usize = LANES * LANES + LANES;
/// Which lane it is.
const LANE_NUMBERS: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Room to list the tiles of sixteen triangles in, and large triangles that are left for later.
#[derive(Debug)]
pub(crate) struct Room {
    pub(crate) large: Vec<(Triangle, Id)>,
    /// Of each tile: the edge functions opposite to corners 1 and 2 at its first pixel.
    edges: [[i32; LISTED]; 2],
    /// Of each: where it lies in the band, and its triangle.
    tiles: [[i32; LISTED]; 2],
    pub(crate) kept: Kept,
}

/// What it takes to sample sixteen triangles, one by one.
#[derive(Debug)]
pub(crate) struct Kept {
    /// Of each triangle: from a tile's first pixel to each of its pixels, for the edge functions
    /// opposite to corners 1 and 2.
    across: [[[i32; LANES]; 2]; LANES],
    /// Twice the area. What the others leave of it is the third edge function: exact, since sums
    /// that overflow come back.
    area: [i32; LANES],
    limit: [[i32; LANES]; 3],
    /// See [`Shading::stored`].
    shading: [[f32; LANES]; 5],
}

impl Default for Room {
    fn default() -> Self {
        Self {
            large: Vec::new(),
            edges: [[0; LISTED]; 2],
            tiles: [[0; LISTED]; 2],
            kept: Kept {
                across: [[[0; LANES]; 2]; LANES],
                area: [0; LANES],
                limit: [[0; LANES]; 3],
                shading: [[0.0; LANES]; 5],
            },
        }
    }
}

impl Kept {
    /// Takes up the triangles in some lanes.
    #[inline(always)]
    pub(crate) fn keep<I: Isa>(&mut self, setup: &Setup<I>, mut lanes: Mask) {
        let (lane_x, lane_y) = (I::load(&LANE_X), I::load(&LANE_Y));
        let ([_, x1, x2], [_, y1, y2]) = (setup.step_x, setup.step_y);
        let (step_x, step_y) = (store_each::<I, 2>([x1, x2]), store_each::<I, 2>([y1, y2]));
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            for k in 0..2 {
                let (x, y) = (I::splat(step_x[k][lane]), I::splat(step_y[k][lane]));
                self.across[lane][k] = I::store(I::add(I::mul(lane_x, x), I::mul(lane_y, y)));
            }
        }
        self.area = I::store(setup.area);
        self.limit = store_each::<I, 3>(setup.limit);
        self.shading = setup.shading.stored();
    }

    /// The samples of a triangle in a tile, given its edge functions opposite to corners 1 and 2 at
    /// the tile's first pixel: those covered, and the nearness of each.
    #[inline(always)]
    pub(crate) fn sample<I: Isa>(&self, lane: usize, edges: [i32; 2]) -> (Mask, I::F) {
        let one = I::add(I::splat(edges[0]), I::load(&self.across[lane][0]));
        let two = I::add(I::splat(edges[1]), I::load(&self.across[lane][1]));
        let rest = I::sub(I::splat(self.area[lane]), I::add(one, two));
        let limit = of_lane(&self.limit, lane);
        let covered =
            I::gt(rest, I::splat(limit[0])) & I::gt(one, I::splat(limit[1])) & I::gt(two, I::splat(limit[2]));
        let shading = Shading::<I>::of_lane(&self.shading, lane);
        (covered, shading.nearness(I::to_f(one), I::to_f(two)))
    }
}

impl Room {
    /// Lists the tiles of triangles of at most [`LISTED_SIDE`] a side, one tile of every triangle a
    /// step. `setup` is that of their first tiles. Returns how many there are.
    #[inline(always)]
    fn list<I: Isa>(
        &mut self,
        setup: &Setup<I>,
        lanes: Mask,
        first: [I::I; 2],
        last: [I::I; 2],
        (first_row, blocks): (i32, usize),
    ) -> usize {
        let lane_numbers = I::load(&LANE_NUMBERS);
        let tile_x = I::shift_right::<TILE_BITS>(first[0]);
        let tile_y = I::shift_right::<TILE_BITS>(first[1]);
        let none = I::splat(-1);
        let columns = I::sub(I::shift_right::<TILE_BITS>(last[0]), tile_x);
        let lines = I::sub(I::shift_right::<TILE_BITS>(last[1]), tile_y);
        let (columns, lines) = (I::blend(lanes, none, columns), I::blend(lanes, none, lines));
        let tiles = TileSteps::new(setup);
        let mut row_edge = setup.edge;
        let row = I::sub(I::shift_left::<TILE_BITS>(tile_y), I::splat(first_row));
        let column = I::shift_left::<TILE_BITS>(tile_x);
        let (mut count, mut dy) = (0, 0);
        loop {
            let in_row = I::gt(lines, I::splat(dy - 1));
            if in_row == 0 {
                return count;
            }
            let (mut edge, mut dx) = (row_edge, 0);
            loop {
                let in_box = in_row & I::gt(columns, I::splat(dx - 1));
                if in_box == 0 {
                    break;
                }
                let met = in_box & tiles.met(&edge);
                let x = I::add(column, I::splat(dx * TILE));
                let y = I::add(row, I::splat(dy * TILE));
                for k in 0..2 {
                    put(&mut self.edges[k], count, I::store(I::compress(met, edge[k + 1])));
                }
                edge = add_each::<I, 3>(edge, tiles.step_x);
                let at = addresses::<I>(x, y, blocks);
                put(&mut self.tiles[0], count, I::store(I::compress(met, at)));
                put(&mut self.tiles[1], count, I::store(I::compress(met, lane_numbers)));
                count += met.count_ones() as usize;
                dx += 1;
            }
            row_edge = add_each::<I, 3>(row_edge, tiles.step_y);
            dy += 1;
        }
    }

    /// Rasterises triangles of at most [`LISTED_SIDE`] a side: lists the tiles of all, and then goes
    /// through them.
    #[inline(always)]
    pub(crate) fn rasterise<I: Isa, S: Sink>(
        &mut self,
        setup: &Setup<I>,
        lanes: Mask,
        first: [I::I; 2],
        last: [I::I; 2],
        ids: Ids<'_>,
        sink: &mut S,
    ) {
        let rows = sink.rows();
        let count = self.list::<I>(setup, lanes, first, last, (rows.first, rows.blocks));
        self.kept.keep(setup, lanes);
        for i in 0..count.min(LISTED) {
            let (at, lane) = (self.tiles[0][i] as usize, self.tiles[1][i] as usize % LANES);
            let edges = [self.edges[0][i], self.edges[1][i]];
            let (covered, nearness) = self.kept.sample::<I>(lane, edges);
            sink.tile::<I>(at / BLOCK_PIXELS, at / LANES % LANES, covered, nearness, ids.of(lane));
        }
    }
}

/// Writes sixteen at a place of a list.
#[inline(always)]
fn put(list: &mut [i32; LISTED], at: usize, values: [i32; LANES]) {
    if let Some(to) = list.get_mut(at..at + LANES) {
        to.copy_from_slice(&values);
    }
}
