//! Hierarchical visibility with coherence, four ways: Bittner & Havran, *Exploiting coherence in
//! hierarchical visibility algorithms* (2001).
//!
//! - `hierarchy-a`, classical: from the root down; every node on the way is asked about, and is
//!   visible, partially visible or invisible. A partially visible one is *opened*; the others, and
//!   the leaves, are the nodes at which the traversal *terminates*.
//! - `hierarchy-b`, hierarchy updating: nodes opened in the last frame are opened again unasked.
//!   What the nodes below came to is pulled up: a node is invisible, or visible, when all its
//!   children are, and is then asked about as one in the next frame.
//! - `hierarchy-c`, and visibility propagation: a node of whose neighbours enough is known is not
//!   asked about (see `rope.rs`, with the proof). It is tried on nodes that were not partially visible
//!   in the last frame: always if it worked then, else with probability `p_vp`.
//! - `hierarchy-d`, and conservative updating: a node at which the traversal terminated, visible or in
//!   part, is taken as visible with probability `p_skip`.
//!
//! The cheaper step goes first: updating, frustum, propagation, skipping, the question.
//!
//! *Order.* Front to back, one node after the other. Questions whose rectangles do not meet go out
//! together ([`ScreenTiles`]): they cannot hide one another, so the answers are the same.
//!
//! # Deviations
//!
//! - The paper's pseudo-code stamps a node's frame only on a test or a uniform pull-up, so that
//!   opened nodes with mixed children would be tested every second frame. Every visit is stamped.
//! - An answer is about what stands *in front* of a box. That all of an inner node's box is visible
//!   says nothing of what its objects hide of each other, and drawing it as a whole would draw all
//!   that. So it counts as partially visible, unless the dial `whole` is set, which is the
//!   published rule.
//! - A binary tree keeps straddlers in inner nodes. They count as one more child, of the class that
//!   an answer about the node itself gave in the same frame, if there was one.
//! - Children without objects, which nobody asks about, do not count; those outside the frustum
//!   count as invisible.
//! - Both rules of propagation conclude less than in the paper, which knows all occluders
//!   beforehand: *hidden* needs cells that were asked about as such
//!   ([`TightBoxes::Never`](crate::tree::TightBoxes), or nodes that have not settled); with boxes that
//!   are always tight, C is B. *Visible* is for leaves alone, which are drawn as a whole; what a
//!   neighbour's objects hide of them is not noticed until they are asked about.
//!   Few cells of our worlds are hidden as a whole, so C asks hardly fewer questions than B.
//! - The tree is left as it is built, as in the paper: these policies do not vote.
//!
//! Conservative whatever the history: nothing is culled but by an answer of this very frame, about
//! the node or about cells that prove it hidden.

mod record;
mod rope;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use self::record::{Class, Record, Records};
use self::rope::Verdict;
use super::front::{Front, FrontQueue};
use super::waves::{Waiting, Waves};
use super::{Action, Answer, Context, Extent, Fate, History, Policy, Ticket};
use crate::dial::{self, Dial};
use crate::geom::{PlaneMask, Question, uncertainty};
use crate::tree::NodeId;
use crate::{Counter, Error};

/// How much coherence is exploited; each step includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coherence {
    /// A: none.
    Classical,
    /// B: hierarchy updating.
    Updating,
    /// C: and visibility propagation.
    Propagating,
    /// D: and conservative updating.
    Conservative,
}

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    coherence: Coherence,
    /// The probability that propagation is tried where it did not work in the last frame.
    pub p_vp: f32,
    /// The probability that a node that was visible, or in part, is not asked about.
    pub p_skip: f32,
    /// Whether an inner node is drawn as a whole if all of its box is visible.
    pub whole: bool,
    /// What the random choices are made from, with the number of the frame.
    pub seed: u64,
    /// For [`Policy::fate`] alone.
    history: History,
    records: Records,
    dice: ChaCha8Rng,
    /// Nodes to look at, nearest first.
    front: FrontQueue,
    questions: Waves,
    /// Whether propagation is tried before a question is asked, by the number of its proxy.
    tries: Vec<bool>,
    /// Inner nodes opened in this frame, parents first.
    opened: Vec<NodeId>,
    counts: Counts,
}

/// What was saved in a frame, and how.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    opened_unasked: u32,
    propagated_nodes: u32,
    skipped_tests: u32,
    pull_ups: u32,
}

impl Hierarchy {
    /// With the paper's constants; of its two best `p_skip`, 0.5 and 0.6, the greater.
    pub fn new(coherence: Coherence) -> Self {
        Self {
            coherence,
            p_vp: 0.5,
            p_skip: 0.6,
            whole: false,
            seed: 1,
            history: History::default(),
            records: Records::default(),
            dice: ChaCha8Rng::seed_from_u64(1),
            front: FrontQueue::default(),
            questions: Waves::default(),
            tries: Vec::new(),
            opened: Vec::new(),
            counts: Counts::default(),
        }
    }
}

