//! *CHC++*: Mattausch, Bittner & Wimmer, *CHC++: Coherent Hierarchical Culling Revisited* (2008).
//!
//! As [`Chc`](super::Chc), with fewer questions and far fewer changes between drawing and asking.
//! Each optimisation has a switch of its own:
//!
//! | | switch | file |
//! |---|---|---|
//! | nodes that were hidden are asked about in batches of `b`, visible leaves while others' answers are awaited | `batching` | `queues` |
//! | the first question about a leaf that turned visible comes after a random time | `randomised` | `sampling` |
//! | questions are about the boxes of descendants | `tight` | `tight` |
//! | several hidden nodes are asked about in one question | `multiqueries` | `multiquery` |
//! | a large multiquery that fails is repeated in groups (ours) | `regroup` | `multiquery` |
//! | inner nodes that come into view are opened, and leaves drawn, unasked if they are seldom hidden (ours) | `guess` | `guess` |
//!
//! With all of them off it does as CHC does, but that it asks about a visible leaf every `n_av`
//! frames, and CHC in the frame after `n_av` (both as published). So the published ablation (CHC,
//! +B, +R, +TB, +MQ) is one switch more at a time.
//!
//! Conservative, as CHC is: what was hidden is asked about in every frame. An answer that finds
//! nothing visible of several nodes hides them all; one that finds something visible says nothing of
//! any of them, and they are asked about one by one, with the next batch. A lost answer draws them
//! all.
//!
//! *Votes.* None, as CHC: see there.
//!
//! # Where we differ
//!
//! - The v-queue is issued when nothing is left to walk to, in one go with the last batch: both are
//!   one submission on a device. The paper issues leaf by leaf whenever an answer has not arrived yet,
//!   and leaves the last answers to the next frame. Here they are awaited: a frame's questions end
//!   with it.
//! - *Guesses.* What comes into view is taken as visible where asking is not expected to pay; see [`guess`].
//! - *Groups.* Nodes of a failed multiquery are asked about one by one as published; of more than four,
//!   in about √|M| groups first. So larger sets are worth a question, and `C` is that of the two steps.
//! - `p_keep` is measured for nodes that are alike: leaves or not, of about the same coverage of the screen,
//!   visible before they were hidden or not; and for nodes of which nothing is known.
//! - Nodes of a failed multiquery join the i-queue instead of being asked about at once: another
//!   batch, not another change of state.
//! - An inner node may be visible, and nothing below it. As published it is then asked about in every
//!   second frame, and its children in between. With multiqueries it stays open for `n_av` frames;
//!   with `regroup`, twice as long when that was in vain again, and up to eight times.
//! - Inner nodes of up to three objects are virtual leaves: hidden, they are one node of a multiquery
//!   instead of two or three, and visible they are asked about as one. In the city, with two objects for
//!   three, it would ask a quarter more questions and draw a tenth fewer objects.
//! - Below a leaf, tight volumes go on to the boxes of its objects; nothing need be built deeper.
//! - A question that counts ([`Want::Dual`]) is about one box. With a threshold of visible samples,
//!   volumes are not tight, and multiqueries ask, as ever, whether a single sample is visible; the
//!   threshold decides about single nodes.

mod dials;
mod guess;
mod multiquery;
mod queues;
mod sampling;
mod spells;
mod tight;

pub use multiquery::KeepRule;

use std::ops::Range;

use super::coherence::{Coherence, Look, Step, Terms};
use super::front::Front;
use super::in_flight::IN_FLIGHT;
use super::odds::{Class, Kind, Odds};
use super::{Action, Answer, Context, Fate, Policy, Ticket};
use crate::dial::Dial;
use crate::geom::Question;
use crate::query::{Wait, Want};
use crate::tree::NodeId;
use crate::{Counter, Error};
use multiquery::{Alike, KeepRate};
use queues::{Queues, Waiting};
use sampling::Sampling;
use spells::Spells;
use tight::{Limits, TightVolume};

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct ChcPlusPlus {
    /// Frames from one question about a visible leaf to the next; 0 counts as 1.
    pub n_av: u32,
    /// Hidden nodes a batch; 0 counts as 1.
    pub b: u32,
    /// Whether questions go out in batches.
    pub batching: bool,
    /// Whether the first question about a leaf that turned visible comes after a random time.
    pub randomised: bool,
    /// Whether questions are about the boxes of descendants.
    pub tight: bool,
    /// Whether several hidden nodes are asked about in one question. It takes batches.
    pub multiqueries: bool,
    /// Whether a large multiquery that fails is repeated in groups, not node by node.
    pub regroup: bool,
    /// Whether nodes that come into view are taken as visible if such nodes are seldom hidden.
    pub guess: bool,
    /// Where the probability comes from that a hidden node stays hidden.
    pub p_keep: KeepRule,
    /// Levels to which tight volumes go down.
    pub d_max: u32,
    /// The surface of a tight volume's boxes, to the surface of the node's box, at most.
    pub s_max: f32,
    /// Objects up to which an inner node is treated as a leaf, where volumes are tight.
    pub virtual_leaf: u32,
    coherence: Coherence,
    queues: Queues,
    volume: TightVolume,
    spells: Spells,
    rate: KeepRate,
    odds: Odds,
    /// Questions asked since answers were last looked for.
    unseen: u32,
    counts: Counts,
}

