//! *NOHC*, near-optimal hierarchical culling: after Guthe, Balázs & Klein, *Near Optimal Hierarchical
//! Culling: Performance Driven Use of Hardware Occlusion Queries* (2006).
//!
//! The walk and the memory are those of [`Chc`](super::Chc). Whether a node is asked about is decided by
//! what a question is expected to cost and to save:
//!
//! ```text
//! P_o(node) · C_r(node) > C_o(node)                                      (1)
//! ```
//!
//! - `P_o`, the probability that the node is hidden: the rate at which nodes of its class were found
//!   so, by temporal coherence (it was hidden, or visible, or nothing is known of it) and by screen
//!   coverage (`odds.rs`). For one that was visible it grows with the frames `i` since it was last asked
//!   about, `1 − (1 − p)ⁱ`.
//! - `C_r`, what it costs not to know: drawing a leaf's objects; for an inner node the lesser of drawing
//!   everything below and of asking about its children instead.
//! - `C_o`, what a question costs: half of it for being asked, half by the pixels of the box. The sum is
//!   calibrated by the backend's own recorded times ([`Costs`](crate::Costs)).
//!
//! Rules that follow:
//!
//! - *Previously visible leaf:* drawn at once; asked about, for the next frame, as soon as (1) holds:
//!   often where leaves become hidden often, or hold many objects, hardly ever where questions are dear.
//! - *Previously visible inner node:* opened.
//! - *Previously hidden node, or one of which nothing is known:* asked about if (1) holds, and its answer
//!   awaited in this frame; else taken as visible. Large new nodes are hardly ever hidden: they are opened
//!   unasked.
//!
//! Conservative whatever the odds: nothing is culled but by an answer of this very frame; who is not
//! asked about is drawn.
//!
//! *Votes.* None, as CHC: see there.
//!
//! # Where we differ
//!
//! - The paper derives `P_o` of a node of which nothing is known from the coverage of the screen by what
//!   has been drawn before it, and fits the cost functions of its card to measured triangles and pixels.
//!   Here both are seen, a class at a time, while the app runs: `C_r` counts objects, and `C_o` is in
//!   units of them.
//! - Its aim, never to be slower than the view frustum alone, needs more than a decision a node: the walk
//!   and the waiting cost something though no question is asked. That is
//!   [`Gated`](super::Gated)'s part.
//! - Answers are looked for after `in_flight` questions, as in our CHC.

use super::coherence::{Coherence, Look, Terms};
use super::front::Front;
use super::in_flight::{Asked, IN_FLIGHT, InFlight, Turn};
use super::odds::{self, Class, Odds};
use super::{Action, Answer, Context, Fate, Policy, Ticket};
use crate::dial::{self, Dial};
use crate::geom::{Proxy, Question};
use crate::{Counter, Error};

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct Nohc {
    /// Questions that go out before answers are looked for; 0 counts as 1.
    pub in_flight: u32,
    /// What a question costs, to what is seen: more than 1 asks less often.
    pub caution: f32,
    coherence: Coherence,
    odds: Odds,
    /// Pixels of a question's rectangle, the mean of those asked lately.
    mean_area: f32,
    questions: InFlight<Expected>,
    /// Nodes that went unasked in this frame because a question did not pay.
    not_worth: u32,
}

/// What an answer tells something about.
#[derive(Clone, Copy, Debug)]
struct Expected {
    class: Class,
    /// Frames since it was asked about before.
    ago: u32,
}

impl Default for Nohc {
    fn default() -> Self {
        Self {
            in_flight: IN_FLIGHT,
            caution: 1.0,
            coherence: Coherence::default(),
            odds: Odds::default(),
            mean_area: 0.0,
            questions: InFlight::default(),
            not_worth: 0,
        }
    }
}

impl Policy for Nohc {
    fn name(&self) -> &'static str {
        "nohc"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.coherence.begin(cx);
        self.odds.begin();
        self.questions.begin();
        self.not_worth = 0;
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
        let Some(Asked { front, was_visible, note, .. }) = self.questions.close(ticket) else { return };
        let Expected { class, ago } = note;
        let visible = answer.is_visible(cx.tradeoff.visible_pixels);
        if !matches!(answer, Answer::Unknown) {
            self.odds.saw(class, ago, !visible);
        }
        if !visible {
            self.coherence.found_hidden(cx, front.node);
            return;
        }
        self.coherence.found_visible(cx, front.node, Terms::NONE);
        if !was_visible {
            self.coherence.take_as_visible(cx, front);
        }
    }

    fn reset(&mut self) {
        self.coherence.reset();
        self.odds = Odds::default();
    }

    fn fate(&self, cx: &Context<'_>, node: crate::tree::NodeId) -> Fate {
        self.coherence.fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        let own = Counter { key: "not_worth_asking", count: self.not_worth };
        self.coherence.counters().into_iter().chain([own]).collect()
    }

    fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::new("in_flight", self.in_flight, "questions that go out before answers are looked for"),
            Dial::new("caution", self.caution, "what a question is taken to cost, to what is seen"),
        ]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "in_flight" => self.in_flight = dial::number(key, value, 1..=4096)?,
            "caution" => self.caution = dial::number(key, value, 0.0..=1000.0)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}

impl Nohc {
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
                let (kind, ago) = self.coherence.memory(cx, front.node);
                let class = Class::new(cx, kind, std::slice::from_ref(&proxy));
                if self.pays(cx, front, &proxy, self.odds.hidden(class, ago)) {
                    self.note_area(&proxy);
                    let note = Expected { class, ago };
                    self.questions.ask(&mut self.coherence, (front, proxy), was_visible, note);
                    if !was_visible {
                        return;
                    }
                } else {
                    self.not_worth += 1;
                }
                self.coherence.take_as_visible(cx, front);
            }
        }
    }

    /// The rule (1).
    fn pays(&self, cx: &Context<'_>, front: Front, proxy: &Proxy, hidden: f32) -> bool {
        let question = self.caution * cx.costs.question();
        let area = if self.mean_area > 0.0 { odds::area(proxy) / self.mean_area } else { 1.0 };
        let objects = cx.tree.count(front.node) as f32;
        let not_knowing = match cx.tree.children(front.node) {
            None => objects,
            Some(children) => {
                let children = children.into_iter().filter(|&child| cx.tree.count(child) > 0).count();
                objects.min(cx.tree.own_count(front.node) as f32 + question * children as f32)
            }
        };
        hidden * not_knowing > question * (0.5 + 0.5 * area.min(4.0))
    }

    fn note_area(&mut self, proxy: &Proxy) {
        const WEIGHT: f32 = 1.0 / 64.0;
        let area = odds::area(proxy);
        let before = if self.mean_area > 0.0 { self.mean_area } else { area };
        self.mean_area = before + WEIGHT * (area - before);
    }
}
