//! Which box a question is about: the cell, or the tight box of what is in it.

use super::Tree;
use super::config::TightBoxes;
use super::node::NodeId;
use crate::geom::Aabb;

impl Tree {
    /// Whether nothing in or below a node has moved or entered for `settle_frames` updates.
    pub fn is_settled(&self, node: NodeId) -> bool {
        self.tick.wrapping_sub(self.nodes.moved_at[node.index()]) >= self.config.settle_frames
    }

    /// Whether something in or below a node has moved or entered in the last so many updates.
    pub(crate) fn has_moved_within(&self, node: NodeId, updates: u32) -> bool {
        self.tick.wrapping_sub(self.nodes.moved_at[node.index()]) < updates
    }

    /// The box that a question about a node asks: it holds every object in the node and below.
    pub fn query_box(&self, node: NodeId) -> Aabb {
        let n = node.index();
        // A straddle child's cell is its parent's, and so is the cell of what it is split into,
        // but for the axes of those splits: their own box is the published choice.
        let tight = self.nodes.is_straddle(node.index)
            || match self.config.tight_boxes {
                TightBoxes::Never => false,
                TightBoxes::Settled => self.is_settled(node),
                TightBoxes::Always => true,
            };
        if tight { self.nodes.bounds[n] } else { self.nodes.cell[n] }
    }
}
