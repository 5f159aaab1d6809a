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

/// The latest edits, numbered from the beginning. Bounded in number and age, so that a world that
/// goes to and fro needs no more memory in time: a reader that falls behind starts its history anew.
#[derive(Clone, Debug, Default)]
pub(crate) struct EditLog {
    edits: VecDeque<Edit>,
    /// The number of the first edit kept.
    start: u64,
    /// The number that the next edit had at the last forgetting.
    old: u64,
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

    /// Edits are kept for as many updates at least, and for twice as many at most.
    const AGE: u32 = 1024;

    /// Forgets edits that are too old, every now and then.
    pub(crate) fn forget(&mut self, tick: u32) {
        if tick.is_multiple_of(Self::AGE) {
            let gone = self.old.saturating_sub(self.start);
            self.edits.drain(..gone as usize);
            self.start += gone;
            self.old = self.end();
        }
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
