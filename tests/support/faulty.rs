//! A backend whose answers go astray, for suites to run with.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::Error;
use tercet::geom::{Proxy, View};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::{ObjectRef, ObjectSet};

use crate::support::Shown;

/// A backend that loses a tenth of its answers, calls a tenth unknown, delivers a tenth twice, and a
/// fifth late: with a later wait of the frame or in the frames after it. All in any order.
pub struct Faulty {
    inner: SoftwareQueries,
    dice: ChaCha8Rng,
    late: Vec<(Ticket, Kept)>,
}

/// An answer, kept for later.
#[derive(Clone)]
enum Kept {
    Any(bool),
    Dual(u32, u32),
    Swept(ObjectSet),
    Unknown,
}

impl Faulty {
    pub fn new(seed: u64) -> Self {
        let dice = ChaCha8Rng::seed_from_u64(seed);
        Self { inner: SoftwareQueries::new(), dice, late: Vec::new() }
    }
}

impl Kept {
    fn new(answer: Answer<'_>) -> Self {
        match answer {
            Answer::Any(visible) => Self::Any(visible),
            Answer::Dual { visible, total } => Self::Dual(visible, total),
            Answer::Swept(found) => Self::Swept(found.clone()),
            Answer::Unknown => Self::Unknown,
        }
    }

    fn answer(&self) -> Answer<'_> {
        match self {
            &Self::Any(visible) => Answer::Any(visible),
            &Self::Dual(visible, total) => Answer::Dual { visible, total },
            Self::Swept(found) => Answer::Swept(found),
            Self::Unknown => Answer::Unknown,
        }
    }
}

impl Shown for Faulty {
    fn shown(&self) -> &SoftwareQueries {
        &self.inner
    }
}

impl QueryBackend for Faulty {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "faulty"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.inner.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.inner.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.inner.ask(ticket, boxes, want)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_objects(objects, record)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.inner.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let mut now = Vec::new();
        let Self { inner, dice, late } = self;
        // What is late may be late again.
        let (due, later) = late.drain(..).partition(|_| dice.random_bool(0.5));
        *late = later;
        inner.answers(wait, |ticket, answer| {
            let answer = (ticket, Kept::new(answer));
            match dice.random_range(0..10) {
                0 => {}
                1 => now.push((ticket, Kept::Unknown)),
                2 => now.extend([answer.clone(), answer]),
                3 | 4 => late.push(answer),
                _ => now.push(answer),
            }
        })?;
        let due: Vec<(Ticket, Kept)> = due;
        now.extend(due);
        now.shuffle(dice);
        now.iter().for_each(|&(ticket, ref kept)| deliver(ticket, kept.answer()));
        Ok(())
    }

    fn end(&mut self) -> Result<(), Error> {
        self.inner.end()
    }
}
