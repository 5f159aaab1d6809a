//! Closing the holes in the arena of blocks.
//!
//! Where objects move fast, runs grow and shrink all the time, and leave holes that no other run
//! fits into. Once these are an eighth of the arena, runs slide down over them, some each update, until all
//! are one at the end, which is cut off.

use std::ops::Range;

use super::block::{Block, LANES};
use super::blocks::{Blocks, NONE, News};
use super::hull::Hull;
use super::runs::Run;

/// Which part of the arena may be holes: one of so many.
const HOLES: usize = 8;

/// Holes that are worth it, at most: runs of one block, of which a fine tree has many, fit into any.
const FEW: usize = 1024;

/// Blocks that slide in one update: at least so many, or one of so many.
const SLIDING: (usize, usize) = (128, 64);

impl Blocks {
    /// Brings runs together, if there is too much room between them: `runs` are those of the nodes, by
    /// index. To be called when no block is stale. O(holes · log holes + blocks moved).
    pub(super) fn compact(&mut self, runs: &mut [Run]) {
        let end = self.blocks.len();
        if HOLES * self.free.blocks() <= end {
            return;
        }
        if self.free.count() > FEW {
            // Many that lie side by side may be few.
            self.free.join();
            if self.free.count() > FEW {
                return;
            }
        }
        let budget = SLIDING.0.max(end / SLIDING.1);
        let mut holes = self.free.take_all();
        // The hole that rises through the arena as runs slide down over it, and takes others in.
        let (mut rising, mut moved) = (0, 0);
        while (holes[rising].end as usize) < end && moved < budget {
            let hole = holes[rising].clone();
            let run = &mut runs[self.owner[hole.end as usize] as usize];
            let length = self.slide(run, hole.start);
            moved += length as usize;
            holes[rising] = hole.start + length..hole.end + length;
            if holes.get(rising + 1).is_some_and(|next| next.start == hole.end + length) {
                rising += 1;
                holes[rising].start = hole.start + length;
            }
        }
        holes.drain(..rising);
        if let Some(last) = holes.pop_if(|hole| hole.end as usize == end) {
            self.cut_off(last.start as usize);
        }
        self.free.put_all(holes);
    }

    /// Moves a run to where it begins before, over blocks without owner; returns its length.
    fn slide(&mut self, run: &mut Run, first: u32) -> u32 {
        let (from, to) = (run.all(), first as usize);
        self.blocks.copy_within(from.clone(), to);
        self.hulls.copy_within(from.clone(), to);
        self.news.copy_within(from.clone(), to);
        self.owner.copy_within(from.clone(), to);
        *run = run.moved_to(first);
        for block in run.used() {
            for (lane, &slot) in
                self.blocks[block].slots.iter().enumerate().filter(|&(_, &slot)| slot != NONE)
            {
                self.known[slot as usize].location = (block * LANES + lane) as u32;
            }
        }
        self.empty(from.start.max(run.all().end)..from.end);
        from.len() as u32
    }

    fn empty(&mut self, blocks: Range<usize>) {
        self.blocks[blocks.clone()].fill(Block::EMPTY);
        self.hulls[blocks.clone()].fill(Hull::EMPTY);
        self.news[blocks].fill(News::default());
    }

    fn cut_off(&mut self, end: usize) {
        self.blocks.truncate(end);
        self.hulls.truncate(end);
        self.news.truncate(end);
        self.owner.truncate(end);
        self.stale.set_len(end);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::geom::Aabb;
    use crate::tree::{Tree, TreeConfig};

    /// Ten thousand objects of which nine tenths go, and the rest moves on: the arena shrinks with them,
    /// also where each leaf leaves a hole.
    #[test]
    fn holes_are_closed() {
        for unasked_leaf in [64, 2] {
            let (before, after) = shrink(unasked_leaf);
            assert!(2 * after < before, "{before} to {after} blocks, leaves of {unasked_leaf}");
        }
    }

    fn shrink(unasked_leaf: u32) -> (usize, usize) {
        let at = |slot: u32, shift: f32| {
            let center = Vec3::new((slot * 7 % 101) as f32, (slot * 11 % 97) as f32, (slot * 13 % 89) as f32);
            Aabb::from_center(center + shift, Vec3::splat(0.25))
        };
        let mut tree =
            Tree::new(TreeConfig { unasked_leaf, bulk_leaf: unasked_leaf, ..TreeConfig::default() });
        (0..10_000).for_each(|slot| tree.insert(slot, &at(slot, 0.0)));
        tree.update();
        let before = tree.blocks.blocks.len();
        (0..10_000).filter(|slot| slot % 10 > 0).for_each(|slot| tree.remove(slot));
        for frame in 0..40 {
            (0..10_000).step_by(20).for_each(|slot| tree.set_bounds(slot, &at(slot, (1 + frame % 3) as f32)));
            tree.update();
            tree.validate().expect("a valid tree");
        }
        (before, tree.blocks.blocks.len())
    }
}
