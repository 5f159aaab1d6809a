//! References: a set of objects found beforehand is drawn, and nothing is asked.

use super::{Action, Answer, Context, Fate, Policy, Ticket};
use crate::scene::ObjectId;
use crate::tree::NodeId;

/// What a reference policy must be given before each frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recording {
    /// The exact visible set, as an oracle finds it: *REF*, the bound that nobody beats.
    ExactSet,
    /// What stop-and-wait on the same hierarchy draws: *OPT* of the CHC papers, the bound for
    /// whoever asks about the boxes of that hierarchy.
    StopAndWait,
}

/// Draws exactly the objects that it was given ([`Policy::give_recorded`]).
#[derive(Clone, Debug)]
pub struct Recorded {
    recording: Recording,
    visible: Vec<ObjectId>,
    done: bool,
}

impl Recorded {
    /// A reference that draws what was recorded in the given way.
    pub fn new(recording: Recording) -> Self {
        Self { recording, visible: Vec::new(), done: true }
    }
}

impl Policy for Recorded {
    fn name(&self) -> &'static str {
        match self.recording {
            Recording::ExactSet => "exact",
            Recording::StopAndWait => "opt",
        }
    }

    fn begin(&mut self, _cx: &Context<'_>) {
        self.done = false;
    }

    fn next(&mut self, _cx: &Context<'_>) -> Action<'_> {
        if std::mem::replace(&mut self.done, true) {
            Action::Done
        } else {
            Action::DrawObjects(&self.visible)
        }
    }

    fn answer(&mut self, _cx: &Context<'_>, _ticket: Ticket, _answer: Answer<'_>) {}

    fn fate(&self, _cx: &Context<'_>, _node: NodeId) -> Fate {
        Fate::Given
    }

    fn wants_recorded(&self) -> Option<Recording> {
        Some(self.recording)
    }

    fn give_recorded(&mut self, visible: &[ObjectId]) {
        self.visible.clear();
        self.visible.extend_from_slice(visible);
    }
}
