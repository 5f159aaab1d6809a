//! The ternary tree with dual queries: Kovalčík & Tobola, *Dynamic Bounding Volume Hierarchies
//! for Occlusion Culling* (2005).
//!
//! Nodes are visited front to back. An inner node that was visible is opened; a leaf, or a node
//! that was hidden as a whole, is asked about: `visible` and `total` samples of its box. Questions
//! go out in waves whose screen rectangles do not meet ([`ScreenTiles`]); what a wave finds
//! visible is drawn before the next one asks. The counts of leaves are the votes by which the
//! tree splits and merges.
//!
//! *Order.* By default, as published ([`Order::FrontToBack`]), a leaf is drawn when its answer is
//! there: the fewest objects are drawn, in some tens of waves. [`Order::VisibleFirst`] (ours, after
//! the coherence of CHC) suits backends on which a wave costs a round trip: leaves that the last
//! frame's finished depth showed are drawn at once, and asked about again when the frame is
//! complete, which counts them exactly.
//!
//! *Skipping.* A leaf that keeps being visible goes unasked for some frames: as many as pay
//! ([`Skip`]). It draws more, never less.
//!
//! *Pull-up.* An inner node none of whose children was visible is hidden as a whole, and asked
//! about as one in the next frame.
//!
//! Conservative whatever the history: nothing is culled but by an answer of this very frame, and
//! every occluder behind that answer was drawn in this frame.

use super::front::{Front, FrontQueue};
use super::skip::{Seen, Share, Turnover};
use super::waves::{Waiting, Waves};
use super::{Action, Context, Extent, Fate, History, Policy, Samples, Skip};
use crate::Error;
use crate::dial::{self, Dial};
use crate::geom::{PlaneMask, Proxy, Question};
use crate::query::{Answer, Ticket};
use crate::tree::{NodeId, Votes};

/// What leaves that were visible in the last frame wait for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Nothing: they are drawn first, and asked about when the frame is complete.
    VisibleFirst,
    /// Their answer, as published.
    FrontToBack,
}

const ORDERS: &[(&str, Order)] =
    &[("visible-first", Order::VisibleFirst), ("front-to-back", Order::FrontToBack)];

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct DualQuery {
    /// What visible leaves wait for.
    pub order: Order,
    /// Frames for which a visible leaf goes unasked.
    pub n_skip: Skip,
    /// Waves in which overlap is heeded; what is left then is asked at once.
    pub max_waves: u32,
    history: History,
    turnover: Turnover,
    /// Nodes to look at, nearest first.
    front: FrontQueue,
    questions: Waves,
    /// Leaves drawn without an answer, to be asked about in the last wave.
    unasked: Vec<Front>,
    stage: Stage,
    waves: u32,
    /// Inner nodes opened in this frame, parents first.
    opened: Vec<NodeId>,
    votes: Votes,
}

/// How far the frame has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Waves decide what is drawn.
    Drawing,
    /// The last wave only counts.
    Counting,
}

impl Default for DualQuery {
    fn default() -> Self {
        Self {
            order: Order::FrontToBack,
            n_skip: Skip::Auto,
            max_waves: 1024,
            history: History::default(),
            turnover: Turnover::default(),
            front: FrontQueue::default(),
            questions: Waves::default(),
            unasked: Vec::new(),
            stage: Stage::Drawing,
            waves: 0,
            opened: Vec::new(),
            votes: Votes::default(),
        }
    }
}

impl Policy for DualQuery {
    fn name(&self) -> &'static str {
        "dual-query"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.history.follow(cx.tree);
        self.turnover.begin();
        self.front.clear();
        self.questions.begin(cx.view.viewport());
        self.unasked.clear();
        self.stage = Stage::Drawing;
        self.opened.clear();
        self.votes.votes.clear();
        self.votes.forward = cx.view.forward();
        self.waves = 0;
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if self.questions.is_idle() {
            self.fill_wave(cx);
            if self.questions.is_idle() && self.stage == Stage::Drawing {
                self.count_unasked(cx);
            }
        }
        if self.questions.is_idle() {
            self.pull_up(cx);
        }
        self.questions.action()
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(Front { node, mask, .. }) = self.questions.node(ticket.0 as usize) else { return };
        if let (Answer::Dual { visible, total }, true) = (answer, cx.tree.is_leaf(node)) {
            self.votes.count(node, visible, total);
        }
        let visible = answer.is_visible(cx.tradeoff.visible_pixels);
        self.note_turnover(cx, node, visible);
        let share = Share::of(answer);
        if visible && self.stage == Stage::Drawing {
            self.found_visible(cx, node, mask, share);
        } else if visible {
            self.count_streak(cx, node, share);
        } else {
            self.history.found_hidden(node, cx.frame);
        }
    }

    fn reset(&mut self) {
        self.history.clear();
        self.turnover = Turnover::default();
    }

    fn vote(&mut self, votes: &mut Votes) {
        votes.forward = self.votes.forward;
        // Kept until the next frame begins, for `fate`.
        votes.votes.extend_from_slice(&self.votes.votes);
    }

    /// O(questions of the frame) for a leaf that was asked about, to find its counts.
    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        match self.history.fate(cx, node) {
            Fate::Visible { .. } => Fate::Visible { samples: self.samples(node) },
            // An inner node that was visible is opened for as long as something below it is.
            Fate::Remembered { .. } if !cx.tree.is_leaf(node) => Fate::Remembered { within: None },
            fate => fate,
        }
    }

    fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::choice("order", self.order, ORDERS, "what leaves visible in the last frame wait for"),
            Dial::new(
                "n_skip",
                self.n_skip.name(),
                "frames for which a visible leaf goes unasked, at most, or auto",
            ),
            Dial::new("max_waves", self.max_waves, "waves in which overlapping questions are held back"),
        ]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "order" => self.order = dial::choice(key, value, ORDERS)?,
            "n_skip" => self.n_skip = Skip::parse(key, value)?,
            "max_waves" => self.max_waves = dial::number(key, value, 0..=100_000)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}

