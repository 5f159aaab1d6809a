//! The depth buffer and its sink.

use rayon::prelude::*;

use super::bands::BAND_ROWS;
use super::hi_z::{Base, HiZ, STALE};
use super::isa::{Isa, LANES, Mask};
use super::layout::{BLOCK, BLOCK_BITS, BLOCK_PIXELS, Block, within};
use super::sink::{Id, Rows, Sink};

/// Nearness of every pixel, block by block. What lies beyond the viewport is infinitely near, so
/// that it hides nothing and is never drawn on.
#[derive(Debug, Default)]
pub(crate) struct Depth {
    width: u32,
    height: u32,
    across: usize,
    cleared: f32,
    blocks: Vec<Block>,
    /// Of each band: it holds the last frame and counts as cleared.
    pending: Vec<bool>,
}

impl Depth {
    /// Takes a size. Bands are cleared when they are first drawn on, or by [`Depth::settle`]: then
    /// they are in the cache.
    pub(crate) fn reset(&mut self, width: u32, height: u32, cleared: f32) {
        let down = height.div_ceil(BLOCK as u32) as usize;
        self.across = width.div_ceil(BLOCK as u32) as usize;
        (self.width, self.height, self.cleared) = (width, height, cleared);
        self.blocks.resize(self.across * down, Block([[cleared; LANES]; LANES]));
        self.pending.clear();
        self.pending.resize(height.div_ceil(BAND_ROWS) as usize, true);
    }

    /// Clears what nothing was drawn on.
    pub(crate) fn settle(&mut self) {
        let (many, cleared, rows) = (self.blocks_a_band(), self.cleared, self.rows_of());
        for (band, (blocks, pending)) in self.blocks.chunks_mut(many).zip(&mut self.pending).enumerate() {
            if std::mem::take(pending) {
                clear(blocks, &rows(band), cleared);
            }
        }
    }

    /// Blocks a row of blocks.
    #[inline(always)]
    pub(crate) fn across(&self) -> usize {
        self.across
    }

    #[inline(always)]
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// The pixels of a tile, by its column and row of tiles.
    #[inline(always)]
    pub(crate) fn tile(&self, x: u32, y: u32) -> &[f32; LANES] {
        let block = (y as usize / 4) * self.across + x as usize / 4;
        &self.blocks[block].0[(y as usize % 4) * 4 + x as usize % 4]
    }

    #[inline(always)]
    pub(crate) fn image(&self) -> DepthImage<'_> {
        DepthImage { depth: self }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
    }

    /// What each band of rows holds, from the top.
    pub(crate) fn rows(&self) -> impl IndexedParallelIterator<Item = Rows> + use<> {
        (0..self.pending.len()).into_par_iter().map(self.rows_of())
    }

    /// What a band of rows holds.
    fn rows_of(&self) -> impl Fn(usize) -> Rows + Send + Sync + Copy + use<> {
        let (width, height, blocks) = (self.width, self.height, self.across);
        move |band| {
            let first = band as u32 * BAND_ROWS;
            Rows {
                first: first as i32,
                last: (first + BAND_ROWS).min(height) as i32 - 1,
                last_column: width as i32 - 1,
                blocks,
            }
        }
    }

    /// Blocks a band of rows; the last one has fewer.
    pub(crate) fn blocks_a_band(&self) -> usize {
        self.across * (BAND_ROWS as usize >> BLOCK_BITS)
    }

    /// One sink a band of rows, from the top.
    pub(crate) fn sinks<'a>(
        &'a mut self,
        hi_z: &'a mut HiZ,
    ) -> impl IndexedParallelIterator<Item = DepthSink<'a>> {
        let (many, rows) = (self.blocks_a_band(), self.rows());
        let base = hi_z.base();
        let hierarchy = base.farthest.par_chunks_mut(many).zip(base.stale.par_chunks_mut(many));
        let bands = self.blocks.par_chunks_mut(many).zip(&mut self.pending).zip(hierarchy);
        let cleared = self.cleared;
        bands.zip(rows).map(move |(((blocks, pending), (farthest, stale)), rows)| DepthSink {
            blocks,
            pending,
            cleared,
            base: Base { farthest, stale },
            rows,
        })
    }
}

/// The depth of a frame, to read. Cleared pixels hold
/// [`DepthDirection::cleared`](crate::geom::DepthDirection::cleared).
#[derive(Clone, Copy, Debug)]
pub struct DepthImage<'a> {
    depth: &'a Depth,
}

impl<'a> DepthImage<'a> {
    /// Width in pixels.
    #[inline]
    pub fn width(&self) -> u32 {
        self.depth.width
    }

    /// Height in pixels.
    #[inline]
    pub fn height(&self) -> u32 {
        self.depth.height
    }

    /// The nearness of a row's pixels, from the left; row 0 is the uppermost.
    pub fn row(&self, y: u32) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        let image = *self;
        (0..self.depth.width).map(move |x| image.at(x, y))
    }

    /// The nearness of a pixel of the viewport.
    pub fn at(&self, x: u32, y: u32) -> f32 {
        let side = BLOCK as u32;
        if self.depth.pending[(y / BAND_ROWS) as usize] {
            return self.depth.cleared;
        }
        let (tile, lane) = within(x, y);
        self.depth.blocks[(y / side) as usize * self.depth.across + (x / side) as usize].0[tile][lane]
    }
}

