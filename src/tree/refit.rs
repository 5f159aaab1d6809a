//! Bringing boxes, epochs and stamps up to date, bottom-up.

use super::Tree;
use super::blocks::NONE;
use super::place::CONTENT;

impl Tree {
    /// Brings the tree up to date after edits: moves what has left its cell, builds where it has
    /// grown crowded, drops nodes that have become superfluous, and refits what has changed.
    /// O(edits · depth); nothing at all for a tree without edits.
    pub(crate) fn update(&mut self) {
        self.tick = self.tick.wrapping_add(1);
        self.relocate();
        self.build_crowded();
        self.collapse_thinned();
        self.shrink_root();
        self.refit();
    }

    /// Recomputes the boxes of dirty nodes, the deepest first, so that each parent is seen once.
    pub(super) fn refit(&mut self) {
        for depth in (0..self.dirty.len()).rev() {
            let mut level = std::mem::take(&mut self.dirty[depth]);
            for node in level.drain(..) {
                let n = node as usize;
                let why = std::mem::take(&mut self.nodes.dirty[n]);
                if why == 0 || !self.nodes.is_alive(node) {
                    continue;
                }
                let own = self.blocks.bounds(self.nodes.run[n]);
                let bounds = self
                    .nodes
                    .children(node)
                    .fold(own, |all, child| all.union(&self.nodes.bounds[child as usize]));
                self.nodes.bounds[n] = bounds;
                if node == 0 && self.nodes.is_leaf(0) {
                    self.nodes.cell[0] = bounds;
                }
                if why & CONTENT != 0 {
                    self.nodes.epoch[n] = self.nodes.epoch[n].wrapping_add(1);
                    self.nodes.moved_at[n] = self.tick;
                }
                let parent = self.nodes.parent[n];
                if parent != NONE {
                    self.touch(parent, why);
                }
            }
            // The emptied list keeps its memory for the next frame.
            self.dirty[depth] = level;
        }
    }
}
