//! Bringing boxes, epochs and stamps up to date, bottom-up.

use super::Tree;
use super::block::union;
use super::blocks::NONE;
use super::node::Nodes;

/// The node needs its box refitted.
pub(super) const REFIT: u8 = 1;
/// Something entered or moved: the content epoch advances as well.
pub(super) const CONTENT: u8 = 2;
/// Objects came or went: the box around the node's own objects is out of date.
pub(super) const REGROUPED: u8 = 4;

/// The nodes to refit, by depth: the deepest go first, so that each parent is seen once.
#[derive(Clone, Debug, Default)]
pub(super) struct Dirty {
    levels: Vec<Vec<u32>>,
    /// Levels that may have nodes.
    deep: usize,
    /// Reused when the lists are made anew.
    listed: Vec<u32>,
}

impl Dirty {
    /// Lists a node, once.
    #[inline]
    pub(super) fn touch(&mut self, nodes: &mut Nodes, node: u32, why: u8) {
        let n = node as usize;
        if nodes.dirty[n] == 0 {
            let depth = nodes.depth[n] as usize;
            if depth >= self.levels.len() {
                self.levels.resize_with(depth + 1, Vec::new);
            }
            self.deep = self.deep.max(depth + 1);
            self.levels[depth].push(node);
        }
        nodes.dirty[n] |= why | REFIT;
    }

    /// Lists all nodes again, and some more, when depths have changed.
    pub(super) fn relist(&mut self, nodes: &mut Nodes, more: impl Iterator<Item = u32>) {
        let mut listed = std::mem::take(&mut self.listed);
        self.levels.iter_mut().for_each(|level| listed.append(level));
        self.deep = 0;
        listed.extend(more);
        for node in listed.drain(..) {
            let why = std::mem::take(&mut nodes.dirty[node as usize]);
            if nodes.is_alive(node) {
                self.touch(nodes, node, why | REGROUPED);
            }
        }
        self.listed = listed;
    }
}

impl Tree {
    /// Brings the tree up to date after edits: moves what has left its cell, places what is new,
    /// builds where it has grown crowded, drops nodes that have become superfluous, and refits
    /// what has changed. O(edits · depth), and next to nothing for a tree without edits.
    pub(crate) fn update(&mut self) {
        self.tick = self.tick.wrapping_add(1);
        self.log.forget(self.tick);
        self.refresh();
        self.relocate();
        self.place_arrivals();
        self.build_crowded();
        self.collapse_thinned();
        self.shrink_root();
        self.blocks.compact(&mut self.nodes.run);
        self.refit();
    }

    /// Marks a node for the next refit.
    pub(super) fn touch(&mut self, node: u32, why: u8) {
        self.dirty.touch(&mut self.nodes, node, why);
    }

    /// Recomputes the boxes of dirty nodes, the deepest first.
    pub(super) fn refit(&mut self) {
        let Self { blocks, nodes, dirty, tick, .. } = self;
        for depth in (0..std::mem::take(&mut dirty.deep)).rev() {
            let mut level = std::mem::take(&mut dirty.levels[depth]);
            for node in level.drain(..) {
                let n = node as usize;
                let why = std::mem::take(&mut nodes.dirty[n]);
                if why == 0 || !nodes.is_alive(node) {
                    continue;
                }
                let mut bounds = blocks.around(nodes.run[n]);
                for child in nodes.children(node) {
                    bounds = union(&bounds, &nodes.bounds[child as usize]);
                }
                nodes.bounds[n] = bounds;
                if node == 0 && nodes.is_leaf(0) {
                    nodes.cell[0] = bounds;
                }
                if why & CONTENT != 0 {
                    nodes.epoch[n] = nodes.epoch[n].wrapping_add(1);
                    nodes.moved_at[n] = *tick;
                }
                let parent = nodes.parent[n];
                if parent != NONE {
                    dirty.touch(nodes, parent, why & CONTENT);
                }
            }
            // The emptied list keeps its memory for the next frame.
            dirty.levels[depth] = level;
        }
        dirty.deep = 0;
    }
}
