//! The ternary tree with dual queries: Kovalčík & Tobola, *Dynamic Bounding Volume Hierarchies
//! for Occlusion Culling* (2005).
//!
//! Nodes are visited front to back. An inner node that was visible is opened; a leaf, or a node
//! that was hidden as a whole, is asked about: `visible` and `total` samples of its box. Questions
//! go out in waves whose screen rectangles do not meet ([`ScreenTiles`]); what a wave finds
//! visible is drawn before the next one asks. The counts of leaves are the votes by which the
//! tree splits and merges.
//!
//! *Skipping:* a leaf found visible in `k` consecutive answers is taken as visible for the next
//! `min(k, n_skip)` frames. The paper says only that such nodes are queried less often; the rule
//! is ours. It draws more, never less.
//!
//! *Pull-up:* an inner node none of whose children was visible is hidden as a whole, and asked
//! about as one in the next frame.
//!
//! Conservative whatever the history: nothing is culled but by an answer of this very frame, and
//! every occluder behind that answer was drawn in this frame.

use std::collections::VecDeque;

use super::front::{Front, FrontQueue};
use super::{Action, Context, Extent, History, Policy, ScreenTiles};
use crate::Error;
use crate::dial::{self, Dial};
use crate::geom::{PlaneMask, Proxy, Question, Viewport};
use crate::query::{Answer, Ticket, Wait, Want};
use crate::tree::{NodeId, Votes};

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct DualQuery {
    /// Frames for which a visible leaf goes unasked, at most; 0 asks every frame.
    pub n_skip: u32,
    /// Waves in which overlap is heeded; what is left then is asked at once.
    pub max_waves: u32,
    history: History,
    /// Nodes to look at, nearest first.
    front: FrontQueue,
    /// Nodes held back for the next wave.
    held: Vec<Front>,
    /// What is asked in this wave; a ticket is an index.
    wave: Vec<Front>,
    /// Proxies of the frame, so that a node held back is not projected again.
    proxies: Vec<Proxy>,
    tiles: ScreenTiles,
    waves: u32,
    /// Actions decided on, in order.
    out: VecDeque<Step>,
    /// Inner nodes opened in this frame, parents first.
    opened: Vec<NodeId>,
    votes: Votes,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Draw(NodeId, Extent),
    Ask(usize),
    Wait,
}

impl Default for DualQuery {
    fn default() -> Self {
        Self {
            n_skip: 0,
            max_waves: 64,
            history: History::default(),
            front: FrontQueue::default(),
            held: Vec::new(),
            wave: Vec::new(),
            proxies: Vec::new(),
            tiles: ScreenTiles::new(Viewport::new(1, 1)),
            waves: 0,
            out: VecDeque::new(),
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
        self.front.clear();
        self.held.clear();
        self.wave.clear();
        self.proxies.clear();
        self.out.clear();
        self.opened.clear();
        self.votes.votes.clear();
        self.votes.forward = cx.view.forward();
        self.tiles = ScreenTiles::new(cx.view.viewport());
        self.waves = 0;
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if self.out.is_empty() {
            self.fill_wave(cx);
        }
        match self.out.pop_front() {
            Some(Step::Draw(node, extent)) => Action::Draw(node, extent),
            Some(Step::Ask(i)) => {
                let proxy = self.wave[i].proxy.expect("only questions are in a wave") as usize;
                let boxes = std::slice::from_ref(&self.proxies[proxy]);
                Action::Ask { ticket: Ticket(i as u32), boxes, want: Want::Dual }
            }
            Some(Step::Wait) => Action::Wait(Wait::Block),
            None => {
                self.pull_up(cx);
                Action::Done
            }
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(&Front { node, mask, .. }) = self.wave.get(ticket.0 as usize) else { return };
        if let (Answer::Dual { visible, total }, true) = (answer, cx.tree.is_leaf(node)) {
            self.votes.count(node, visible, total);
        }
        if answer.is_visible(cx.tradeoff.visible_pixels) {
            self.found_visible(cx, node, mask);
        } else {
            let state = self.history.entry(node);
            (state.frame, state.visible, state.streak) = (cx.frame, false, 0);
        }
    }

    fn reset(&mut self) {
        self.history.clear();
    }

    fn vote(&mut self, votes: &mut Votes) {
        votes.forward = self.votes.forward;
        votes.votes.append(&mut self.votes.votes);
    }

    fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::new("n_skip", self.n_skip, "frames for which a visible leaf goes unasked, at most"),
            Dial::new("max_waves", self.max_waves, "waves in which overlapping questions are held back"),
        ]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "n_skip" => self.n_skip = dial::number(key, value, 0..=1000)?,
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
        self.wave.clear();
        self.tiles.clear();
        self.front.take_back(&mut self.held);
        while let Some(front) = self.front.pop() {
            if front.proxy.is_none() && self.is_taken_as_visible(cx, front.node) {
                self.take_as_visible(cx, front.node, front.mask);
                continue;
            }
            let Some(front) = self.question(cx, front) else { continue };
            let rect = self.proxies[front.proxy.expect("it has its question") as usize].rect;
            if self.tiles.cover(rect) && self.waves < self.max_waves {
                self.held.push(front);
            } else {
                self.out.push_back(Step::Ask(self.wave.len()));
                self.wave.push(front);
            }
        }
        if !self.wave.is_empty() {
            self.waves += 1;
            self.out.push_back(Step::Wait);
        }
    }

    /// An inner node that was visible, or is new, is opened unasked; a leaf within its skip is
    /// drawn unasked.
    fn is_taken_as_visible(&self, cx: &Context<'_>, node: NodeId) -> bool {
        let state = self.history.get(node);
        if cx.tree.is_leaf(node) {
            state.visible && cx.frame <= state.skip_until
        } else {
            state.visible || state.frame == 0
        }
    }

    /// The node with its question, or None if it needs none.
    fn question(&mut self, cx: &Context<'_>, mut front: Front) -> Option<Front> {
        if front.proxy.is_some() {
            return Some(front);
        }
        match Question::new(&cx.tree.query_box(front.node), cx.view) {
            Question::Outside => None,
            Question::Visible => {
                if cx.tree.is_leaf(front.node) {
                    self.votes.near(front.node);
                }
                self.found_visible(cx, front.node, front.mask);
                None
            }
            Question::Ask(proxy) => {
                front.proxy = Some(self.proxies.len() as u32);
                self.proxies.push(proxy);
                Some(front)
            }
        }
    }

    /// An answer, or the near plane, says that a node is visible.
    fn found_visible(&mut self, cx: &Context<'_>, node: NodeId, mask: PlaneMask) {
        let n_skip = self.n_skip;
        let state = self.history.entry(node);
        state.streak = state.streak.saturating_add(1);
        state.skip_until = cx.frame + state.streak.min(n_skip);
        self.take_as_visible(cx, node, mask);
    }

    /// Draws a leaf, opens an inner node.
    fn take_as_visible(&mut self, cx: &Context<'_>, node: NodeId, mask: PlaneMask) {
        let state = self.history.entry(node);
        (state.frame, state.visible) = (cx.frame, true);
        if cx.tree.own_count(node) > 0 {
            self.out.push_back(Step::Draw(node, Extent::Own));
        }
        if let Some(children) = cx.tree.children(node) {
            self.opened.push(node);
            for child in children {
                self.front.push(cx, child, mask);
            }
        }
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