impl Policy for Hierarchy {
    fn name(&self) -> &'static str {
        match self.coherence {
            Coherence::Classical => "hierarchy-a",
            Coherence::Updating => "hierarchy-b",
            Coherence::Propagating => "hierarchy-c",
            Coherence::Conservative => "hierarchy-d",
        }
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.history.follow(cx.tree);
        self.records.reserve(cx.tree.index_bound());
        // A frame's choices depend on nothing but the seed and its number.
        self.dice = ChaCha8Rng::seed_from_u64(self.seed);
        self.dice.set_stream(u64::from(cx.frame));
        self.front.clear();
        self.questions.begin(cx.view.viewport());
        self.tries.clear();
        self.opened.clear();
        self.counts = Counts::default();
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if self.questions.is_idle() {
            self.fill_wave(cx);
        }
        if self.questions.is_idle() {
            self.pull_up(cx);
        }
        self.questions.action()
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(front) = self.questions.node(ticket.0 as usize) else { return };
        if answer.is_visible(cx.tradeoff.visible_pixels) {
            let all = matches!(answer, Answer::Dual { visible, total } if visible >= total);
            let class = if all { Class::Visible } else { Class::Partial };
            self.found_visible(cx, front, class);
            return;
        }
        let (asked, cell) = (cx.tree.query_box(front.node), cx.tree.cell(front.node));
        // Samples that were given up are visible ones: they prove nothing about others.
        let proves = asked == cell && matches!(answer, Answer::Dual { visible: 0, .. });
        let hidden_within = if proves { uncertainty(&cell, cx.view) } else { None };
        let record = Record { class: Class::Invisible, asked: true, hidden_within, ..Record::default() };
        self.found_hidden(cx, front.node, record);
    }

    fn reset(&mut self) {
        self.history.clear();
        self.records.clear();
    }

    /// A node that its neighbours prove hidden counts as asked about.
    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.history.fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        let Counts { opened_unasked, propagated_nodes, skipped_tests, pull_ups } = self.counts;
        vec![
            Counter { key: "opened_unasked", count: opened_unasked },
            Counter { key: "propagated_nodes", count: propagated_nodes },
            Counter { key: "skipped_tests", count: skipped_tests },
            Counter { key: "pull_ups", count: pull_ups },
        ]
    }

    fn dials(&self) -> Vec<Dial> {
        let mut dials = vec![Dial::new(
            "whole",
            self.whole,
            "draw an inner node as a whole if all of its box is visible",
        )];
        if self.coherence >= Coherence::Propagating {
            dials.push(Dial::new(
                "p_vp",
                self.p_vp,
                "how often propagation is tried where it failed, 0 to 1",
            ));
            dials.push(Dial::new("choices", self.seed.to_string(), "what the random choices are made from"));
        }
        if self.coherence >= Coherence::Conservative {
            dials.push(Dial::new("p_skip", self.p_skip, "how often what was visible goes unasked, 0 to 1"));
        }
        dials
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        if !self.dials().iter().any(|dial| dial.key == key) {
            return Err(dial::unknown(key, value, &self.dials()));
        }
        match key {
            "whole" => self.whole = dial::switch(key, value)?,
            "p_vp" => self.p_vp = dial::number(key, value, 0.0..=1.0)?,
            "p_skip" => self.p_skip = dial::number(key, value, 0.0..=1.0)?,
            _ => self.seed = dial::number(key, value, 0..=u64::MAX)?,
        }
        Ok(())
    }
}

impl Hierarchy {
    /// Goes through all nodes on the way, nearest first: opens, draws, and gathers the questions
    /// that may be asked together.
    fn fill_wave(&mut self, cx: &Context<'_>) {
        self.questions.start();
        loop {
            // The nearest of what was held back and what is new.
            let question = match self.questions.next_held(self.front.peek()) {
                Some(question) => question,
                None => {
                    let Some(front) = self.front.pop() else { break };
                    let Some(question) = self.look_at(cx, front) else { continue };
                    question
                }
            };
            if self.tries[question.proxy as usize] && self.propagate(cx, question.front) {
                continue;
            }
            self.questions.add(question, true);
        }
        self.questions.close();
    }

    /// Opens or draws a node, or returns its question.
    fn look_at(&mut self, cx: &Context<'_>, front: Front) -> Option<Waiting> {
        let is_leaf = cx.tree.is_leaf(front.node);
        let last = self.records.of(front.node, cx.frame.wrapping_sub(1)).copied();
        let last = last.filter(|_| self.coherence >= Coherence::Updating);
        if last.is_some_and(|last| last.opened && !is_leaf) {
            self.counts.opened_unasked += 1;
            self.open(cx, front, Record::default());
            return None;
        }
        let proxy = match cx.question(front.node) {
            Question::Outside => return None,
            Question::Visible => {
                self.found_visible(cx, front, Class::Partial);
                return None;
            }
            Question::Ask(proxy) => proxy,
        };
        let tries = self.tries_propagation(last.as_ref());
        if tries && self.propagate(cx, front) {
            return None;
        }
        if let Some(last) = last.filter(|last| last.class != Class::Invisible)
            && self.coherence >= Coherence::Conservative
            && self.dice.random::<f32>() < cx.tradeoff.p_skip.unwrap_or(self.p_skip)
        {
            self.counts.skipped_tests += 1;
            self.take_as_visible(cx, front, Record { class: last.class, ..Record::default() });
            return None;
        }
        // Its neighbours may be answered about while it is held back.
        self.tries.push(tries);
        Some(self.questions.question(front, proxy, false))
    }

