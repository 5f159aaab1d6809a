//! Hierarchical stop-and-wait: each node is asked about, nearest first, and its answer awaited
//! before anything else happens. Slow, and a reference: no policy that asks about the same boxes
//! of the same hierarchy, front to back, knows more when it decides.

use super::front::{Front, FrontQueue};
use super::{Action, Answer, Context, Extent, Fate, History, Policy, Ticket};
use crate::geom::{PlaneMask, Proxy, Question};
use crate::query::{Wait, Want};
use crate::tree::NodeId;

/// See the module's documentation.
#[derive(Clone, Debug, Default)]
pub struct StopAndWait {
    /// Decides nothing: for [`Policy::fate`] alone.
    history: History,
    front: FrontQueue,
    /// The node in question, with its proxy.
    asked: Option<(Front, Proxy)>,
    /// Whether its answer is still to be waited for.
    waiting: bool,
    /// A visible node whose own objects are to be drawn.
    draw: Option<NodeId>,
}

impl Policy for StopAndWait {
    fn name(&self) -> &'static str {
        "stop-and-wait"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.history.follow(cx.tree);
        self.front.clear();
        (self.asked, self.waiting, self.draw) = (None, false, None);
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if std::mem::take(&mut self.waiting) {
            return Action::Wait(Wait::Block);
        }
        loop {
            if let Some(node) = self.draw.take() {
                return Action::Draw(node, Extent::Own);
            }
            let Some(front) = self.front.pop() else { return Action::Done };
            match cx.question(front.node) {
                Question::Outside => {}
                Question::Visible => self.found_visible(cx, front),
                Question::Ask(proxy) => {
                    let (_, proxy) = self.asked.insert((front, proxy));
                    self.waiting = true;
                    let boxes = std::slice::from_ref(proxy);
                    return Action::Ask { ticket: Ticket(0), boxes, want: Want::Any };
                }
            }
        }
    }

    fn answer(&mut self, cx: &Context<'_>, _ticket: Ticket, answer: Answer<'_>) {
        let Some((front, _)) = self.asked.take() else { return };
        if answer.is_visible(cx.tradeoff.visible_pixels) {
            self.found_visible(cx, front);
        } else {
            self.history.found_hidden(front.node, cx.frame);
        }
    }

    fn reset(&mut self) {
        self.history.clear();
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.history.fate(cx, node)
    }
}

impl StopAndWait {
    fn found_visible(&mut self, cx: &Context<'_>, front: Front) {
        let state = self.history.entry(front.node);
        (state.frame, state.asked_at, state.visible, state.streak) = (cx.frame, cx.frame, true, 1);
        if cx.tree.own_count(front.node) > 0 {
            self.draw = Some(front.node);
        }
        for child in cx.tree.children(front.node).into_iter().flatten() {
            self.front.push(cx, child, front.mask);
        }
    }
}
