//! Where samples go.

use super::isa::{Isa, Mask};
use super::layout::{BLOCK, BLOCK_BITS, blocks, children, tile_of};
use crate::geom::PixelRect;

/// A band of rows of blocks that takes samples. Blocks are counted from the band's first.
pub(crate) trait Sink {
    /// Whether the sink wants to know which triangle a sample belongs to.
    const WANTS_IDS: bool;

    /// Called before anything of a run is drawn.
    fn begin(&mut self) {}

    /// What the sink holds.
    fn rows(&self) -> Rows;

    /// Whether more of a draw call can tell the sink anything.
    #[inline(always)]
    fn wants(&mut self, _call: u32) -> bool {
        true
    }

    /// Whether nothing of `nearest` or farther changes anything in some pixels of the band.
    #[inline(always)]
    fn hides<I: Isa>(&mut self, rect: &PixelRect, nearest: f32) -> bool {
        let (nearest, rows) = (I::splat_f(nearest), self.rows());
        let (first, last) = blocks(rect);
        for by in first[1]..=last[1] {
            for bx in first[0]..=last[0] {
                let tiles = children(
                    [tile_of(rect.x0 as i32, bx as i32), tile_of(rect.y0 as i32, by as i32)],
                    [tile_of(rect.x1 as i32 - 1, bx as i32), tile_of(rect.y1 as i32 - 1, by as i32)],
                );
                let block = rows.block((bx << BLOCK_BITS) as i32, (by << BLOCK_BITS) as i32);
                if !self.hides_tiles::<I>(block, tiles, nearest) {
                    return false;
                }
            }
        }
        true
    }

    /// The same for some tiles of a block.
    fn hides_tiles<I: Isa>(&mut self, block: usize, tiles: Mask, nearest: I::F) -> bool;

    /// The tiles of a block in which a nearness up to `greatest` can change something.
    fn open_tiles<I: Isa>(&mut self, block: usize, greatest: I::F) -> Mask;

    /// The samples of a tile, a lane each.
    fn tile<I: Isa>(&mut self, block: usize, tile: usize, covered: Mask, nearness: I::F, id: Id);

    /// One sample; `at` counts pixels as they lie in memory.
    fn sample(&mut self, at: usize, nearness: f32, id: Id);
}

/// Which triangle of which draw call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Id {
    /// Index of the draw call.
    pub(crate) call: u32,
    /// Index of the triangle in the call's level.
    pub(crate) triangle: u32,
}

/// The rows of pixels of a band that lie in the viewport, `last` included; and its columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    /// First row; the first of a block.
    pub(crate) first: i32,
    /// Last row.
    pub(crate) last: i32,
    /// The viewport's last column.
    pub(crate) last_column: i32,
    /// Blocks a row of blocks.
    pub(crate) blocks: usize,
}

impl Rows {
    /// The block that holds a pixel of the band.
    #[inline(always)]
    pub(crate) fn block(&self, column: i32, row: i32) -> usize {
        ((row - self.first) / BLOCK) as usize * self.blocks + (column / BLOCK) as usize
    }
}
