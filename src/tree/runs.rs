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

    /// Where its object of this index is: block × 16 + lane.
    pub(super) fn location(self, index: u32) -> usize {
        self.first as usize * LANES + index as usize
    }

    /// The index of an object by where it is.
    pub(super) fn index(self, location: usize) -> u32 {
        (location - self.first as usize * LANES) as u32
    }
}

/// Runs that belong to no node, by class.
#[derive(Clone, Debug, Default)]
pub(super) struct FreeRuns {
    first: Vec<Vec<u32>>,
}

impl FreeRuns {
    /// Takes a run back.
    pub(super) fn put(&mut self, run: Run) {
        if run.first == NONE {
            return;
        }
        let class = run.class as usize;
        if class >= self.first.len() {
            self.first.resize_with(class + 1, Vec::new);
        }
        self.first[class].push(run.first);
    }

    /// Hands out a run of a class: one that was given back, or a part of a larger one.
    pub(super) fn take(&mut self, class: u8) -> Option<Run> {
        let found = (class as usize..self.first.len()).find(|&c| !self.first[c].is_empty())?;
        let first = self.first[found].pop()?;
        let end = first + blocks_in(found as u8);
        let mut rest = first + blocks_in(class);
        while rest < end {
            // The largest class that fits: the least above it, unless it is met exactly.
            let class = class_of(end - rest + 1) - 1;
            self.put(Run::new(rest, class));
            rest += blocks_in(class);
        }
        Some(Run::new(first, class))
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.first.iter().map(|f| f.capacity() * size_of::<u32>()).sum()
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
}
