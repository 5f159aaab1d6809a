//! *CHC*, coherent hierarchical culling: Bittner, Wimmer, Piringer & Purgathofer, *Coherent
//! Hierarchical Culling: Hardware Occlusion Queries Made Useful* (2004).
//!
//! Nodes are visited front to back. What was visible in the last frame needs no answer to be drawn:
//! a leaf is drawn at once, and asked about for the next frame; an inner node is opened without a
//! question. What was hidden is asked about, and its answer awaited in this frame, while the walk
//! goes on elsewhere. Answers pull visibility up ([`Coherence`]).
//!
//! *Assumed visible.* A leaf that was found visible goes unasked for `n_av` frames, and is asked
//! about in the frame after those.
//!
//! Conservative whatever the history: nothing is culled but by an answer of this very frame, for a
//! node that was hidden is asked about in every frame. A leaf that was visible is drawn whatever its
//! answer says; that only decides how the next frame begins.
//!
//! *Votes.* It asks whether something is visible, not how much
//! ([`Want::Any`](crate::query::Want::Any)): its answers say nothing on the tree's shape. The tree is as fine
//! as it is built, since somebody asks.
//!
//! # Where we differ
//!
//! - The paper looks for an answer before each node that it visits; this looks when `in_flight`
//!   questions have gone out since the last look. On a device a look is a submission.
//! - A node at the near plane cannot be asked about: it is visible.
//! - A threshold of visible samples ([`Tradeoff`](crate::Tradeoff)) makes questions count
//!   ([`Want::Dual`](crate::query::Want::Dual)).

use super::coherence::{Coherence, Look, Terms};
use super::front::Front;
use super::in_flight::{Asked, IN_FLIGHT, InFlight, Turn};
use super::{Action, Answer, Context, Fate, Policy, Ticket};
use crate::dial::{self, Dial};
use crate::geom::Question;
use crate::tree::NodeId;
use crate::{Counter, Error};

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct Chc {
    /// Frames for which a leaf that was found visible goes unasked.
    pub n_av: u32,
    /// Questions that go out before answers are looked for; 0 counts as 1.
    pub in_flight: u32,
    coherence: Coherence,
    /// Nothing need be noted of them.
    questions: InFlight<()>,
}

impl Default for Chc {
    fn default() -> Self {
        Self {
            n_av: 10,
            in_flight: IN_FLIGHT,
            coherence: Coherence::default(),
            questions: InFlight::default(),
        }
    }
}

impl Policy for Chc {
    fn name(&self) -> &'static str {
        "chc"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.coherence.begin(cx);
        self.questions.begin();
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        loop {
            match self.questions.turn(cx, &mut self.coherence, self.in_flight) {
                Turn::Look(front) => self.look_at(cx, front),
                Turn::Step(step) => return self.questions.action(cx, step),
                Turn::Wait(wait) => return Action::Wait(wait),
                Turn::Done => return Action::Done,
            }
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(Asked { front, was_visible, .. }) = self.questions.close(ticket) else { return };
        if !answer.is_visible(cx.tradeoff.visible_pixels) {
            self.coherence.found_hidden(cx, front.node);
            return;
        }
        let terms = Terms { leaf: cx.tradeoff.n_av.unwrap_or(self.n_av), inner: 0 };
        self.coherence.found_visible(cx, front.node, terms.after(answer));
        if !was_visible {
            self.coherence.take_as_visible(cx, front);
        }
    }

    fn reset(&mut self) {
        self.coherence.reset();
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.coherence.fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        self.coherence.counters()
    }

    fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::new("n_av", self.n_av, "frames for which a leaf found visible goes unasked"),
            Dial::new("in_flight", self.in_flight, "questions that go out before answers are looked for"),
        ]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "n_av" => self.n_av = dial::number(key, value, 0..=1000)?,
            "in_flight" => self.in_flight = dial::number(key, value, 1..=4096)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}

impl Chc {
    /// Opens, draws or asks about a node.
    fn look_at(&mut self, cx: &Context<'_>, front: Front) {
        let Look::Ask { was_visible } = self.coherence.look_at(cx, front) else {
            return self.coherence.take_as_visible(cx, front);
        };
        match cx.question(front.node) {
            Question::Outside => {}
            Question::Visible => {
                self.coherence.found_visible(cx, front.node, Terms::NONE);
                self.coherence.take_as_visible(cx, front);
            }
            Question::Ask(proxy) => {
                self.questions.ask(&mut self.coherence, (front, proxy), was_visible, ());
                if was_visible {
                    self.coherence.take_as_visible(cx, front);
                }
            }
        }
    }
}