/// Keeps the greatest nearness of a band of rows.
#[derive(Debug)]
pub(crate) struct DepthSink<'a> {
    blocks: &'a mut [Block],
    pending: &'a mut bool,
    cleared: f32,
    base: Base<'a>,
    rows: Rows,
}

/// Changes of a block after which its hierarchy is brought up to date before somebody is drawn for
/// want of knowing better.
pub(crate) const REFRESH_CALL: u32 = 8;
/// The same before a triangle is drawn.
pub(crate) const REFRESH_TRIANGLE: u32 = 16;

impl DepthSink<'_> {
    #[inline(always)]
    fn refresh<I: Isa>(&mut self, block: usize) {
        self.base.farthest[block] = I::store_f(I::least(&self.blocks[block].0));
        self.base.stale[block] = STALE;
    }

    /// Some tiles of a block, brought up to date after so many changes: those in which some sample is not
    /// before all up to `greatest`.
    #[inline(always)]
    pub(crate) fn tiles_in_reach<I: Isa>(&mut self, block: usize, greatest: I::F, changes: u32) -> Mask {
        if self.base.stale[block] & !STALE >= changes {
            self.refresh::<I>(block);
        }
        I::ge_f(greatest, I::load_f(&self.base.farthest[block]))
    }

    /// The samples of a tile.
    #[inline(always)]
    pub(crate) fn kept<I: Isa>(&self, block: usize, tile: usize) -> I::F {
        I::load_f(&self.blocks[block].0[tile])
    }

    /// A sample, as it lies in memory.
    #[inline(always)]
    pub(crate) fn kept_at(&self, at: usize) -> f32 {
        self.blocks[at / BLOCK_PIXELS].0[at / LANES % LANES][at % LANES]
    }
}

impl Sink for DepthSink<'_> {
    const WANTS_IDS: bool = false;

    #[inline(always)]
    fn begin(&mut self) {
        if std::mem::take(self.pending) {
            clear(self.blocks, &self.rows, self.cleared);
        }
    }

    #[inline(always)]
    fn rows(&self) -> Rows {
        self.rows
    }

    #[inline(always)]
    fn hides_tiles<I: Isa>(&mut self, block: usize, tiles: Mask, nearest: I::F) -> bool {
        // Nothing nearer than what is there: the greatest nearness stays as it is.
        let mut open = tiles & I::gt_f(nearest, I::load_f(&self.base.farthest[block]));
        if open != 0 && self.base.stale[block] & !STALE >= REFRESH_CALL {
            self.refresh::<I>(block);
            open = tiles & I::gt_f(nearest, I::load_f(&self.base.farthest[block]));
        }
        open == 0
    }

    #[inline(always)]
    fn open_tiles<I: Isa>(&mut self, block: usize, greatest: I::F) -> Mask {
        if self.base.stale[block] & !STALE >= REFRESH_TRIANGLE {
            self.refresh::<I>(block);
        }
        I::gt_f(greatest, I::load_f(&self.base.farthest[block]))
    }

    #[inline(always)]
    fn tile<I: Isa>(&mut self, block: usize, tile: usize, covered: Mask, nearness: I::F, _: Id) {
        let pixels = &mut self.blocks[block].0[tile];
        // All lanes are stored: what follows cannot read from a masked store before it has reached
        // the cache.
        let covering = I::blend_f(covered, I::splat_f(f32::NEG_INFINITY), nearness);
        *pixels = I::store_f(I::max_f(covering, I::load_f(pixels)));
        self.base.note(block);
    }

    #[inline(always)]
    fn sample(&mut self, at: usize, nearness: f32, _: Id) {
        let block = at / BLOCK_PIXELS;
        let kept = &mut self.blocks[block].0[at / LANES % LANES][at % LANES];
        // Stored in any case: which one is nearer cannot be foretold.
        *kept = if nearness > *kept { nearness } else { *kept };
        self.base.note(block);
    }
}

/// Clears the blocks of a band; what lies beyond the viewport becomes infinitely near.
fn clear(blocks: &mut [Block], rows: &Rows, cleared: f32) {
    blocks.fill(Block([[cleared; LANES]; LANES]));
    let (width, height) = (rows.last_column + 1, rows.last + 1 - rows.first);
    for (index, block) in blocks.iter_mut().enumerate() {
        let first = [(index % rows.blocks) as i32, (index / rows.blocks) as i32].map(|b| b << BLOCK_BITS);
        if first[0] + BLOCK <= width && first[1] + BLOCK <= height {
            continue;
        }
        for y in 0..BLOCK {
            for x in 0..BLOCK {
                if first[0] + x >= width || first[1] + y >= height {
                    let (tile, lane) = within(x as u32, y as u32);
                    block.0[tile][lane] = f32::INFINITY;
                }
            }
        }
    }
}
