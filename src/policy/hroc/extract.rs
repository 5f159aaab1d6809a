//! Extraction of occludee groups (HROC, stage 2): bottom-up from the occluders.
//!
//! Each occluder marks its node and the nodes above it visible, and what hangs off that way unknown: the
//! siblings, two of each node; the children, where an inner node holds the occluder itself. The nodes
//! that are unknown in the end are the groups: the largest subtrees without an occluder. Without any
//! occluder the root is the only group.
//!
//! The printed algorithm overwrites a sibling that is visible already, and drops the other objects of an
//! occluder's leaf. Here a visible node stays visible, and visible nodes are handed over, for their own
//! objects to be asked about.

use crate::tree::{NodeId, Tree};

/// What the occluders of a frame leave to be asked about.
#[derive(Clone, Debug, Default)]
pub(in crate::policy) struct Extraction {
    /// By node index: a mark of this round, or an older one.
    marks: Vec<u32>,
    /// The mark of this round for unknown nodes; the next number is that for visible ones.
    unknown: u32,
    groups: Vec<NodeId>,
    visible: Vec<NodeId>,
}

impl Extraction {
    /// Starts a round.
    pub(in crate::policy) fn begin(&mut self, tree: &Tree) {
        self.groups.clear();
        self.visible.clear();
        self.marks.resize(tree.index_bound(), 0);
        if self.unknown >= u32::MAX - 2 {
            self.marks.fill(0);
            self.unknown = 0;
        }
        self.unknown += 2;
    }

    /// Takes over an occluder, by its node. O(depth), O(1) for nodes that were visited before.
    pub(in crate::policy) fn add_occluder(&mut self, tree: &Tree, node: NodeId) {
        let mut node = node;
        loop {
            let mark = std::mem::replace(&mut self.marks[node.index()], self.unknown + 1);
            if mark == self.unknown + 1 {
                return; // and so are those above it, with their children marked
            }
            self.visible.push(node);
            for child in tree.children(node).into_iter().flatten() {
                let mark = &mut self.marks[child.index()];
                if *mark < self.unknown {
                    *mark = self.unknown;
                    self.groups.push(child);
                }
            }
            let Some(parent) = tree.parent(node) else { return };
            node = parent;
        }
    }

    /// The nodes at or below which there are occluders.
    pub(in crate::policy) fn visible(&self) -> &[NodeId] {
        &self.visible
    }

    /// The groups: at or below none of them is an occluder, and no group lies below another.
    pub(in crate::policy) fn groups(&mut self, tree: &Tree) -> &[NodeId] {
        let (marks, unknown) = (&self.marks, self.unknown);
        self.groups.retain(|group| marks[group.index()] == unknown);
        if self.visible.is_empty() {
            self.groups.push(tree.root());
        }
        &self.groups
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::Vec3;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::geom::Aabb;
    use crate::tree::{Straddlers, TreeConfig};

    fn tree(dice: &mut ChaCha8Rng, straddlers: Straddlers, count: u32) -> Tree {
        let config = TreeConfig { bulk_leaf: 4, unasked_leaf: 4, straddlers, ..TreeConfig::stable() };
        let mut tree = Tree::new(config);
        for slot in 0..count {
            let mut v = |r: f32| Vec3::from_array(std::array::from_fn(|_| dice.random_range(-r..r)));
            let (center, half) = (v(50.0), v(4.0).abs());
            tree.insert(slot, &Aabb::from_center(center, half));
        }
        tree.update();
        tree
    }

    /// By the definition: visible is what holds an occluder; groups are what does not, just below it.
    fn naive(tree: &Tree, occluders: &[NodeId]) -> (BTreeSet<usize>, BTreeSet<usize>) {
        let up = |&node: &NodeId| std::iter::successors(Some(node), |&node| tree.parent(node));
        let visible: BTreeSet<usize> = occluders.iter().flat_map(up).map(NodeId::index).collect();
        let is_group = |node: &NodeId| {
            let above = tree.parent(*node).map(NodeId::index);
            !visible.contains(&node.index()) && above.is_none_or(|above| visible.contains(&above))
        };
        let groups = tree.nodes().map(|node| node.id).filter(is_group).map(NodeId::index).collect();
        (visible, groups)
    }

    #[test]
    fn groups_are_the_largest_subtrees_without_an_occluder() {
        let mut dice = ChaCha8Rng::seed_from_u64(11);
        let mut extraction = Extraction::default();
        let mut most = 0;
        for round in 0..300 {
            let straddlers = if round % 2 == 0 { Straddlers::Leaf } else { Straddlers::StayInParent };
            let tree = tree(&mut dice, straddlers, 200);
            let count = dice.random_range(0..[1, 2, 3, 40][round % 4]);
            let nodes = (0..count).map(|_| tree.node_of(dice.random_range(0..200)).expect("a node"));
            let occluders: Vec<NodeId> = nodes.collect();
            extraction.begin(&tree);
            occluders.iter().for_each(|&node| extraction.add_occluder(&tree, node));
            let indices = |nodes: &[NodeId]| nodes.iter().map(|node| node.index()).collect::<Vec<_>>();
            let groups = indices(extraction.groups(&tree));
            let visible = indices(extraction.visible());
            let found = (BTreeSet::from_iter(visible.clone()), BTreeSet::from_iter(groups.clone()));
            assert_eq!(found, naive(&tree, &occluders), "round {round}");
            assert_eq!((found.0.len(), found.1.len()), (visible.len(), groups.len()), "each once");
            most = most.max(groups.len());
        }
        assert!(most > 20, "{most} groups at most");
    }
}
