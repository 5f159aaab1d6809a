//! From snapped triangles to samples: exact coverage, and one arithmetic of depth (see `setup`).
//!
//! Sixteen triangles are set up at once. The tiny ones among them are sampled together, a lane a
//! triangle; the small ones tile by tile, a lane a pixel. What is larger than [`SMALL_EXTENT`]
//! goes to `large`.

use super::isa::{ALL, Isa, LANES, Mask, splat_each, store_each, store_each_f};
use super::large;
use super::layout::{BLOCK, BLOCK_BITS, BLOCK_PIXELS, LANE_X, LANE_Y, TILE, TILE_BITS, children};
use super::setup::{Corners, SMALL_EXTENT, Setup, Shading, first_samples, last_samples};
use super::sink::{Id, Sink};

/// The most sample columns or rows of a triangle that is sampled among others, a lane each.
const TINY_SIDE: i32 = 3;
/// Tiny triangles among sixteen from which they are sampled together. Fewer take longer than each
/// by itself.
const TINY_FROM: u32 = 3;

/// Which triangles the lanes are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ids<'a> {
    /// The draw call of all triangles.
    pub(crate) call: u32,
    /// Which triangle of it each lane is; none where nobody asks.
    pub(crate) triangles: Option<&'a [u32; LANES]>,
}

impl Ids<'_> {
    #[inline(always)]
    fn of(&self, lane: usize) -> Id {
        let triangle = match self.triangles {
            Some(triangles) => triangles[lane],
            None => 0,
        };
        Id { call: self.call, triangle }
    }
}

/// Rasterises the triangles in some lanes. Returns how many have a sample in their bounding box,
/// of those that begin in this band.
#[inline(always)]
pub(crate) fn triangles<I: Isa, S: Sink>(
    corners: &Corners<I>,
    lanes: Mask,
    ids: Ids<'_>,
    room: &mut Room,
    sink: &mut S,
) -> u32 {
    let rows = sink.rows();
    let Corners { x, y, .. } = corners;
    let (left, right) = (I::min(I::min(x[0], x[1]), x[2]), I::max(I::max(x[0], x[1]), x[2]));
    let (top, bottom) = (I::min(I::min(y[0], y[1]), y[2]), I::max(I::max(y[0], y[1]), y[2]));
    let above = first_samples::<I>(top);
    let first = [I::max(first_samples::<I>(left), I::splat(0)), I::max(above, I::splat(rows.first))];
    let last = [
        I::min(last_samples::<I>(right), I::splat(rows.last_column)),
        I::min(last_samples::<I>(bottom), I::splat(rows.last)),
    ];
    let kept = lanes & !(I::gt(first[0], last[0]) | I::gt(first[1], last[1]));
    if kept == 0 {
        return 0;
    }
    let begin_here = if rows.first == 0 { kept } else { kept & I::gt(above, I::splat(rows.first - 1)) };
    let extent = I::splat(SMALL_EXTENT);
    let larger = kept & (I::gt(I::sub(right, left), extent) | I::gt(I::sub(bottom, top), extent));
    let side = [I::sub(last[0], first[0]), I::sub(last[1], first[1])];
    let wide = I::splat(TINY_SIDE - 1);
    let mut tiny = kept & !larger & !(I::gt(side[0], wide) | I::gt(side[1], wide));
    if tiny.count_ones() < TINY_FROM {
        tiny = 0;
    }
    let small = kept & !larger & !tiny;
    if tiny != 0 {
        let setup = Setup::new(corners, first[0], first[1]);
        sample_tiny::<I, S>(&setup, tiny, first, side, ids, sink);
    }
    let few = I::splat(LISTED_SIDE - 1);
    let walked = small & (I::gt(side[0], few) | I::gt(side[1], few));
    let listed = small & !walked;
    if listed != 0 {
        room.rasterise::<I, S>(corners, listed, first, last, ids, sink);
    }
    if walked != 0 {
        let block = I::splat(-BLOCK);
        let setup = Setup::new(corners, I::and(first[0], block), I::and(first[1], block));
        let stored = Stored::new(&setup, first, last);
        // Those that are wound like the nearest first: of a closed mesh they hide the others.
        let turned = setup.turned & walked;
        for lanes in if setup.nearest(walked) & turned == 0 { [walked & !turned, turned] } else { [turned, walked & !turned] } {
            let mut lanes = lanes;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                stored.walk::<I, S>(lane, ids.of(lane), sink);
            }
        }
    }
    if larger != 0 {
        let (x, y) = (store_each::<I, 3>(corners.x), store_each::<I, 3>(corners.y));
        let nearness = store_each_f::<I, 3>(corners.nearness);
        let mut lanes = larger;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let triangle = large::Triangle {
                x: [x[0][lane], x[1][lane], x[2][lane]],
                y: [y[0][lane], y[1][lane], y[2][lane]],
                nearness: [nearness[0][lane], nearness[1][lane], nearness[2][lane]],
            };
            large::walk::<I, S>(&triangle, ids.of(lane), sink);
        }
    }
    begin_here.count_ones()
}

