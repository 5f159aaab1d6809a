//! What each node was found to be, in this frame and in the last one.
//!
//! Unlike a [`History`](crate::policy::History), these records are not handed on by splits and
//! merges: a node without a record of the last frame is asked about, which is always right.

use crate::tree::NodeId;

/// What an answer says of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) enum Class {
    /// Every sample of its box passes the depth test.
    Visible,
    /// Some do, or nobody knows.
    #[default]
    Partial,
    /// None does.
    Invisible,
}

/// What a node was found to be in one frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    pub(super) class: Class,
    /// Whether its children were looked at.
    pub(super) opened: bool,
    /// Whether a question about itself was answered, or was not needed.
    pub(super) asked: bool,
    /// Whether its class came from its neighbours.
    pub(super) propagated: bool,
    /// For an invisible node whose whole cell is known to be hidden: how far samples of geometry
    /// may lie from where they ought to, at most, for that to hold.
    pub(super) hidden_within: Option<[f64; 3]>,
}

/// Records by node index.
#[derive(Clone, Debug, Default)]
pub(super) struct Records(Vec<Stamped>);

/// A record, and whose it is, of which frame.
#[derive(Clone, Copy, Debug, Default)]
struct Stamped {
    identity: u32,
    frame: u32,
    record: Record,
}

impl Records {
    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Makes room for nodes with indices below `bound`.
    pub(super) fn reserve(&mut self, bound: usize) {
        self.0.resize(bound.max(self.0.len()), Stamped::default());
    }

    /// The record of a node, if there is one of that frame.
    pub(super) fn of(&self, node: NodeId, frame: u32) -> Option<&Record> {
        let stamped = self.0.get(node.index())?;
        (stamped.identity == node.identity() && stamped.frame == frame).then_some(&stamped.record)
    }

    /// Writes the record of a node in a frame.
    pub(super) fn note(&mut self, node: NodeId, frame: u32, record: Record) {
        self.0[node.index()] = Stamped { identity: node.identity(), frame, record };
    }
}
