//! A policy that is told made-up times: now asking pays, now it does not.

use tercet::policy::{Action, Context, Fate, Policy};
use tercet::query::{Answer, Ticket};
use tercet::tree::{NodeId, Votes};
use tercet::{Counter, FrameCost};

pub struct Fickle<P>(pub P);

/// Twelve frames in which questions cost nothing, and twelve in which they cost much; now a device's, now not.
fn told<'a>(cx: &Context<'a>) -> Context<'a> {
    let objects = 30 + cx.frame * 7 % 20;
    let seconds = if (cx.frame / 12).is_multiple_of(2) { 1e-3 } else { 1.0 };
    let (total, ago) = (seconds * objects as f32, 1 + 2 * (cx.frame / 30 % 2));
    let last = FrameCost { total, draw: 1e-3, drawn: objects, ago };
    Context { costs: cx.costs.after(last), ..*cx }
}

impl<P: Policy> Policy for Fickle<P> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn needs_blocking(&self) -> bool {
        self.0.needs_blocking()
    }

    fn asks(&self) -> bool {
        self.0.asks()
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.0.begin(&told(cx));
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        self.0.next(&told(cx))
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        self.0.answer(&told(cx), ticket, answer);
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn vote(&mut self, votes: &mut Votes) {
        self.0.vote(votes);
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.0.fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        self.0.counters()
    }
}