/// The most sample columns or rows of a triangle whose tiles are listed.
const LISTED_SIDE: i32 = 12;
/// Room for the tiles of sixteen of those, at most 4 × 4 each, and one more register.
const LISTED: usize = LANES * LANES + LANES;
/// Which lane it is.
const LANE_NUMBERS: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Room to list the tiles of sixteen triangles in.
pub(crate) struct Room {
    /// Of each tile: the edge functions at its first pixel.
    edges: [[i32; LISTED]; 3],
    /// Of each: where it lies in the band, and its triangle.
    tiles: [[i32; LISTED]; 2],
    /// Of each triangle: from a tile's first pixel to each of its pixels.
    across: [[[i32; LANES]; 3]; LANES],
    limit: [[i32; LANES]; 3],
    /// As [`Shading`] has it, in its order.
    shading: [[f32; LANES]; 6],
}

impl Room {
    pub(crate) const EMPTY: Self = Self {
        edges: [[0; LISTED]; 3],
        tiles: [[0; LISTED]; 2],
        across: [[[0; LANES]; 3]; LANES],
        limit: [[0; LANES]; 3],
        shading: [[0.0; LANES]; 6],
    };

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
        // From a tile's first pixel to its greatest, and from tile to tile.
        let (mut row_edge, mut limit) = (setup.edge, setup.limit);
        let (mut step_x, mut step_y) = (setup.step_x, setup.step_y);
        for k in 0..3 {
            let zero = I::splat(0);
            let reach = I::add(I::max(step_x[k], zero), I::max(step_y[k], zero));
            let reach = I::add(reach, I::shift_left::<1>(reach));
            limit[k] = I::sub(limit[k], reach);
            step_x[k] = I::shift_left::<TILE_BITS>(step_x[k]);
            step_y[k] = I::shift_left::<TILE_BITS>(step_y[k]);
        }
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
                let met =
                    in_box & I::gt(edge[0], limit[0]) & I::gt(edge[1], limit[1]) & I::gt(edge[2], limit[2]);
                let x = I::add(column, I::splat(dx * TILE));
                let y = I::add(row, I::splat(dy * TILE));
                for k in 0..3 {
                    put(&mut self.edges[k], count, I::store(I::compress(met, edge[k])));
                    edge[k] = I::add(edge[k], step_x[k]);
                }
                let at = addresses::<I>(x, y, blocks);
                put(&mut self.tiles[0], count, I::store(I::compress(met, at)));
                put(&mut self.tiles[1], count, I::store(I::compress(met, lane_numbers)));
                count += met.count_ones() as usize;
                dx += 1;
            }
            for k in 0..3 {
                row_edge[k] = I::add(row_edge[k], step_y[k]);
            }
            dy += 1;
        }
    }

    /// Rasterises triangles of at most [`LISTED_SIDE`] a side: lists the tiles of all, and then goes
    /// through them. Loops of few steps, of which nobody can foretell how many, take longer.
    #[inline(always)]
    fn rasterise<I: Isa, S: Sink>(
        &mut self,
        corners: &Corners<I>,
        mut lanes: Mask,
        first: [I::I; 2],
        last: [I::I; 2],
        ids: Ids<'_>,
        sink: &mut S,
    ) {
        let rows = sink.rows();
        let tile = I::splat(-TILE);
        let setup = Setup::new(corners, I::and(first[0], tile), I::and(first[1], tile));
        let count = self.list::<I>(&setup, lanes, first, last, (rows.first, rows.blocks));
        let (lane_x, lane_y) = (I::load(&LANE_X), I::load(&LANE_Y));
        let (step_x, step_y) = (store_each::<I, 3>(setup.step_x), store_each::<I, 3>(setup.step_y));
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            for k in 0..3 {
                let (x, y) = (I::splat(step_x[k][lane]), I::splat(step_y[k][lane]));
                self.across[lane][k] = I::store(I::add(I::mul(lane_x, x), I::mul(lane_y, y)));
            }
        }
        self.limit = store_each::<I, 3>(setup.limit);
        let Shading { inverse_area, base, along_1, along_2, least, greatest } = setup.shading;
        self.shading = store_each_f::<I, 6>([inverse_area, base, along_1, along_2, least, greatest]);
        for i in 0..count.min(LISTED) {
            let (at, lane) = (self.tiles[0][i] as usize, self.tiles[1][i] as usize % LANES);
            let (mut e, mut covered) = ([lane_x; 3], ALL);
            for k in 0..3 {
                e[k] = I::add(I::splat(self.edges[k][i]), I::load(&self.across[lane][k]));
                covered &= I::gt(e[k], I::splat(self.limit[k][lane]));
            }
            let [inverse_area, base, along_1, along_2, least, greatest] =
                splat_each::<I, 6>(column(&self.shading, lane));
            let shading = Shading::<I> { inverse_area, base, along_1, along_2, least, greatest };
            let nearness = shading.nearness(I::to_f(e[1]), I::to_f(e[2]));
            sink.tile::<I>(at / BLOCK_PIXELS, at / LANES % LANES, covered, nearness, ids.of(lane));
        }
    }
}

