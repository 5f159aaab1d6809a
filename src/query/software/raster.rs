//! From snapped triangles to samples: exact coverage, and one arithmetic of depth (see `setup`).
//!
//! Sixteen triangles are set up at once. The tiny ones among them are sampled together, a lane a
//! triangle; the small ones tile by tile, a lane a pixel: their tiles are listed first (`tiles`)
//! where they have few, and else walked (`walk`). What is larger than [`SMALL_EXTENT`] is left
//! for `large`.
#![expect(clippy::needless_range_loop, reason = "lanes of several arrays advance together, by index")]

use super::isa::{Isa, LANES, Mask, of_lane, store_each, store_each_f};
use super::large::Triangle;
use super::layout::{BLOCK, BLOCK_BITS, BLOCK_PIXELS, TILE, TILE_BITS};
use super::setup::{Corners, SMALL_EXTENT, Setup, first_samples, last_samples};
use super::sink::{Id, Rows, Sink};
use super::tiles::{LISTED_SIDE, Room};
use super::walk::Stored;
use super::winding::Winding;

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
    pub(crate) fn of(&self, lane: usize) -> Id {
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
    winding: Winding,
    ids: Ids<'_>,
    room: &mut Room,
    sink: &mut S,
) -> u32 {
    let Bounds { first, last, kept, begin_here, larger } = Bounds::new(corners, lanes, sink.rows());
    if kept == 0 {
        return 0;
    }
    let side = [I::sub(last[0], first[0]), I::sub(last[1], first[1])];
    let wide = I::splat(TINY_SIDE - 1);
    let mut tiny = kept & !larger & !(I::gt(side[0], wide) | I::gt(side[1], wide));
    if tiny.count_ones() < TINY_FROM {
        tiny = 0;
    }
    let small = kept & !larger & !tiny;
    if tiny | small != 0 {
        let few = I::splat(LISTED_SIDE - 1);
        let walked = small & (I::gt(side[0], few) | I::gt(side[1], few));
        let listed = small & !walked;
        // Of the first sample, its tile or its block.
        let grid = I::blend(walked, I::blend(listed, I::splat(-1), I::splat(-TILE)), I::splat(-BLOCK));
        let setup = Setup::new(corners, I::and(first[0], grid), I::and(first[1], grid));
        let drawn = winding.drawn(setup.turned);
        let (tiny, listed, walked) = (tiny & drawn, listed & drawn, walked & drawn);
        if tiny != 0 {
            sample_tiny::<I, S>(&setup, tiny, first, side, ids, sink);
        }
        if listed != 0 {
            room.rasterise::<I, S>(&setup, listed, first, last, ids, sink);
        }
        if walked != 0 {
            let stored = Stored::new(&setup, first, last);
            // Those that are wound like the nearest first: of a closed mesh they hide the others.
            let before = if setup.nearest(walked) & setup.turned == 0 { !setup.turned } else { setup.turned };
            for mut lanes in [walked & before, walked & !before] {
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    stored.walk::<I, S>(lane, ids.of(lane), sink);
                }
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
            let (x, y) = (of_lane(&x, lane), of_lane(&y, lane));
            room.large.push((Triangle { x, y, nearness: of_lane(&nearness, lane) }, ids.of(lane)));
        }
    }
    begin_here.count_ones()
}

/// Where the samples of sixteen triangles can lie in a band.
pub(crate) struct Bounds<I: Isa> {
    /// First columns and rows.
    pub(crate) first: [I::I; 2],
    /// Last columns and rows.
    pub(crate) last: [I::I; 2],
    /// The triangles that have a sample in their bounding box.
    pub(crate) kept: Mask,
    /// Those of them that have none in a band before.
    pub(crate) begin_here: Mask,
    /// Those of them that are larger than [`SMALL_EXTENT`].
    pub(crate) larger: Mask,
}

impl<I: Isa> Bounds<I> {
    #[inline(always)]
    pub(crate) fn new(corners: &Corners<I>, lanes: Mask, rows: Rows) -> Self {
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
        let begin_here = if rows.first == 0 { kept } else { kept & I::gt(above, I::splat(rows.first - 1)) };
        let extent = I::splat(SMALL_EXTENT);
        let larger = kept & (I::gt(I::sub(right, left), extent) | I::gt(I::sub(bottom, top), extent));
        Self { first, last, kept, begin_here, larger }
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
                let nearness = I::store_f(setup.shading.nearness(I::to_f(edge[1]), I::to_f(edge[2])));
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
pub(crate) fn addresses<I: Isa>(column: I::I, row: I::I, blocks: usize) -> I::I {
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
