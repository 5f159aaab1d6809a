//! Occluder filtering (HROC, *OF*): which of the drawn objects own a sample?
//!
//! The draw calls of the frame are rasterised once more, against the depth that they have left: the same
//! triangle yields the same bits, so a sample is in sight exactly if it is not below the stored one. Most
//! of what is hidden is skipped whole by the hierarchy.

use rayon::prelude::*;

use super::super::SoftwareQueries;
use super::super::isa::{Isa, LANES, Mask};
use super::super::layout::{BLOCK_PIXELS, Block};
use super::super::pass::DrawCall;
use super::super::sink::{Id, Rows, Sink};
use crate::geom::View;
use crate::scene::{ObjectId, ObjectSet};

/// The frame's draw calls, of which somebody may want to know whose they are.
#[derive(Debug, Default)]
pub(in super::super) struct Owned {
    pub(in super::super) calls: Vec<DrawCall>,
    /// Whose each call is.
    pub(in super::super) owners: Vec<ObjectId>,
    /// A bit a call, a row of words a band; the first row is that of all bands.
    seen: Vec<u64>,
}

impl Owned {
    pub(in super::super) fn clear(&mut self) {
        self.calls.clear();
        self.owners.clear();
    }
}

impl SoftwareQueries {
    /// Those of the loose objects that own a sample.
    pub(super) fn owners(&mut self, view: &View, loose: &ObjectSet, found: &mut ObjectSet) {
        let many = self.depth.blocks_a_band();
        let Owned { calls, owners, seen } = &mut self.owned;
        let words = calls.len().div_ceil(64).max(1);
        seen.clear();
        seen.resize(words * (self.depth.rows().len() + 1), 0);
        let (all, by_band) = seen.split_at_mut(words);
        let held = self.depth.blocks().par_chunks(many).zip(self.hi_z.farthest().par_chunks(many));
        let bands = held.zip(by_band.par_chunks_mut(words)).zip(self.depth.rows());
        let sinks = bands.map(|(((depth, farthest), seen), rows)| OwnerSink { depth, farthest, seen, rows });
        self.bands.rasterise(self.simd, view, calls, sinks);
        for band in by_band.chunks(words) {
            all.iter_mut().zip(band).for_each(|(all, band)| *all |= band);
        }
        for (call, &owner) in owners.iter().enumerate() {
            if all[call / 64] & (1 << (call % 64)) != 0 && loose.contains(owner) {
                found.insert(owner);
            }
        }
    }
}

/// Looks at the samples of a band of rows.
struct OwnerSink<'a> {
    depth: &'a [Block],
    farthest: &'a [[f32; LANES]],
    seen: &'a mut [u64],
    rows: Rows,
}

impl OwnerSink<'_> {
    #[inline(always)]
    fn see(&mut self, call: u32) {
        self.seen[call as usize / 64] |= 1 << (call % 64);
    }
}

impl Sink for OwnerSink<'_> {
    const WANTS_IDS: bool = true;

    #[inline(always)]
    fn rows(&self) -> Rows {
        self.rows
    }

    /// One sample is enough.
    #[inline(always)]
    fn wants(&mut self, call: u32) -> bool {
        self.seen[call as usize / 64] & (1 << (call % 64)) == 0
    }

    #[inline(always)]
    fn hides_tiles<I: Isa>(&mut self, block: usize, tiles: Mask, nearest: I::F) -> bool {
        tiles & self.open_tiles::<I>(block, nearest) == 0
    }

    /// Those where not everything is nearer. What is equally far counts as seen.
    #[inline(always)]
    fn open_tiles<I: Isa>(&mut self, block: usize, greatest: I::F) -> Mask {
        I::ge_f(greatest, I::load_f(&self.farthest[block]))
    }

    #[inline(always)]
    fn tile<I: Isa>(&mut self, block: usize, tile: usize, covered: Mask, nearness: I::F, id: Id) {
        if covered & I::ge_f(nearness, I::load_f(&self.depth[block].0[tile])) != 0 {
            self.see(id.call);
        }
    }

    #[inline(always)]
    fn sample(&mut self, at: usize, nearness: f32, id: Id) {
        let (block, tile, lane) = (at / BLOCK_PIXELS, at / LANES % LANES, at % LANES);
        if nearness >= self.depth[block].0[tile][lane] {
            self.see(id.call);
        }
    }
}