/// Samples triangles of at most [`TINY_SIDE`] sample columns and rows: one step looks at one
/// sample of every triangle.
#[inline(always)]
fn sample_tiny<I: Isa, S: Sink>(
    setup: &Setup<I>,
    lanes: Mask,
    first: [I::I; 2],
    side: [I::I; 2],
    ids: Ids<'_>,
    sink: &mut S,
) {
    let rows = sink.rows();
    let outside = I::splat(-1);
    let (columns, lines) = (I::blend(lanes, outside, side[0]), I::blend(lanes, outside, side[1]));
    let mut row_edge = setup.edge;
    let mut dy = 0;
    loop {
        let in_row = I::gt(lines, I::splat(dy - 1));
        if in_row == 0 {
            return;
        }
        let mut edge = row_edge;
        let mut dx = 0;
        loop {
            let in_box = in_row & I::gt(columns, I::splat(dx - 1));
            if in_box == 0 {
                break;
            }
            let mut covered = in_box
                & I::gt(edge[0], setup.limit[0])
                & I::gt(edge[1], setup.limit[1])
                & I::gt(edge[2], setup.limit[2]);
            if covered != 0 {
                let nearness =
                    I::store_f(setup.shading.nearness(I::to_f(edge[1]), I::to_f(edge[2])));
                let column = I::add(first[0], I::splat(dx));
                let row = I::add(first[1], I::splat(dy - rows.first));
                let at = I::store(addresses::<I>(column, row, rows.blocks));
                while covered != 0 {
                    let lane = covered.trailing_zeros() as usize;
                    covered &= covered - 1;
                    sink.sample(at[lane] as usize, nearness[lane], ids.of(lane));
                }
            }
            for k in 0..3 {
                edge[k] = I::add(edge[k], setup.step_x[k]);
            }
            dx += 1;
        }
        for k in 0..3 {
            row_edge[k] = I::add(row_edge[k], setup.step_y[k]);
        }
        dy += 1;
    }
}

