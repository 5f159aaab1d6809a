//! A policy that culls by old answers, for suites to find out.

use tercet::geom::{Proxy, Question};
use tercet::policy::{Action, Context, Policy};
use tercet::query::{Answer, Ticket};
use tercet::tree::NodeId;

/// Any policy, but that what was found hidden in the last frame it was asked about is not asked about
/// again in the next one: the old answer stands.
pub struct Trusting {
    policy: Box<dyn Policy>,
    /// The nodes that a proxy of this frame may stand for.
    nodes: Vec<(Proxy, NodeId)>,
    /// What was asked, and whether it was found hidden: in this frame, and in the last one.
    asked: Vec<(Ticket, NodeId)>,
    hidden: Vec<NodeId>,
    hidden_before: Vec<NodeId>,
}

impl Trusting {
    pub fn new(policy: Box<dyn Policy>) -> Self {
        Self { policy, nodes: vec![], asked: vec![], hidden: vec![], hidden_before: vec![] }
    }
}

impl Policy for Trusting {
    fn name(&self) -> &'static str {
        "trusting"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.nodes.clear();
        for node in cx.tree.nodes().filter(|node| node.below > 0) {
            if let Question::Ask(proxy) = Question::new(&cx.tree.query_box(node.id), cx.view) {
                self.nodes.push((proxy, node.id));
            }
        }
        self.hidden_before = std::mem::take(&mut self.hidden);
        self.asked.clear();
        self.policy.begin(cx);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        loop {
            let trusted = match self.policy.next(cx) {
                Action::Ask { ticket, boxes: [proxy], want } => {
                    let node = self.nodes.iter().find(|(p, _)| p == proxy).map(|(_, node)| *node);
                    self.asked.extend(node.map(|node| (ticket, node)));
                    if !node.is_some_and(|node| self.hidden_before.contains(&node)) {
                        let boxes = self.nodes.iter().find(|(p, _)| p == proxy).map(|(p, _)| p);
                        let boxes = std::slice::from_ref(boxes.expect("each question is about a node"));
                        return Action::Ask { ticket, boxes, want };
                    }
                    ticket
                }
                Action::Draw(node, extent) => return Action::Draw(node, extent),
                Action::Wait(wait) => return Action::Wait(wait),
                Action::Done => return Action::Done,
                Action::Ask { .. }
                | Action::DrawObjects(_)
                | Action::DrawIfSeen { .. }
                | Action::Sweep { .. } => panic!("one box a question, please"),
            };
            self.policy.answer(cx, trusted, Answer::Any(false));
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        if !answer.is_visible(0) {
            let node = self.asked.iter().find(|(asked, _)| *asked == ticket).map(|(_, node)| *node);
            self.hidden.extend(node);
        }
        self.policy.answer(cx, ticket, answer);
    }
}