impl DualQuery {
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
            self.questions.add(question, self.waves < self.max_waves);
        }
        self.waves += 1;
        self.questions.close();
    }

    /// Asks about the leaves that were drawn without an answer, against the finished depth.
    fn count_unasked(&mut self, cx: &Context<'_>) {
        self.stage = Stage::Counting;
        self.questions.start();
        while let Some(front) = self.unasked.pop() {
            match cx.question(front.node) {
                Question::Outside => self.history.entry(front.node).visible = false,
                Question::Visible => self.votes.near(front.node),
                Question::Ask(proxy) => {
                    let question = self.with_proxy(front, proxy);
                    self.questions.ask(question);
                }
            }
        }
        self.questions.close();
    }

    /// An inner node that was visible, or is new, is opened unasked; a leaf that was visible is
    /// drawn unasked if visible ones go first, or within its skip.
    fn is_taken_as_visible(&mut self, cx: &Context<'_>, front: Front) -> bool {
        let state = self.history.get(front.node);
        if !cx.tree.is_leaf(front.node) {
            return state.visible || state.frame == 0;
        }
        let skips = cx.frame <= state.skip_until;
        let first = self.order == Order::VisibleFirst;
        if state.visible && first && !skips {
            self.unasked.push(front);
        }
        state.visible && (first || skips)
    }

    /// Opens or draws a node, or returns its question.
    fn look_at(&mut self, cx: &Context<'_>, front: Front) -> Option<Waiting> {
        if self.is_taken_as_visible(cx, front) {
            self.take_as_visible(cx, front.node, front.mask);
            return None;
        }
        match cx.question(front.node) {
            Question::Outside => None,
            Question::Visible => {
                if cx.tree.is_leaf(front.node) {
                    self.votes.near(front.node);
                }
                self.found_visible(cx, front.node, front.mask, Share::default());
                None
            }
            Question::Ask(proxy) => Some(self.with_proxy(front, proxy)),
        }
    }

    fn with_proxy(&mut self, front: Front, proxy: Proxy) -> Waiting {
        let state = self.history.get(front.node);
        let expected_hidden = state.frame != 0 && !state.visible;
        self.questions.question(front, proxy, expected_hidden)
    }

    /// An answer, or the near plane, says that a node is visible.
    fn found_visible(&mut self, cx: &Context<'_>, node: NodeId, mask: PlaneMask, share: Share) {
        self.count_streak(cx, node, share);
        self.take_as_visible(cx, node, mask);
    }

    /// An answer about a leaf says how often leaves become hidden, and visible again.
    fn note_turnover(&mut self, cx: &Context<'_>, node: NodeId, visible: bool) {
        let state = self.history.get(node);
        if !cx.tree.is_leaf(node) || state.frame == 0 {
            return;
        }
        if !state.visible {
            // An older memory says nothing of how long it stayed hidden.
            if state.frame.wrapping_add(1) == cx.frame {
                self.turnover.was_hidden(!visible);
            }
        } else if state.asked_at != 0 {
            self.turnover.was_visible(state.share, cx.frame.wrapping_sub(state.asked_at), !visible);
        }
    }

    fn count_streak(&mut self, cx: &Context<'_>, node: NodeId, share: Share) {
        let state = self.history.entry(node);
        state.streak = state.streak.saturating_add(1);
        (state.asked_at, state.share) = (cx.frame, share);
        let leaf = Seen { node, objects: cx.tree.own_count(node), streak: state.streak, share };
        let skip = self.n_skip.frames(leaf, &cx.costs, &self.turnover);
        state.skip_until = cx.frame.saturating_add(skip);
    }

    /// Draws a leaf, opens an inner node.
    fn take_as_visible(&mut self, cx: &Context<'_>, node: NodeId, mask: PlaneMask) {
        let state = self.history.entry(node);
        (state.frame, state.visible) = (cx.frame, true);
        if cx.tree.own_count(node) > 0 {
            self.questions.draw(node, Extent::Own);
        }
        if let Some(children) = cx.tree.children(node) {
            self.opened.push(node);
            for child in children {
                self.front.push(cx, child, mask);
            }
        }
    }

    /// What was counted of a leaf in this frame.
    fn samples(&self, node: NodeId) -> Option<Samples> {
        let vote = self.votes.votes.iter().find(|vote| vote.node == node)?;
        Some(Samples { visible: vote.visible, total: vote.total })
    }

    /// An opened node none of whose children was visible was hidden as a whole.
    fn pull_up(&mut self, cx: &Context<'_>) {
        while let Some(node) = self.opened.pop() {
            let Some(children) = cx.tree.children(node) else { continue };
            let visible = |child: NodeId| {
                let state = self.history.get(child);
                state.frame == cx.frame && state.visible
            };
            if !children.into_iter().any(visible) {
                self.history.entry(node).visible = false;
            }
        }
    }
}