/// Where pixels lie in the memory of a band; rows count from its first.
#[inline(always)]
fn addresses<I: Isa>(column: I::I, row: I::I, blocks: usize) -> I::I {
    const { assert!(BLOCK_PIXELS == 256 && TILE_BITS == 2) };
    let three = I::splat(3);
    let block = I::add(
        I::mul(I::shift_right::<BLOCK_BITS>(row), I::splat(blocks as i32)),
        I::shift_right::<BLOCK_BITS>(column),
    );
    let tile = I::or(
        I::shift_left::<2>(I::and(I::shift_right::<TILE_BITS>(row), three)),
        I::and(I::shift_right::<TILE_BITS>(column), three),
    );
    let lane = I::or(I::shift_left::<2>(I::and(row, three)), I::and(column, three));
    I::or(I::shift_left::<8>(block), I::or(I::shift_left::<4>(tile), lane))
}

/// The tile of a block that a pixel lies in, by column or row; beyond the block, beyond its tiles.
#[inline(always)]
fn tile_of(pixel: i32, block: i32) -> i32 {
    (pixel - (block << BLOCK_BITS)) >> TILE_BITS
}

/// Writes sixteen at a place of a list.
#[inline(always)]
fn put(list: &mut [i32; LISTED], at: usize, values: [i32; LANES]) {
    if let Some(to) = list.get_mut(at..at + LANES) {
        to.copy_from_slice(&values);
    }
}

/// One lane of each.
#[inline(always)]
fn column<T: Copy, const N: usize>(rows: &[[T; LANES]; N], lane: usize) -> [T; N] {
    let mut out = [rows[0][lane]; N];
    for i in 1..N {
        out[i] = rows[i][lane];
    }
    out
}

/// Sixteen triangles that are walked one after the other.
struct Stored {
    edge: [[i32; LANES]; 3],
    step_x: [[i32; LANES]; 3],
    step_y: [[i32; LANES]; 3],
    limit: [[i32; LANES]; 3],
    /// As [`Shading`] has it, in its order.
    shading: [[f32; LANES]; 6],
    rise: [f32; LANES],
    first: [[i32; LANES]; 2],
    last: [[i32; LANES]; 2],
}

impl Stored {
    #[inline(always)]
    fn new<I: Isa>(setup: &Setup<I>, first: [I::I; 2], last: [I::I; 2]) -> Self {
        let Shading { inverse_area, base, along_1, along_2, least, greatest } = setup.shading;
        Self {
            edge: store_each::<I, 3>(setup.edge),
            step_x: store_each::<I, 3>(setup.step_x),
            step_y: store_each::<I, 3>(setup.step_y),
            limit: store_each::<I, 3>(setup.limit),
            shading: store_each_f::<I, 6>([inverse_area, base, along_1, along_2, least, greatest]),
            rise: I::store_f(setup.shading.rise(&setup.step_x, &setup.step_y, TILE as f32)),
            first: store_each::<I, 2>(first),
            last: store_each::<I, 2>(last),
        }
    }

    /// Rasterises a triangle: of each block the tiles that it may cover, of each of those the
    /// pixels.
    #[inline(always)]
    fn walk<I: Isa, S: Sink>(&self, lane: usize, id: Id, sink: &mut S) {
        let rows = sink.rows();
        let ([x0, y0], [x1, y1]) = (column(&self.first, lane), column(&self.last, lane));
        let [inverse_area, base, along_1, along_2, least, greatest] =
            splat_each::<I, 6>(column(&self.shading, lane));
        let shading = Shading::<I> { inverse_area, base, along_1, along_2, least, greatest };
        let rise = I::splat_f(self.rise[lane]);
        let (step_x, step_y) = (column(&self.step_x, lane), column(&self.step_y, lane));
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
        let mut row_edge = column(&self.edge, lane);
        let mut block_row = rows.block(x0, y0);
        for by in y0 >> BLOCK_BITS..=y1 >> BLOCK_BITS {
            let mut edge = row_edge;
            let mut block = block_row;
            for bx in x0 >> BLOCK_BITS..=x1 >> BLOCK_BITS {
                let mut tiles = children(
                    [tile_of(x0, bx), tile_of(y0, by)],
                    [tile_of(x1, bx), tile_of(y1, by)],
                );
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
                block += 1;
            }
            for k in 0..3 {
                row_edge[k] = row_edge[k].wrapping_add(step_y[k] << BLOCK_BITS);
            }
            block_row += rows.blocks;
        }
    }
}
