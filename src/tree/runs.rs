//! Runs: a node's share of the arena of blocks.

use std::ops::Range;

use super::block::LANES;
use super::blocks::NONE;

/// Consecutive blocks of one node, dense from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    first: u32,
    /// What [`blocks_in`] makes of it is the number of blocks.
    class: u8,
    /// Objects in it.
    pub(crate) len: u32,
    /// How many of them, at its front, keep moving.
    pub(super) active: u32,
}

impl Run {
    /// A run without any block.
    pub(crate) const EMPTY: Self = Self { first: NONE, class: 0, len: 0, active: 0 };

    /// A run that begins with this block and holds nothing yet.
    pub(super) fn new(first: u32, class: u8) -> Self {
        Self { first, class, len: 0, active: 0 }
    }

    /// The least class that has room for so many objects.
    pub(super) fn class_for(count: u32) -> u8 {
        class_of(count.div_ceil(LANES as u32))
    }

    /// Objects that it has room for.
    pub(super) fn capacity(self) -> u32 {
        self.all().len() as u32 * LANES as u32
    }

    /// Whether three quarters of the room, and more than a block, are unused.
    pub(super) fn is_sparse(self) -> bool {
        self.class > 0 && self.len * 4 <= self.capacity()
    }

    /// Blocks that hold objects.
    pub(super) fn used(self) -> Range<usize> {
        let first = self.all().start;
        first..first + (self.len as usize).div_ceil(LANES)
    }

    /// All its blocks.
    pub(super) fn all(self) -> Range<usize> {
        if self.first == NONE {
            return 0..0;
        }
        let first = self.first as usize;
        first..first + blocks_in(self.class) as usize
    }

    /// The same, from another first block on.
    pub(super) fn moved_to(self, first: u32) -> Self {
        Self { first, ..self }
    }

    /// A bit for each lane of one of its blocks that is not in front, with the objects that keep moving, but
    /// should be if its object does; a run of one block has no front.
    #[inline(always)]
    pub(super) fn not_in_front(self, block: usize) -> u16 {
        let in_front = self.active.saturating_sub(self.index(block * LANES));
        if self.len <= LANES as u32 { 0 } else { u32::from(u16::MAX).unbounded_shl(in_front) as u16 }
    }

    /// Where its object of this index is: block × 16 + lane.
    pub(super) fn location(self, index: u32) -> usize {
        self.first as usize * LANES + index as usize
    }

    /// The index of an object by where it is.
    pub(super) fn index(self, location: usize) -> u32 {
        (location - self.first as usize * LANES) as u32
    }
}

/// Runs that belong to no node.
#[derive(Clone, Debug, Default)]
pub(super) struct FreeRuns {
    /// Their first blocks, by class.
    first: Vec<Vec<u32>>,
    /// How many were given back since neighbours were last joined.
    fresh: usize,
    /// All their blocks.
    blocks: u32,
    /// Reused by each joining: the runs as ranges of blocks.
    holes: Vec<Range<u32>>,
}

impl FreeRuns {
    /// Takes a run back.
    pub(super) fn put(&mut self, run: Run) {
        if run.first != NONE {
            self.fresh += 1;
            self.list(run.first, run.class);
        }
    }

    /// Hands out a run of a class: one that was given back, or a part of a larger one. O(classes), and
    /// O(log n) for each that was given back, where neighbours must be joined for it.
    pub(super) fn take(&mut self, class: u8) -> Option<Run> {
        let found = self.least(class).or_else(|| {
            self.join();
            self.least(class)
        })?;
        let first = self.first[found as usize].pop()?;
        self.blocks -= blocks_in(found);
        self.divide(first + blocks_in(class)..first + blocks_in(found));
        Some(Run::new(first, class))
    }

    /// Blocks in them.
    pub(super) fn blocks(&self) -> usize {
        self.blocks as usize
    }

    /// How many there are, where neighbours count by themselves.
    pub(super) fn count(&self) -> usize {
        self.first.iter().map(Vec::len).sum()
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let lists: usize = self.first.iter().map(|f| f.capacity() * size_of::<u32>()).sum();
        lists + self.holes.capacity() * size_of::<Range<u32>>()
    }

    /// The least class of a free run that has room for one of this class.
    fn least(&self, class: u8) -> Option<u8> {
        (class..self.first.len() as u8).find(|&c| !self.first[c as usize].is_empty())
    }

