//! What became of a node in the last frame, for whoever wants to show it.
//!
//! Nothing is kept for this: a policy reads it off its own [`History`] when it is asked
//! ([`Policy::fate`](super::Policy::fate)).

use std::fmt;

use super::{Context, History};
use crate::geom::Question;
use crate::tree::{Edit, NodeId, Tree};

/// What became of a node in the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The policy does not say, or the node came or was merged after the frame.
    Unknown,
    /// Drawn by a policy that asks nothing.
    Unasked,
    /// The policy draws the objects that it was given and looks at no node.
    Given,
    /// Its objects were swept, one by one or in groups.
    Swept,
    /// Outside the frustum, or so small on the screen that it lies between the samples.
    Outside,
    /// Not looked at, because a node above it was not visible.
    NotReached,
    /// Asked about, and no sample of its box was visible.
    Hidden,
    /// Asked about, and something of its box was visible, or the answer was lost.
    Visible {
        /// How much, where the policy asked for counts and kept them.
        samples: Option<Samples>,
    },
    /// Taken as visible without asking, since it was visible, or is new.
    Remembered {
        /// In how many frames it is asked about again, at the latest; 1 is the next one. None if
        /// the policy did not set a term.
        within: Option<u32>,
    },
    /// Taken as visible without asking: its box crosses the near plane, or holds the eye, or is too
    /// near for its projection to be certain.
    Near,
}

/// A count of the samples of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Those that passed the depth test.
    pub visible: u32,
    /// Those that the box covers.
    pub total: u32,
}

impl Fate {
    /// Whether a question about the node was asked in the last frame.
    pub const fn was_asked(self) -> bool {
        matches!(self, Self::Hidden | Self::Visible { .. })
    }
}

impl fmt::Display for Fate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => write!(f, "not known"),
            Self::Unasked => write!(f, "drawn: nothing is asked"),
            Self::Given => write!(f, "drawn object by object"),
            Self::Swept => write!(f, "swept object by object"),
            Self::Outside => write!(f, "outside the view"),
            Self::NotReached => write!(f, "below a node that was not visible"),
            Self::Hidden => write!(f, "asked: hidden"),
            Self::Visible { samples: None } => write!(f, "asked: visible"),
            Self::Visible { samples: Some(samples) } => write!(f, "asked: {samples}"),
            Self::Remembered { within: None } => write!(f, "taken as visible"),
            Self::Remembered { within: Some(1) } => write!(f, "taken as visible, for this frame"),
            Self::Remembered { within: Some(n) } => write!(f, "taken as visible, for at most {n} frames"),
            Self::Near => write!(f, "at the near plane"),
        }
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} samples visible", self.visible, self.total)
    }
}

impl History {
    /// What became of a node in the frame of `cx`, for a policy that writes each node it looks at
    /// here, and each answer with [`NodeState::asked_at`](super::NodeState::asked_at). O(1), and
    /// O(edits) after the tree has changed its shape.
    pub fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        let state = self.get(node);
        let question = || cx.question(node);
        if state.frame != cx.frame {
            let outside = !cx.frustum.intersects(&cx.tree.bounds(node)) || question() == Question::Outside;
            if outside { Fate::Outside } else { Fate::NotReached }
        } else if self.was_merged_since(cx.tree, node) {
            // The memory is that of the inner node that it was, which says little of the leaf.
            Fate::Unknown
        } else if state.asked_at != cx.frame {
            let left = state.skip_until.checked_sub(cx.frame);
            Fate::Remembered { within: left.map(|frames| frames.saturating_add(1)) }
        } else if state.streak == 0 {
            // Not `!state.visible`: an open node below which nothing was visible is that, too.
            Fate::Hidden
        } else if question() == Question::Visible {
            Fate::Near
        } else {
            Fate::Visible { samples: None }
        }
    }

    /// Whether a node has become a leaf since the history followed the tree.
    fn was_merged_since(&self, tree: &Tree, node: NodeId) -> bool {
        let is_merge = |edit: &Edit| matches!(edit, Edit::Merged { parent, .. } if *parent == node);
        tree.is_leaf(node) && tree.log().since(self.cursor()).is_none_or(|mut edits| edits.any(is_merge))
    }
}
