//! What is to blame for a false cull, by evidence.
//!
//! An object owns samples of the finished frame, and a box that holds it was culled. Every sample that the
//! object owns is covered by that box's proxy and lies no nearer than it (`geom/proxy.rs`), so the box has at
//! least as many samples in sight *of the finished frame's depth*. A question is put to the depth that some
//! of the frame's draws left. That depth is nowhere nearer than what all of them leave, and that one nowhere
//! nearer than the finished frame's. Hence, with counts of one box against the three,
//!
//! ```text
//! asked then  ≥  recount, against all that was drawn  ≥  samples that the object owns  ≥  1
//! ```
//!
//! The auditor makes the recount, exactly and at full resolution, and so tells causes apart:
//!
//! 1. A sample of the object is not covered by the proxy of its *own* box, and the triangle that owns it
//!    reaches out of the box: the app's [`Bounds`](crate::scene::Bounds) are wrong.
//! 2. The policy draws a list that it was given: that list is to blame.
//! 3. The recount is within `visible_pixels`: the threshold is to blame. Above it, it cannot be: the
//!    question then would have counted no less.
//! 4. Nothing of this: a defect.
//!
//! *Limits.* That the recount is within the threshold shows that the threshold suffices to lose the object,
//! not that the question counted so few: a defect that hides behind a threshold is found when that is turned
//! to 0. The depth is that of the software rasteriser: a GPU may give a sample on a silhouette to another
//! object, and an object that owns nothing else may then be called lost although it is not.

use std::fmt;

use crate::policy::Samples;
use crate::{Tradeoff, Why};

/// What is to blame for a false cull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Blame {
    /// The dial of [`Tradeoff`] with this name.
    Dial(&'static str),
    /// The app: its box does not hold all that is drawn of the object.
    Bounds,
    /// Whoever gave the policy the list of what to draw.
    List,
    /// Nothing that was given up explains it.
    Defect,
}

/// A box that decided, asked about again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Recount {
    /// It need not be asked about: nothing of it is on a sample.
    Outside,
    /// It need not be asked about: it is visible.
    Visible,
    /// What was counted.
    Counted(Samples),
}

/// What is known about a false cull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    /// What the culler says.
    pub(super) why: Why,
    /// Whether the object is seen where its own box is not.
    pub(super) leaves_box: bool,
    /// The box that decided, at full resolution in this frame.
    pub(super) recount: Recount,
}

impl Evidence {
    /// What is to blame, by the rules above.
    pub(super) fn blame(&self, tradeoff: &Tradeoff) -> Blame {
        if self.leaves_box {
            return Blame::Bounds;
        }
        match self.why {
            Why::Given { .. } => Blame::List,
            Why::Hidden(_) | Why::Unknown { .. } if self.recount.is_within(tradeoff.visible_pixels) => {
                Blame::Dial("visible_pixels")
            }
            _ => Blame::Defect,
        }
    }
}

impl Recount {
    /// Whether a threshold above 0 culls it.
    fn is_within(self, ignored: u32) -> bool {
        matches!(self, Self::Counted(samples) if samples.visible <= ignored && ignored > 0)
    }

    /// What was counted, if it was.
    pub(super) fn samples(self) -> Option<Samples> {
        match self {
            Self::Counted(samples) => Some(samples),
            Self::Outside | Self::Visible => None,
        }
    }
}

impl Blame {
    /// The name of the dial; None if no dial is to blame.
    pub const fn dial(self) -> Option<&'static str> {
        match self {
            Self::Dial(key) => Some(key),
            Self::Bounds | Self::List | Self::Defect => None,
        }
    }
}

impl fmt::Display for Blame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dial(key) => write!(f, "To blame: the dial {key}"),
            Self::Bounds => {
                write!(f, "To blame: its Bounds do not hold all that is drawn of it; mend them, or add Slack")
            }
            Self::List => write!(f, "To blame: the list that the policy was given"),
            Self::Defect => write!(f, "A DEFECT: nothing that was given up explains it; please report it"),
        }
    }
}