/// What is counted in a frame.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    batches: u32,
    multiqueries: u32,
    failed: u32,
    guessed: u32,
}

impl Default for ChcPlusPlus {
    fn default() -> Self {
        Self {
            n_av: 10,
            b: 50,
            batching: true,
            randomised: true,
            tight: true,
            multiqueries: true,
            regroup: true,
            guess: true,
            p_keep: KeepRule::Measured,
            d_max: 3,
            s_max: 1.4,
            virtual_leaf: 3,
            coherence: Coherence::default(),
            queues: Queues::default(),
            volume: TightVolume::default(),
            spells: Spells::default(),
            rate: KeepRate::default(),
            odds: Odds::default(),
            unseen: 0,
            counts: Counts::default(),
        }
    }
}

impl Policy for ChcPlusPlus {
    fn name(&self) -> &'static str {
        "chc++"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.coherence.virtual_leaf = if self.tight { self.virtual_leaf } else { 0 };
        self.coherence.begin(cx);
        self.queues.begin();
        self.odds.begin();
        self.unseen = 0;
        self.counts = Counts::default();
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        loop {
            match self.coherence.step() {
                Some(Step::Draw(node, extent)) => return Action::Draw(node, extent),
                Some(Step::Ask(question)) => {
                    let boxes = self.queues.boxes(question);
                    let counts = cx.tradeoff.visible_pixels > 0 && boxes.len() == 1;
                    let want = if counts { Want::Dual } else { Want::Any };
                    return Action::Ask { ticket: Ticket(question as u32), boxes, want };
                }
                None => {}
            }
            let enough = if self.batching { 1 } else { IN_FLIGHT };
            if self.unseen >= enough && !self.coherence.is_at_end() {
                self.unseen = 0;
                return Action::Wait(Wait::Poll);
            }
            if let Some(front) = self.coherence.pop() {
                self.look_at(cx, front);
            } else if self.issue_batch() || self.issue_visible() {
                // They are asked next.
            } else if self.queues.is_open() {
                self.unseen = 0;
                return Action::Wait(Wait::Block);
            } else {
                self.coherence.pull_up(cx, |node| self.spells.is_hidden(node, cx.frame, true));
                return Action::Done;
            }
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(asked) = self.queues.close(ticket) else { return };
        let visible = answer.is_visible(cx.tradeoff.visible_pixels);
        let lost = matches!(answer, Answer::Unknown);
        let failed = visible && !lost && asked.nodes.len() > 1;
        self.counts.failed += u32::from(failed);
        if failed && self.regroup && !asked.is_group && asked.nodes.len() > multiquery::EACH {
            return self.queues.wait_in_groups(asked.nodes);
        }
        for node in asked.nodes {
            let node = self.queues.node(node).clone();
            if failed {
                self.queues.wait_invisible(Waiting { p_keep: 0.0, ..node });
                continue;
            }
            if !asked.was_visible && !lost {
                self.rate.saw(node.hidden_for, node.alike, !answer.is_visible(0));
                if node.hidden_for == 0 {
                    self.odds.saw(node.alike.class, 1, !visible);
                }
            }
            if visible {
                self.found_visible(cx, node.front, asked.was_visible, answer);
            } else {
                self.found_hidden(cx, &node, asked.was_visible, answer);
            }
        }
    }

    fn reset(&mut self) {
        self.cut();
        self.odds = Odds::default();
    }

    /// How long nodes keep their state is the same elsewhere.
    fn cut(&mut self) {
        self.coherence.reset();
        self.spells.clear();
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.coherence.fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        let Counts { batches, multiqueries, failed, guessed } = self.counts;
        let own = [
            ("batches", batches),
            ("multiqueries", multiqueries),
            ("failed_multiqueries", failed),
            ("guessed_visible", guessed),
        ];
        let own = own.into_iter().map(|(key, count)| Counter { key, count });
        own.chain(self.coherence.counters()).collect()
    }

    fn dials(&self) -> Vec<Dial> {
        dials::of(self)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        dials::set(self, key, value)
    }
}

/// What the view says of a node's boxes.
enum Boxes {
    /// None can own a sample.
    Outside,
    /// One meets the near plane.
    Near,
    /// To be asked: those of the frame's proxies.
    Ask(Range<usize>),
}