    /// Makes one of free runs that lie side by side, or the arena would come to consist of those of the
    /// wrong size. Not again before a quarter of the runs are new: so it costs no more than giving them back.
    pub(super) fn join(&mut self) {
        if 4 * self.fresh < self.count().max(1) {
            return;
        }
        let holes = self.take_all();
        self.put_all(holes);
    }

    /// Takes all of them out, in order, neighbours joined; to be given back by [`Self::put_all`].
    pub(super) fn take_all(&mut self) -> Vec<Range<u32>> {
        let mut holes = std::mem::take(&mut self.holes);
        for (class, list) in (0..).zip(&mut self.first) {
            holes.extend(list.drain(..).map(|first| first..first + blocks_in(class)));
        }
        holes.sort_unstable_by_key(|hole| hole.start);
        holes.dedup_by(|hole, before| {
            let joined = hole.start == before.end;
            before.end = if joined { hole.end } else { before.end };
            joined
        });
        (self.fresh, self.blocks) = (0, 0);
        holes
    }

    /// Gives them back.
    pub(super) fn put_all(&mut self, mut holes: Vec<Range<u32>>) {
        // From behind: the last that is listed is the next to be taken, and those in front shall be.
        holes.drain(..).rev().for_each(|hole| self.divide(hole));
        self.holes = holes;
    }

    /// Lists blocks as runs: the largest that there are.
    fn divide(&mut self, mut blocks: Range<u32>) {
        while !blocks.is_empty() {
            // The largest class that fits: the least above it, unless it is met exactly.
            let class = class_of(blocks.end - blocks.start + 1) - 1;
            self.list(blocks.start, class);
            blocks.start += blocks_in(class);
        }
    }

    fn list(&mut self, first: u32, class: u8) {
        self.blocks += blocks_in(class);
        let class = class as usize;
        if class >= self.first.len() {
            self.first.resize_with(class + 1, Vec::new);
        }
        self.first[class].push(first);
    }
}

/// Classes are 1 to 8 blocks, then four to each doubling: 10, 12, 14, 16, 20 …
fn blocks_in(class: u8) -> u32 {
    match class {
        0..8 => u32::from(class) + 1,
        _ => u32::from(class % 4 + 5) << (class / 4 - 1),
    }
}

/// The least class of at least so many blocks.
fn class_of(blocks: u32) -> u8 {
    if blocks <= 8 {
        return blocks.max(1) as u8 - 1;
    }
    let octave = (blocks - 1).ilog2() as u8;
    let quarter = ((blocks - 1) >> (octave - 2)) as u8 - 4;
    8 + 4 * (octave - 3) + quarter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_hold_what_they_are_for_and_little_more() {
        for blocks in 1..100_000 {
            let class = class_of(blocks);
            assert!(blocks_in(class) >= blocks, "{blocks}");
            assert!(class == 0 || blocks_in(class - 1) < blocks, "{blocks}");
            assert!(blocks_in(class) <= blocks + blocks / 4, "{blocks}");
        }
    }

    #[test]
    fn a_larger_run_is_cut_up_without_loss() {
        for size in 2..60 {
            let mut free = FreeRuns::default();
            free.put(Run::new(100, class_of(size)));
            let mut blocks = Vec::new();
            while let Some(run) = free.take(0) {
                blocks.extend(run.all());
            }
            blocks.sort_unstable();
            let all: Vec<usize> = (100..100 + blocks_in(class_of(size)) as usize).collect();
            assert_eq!(blocks, all);
        }
    }

    /// Whatever is handed out and given back, in whatever sizes: no block is lost or given twice, and
    /// once all are back they are one run again.
    #[test]
    fn neighbours_are_joined() {
        let (mut free, mut held) = (FreeRuns::default(), Vec::<Run>::new());
        let (whole, mut seed) = (Run::new(0, class_of(512)), 1_u32);
        free.put(whole);
        for _ in 0..2000 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let class = (seed >> 16) as u8 % 20;
            match free.take(class) {
                Some(run) if seed >> 31 == 0 => held.push(run),
                Some(run) => free.put(run),
                None => held.drain(..held.len() / 2).for_each(|run| free.put(run)),
            }
            let mut blocks: Vec<usize> = held.iter().flat_map(|run| run.all()).collect();
            blocks.sort_unstable();
            assert!(blocks.is_sorted_by(|a, b| a < b), "{blocks:?}");
        }
        held.drain(..).for_each(|run| free.put(run));
        assert_eq!(free.take(whole.class), Some(whole));
    }
}
