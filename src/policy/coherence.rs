//! What CHC and CHC++ have in common: a walk from front to back that opens what was visible in the
//! last frame, and a memory that answers change.
//!
//! *Pull-up.* An opened node is visible if something below it is, or if its own answer in this frame
//! said so; else it was hidden as a whole, and is asked about as one in the next frame. The papers
//! write it upward from each answer (`PullUpVisibility`); done once, from the deepest opened node up,
//! it comes to the same.

use std::collections::VecDeque;

use super::front::{Front, FrontQueue};
use super::odds::Kind;
use super::{Answer, Context, Extent, Fate, History};
use crate::Counter;
use crate::geom::PlaneMask;
use crate::tree::NodeId;

/// The walk of one frame, with the memory of the frames before.
#[derive(Clone, Debug, Default)]
pub(super) struct Coherence {
    /// An inner node with at most so many objects is a *virtual leaf*: it is not opened, but asked
    /// about and drawn whole.
    pub(super) virtual_leaf: u32,
    /// Inner nodes that took their state from those below them in this frame.
    pull_ups: u32,
    /// Visible leaves that went unasked in this frame.
    skipped_tests: u32,
    history: History,
    front: FrontQueue,
    /// Actions decided on, in order.
    out: VecDeque<Step>,
    /// Inner nodes opened in this frame, parents first.
    opened: Vec<NodeId>,
}

/// What is to be done about a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// It was visible in the last frame, and is an inner node, or a leaf within its term.
    TakeAsVisible,
    /// Its question is due. A leaf that was visible in the last frame is drawn all the same.
    Ask { was_visible: bool },
}

/// Frames for which a node that was found visible is taken as such.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    pub(super) leaf: u32,
    pub(super) inner: u32,
}

/// What the policy does next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    Draw(NodeId, Extent),
    /// The question of this number.
    Ask(usize),
}

