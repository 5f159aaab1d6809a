//! What is to blame for a false cull, by evidence.
//!
//! An object owns samples of the finished frame, and a box that holds it was culled. Every sample that the
//! object owns is covered by that box's proxy and is no nearer than it (`geom/proxy.rs`), so the box has at
//! least as many samples in sight *of the finished frame's depth*. A question is put to the depth that some
//! of the frame's draws left. That depth is nowhere nearer than what all of them leave, which is nowhere
//! nearer than the finished frame's. Hence, with counts of one box against the three depths,
//!
//! ```text
//! asked then  ≥  recount, against all that was drawn  ≥  samples that the object owns  ≥  1
//! ```
//!
//! at full resolution; and the first of these holds at any other, too. So the auditor draws what was drawn
//! once more and makes the recount exactly, both as the culler asked (at 1/d of the resolution, with a
//! threshold of 1/d² of `visible_pixels`) and at full resolution. A question of this frame can have culled
//! the box only if the first recount is within the threshold. Where that is 0, a policy may have asked
//! about tighter boxes than the node's own (CHC++ does), but about one that holds the object's: then that
//! one is recounted. In this order:
//!
//! 1. A sample of the object is not covered by the proxy of its *own* box, and the triangle that owns it
//!    reaches out of the box: the app's [`Bounds`](crate::scene::Bounds) are wrong.
//! 2. The policy draws a list that it was given: that list is to blame.
//! 3. It was culled by the frustum, or nothing is in sight of a box that holds an object which is: a defect.
//! 4. Recounted as asked, the box is within the threshold. If it is so at full resolution, too,
//!    `visible_pixels` is to blame, which loses the object without any other dial's help; if not,
//!    `resolution_divisor`, without which it would have been drawn. Boxes between the samples, and sweeps,
//!    have no threshold.
//! 5. It is not, but the question saw the depth of an earlier frame: `latency` is to blame, without which
//!    the object would have been drawn.
//! 6. Nothing of this: a defect.
//!
//! What was left out by its geometry ([`Action::DrawIfSeen`](crate::policy::Action::DrawIfSeen)) may have a box in
//! sight: it is no dial's fault, so rule 6 would find it, but under `latency` rule 5 comes first.
//!
//! The other dials lose nothing: those for skipping questions and the budget draw what is not asked about.
//!
//! *Limits.* A recount within the threshold shows that this dial suffices to lose the object, not that the
//! question counted so few, nor that it counted at all (one about several boxes does not): what hides
//! behind a lossy dial is found with that dial turned off. The depth of earlier frames is not kept here, so
//! under `latency` a defect is taken for lateness unless rule 3 finds it. And depth is that of the software
//! rasteriser: a GPU may give a sample on a silhouette to another object, and an object that owns nothing
//! else is then called lost although it is not.

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
    pub(super) full: Recount,
    /// What was asked about, at the resolution that it was asked at.
    pub(super) as_asked: Recount,
    /// How many times coarser that is.
    pub(super) divisor: u32,
    /// Whether the questions saw the depth of an earlier frame.
    pub(super) was_late: bool,
}

impl Evidence {
    /// What is to blame, by the rules above.
    pub(super) fn blame(&self, tradeoff: &Tradeoff) -> Blame {
        if self.leaves_box {
            return Blame::Bounds;
        }
        // The box that decided may have been asked about; or it was not, but judged in this very frame.
        let (was_asked, ignored) = match self.why {
            Why::Given { .. } => return Blame::List,
            Why::Hidden(_) | Why::Unknown { .. } => (true, tradeoff.visible_pixels),
            Why::NoSample(_) | Why::Swept { .. } => (false, 0),
            _ => return Blame::Defect,
        };
        let tradeoff = Tradeoff { visible_pixels: ignored, ..*tradeoff };
        let ignored_as_asked = tradeoff.at_resolution(self.divisor).visible_pixels;
        if self.full.is_within(0) {
            Blame::Defect
        } else if self.as_asked.is_within(ignored_as_asked) {
            let suffices = self.full.is_within(ignored);
            Blame::Dial(if suffices { "visible_pixels" } else { "resolution_divisor" })
        } else if self.was_late && was_asked {
            Blame::Dial("latency")
        } else {
            Blame::Defect
        }
    }
}

