//! The questions of a frame: those that are open, and those for which the budget has no room.

use std::time::Instant;

use crate::Budget;
use crate::geom::Proxy;
use crate::query::Ticket;

/// The questions of a frame that have no answer yet, numbered for the backend: from frame to frame,
/// so that an answer which comes after its frame is not taken for that to another question.
#[derive(Debug, Default)]
pub(super) struct OpenQuestions {
    /// By the backend's number, less the frame's first: the policy's own ticket, until it is answered.
    asked: Vec<Option<Ticket>>,
    /// The number of the frame's first question.
    base: u32,
    /// All before this are answered.
    first: usize,
}

impl OpenQuestions {
    pub(super) fn clear(&mut self) {
        self.base = self.base.wrapping_add(self.asked.len() as u32);
        self.asked.clear();
        self.first = 0;
    }

    pub(super) fn ask(&mut self, ticket: Ticket) -> Ticket {
        self.asked.push(Some(ticket));
        Ticket(self.base.wrapping_add(self.asked.len() as u32 - 1))
    }

    /// The policy's ticket of an answer that it waits for; none for one that comes twice, or is
    /// to no question of this frame.
    pub(super) fn close(&mut self, ticket: Ticket) -> Option<Ticket> {
        self.asked.get_mut(ticket.0.wrapping_sub(self.base) as usize)?.take()
    }

    /// Those that should have been answered by now, and were not.
    pub(super) fn lost(&mut self) -> impl Iterator<Item = Ticket> {
        let first = std::mem::replace(&mut self.first, self.asked.len());
        self.asked[first..].iter_mut().filter_map(Option::take)
    }
}

/// What is left of the budget of a frame.
pub(super) struct Purse {
    budget: Budget,
    start: Instant,
    queries: u32,
    box_pixels: u64,
    is_empty: bool,
}

impl Purse {
    /// Full, for a frame that began then.
    pub(super) fn new(budget: Budget, start: Instant) -> Self {
        Self { budget, start, queries: 0, box_pixels: 0, is_empty: false }
    }

    /// Takes what a question costs; false if it is not there. Once it was not, nothing is: so that a frame
    /// can be replayed from the number of its questions alone.
    pub(super) fn pays(&mut self, boxes: &[Proxy]) -> bool {
        let Budget { queries, box_pixels, time } = self.budget;
        self.queries += 1;
        if box_pixels.is_some() {
            self.box_pixels += boxes.iter().map(|proxy| proxy.rect.area()).sum::<u64>();
        }
        self.is_empty |= queries.is_some_and(|most| self.queries > most)
            || box_pixels.is_some_and(|most| self.box_pixels > most)
            || time.is_some_and(|most| self.start.elapsed() > most);
        !self.is_empty
    }
}
