//! What the threads of a sweep share: what it looks at, the depth, and the flags of what is found.

use std::sync::atomic::{AtomicU64, Ordering};

use super::super::count::Scene;
use super::super::level::SimdLevel;
use crate::geom::{Aabb, PlaneMask, Proxy, Question};
use crate::query::Sweep;
use crate::scene::ObjectSet;
use crate::tree::{NodeId, Tree};

/// A sweep under way.
pub(super) struct Field<'a> {
    pub(super) sweep: &'a Sweep<'a>,
    pub(super) tree: &'a Tree,
    pub(super) simd: SimdLevel,
    pub(super) scene: Scene<'a>,
    /// They are not looked for below groups.
    pub(super) loose: &'a ObjectSet,
    /// What was found, a bit a slot.
    pub(super) flags: &'a [AtomicU64],
}

/// What was counted. Sums do not depend on who did what.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    /// Boxes of nodes that were tested.
    pub(super) nodes: u64,
    /// Rays that went down a subtree.
    pub(super) rays: u64,
    /// Objects that were tested.
    pub(super) tested: u64,
}

impl Tally {
    pub(super) fn add_up(self, other: Self) -> Self {
        Self {
            nodes: self.nodes + other.nodes,
            rays: self.rays + other.rays,
            tested: self.tested + other.tested,
        }
    }
}

impl Field<'_> {
    /// Notes that an object was found.
    pub(super) fn flag(&self, slot: u32) {
        self.flags[slot as usize / 64].fetch_or(1 << (slot % 64), Ordering::Relaxed);
    }

    /// Whether a box passes: by its proxy, if it has one.
    pub(super) fn passes(&self, bounds: &Aabb, by: impl FnOnce(&Proxy) -> bool) -> bool {
        match Question::new(bounds, self.sweep.view) {
            Question::Outside => false,
            Question::Visible => true,
            Question::Ask(proxy) => !super::is_usable(&proxy) || by(&proxy),
        }
    }

    /// Each own object of a node that meets the frustum, unless it is loose. `mask` has the planes that
    /// the node crosses.
    pub(super) fn each_own(&self, node: NodeId, mask: PlaneMask, mut found: impl FnMut(u32, &Aabb)) {
        for (block, lane) in self.tree.own_inside(node, self.sweep.frustum, mask) {
            let slot = block.slots[lane];
            if !self.is_loose(slot) {
                found(slot, &block.aabb(lane));
            }
        }
    }

    /// The children of a node that hold something and meet the frustum, with the planes they cross.
    pub(super) fn children(
        &self,
        node: NodeId,
        mask: PlaneMask,
    ) -> impl Iterator<Item = (NodeId, PlaneMask)> + use<'_> {
        let children = self.tree.children(node).into_iter().flatten();
        children.filter_map(move |child| self.enter(child, mask))
    }

    /// A node with the planes that it crosses, unless it is empty or outside.
    pub(super) fn enter(&self, node: NodeId, mask: PlaneMask) -> Option<(NodeId, PlaneMask)> {
        let holds = self.tree.count(node) > 0;
        let mask = holds.then(|| self.sweep.frustum.classify(&self.tree.bounds(node), mask)).flatten()?;
        Some((node, mask))
    }

    fn is_loose(&self, slot: u32) -> bool {
        let word = self.loose.words().get(slot as usize / 64);
        word.is_some_and(|word| word & (1 << (slot % 64)) != 0)
    }
}
