//! View-frustum culling (*VFC*): what does not meet the frustum is not drawn, and nothing is
//! asked.

use super::{Action, Answer, Context, Extent, Fate, Policy, Ticket};
use crate::tree::NodeId;

/// Draws every object whose box meets the view frustum. The driver walks the tree with plane
/// masks inherited down, so this is the whole of it.
#[derive(Clone, Debug, Default)]
pub struct FrustumOnly {
    done: bool,
}

impl Policy for FrustumOnly {
    fn name(&self) -> &'static str {
        "frustum"
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
            Action::Draw(cx.tree.root(), Extent::Subtree)
        }
    }

    fn answer(&mut self, _cx: &Context<'_>, _ticket: Ticket, _answer: Answer<'_>) {}

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        if cx.frustum.intersects(&cx.tree.bounds(node)) { Fate::Unasked } else { Fate::Outside }
    }
}