impl ChcPlusPlus {
    /// Opens or draws a node, or queues its question.
    fn look_at(&mut self, cx: &Context<'_>, front: Front) {
        let Look::Ask { was_visible } = self.coherence.look_at(cx, front) else {
            return self.coherence.take_as_visible(cx, front);
        };
        let boxes = match self.boxes(cx, front.node) {
            Boxes::Outside => return,
            Boxes::Near => {
                self.coherence.found_visible(cx, front.node, Terms::NONE);
                return self.coherence.take_as_visible(cx, front);
            }
            Boxes::Ask(boxes) => boxes,
        };
        let (kind, _) = self.coherence.memory(cx, front.node);
        let class = Class::new(cx, kind, &self.queues.proxies[boxes.clone()]);
        if was_visible {
            let alike = Alike { class, was_visible };
            self.queues.wait_visible(Waiting { front, boxes, alike, hidden_for: 0, p_keep: 0.0 });
            if !self.batching {
                self.unseen += 1;
                self.issue_visible();
            }
            self.coherence.take_as_visible(cx, front);
        } else {
            let (hidden_for, was_visible) = self.spells.frames(front.node, cx.frame);
            let alike = Alike { class, was_visible };
            let hidden = self.odds.hidden(class, 1);
            if self.guess && hidden_for == 0 && guess::is_visible(cx, front.node, class, hidden) {
                self.counts.guessed += 1;
                if class.is_leaf {
                    self.coherence.assume_visible(
                        cx,
                        front.node,
                        sampling::soon(front.node, cx.frame, self.n_av(cx)),
                    );
                }
                return self.coherence.take_as_visible(cx, front);
            }
            let p_keep = match self.multiqueries {
                true if self.guess && hidden_for == 0 => hidden,
                true => self.rate.p_keep(self.p_keep, hidden_for, alike),
                false => 0.0,
            };
            let waiting = self.queues.wait_invisible(Waiting { front, boxes, alike, hidden_for, p_keep });
            if !self.batching || waiting >= self.b as usize {
                self.issue_batch();
            }
        }
    }

    /// The proxies of a node's boxes.
    fn boxes(&mut self, cx: &Context<'_>, node: NodeId) -> Boxes {
        // A count is about one box.
        let d_max = if self.tight && cx.tradeoff.visible_pixels == 0 { self.d_max } else { 0 };
        let proxies = &mut self.queues.proxies;
        let first = proxies.len();
        for aabb in self.volume.of(cx.tree, node, Limits { d_max, s_max: self.s_max }) {
            match cx.question_about(node, &aabb) {
                Question::Outside => {}
                Question::Visible => {
                    proxies.truncate(first);
                    return Boxes::Near;
                }
                Question::Ask(proxy) => proxies.push(proxy),
            }
        }
        if proxies.len() > first {
            return Boxes::Ask(first..proxies.len());
        }
        if cx.question(node) != Question::Outside {
            // Whoever asks about the node's fate asks about its one box.
            self.coherence.found_hidden(cx, node);
        }
        Boxes::Outside
    }

    /// Issues the i-queue; false if it is empty.
    fn issue_batch(&mut self) -> bool {
        let questions = self.queues.issue_invisible(self.regroup);
        self.counts.batches += u32::from(!questions.is_empty());
        let multiqueries = questions.clone().filter(|&question| self.queues.is_multiquery(question));
        self.counts.multiqueries += multiqueries.count() as u32;
        self.unseen += questions.len() as u32;
        self.ask(questions)
    }

    /// Issues the v-queue; false if it is empty.
    fn issue_visible(&mut self) -> bool {
        let questions = self.queues.issue_visible();
        self.ask(questions)
    }

    fn ask(&mut self, questions: Range<usize>) -> bool {
        let any = !questions.is_empty();
        questions.for_each(|question| self.coherence.ask(question));
        any
    }

    fn n_av(&self, cx: &Context<'_>) -> u32 {
        cx.tradeoff.n_av.unwrap_or(self.n_av)
    }

    fn found_visible(&mut self, cx: &Context<'_>, front: Front, was_visible: bool, answer: Answer<'_>) {
        let n_av = self.n_av(cx);
        let sampling = Sampling { n_av, randomised: self.randomised };
        let leaf = sampling.term(front.node, cx.frame, !was_visible);
        // Its children cost little in the questions of others; it alone would spoil them, over and over.
        // The more often in vain, the longer it stays open.
        let inner = match (self.multiqueries, self.regroup) {
            (false, _) => 0,
            (true, false) => n_av.saturating_sub(1),
            (true, true) => (n_av << self.coherence.streak(front.node).min(3)).saturating_sub(1),
        };
        self.coherence.found_visible(cx, front.node, Terms { leaf, inner }.after(answer));
        if !was_visible {
            self.coherence.take_as_visible(cx, front);
        }
    }

    fn found_hidden(&mut self, cx: &Context<'_>, node: &Waiting, was_visible: bool, answer: Answer<'_>) {
        self.coherence.found_hidden(cx, node.front.node);
        // What shows a few samples, fewer than the threshold, would spoil a multiquery.
        if !answer.is_visible(0) {
            let once_visible = was_visible || node.alike.class.kind == Kind::OnceVisible;
            self.spells.is_hidden(node.front.node, cx.frame, once_visible);
        }
    }
}
