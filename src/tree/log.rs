//! What changed in the tree's shape, so that a view's history can follow its nodes.

use std::collections::VecDeque;

use super::node::NodeId;

/// A change of shape. Identities are those after a split, before a merge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    /// A leaf became an inner node: its history is the children's first.
    Split {
        /// The leaf that was.
        parent: NodeId,
        /// Low, high, straddle.
        children: [NodeId; 3],
    },
    /// Three leaves became one.
    Merged {
        /// The leaf that is now.
        parent: NodeId,
        /// The children that are gone.
        children: [NodeId; 3],
    },
    /// A node's content went to another index, as the root grew or shrank.
    Moved {
        /// Where it was.
        from: NodeId,
        /// Where it is.
        to: NodeId,
    },
}

/// The latest edits, numbered from the beginning. Bounded: a reader that falls behind starts its
/// history anew.
#[derive(Clone, Debug, Default)]
pub(crate) struct EditLog {
    edits: VecDeque<Edit>,
    /// The number of the first edit kept.
    start: u64,
}

impl EditLog {
    /// Edits kept. A bulk build of a large scene logs more than this at once; a new history loses
    /// nothing by it.
    const KEPT: usize = 1 << 14;

    pub(crate) fn push(&mut self, edit: Edit) {
        if self.edits.len() == Self::KEPT {
            self.edits.pop_front();
            self.start += 1;
        }
        self.edits.push_back(edit);
    }

    /// The number that the next edit will have.
    pub(crate) fn end(&self) -> u64 {
        self.start + self.edits.len() as u64
    }

    /// The edits from number `cursor` on, or None if some are no longer kept.
    pub(crate) fn since(&self, cursor: u64) -> Option<impl Iterator<Item = &Edit>> {
        let skipped = usize::try_from(cursor.checked_sub(self.start)?).ok()?;
        Some(self.edits.iter().skip(skipped))
    }
}