    /// Whether a node's neighbours are looked at: what was partially visible will hardly have become
    /// one or the other as a whole.
    fn tries_propagation(&mut self, last: Option<&Record>) -> bool {
        self.coherence >= Coherence::Propagating
            && last.is_none_or(|last| last.class != Class::Partial)
            && (last.is_some_and(|last| last.propagated) || self.dice.random::<f32>() < self.p_vp)
    }

    /// Classifies a node by its neighbours, if they say enough.
    fn propagate(&mut self, cx: &Context<'_>, front: Front) -> bool {
        let Some(verdict) = rope::ask_neighbours(cx, &self.records, front.node) else { return false };
        self.counts.propagated_nodes += 1;
        let record = Record { propagated: true, ..Record::default() };
        match verdict {
            Verdict::Hidden(within) => {
                let hidden_within = Some(within);
                let record = Record { class: Class::Invisible, hidden_within, ..record };
                self.found_hidden(cx, front.node, record);
            }
            Verdict::Visible => {
                self.take_as_visible(cx, front, Record { class: Class::Visible, ..record });
            }
        }
        true
    }

    fn found_hidden(&mut self, cx: &Context<'_>, node: NodeId, record: Record) {
        self.history.found_hidden(node, cx.frame);
        self.records.note(node, cx.frame, record);
    }

    /// An answer, or the near plane, says that a node is visible, as a whole or in part.
    fn found_visible(&mut self, cx: &Context<'_>, front: Front, class: Class) {
        let state = self.history.entry(front.node);
        (state.asked_at, state.streak) = (cx.frame, state.streak.saturating_add(1));
        let record = Record { class, asked: true, ..Record::default() };
        if cx.tree.is_leaf(front.node) || self.whole && class == Class::Visible {
            self.take_as_visible(cx, front, record);
        } else {
            self.open(cx, front, record);
        }
    }

    /// Draws a node with all below it.
    fn take_as_visible(&mut self, cx: &Context<'_>, front: Front, record: Record) {
        self.stamp_visible(cx, front.node);
        self.records.note(front.node, cx.frame, record);
        self.questions.draw(front.node, Extent::Subtree);
    }

    /// Draws an inner node's own objects and looks at its children. What it is as a whole is known
    /// when the frame is complete.
    fn open(&mut self, cx: &Context<'_>, front: Front, record: Record) {
        self.stamp_visible(cx, front.node);
        let record = Record { class: Class::Partial, opened: true, ..record };
        self.records.note(front.node, cx.frame, record);
        self.opened.push(front.node);
        if cx.tree.own_count(front.node) > 0 {
            self.questions.draw(front.node, Extent::Own);
        }
        for child in cx.tree.children(front.node).into_iter().flatten() {
            self.front.push(cx, child, front.mask);
        }
    }

    fn stamp_visible(&mut self, cx: &Context<'_>, node: NodeId) {
        let state = self.history.entry(node);
        (state.frame, state.visible) = (cx.frame, true);
    }

    /// An opened node all of whose children came to the same is that as a whole, children first.
    fn pull_up(&mut self, cx: &Context<'_>) {
        if self.coherence < Coherence::Updating {
            return;
        }
        while let Some(node) = self.opened.pop() {
            let Some(record) = self.records.of(node, cx.frame).copied() else { continue };
            let class = self.class_of_content(cx, node, &record);
            // An inner node that is visible as a whole is opened again, unless it may be drawn so.
            let opened = class == Class::Partial || class == Class::Visible && !self.whole;
            if !opened {
                self.counts.pull_ups += 1;
                self.history.entry(node).visible = class == Class::Visible;
            }
            self.records.note(node, cx.frame, Record { class, opened, ..record });
        }
    }

    /// What the children of a node and its own objects have in common.
    fn class_of_content(&self, cx: &Context<'_>, node: NodeId, record: &Record) -> Class {
        let children = cx.tree.children(node).into_iter().flatten().filter(|&c| cx.tree.count(c) > 0);
        let of_child = |child| self.records.of(child, cx.frame).map_or(Class::Invisible, |r| r.class);
        let own = (cx.tree.own_count(node) > 0 && record.asked).then_some(Class::Partial);
        let mut all = children.map(of_child).chain(own);
        let first = all.next().unwrap_or_default();
        if all.all(|class| class == first) { first } else { Class::Partial }
    }
}
