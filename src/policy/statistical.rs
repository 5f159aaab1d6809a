//! Statistically optimised occlusion queries: the baseline of Kovalčík & Tobola 2005, after
//! Kovalčík & Sochor 2005.
//!
//! Meant for a binary tree ([`Straddlers::StayInParent`](crate::tree::Straddlers)): straddlers
//! stay in inner nodes and are drawn whenever their node is visible. Nodes are visited front to
//! back; several questions are in flight while the traversal goes on, and no heed is paid to
//! whether they overlap on the screen. A node that was visible is asked about less often.
//!
//! The text gives no exact rule for that. Ours, fixed before anything was measured: after `k`
//! consecutive visible answers a node's question is skipped for `min(k, n_skip)` frames, with
//! `n_skip = 8`, and the node taken as visible.

use std::collections::VecDeque;

use super::front::{Front, FrontQueue};
use super::{Action, Answer, Context, Extent, Fate, History, Policy, Ticket};
use crate::Error;
use crate::dial::{self, Dial};
use crate::geom::{PlaneMask, Proxy, Question};
use crate::query::{Wait, Want};
use crate::tree::NodeId;

/// See the module's documentation.
#[derive(Clone, Debug)]
pub struct Statistical {
    /// Frames for which a visible node goes unasked, at most.
    pub n_skip: u32,
    /// Questions in flight before their answers are awaited; 0 counts as 1.
    pub in_flight: u32,
    history: History,
    front: FrontQueue,
    /// What is in flight; a ticket is an index.
    asked: Vec<(Front, Proxy)>,
    out: VecDeque<Step>,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Draw(NodeId),
    Ask(usize),
    Wait,
}

impl Default for Statistical {
    fn default() -> Self {
        Self {
            n_skip: 8,
            in_flight: 8,
            history: History::default(),
            front: FrontQueue::default(),
            asked: Vec::new(),
            out: VecDeque::new(),
        }
    }
}

impl Policy for Statistical {
    fn name(&self) -> &'static str {
        "statistical"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.history.follow(cx.tree);
        self.front.clear();
        self.out.clear();
        self.front.push(cx, cx.tree.root(), PlaneMask::ALL);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if self.out.is_empty() {
            self.advance(cx);
        }
        match self.out.pop_front() {
            Some(Step::Draw(node)) => Action::Draw(node, Extent::Own),
            Some(Step::Ask(i)) => {
                let boxes = std::slice::from_ref(&self.asked[i].1);
                Action::Ask { ticket: Ticket(i as u32), boxes, want: Want::Any }
            }
            Some(Step::Wait) => Action::Wait(Wait::Block),
            None => Action::Done,
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        let Some(&(front, _)) = self.asked.get(ticket.0 as usize) else { return };
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

    fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::new("n_skip", self.n_skip, "frames for which a visible node goes unasked, at most"),
            Dial::new("in_flight", self.in_flight, "questions in flight before their answers are awaited"),
        ]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "n_skip" => self.n_skip = dial::number(key, value, 0..=1000)?,
            "in_flight" => self.in_flight = dial::number(key, value, 1..=4096)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}

impl Statistical {
    /// Goes on until enough questions are in flight, or nothing is left.
    fn advance(&mut self, cx: &Context<'_>) {
        self.asked.clear();
        while self.asked.len() < self.in_flight.max(1) as usize {
            let Some(front) = self.front.pop() else { break };
            let state = self.history.get(front.node);
            if state.visible && cx.frame <= state.skip_until {
                self.take_as_visible(cx, front);
                continue;
            }
            match cx.question(front.node) {
                Question::Outside => {}
                Question::Visible => self.found_visible(cx, front),
                Question::Ask(proxy) => {
                    self.out.push_back(Step::Ask(self.asked.len()));
                    self.asked.push((front, proxy));
                }
            }
        }
        if !self.asked.is_empty() {
            self.out.push_back(Step::Wait);
        }
    }

    fn found_visible(&mut self, cx: &Context<'_>, front: Front) {
        let n_skip = self.n_skip;
        let state = self.history.entry(front.node);
        state.streak = state.streak.saturating_add(1);
        state.asked_at = cx.frame;
        state.skip_until = cx.frame.saturating_add(state.streak.min(n_skip));
        self.take_as_visible(cx, front);
    }

    fn take_as_visible(&mut self, cx: &Context<'_>, front: Front) {
        let state = self.history.entry(front.node);
        (state.frame, state.visible) = (cx.frame, true);
        if cx.tree.own_count(front.node) > 0 {
            self.out.push_back(Step::Draw(front.node));
        }
        for child in cx.tree.children(front.node).into_iter().flatten() {
            self.front.push(cx, child, front.mask);
        }
    }
}
