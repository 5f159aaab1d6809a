//! No culling (*NOC*): everything is drawn, inside the frustum or not.

use super::{Action, Answer, Context, Extent, Fate, Policy, Ticket};
use crate::tree::NodeId;

/// Draws every object: what culling is measured against.
#[derive(Clone, Debug, Default)]
pub struct DrawAll {
    done: bool,
}

impl Policy for DrawAll {
    fn name(&self) -> &'static str {
        "none"
    }

    fn asks(&self) -> bool {
        false
    }

    fn begin(&mut self, _cx: &Context<'_>) {
        self.done = false;
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if std::mem::replace(&mut self.done, true) {
            Action::Done
        } else {
            Action::Draw(cx.tree.root(), Extent::Everything)
        }
    }

    fn answer(&mut self, _cx: &Context<'_>, _ticket: Ticket, _answer: Answer<'_>) {}

    fn fate(&self, _cx: &Context<'_>, _node: NodeId) -> Fate {
        Fate::Unasked
    }
}
