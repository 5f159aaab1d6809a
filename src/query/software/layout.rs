//! Where pixels lie in memory: blocks of 16 × 16 pixels, each of 4 × 4 tiles of 4 × 4 pixels.
//!
//! A tile is one cache line and one register of sixteen lanes; the tiles of a block are sixteen
//! lanes again. So a triangle finds the tiles that it meets with one step, and then works on
//! whole tiles.

use super::isa::{LANES, Mask};
use crate::geom::PixelRect;

/// Pixels a side of a tile, and tiles a side of a block, as a power of two.
pub(crate) const TILE_BITS: u32 = 2;
/// Pixels a side of a tile.
pub(crate) const TILE: i32 = 1 << TILE_BITS;
/// Pixels a side of a block, as a power of two.
pub(crate) const BLOCK_BITS: u32 = 2 * TILE_BITS;
/// Pixels a side of a block.
pub(crate) const BLOCK: i32 = 1 << BLOCK_BITS;
/// Pixels of a block.
pub(crate) const BLOCK_PIXELS: usize = LANES * LANES;

/// The pixels of a block, a tile after the other.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Block(pub(crate) [[f32; LANES]; LANES]);

/// Column of a pixel in its tile, or of a tile in its block, by lane.
pub(crate) const LANE_X: [i32; LANES] = [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3];
/// Row of a pixel in its tile, or of a tile in its block, by lane.
pub(crate) const LANE_Y: [i32; LANES] = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];

/// Where a pixel of a block lies: its tile, and its lane there.
#[inline(always)]
pub(crate) fn within(x: u32, y: u32) -> (usize, usize) {
    let tile = (y >> TILE_BITS & 3) << 2 | (x >> TILE_BITS & 3);
    let lane = (y & 3) << 2 | (x & 3);
    (tile as usize, lane as usize)
}

/// The children of a node that lie in a range of columns and rows, ends included: tiles of a block,
/// or pixels of a tile. `first` and `last` count children from the node's own first; they may
/// lie beyond it, but meet it.
#[inline(always)]
pub(crate) fn children(first: [i32; 2], last: [i32; 2]) -> Mask {
    let (x0, x1) = (first[0].max(0) as u32, last[0].min(3) as u32);
    let (y0, y1) = (first[1].max(0) as u32, last[1].min(3) as u32);
    let columns = ((2 << x1) - (1 << x0)) * 0x1111;
    let rows = (1 << (4 * y1 + 4)) - (1 << (4 * y0));
    columns & rows
}

/// The blocks that pixels lie in, ends included.
#[inline(always)]
pub(crate) fn blocks(rect: &PixelRect) -> ([u32; 2], [u32; 2]) {
    let first = [rect.x0, rect.y0].map(|v| v >> BLOCK_BITS);
    (first, [rect.x1, rect.y1].map(|v| (v - 1) >> BLOCK_BITS))
}

/// The tile of a block that a pixel lies in, by column or row; beyond the block, beyond its tiles.
#[inline(always)]
pub(crate) fn tile_of(pixel: i32, block: i32) -> i32 {
    (pixel - (block << BLOCK_BITS)) >> TILE_BITS
}
