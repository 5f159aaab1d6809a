//! Nodes on the way, nearest first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Context;
use crate::geom::PlaneMask;
use crate::tree::NodeId;

/// A node on the way, with how far in front of the viewer it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Front {
    distance: f32,
    pub(super) node: NodeId,
    /// The planes that its parent crosses.
    pub(super) mask: PlaneMask,
}

/// A priority queue of nodes: the nearest comes first, ties by index, for determinism.
#[derive(Clone, Debug, Default)]
pub(super) struct FrontQueue(BinaryHeap<Front>);

impl FrontQueue {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Puts a node on the way, unless it is empty or outside the frustum. O(log n).
    pub(super) fn push(&mut self, cx: &Context<'_>, node: NodeId, mask: PlaneMask) {
        if cx.tree.count(node) == 0 {
            return;
        }
        if let Some(mask) = cx.frustum.classify(&cx.tree.bounds(node), mask) {
            let distance = cx.tree.distance(node, cx.view.eye());
            self.0.push(Front { distance, node, mask });
        }
    }

    /// The nearest node.
    pub(super) fn peek(&self) -> Option<&Front> {
        self.0.peek()
    }

    /// Takes the nearest node. O(log n).
    pub(super) fn pop(&mut self) -> Option<Front> {
        self.0.pop()
    }
}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = other.distance.total_cmp(&self.distance);
        by_distance.then_with(|| other.node.index().cmp(&self.node.index()))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Front {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Front {}
