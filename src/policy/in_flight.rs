//! Questions about a node each that are on their way while the walk goes on: what CHC and NOHC have in common.
//!
//! Answers are looked for when some questions have gone out since the last look, and awaited when nothing is
//! left to walk to.

use super::coherence::{Coherence, Step};
use super::front::Front;
use super::{Action, Context, Ticket};
use crate::geom::Proxy;
use crate::query::{Wait, Want};

/// Questions on their way before answers are looked for, by default.
pub(super) const IN_FLIGHT: u32 = 8;

/// The questions of a frame, each with what its policy notes of it.
#[derive(Clone, Debug)]
pub(super) struct InFlight<N> {
    /// A ticket is an index.
    asked: Vec<Asked<N>>,
    /// Questions without an answer, and those asked since answers were last looked for.
    open: u32,
    unseen: u32,
}

/// A question.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<N> {
    pub(super) front: Front,
    /// Whether it was visible in the last frame: then it is drawn already.
    pub(super) was_visible: bool,
    pub(super) note: N,
    proxy: Proxy,
    answered: bool,
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Turn {
    /// A node is to be looked at.
    Look(Front),
    /// See [`InFlight::action`].
    Step(Step),
    Wait(Wait),
    Done,
}

impl<N> Default for InFlight<N> {
    fn default() -> Self {
        Self { asked: Vec::new(), open: 0, unseen: 0 }
    }
}

impl<N: Copy> InFlight<N> {
    /// Starts a frame.
    pub(super) fn begin(&mut self) {
        self.asked.clear();
        (self.open, self.unseen) = (0, 0);
    }

    /// Goes on with the walk; answers are looked for after `in_flight` questions.
    #[inline]
    pub(super) fn turn(&mut self, cx: &Context<'_>, coherence: &mut Coherence, in_flight: u32) -> Turn {
        if let Some(step) = coherence.step() {
            return Turn::Step(step);
        }
        if self.unseen >= in_flight.max(1) && !coherence.is_at_end() {
            self.unseen = 0;
            return Turn::Wait(Wait::Poll);
        }
        if let Some(front) = coherence.pop() {
            return Turn::Look(front);
        }
        if self.open > 0 {
            self.unseen = 0;
            return Turn::Wait(Wait::Block);
        }
        coherence.pull_up(cx, |_| {});
        Turn::Done
    }

    /// What a step of the walk comes to.
    #[inline]
    pub(super) fn action(&self, cx: &Context<'_>, step: Step) -> Action<'_> {
        match step {
            Step::Draw(node, extent) => Action::Draw(node, extent),
            Step::Ask(i) => {
                let boxes = std::slice::from_ref(&self.asked[i].proxy);
                let want = if cx.tradeoff.visible_pixels == 0 { Want::Any } else { Want::Dual };
                Action::Ask { ticket: Ticket(i as u32), boxes, want }
            }
        }
    }

    /// Asks about a node.
    #[inline]
    pub(super) fn ask(
        &mut self,
        coherence: &mut Coherence,
        (front, proxy): (Front, Proxy),
        was_visible: bool,
        note: N,
    ) {
        coherence.ask(self.asked.len());
        self.asked.push(Asked { front, was_visible, note, proxy, answered: false });
        (self.open, self.unseen) = (self.open + 1, self.unseen + 1);
    }

    /// The question that an answer is to, if it is the first one to it.
    #[inline]
    pub(super) fn close(&mut self, ticket: Ticket) -> Option<Asked<N>> {
        let asked = self.asked.get_mut(ticket.0 as usize)?;
        if std::mem::replace(&mut asked.answered, true) {
            return None;
        }
        self.open -= 1;
        Some(*asked)
    }
}