impl Coherence {
    /// Starts a frame at the root.
    pub(super) fn begin(&mut self, cx: &Context<'_>) {
        self.history.follow(cx.tree);
        self.front.clear();
        self.out.clear();
        self.opened.clear();
        (self.pull_ups, self.skipped_tests) = (0, 0);
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    /// Forgets all frames.
    pub(super) fn reset(&mut self) {
        self.history.clear();
    }

    /// The next action decided on.
    pub(super) fn step(&mut self) -> Option<Step> {
        self.out.pop_front()
    }

    /// The nearest node on the way. O(log n).
    pub(super) fn pop(&mut self) -> Option<Front> {
        self.front.pop()
    }

    /// Whether no node is on the way.
    pub(super) fn is_at_end(&self) -> bool {
        self.front.peek().is_none()
    }

    /// What is to be done about a node.
    pub(super) fn look_at(&mut self, cx: &Context<'_>, front: Front) -> Look {
        let state = self.history.get(front.node);
        if !state.visible || state.frame != cx.frame.wrapping_sub(1) {
            return Look::Ask { was_visible: false };
        }
        if self.is_leaf(cx, front.node) {
            if cx.frame > state.skip_until {
                return Look::Ask { was_visible: true };
            }
            self.skipped_tests += 1;
        }
        Look::TakeAsVisible
    }

    /// What is remembered of a node that is to be asked about and whether it is a leaf; and how many frames
    /// ago it was last asked about, 1 if it never was.
    pub(super) fn memory(&self, cx: &Context<'_>, node: NodeId) -> ((Kind, bool), u32) {
        let state = self.history.get(node);
        let kind = match (state.frame == cx.frame.wrapping_sub(1), state.visible) {
            _ if state.frame == 0 => Kind::New,
            (true, true) => Kind::Visible,
            (true, false) => Kind::Hidden,
            (false, true) => Kind::OnceVisible,
            (false, false) => Kind::OnceHidden,
        };
        let is_known = state.asked_at != 0 && matches!(kind, Kind::Visible | Kind::Hidden);
        let ago = if is_known { cx.frame.wrapping_sub(state.asked_at) } else { 1 };
        ((kind, self.is_leaf(cx, node)), ago)
    }

    /// Answers that found a node visible since one that found it hidden.
    pub(super) fn streak(&self, node: NodeId) -> u32 {
        self.history.get(node).streak
    }

    /// For so many frames after this one, a leaf that was not asked about stays unasked.
    pub(super) fn assume_visible(&mut self, cx: &Context<'_>, leaf: NodeId, term: u32) {
        self.history.entry(leaf).skip_until = cx.frame.saturating_add(term);
    }

    /// Will ask a question.
    pub(super) fn ask(&mut self, question: usize) {
        self.out.push_back(Step::Ask(question));
    }

    /// Draws a leaf, opens an inner node.
    pub(super) fn take_as_visible(&mut self, cx: &Context<'_>, Front { node, mask, .. }: Front) {
        let state = self.history.entry(node);
        (state.frame, state.visible) = (cx.frame, true);
        if self.is_virtual_leaf(cx, node) {
            self.out.push_back(Step::Draw(node, Extent::Subtree));
            return;
        }
        if cx.tree.own_count(node) > 0 {
            self.out.push_back(Step::Draw(node, Extent::Own));
        }
        if cx.tree.is_leaf(node) {
            return;
        }
        self.opened.push(node);
        for child in cx.tree.children(node).into_iter().flatten() {
            self.front.push(cx, child, mask);
        }
    }

    /// Remembers that a node was asked about, or met the near plane, and is visible. For so many frames
    /// after this one a leaf goes unasked, and an inner node is not hidden for what is below it.
    pub(super) fn found_visible(&mut self, cx: &Context<'_>, node: NodeId, terms: Terms) {
        let term = if self.is_leaf(cx, node) { terms.leaf } else { terms.inner };
        let state = self.history.entry(node);
        (state.asked_at, state.streak) = (cx.frame, state.streak.saturating_add(1));
        state.skip_until = cx.frame.saturating_add(term);
    }

    /// Remembers that a node is hidden.
    pub(super) fn found_hidden(&mut self, cx: &Context<'_>, node: NodeId) {
        self.history.found_hidden(node, cx.frame);
    }

    /// At the end of the frame; `hidden` is told the nodes that were hidden as a whole.
    pub(super) fn pull_up(&mut self, cx: &Context<'_>, mut hidden: impl FnMut(NodeId)) {
        self.pull_ups = self.opened.len() as u32;
        while let Some(node) = self.opened.pop() {
            let is_visible = |child: NodeId| {
                let state = self.history.get(child);
                state.frame == cx.frame && state.visible
            };
            let may_be_hidden = cx.frame > self.history.get(node).skip_until;
            if may_be_hidden && !cx.tree.children(node).into_iter().flatten().any(is_visible) {
                self.history.entry(node).visible = false;
                hidden(node);
            }
        }
    }

    /// See [`Policy::fate`](super::Policy::fate).
    pub(super) fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        match self.history.fate(cx, node) {
            // An inner node that was visible is opened for as long as something below it is.
            Fate::Remembered { .. } if !self.is_leaf(cx, node) => Fate::Remembered { within: None },
            fate => fate,
        }
    }

    /// See [`Policy::counters`](super::Policy::counters).
    pub(super) fn counters(&self) -> Vec<Counter> {
        vec![
            Counter { key: "pull_ups", count: self.pull_ups },
            Counter { key: "skipped_tests", count: self.skipped_tests },
        ]
    }

    /// Whether a node is asked about and drawn as one.
    pub(super) fn is_leaf(&self, cx: &Context<'_>, node: NodeId) -> bool {
        cx.tree.is_leaf(node) || self.is_virtual_leaf(cx, node)
    }

    fn is_virtual_leaf(&self, cx: &Context<'_>, node: NodeId) -> bool {
        !cx.tree.is_leaf(node) && cx.tree.count(node) <= self.virtual_leaf as usize
    }
}

impl Terms {
    /// No frame but the one that it was found in.
    pub(super) const NONE: Self = Self { leaf: 0, inner: 0 };

    /// After an answer: a lost one is not to be trusted.
    pub(super) fn after(self, answer: Answer<'_>) -> Self {
        if matches!(answer, Answer::Unknown) { Self::NONE } else { self }
    }
}