impl Recount {
    /// Whether no more than this is in sight.
    fn is_within(self, ignored: u32) -> bool {
        match self {
            Self::Outside => true,
            Self::Visible => false,
            Self::Counted(samples) => samples.visible <= ignored,
        }
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
            Self::Dial(key) => write!(f, "the dial {key}"),
            Self::Bounds => write!(f, "its Bounds, which do not hold all that is drawn of it"),
            Self::List => write!(f, "the list that the policy was given"),
            Self::Defect => write!(f, "A DEFECT (nothing that was given up explains it: please report it)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is seen of the box at full resolution and as asked.
    fn evidence(why: Why, full: u32, as_asked: u32, divisor: u32, was_late: bool) -> Evidence {
        let counted = |visible| Recount::Counted(Samples { visible, total: 100 });
        let (full, as_asked) = (counted(full), counted(as_asked));
        Evidence { why, leaves_box: false, full, as_asked, divisor, was_late }
    }

    #[test]
    fn each_dial_is_blamed_for_what_only_it_explains() {
        let (asked, swept) = (Why::Unknown { drawn: false }, Why::Swept { drawn: false });
        let ignoring = |visible_pixels| Tradeoff { visible_pixels, ..Tradeoff::EXACT };
        let dial = Blame::Dial;
        for (why, full, as_asked, divisor, was_late, ignored, blame) in [
            // Exact.
            (asked, 1, 1, 1, false, 0, Blame::Defect),
            (swept, 1, 1, 1, false, 50, Blame::Defect),
            (asked, 0, 0, 1, true, 50, Blame::Defect),
            (Why::Outside, 5, 0, 2, true, 50, Blame::Defect),
            // One dial.
            (asked, 50, 50, 1, false, 50, dial("visible_pixels")),
            (asked, 51, 51, 1, false, 50, Blame::Defect),
            (asked, 9, 0, 2, false, 0, dial("resolution_divisor")),
            (swept, 9, 0, 2, false, 0, dial("resolution_divisor")),
            (asked, 9, 1, 2, false, 0, Blame::Defect),
            (asked, 9, 9, 1, true, 0, dial("latency")),
            // Sweeps are never late.
            (swept, 9, 9, 1, true, 0, Blame::Defect),
            // Several: 50 pixels are 12 samples at half the resolution.
            (asked, 50, 12, 2, false, 50, dial("visible_pixels")),
            (asked, 51, 12, 2, false, 50, dial("resolution_divisor")),
            (asked, 51, 13, 2, true, 50, dial("latency")),
            (asked, 51, 13, 2, false, 50, Blame::Defect),
            (asked, 50, 50, 1, true, 50, dial("visible_pixels")),
        ] {
            let evidence = evidence(why, full, as_asked, divisor, was_late);
            assert_eq!(evidence.blame(&ignoring(ignored)), blame, "{evidence:?}, {ignored} ignored");
        }
    }

    #[test]
    fn a_box_between_the_coarse_samples_is_a_matter_of_resolution() {
        let mut evidence = evidence(Why::Swept { drawn: false }, 3, 0, 4, false);
        evidence.as_asked = Recount::Outside;
        assert_eq!(evidence.blame(&Tradeoff::EXACT), Blame::Dial("resolution_divisor"));
        (evidence.full, evidence.as_asked) = (Recount::Visible, Recount::Visible);
        assert_eq!(evidence.blame(&Tradeoff::EXACT), Blame::Defect);
    }

    #[test]
    fn who_gave_the_list_or_the_box_is_asked_first() {
        let tradeoff = Tradeoff { visible_pixels: 9, ..Tradeoff::EXACT };
        let given = evidence(Why::Given { drawn: false }, 1, 1, 1, false);
        assert_eq!(given.blame(&tradeoff), Blame::List);
        assert_eq!(Evidence { leaves_box: true, ..given }.blame(&tradeoff), Blame::Bounds);
        assert_eq!(Blame::List.dial().or(Blame::Bounds.dial()).or(Blame::Defect.dial()), None);
    }
}
