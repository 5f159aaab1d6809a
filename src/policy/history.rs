//! What a view remembers of nodes, and how memories follow the tree as it splits and merges.

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

    /// Follows the tree's changes of shape since the last call: split nodes hand their memories
    /// to their children, merged ones leave theirs to the parent (visible if any of them was).
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

    /// The memory of a node, to write.
    pub fn entry(&mut self, node: NodeId) -> &mut NodeState {
        let state = &mut self.states[node.index()];
        if state.identity != node.identity() {
            *state = NodeState { identity: node.identity(), ..NodeState::default() };
        }
        state
    }

    fn apply(states: &mut [NodeState], edit: &Edit) {
        match *edit {
            Edit::Split { parent, children } => {
                let memory = recall(states, parent);
                for child in children {
                    states[child.index()] = NodeState { identity: child.identity(), ..memory };
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
