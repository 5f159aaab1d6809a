//! The exact visible set (*REF*): the bound that no policy beats.

use super::{Action, Answer, Context, Policy, Ticket};
use crate::scene::ObjectId;

/// Draws exactly the objects that it was told are visible, as an oracle found them, and asks
/// nothing. Before each frame it is given the set ([`Policy::give_exact`]).
#[derive(Clone, Debug, Default)]
pub struct Exact {
    visible: Vec<ObjectId>,
    done: bool,
}

impl Policy for Exact {
    fn name(&self) -> &'static str {
        "exact"
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

    fn give_exact(&mut self, visible: &[ObjectId]) {
        self.visible.clear();
        self.visible.extend_from_slice(visible);
    }

    fn wants_exact(&self) -> bool {
        true
    }
}
