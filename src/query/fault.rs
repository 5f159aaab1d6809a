//! A backend with faults: what a policy must bear, on purpose and reproducibly.
//!
//! Real devices are late, drop what was asked, run out of room, and are lost. Behind [`Faulty`] any
//! backend does so, by dice with a seed. Nothing of it may lose an object: an answer that is missing or
//! unknown draws, and one for a question of another frame is nobody's.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::kept::KeptAnswer;
use super::{Answer, DeviceTimes, DrawTime, QueryBackend, Sweep, Ticket, Wait, Want};
use crate::Error;
use crate::geom::{Proxy, View};
use crate::scene::ObjectRef;

/// How often what goes wrong. Probabilities are of each answer; what they leave of 1 arrives as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faults {
    /// It never arrives.
    pub lost: f64,
    /// It arrives as [`Answer::Unknown`].
    pub unknown: f64,
    /// It arrives twice.
    pub doubled: f64,
    /// It arrives with later ones, maybe in a later frame.
    pub late: f64,
    /// Whether answers arrive in any order.
    pub reordered: bool,
    /// Questions a frame for which there is room; the others are answered [`Answer::Unknown`].
    pub room: Option<u32>,
    /// The frame, from 0, in which the device is lost: the first time that it is waited for, everything
    /// that was asked is answered [`Answer::Unknown`], and [`Error::Device`] is returned. The next frame
    /// has a new one.
    pub lost_device: Option<u32>,
}

impl Faults {
    /// None at all.
    pub const NONE: Self = Self {
        lost: 0.0,
        unknown: 0.0,
        doubled: 0.0,
        late: 0.0,
        reordered: false,
        room: None,
        lost_device: None,
    };

    /// A tenth lost, a tenth unknown, a tenth doubled, a fifth late, and all of them in any order.
    pub const MANY: Self =
        Self { lost: 0.1, unknown: 0.1, doubled: 0.1, late: 0.2, reordered: true, ..Self::NONE };
}

/// A backend with faults.
#[derive(Clone, Debug)]
pub struct Faulty<B> {
    /// The backend behind.
    pub inner: B,
    /// What goes wrong.
    pub faults: Faults,
    dice: ChaCha8Rng,
    /// Held back for a later delivery.
    late: Vec<(Ticket, KeptAnswer)>,
    /// Delivered next.
    now: Vec<(Ticket, KeptAnswer)>,
    /// For which there was no room.
    refused: Vec<Ticket>,
    asked: u32,
    /// Frames begun.
    frames: u32,
    /// Whether the device that is to be lost in this frame is still there.
    doomed: bool,
}

impl<B> Faulty<B> {
    /// A backend with faults; the same seed, the same ones.
    pub fn new(inner: B, faults: Faults, seed: u64) -> Self {
        let dice = ChaCha8Rng::seed_from_u64(seed);
        let (late, now, refused) = Default::default();
        Self { inner, faults, dice, late, now, refused, asked: 0, frames: 0, doomed: false }
    }

    /// Begins a frame.
    fn start(&mut self) {
        self.asked = 0;
        self.refused.clear();
        self.doomed = self.faults.lost_device == Some(self.frames);
        self.frames += 1;
    }

    /// Whether there is room for another question.
    fn has_room(&mut self, ticket: Ticket) -> bool {
        self.asked += 1;
        let has_room = self.faults.room.is_none_or(|room| self.asked <= room);
        if !has_room {
            self.refused.push(ticket);
        }
        has_room
    }
}

impl<B: QueryBackend> QueryBackend for Faulty<B> {
    type Pass = B::Pass;

    fn name(&self) -> &'static str {
        "faulty"
    }

    fn can_block(&self) -> bool {
        self.inner.can_block()
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.start();
        self.inner.begin(view)
    }

    fn begin_late(&mut self, view: &View, frames: u32) -> Result<Option<View>, Error> {
        self.start();
        self.inner.begin_late(view, frames)
    }

    fn owns_depth(&self) -> bool {
        self.inner.owns_depth()
    }

    fn draw(&mut self, record: impl FnOnce(&mut B::Pass)) -> Result<(), Error> {
        self.inner.draw(record)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_objects(objects, record)
    }

    fn draws_if_seen(&self) -> bool {
        self.inner.draws_if_seen()
    }

    fn draw_if_seen(
        &mut self,
        ticket: Ticket,
        objects: &[ObjectRef],
        record: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_if_seen(ticket, objects, record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        if self.has_room(ticket) { self.inner.ask(ticket, boxes, want) } else { Ok(()) }
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        if self.has_room(ticket) { self.inner.sweep(ticket, sweep) } else { Ok(()) }
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let Self { inner, faults, dice, late, now, refused, .. } = self;
        if std::mem::take(&mut self.doomed) {
            late.clear();
            refused.drain(..).for_each(|ticket| deliver(ticket, Answer::Unknown));
            inner.answers(wait, |ticket, _| deliver(ticket, Answer::Unknown))?;
            return Err(Error::Device { why: "it was lost, as the faults have it".into() });
        }
        now.extend(refused.drain(..).map(|ticket| (ticket, KeptAnswer::Unknown)));
        // What is late may be late again.
        now.extend(late.extract_if(.., |_| dice.random_bool(0.5)));
        inner.answers(wait, |ticket, answer| {
            let kept = (ticket, KeptAnswer::from(answer));
            let mut roll: f64 = dice.random();
            let mut falls = |share: f64| {
                roll -= share;
                roll < 0.0
            };
            match kept {
                _ if falls(faults.lost) => {}
                _ if falls(faults.unknown) => now.push((ticket, KeptAnswer::Unknown)),
                kept if falls(faults.doubled) => now.extend([kept.clone(), kept]),
                kept if falls(faults.late) => late.push(kept),
                kept => now.push(kept),
            }
        })?;
        if faults.reordered {
            now.shuffle(dice);
        }
        now.drain(..).for_each(|(ticket, kept)| kept.deliver(ticket, &mut deliver));
        Ok(())
    }

    fn draw_time(&self) -> DrawTime {
        self.inner.draw_time()
    }

    fn device_times(&self, frame: u64) -> Option<DeviceTimes> {
        self.inner.device_times(frame)
    }

    fn end(&mut self) -> Result<(), Error> {
        self.inner.end()
    }
}
