//! What a view remembers of nodes, and how memories follow the tree as it splits and merges.

use super::skip::Share;
use crate::tree::{Edit, NodeId, Tree};

/// What one view remembers of one node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeState {
    /// Whose memory this is: of another identity, it is none.
    identity: u32,
    /// The frame in which the node was last classified; 0 for never.
    pub frame: u32,
    /// Whether it was visible then.
    pub visible: bool,
    /// Consecutive answers that found it visible.
    pub streak: u32,
    /// The frame of the last answer, or of the last time that the near plane answered; 0 for never.
    pub asked_at: u32,
    /// What the last answer that found it visible said.
    pub share: Share,
    /// The last frame for which it is taken as visible without asking.
    pub skip_until: u32,
}

/// One view's memories, by node index.
#[derive(Clone, Debug, Default)]
pub struct History {
    states: Vec<NodeState>,
    /// The number of the next edit of the tree to follow.
    cursor: u64,
}

impl History {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.states.clear();
    }

    /// Follows the tree's changes of shape since the last call: split nodes tell their children
    /// whether they were visible, merged ones leave their memories to the parent (visible if any of
    /// them was).
    /// O(edits); a view that has fallen too far behind forgets.
    pub fn follow(&mut self, tree: &Tree) {
        let log = tree.log();
        match log.since(self.cursor) {
            None => self.states.clear(),
            Some(edits) => {
                self.states.resize(tree.index_bound().max(self.states.len()), NodeState::default());
                for edit in edits {
                    Self::apply(&mut self.states, edit);
                }
            }
        }
        self.states.resize(tree.index_bound(), NodeState::default());
        self.cursor = log.end();
    }

    /// What is remembered of a node; nothing for one that is new.
    pub fn get(&self, node: NodeId) -> NodeState {
        recall(&self.states, node)
    }

    /// Remembers that an answer of this frame found a node hidden.
    pub fn found_hidden(&mut self, node: NodeId, frame: u32) {
        let state = self.entry(node);
        (state.frame, state.asked_at, state.visible, state.streak) = (frame, frame, false, 0);
    }

    /// The memory of a node, to write.
    pub fn entry(&mut self, node: NodeId) -> &mut NodeState {
        let state = &mut self.states[node.index()];
        if state.identity != node.identity() {
            *state = NodeState { identity: node.identity(), ..NodeState::default() };
        }
        state
    }

    /// The number of the first edit that has not been followed.
    pub(super) fn cursor(&self) -> u64 {
        self.cursor
    }

    fn apply(states: &mut [NodeState], edit: &Edit) {
        match *edit {
            Edit::Split { parent, children } => {
                // Nobody has asked about the children themselves.
                let NodeState { frame, visible, .. } = recall(states, parent);
                for child in children {
                    let identity = child.identity();
                    states[child.index()] = NodeState { identity, frame, visible, ..NodeState::default() };
                }
            }
            Edit::Merged { parent, children } => {
                let memories = children.map(|c| recall(states, c));
                let visible = memories.iter().find(|m| m.visible);
                let latest = memories.iter().max_by_key(|m| m.frame);
                let memory = visible.or(latest).copied().unwrap_or_default();
                states[parent.index()] = NodeState { identity: parent.identity(), ..memory };
            }
            Edit::Moved { from, to } => {
                let memory = recall(states, from);
                states[to.index()] = NodeState { identity: to.identity(), ..memory };
            }
        }
    }
}

fn recall(states: &[NodeState], node: NodeId) -> NodeState {
    let known = states.get(node.index()).filter(|s| s.identity == node.identity());
    known.copied().unwrap_or(NodeState { identity: node.identity(), ..NodeState::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::tree::{Straddlers, TreeConfig, Votes};
    use glam::Vec3;

    fn votes(tree: &Tree, visible: u32) -> Votes {
        let leaves = tree.nodes().filter(|n| n.is_leaf).map(|n| n.id);
        let mut votes = Votes { forward: Vec3::X, ..Votes::default() };
        leaves.for_each(|leaf| votes.count(leaf, visible, 100));
        votes
    }

    fn row(config: TreeConfig) -> Tree {
        let mut tree = Tree::new(config);
        for i in 0..4 {
            let center = Vec3::new(10.0 * i as f32, 0.0, 0.0);
            tree.insert(i, &Aabb::from_center(center, Vec3::ONE));
        }
        tree.update();
        tree
    }

    #[test]
    fn memories_go_down_with_a_split_and_up_with_a_merge() {
        let config = TreeConfig {
            o_split: 4,
            bulk_leaf: 8,
            o_merge: 8,
            cooldown: 0,
            merge_below_split: false,
            straddlers: Straddlers::Leaf,
            ..TreeConfig::stable()
        };
        let mut tree = row(config);
        let mut history = History::default();
        history.follow(&tree);
        let root = tree.root();
        *history.entry(root) = NodeState { frame: 7, visible: true, streak: 3, ..history.get(root) };

        tree.adapt([&votes(&tree, 100)].into_iter());
        history.follow(&tree);
        let children = tree.children(root).expect("a split root");
        for child in children {
            let state = history.get(child);
            assert_eq!(
                (state.frame, state.visible, state.streak),
                (7, true, 0),
                "nobody asked about the child"
            );
        }
        // One child goes on being visible, the others are found hidden; then all merge.
        for child in children {
            history.entry(child).visible = child == children[1];
        }
        tree.update();
        tree.adapt([&votes(&tree, 0)].into_iter());
        assert!(tree.is_leaf(root));
        history.follow(&tree);
        assert!(history.get(root).visible, "visible if one of the three was");
        let again = tree.root();
        assert_eq!(again, root, "the root has kept its identity");
    }

    #[test]
    fn a_grown_root_leaves_its_memory_to_the_half_that_it_became() {
        let mut tree = row(TreeConfig { bulk_leaf: 1, unasked_leaf: 1, ..TreeConfig::stable() });
        let mut history = History::default();
        tree.update();
        history.follow(&tree);
        let old = tree.root();
        history.entry(old).frame = 9;
        tree.insert(99, &Aabb::from_center(Vec3::X * 1e4, Vec3::ONE));
        tree.update();
        history.follow(&tree);
        assert_eq!(history.get(tree.root()).frame, 0, "the root is new");
        let heirs = tree.nodes().filter(|n| history.get(n.id).frame == 9).count();
        assert_eq!(heirs, 1);
    }

    #[test]
    fn a_view_that_fell_behind_forgets() {
        let mut tree = row(TreeConfig { bulk_leaf: 1, unasked_leaf: 1, ..TreeConfig::stable() });
        let mut history = History::default();
        history.follow(&tree);
        history.entry(tree.root()).frame = 5;
        for round in 0..10_000u32 {
            let far = Vec3::new(1e5 * (round % 2) as f32, 0.0, 0.0);
            tree.insert(1000, &Aabb::from_center(far, Vec3::ONE));
            tree.update();
            tree.remove(1000);
            tree.update();
        }
        history.follow(&tree);
        assert_eq!(history.get(tree.root()).frame, 0);
    }
}
