//! What went between a view and its backend.

use serde::{Deserialize, Serialize};

use super::chunk::RecordedView;
use crate::Error;
use crate::geom::{Proxy, View};
use crate::query::{Answer, DeviceTimes, DrawTime, KeptAnswer, QueryBackend, Sweep, Ticket, Wait, Want};
use crate::scene::{ObjectRef, Scene};

/// The questions of a frame, in short, and the answers, delivery by delivery.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Log {
    /// Whether the backend owned its depth.
    pub(super) owns_depth: bool,
    /// Whether it could leave out what does not show.
    pub(super) draws_if_seen: bool,
    /// The earlier frame whose depth the questions saw.
    pub(super) past: Option<RecordedView>,
    pub(super) asked: Asked,
    /// One for each time that answers were called for.
    pub(super) deliveries: Vec<Delivery>,
}

/// The answers of one call for them, by ticket.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Delivery {
    pub(super) answers: Vec<(u32, KeptAnswer)>,
    /// What the backend reported instead of success, in words.
    pub(super) error: Option<String>,
}

impl Delivery {
    /// Whether all slots that its answers name are those of objects, or of some that are gone: answers may
    /// be late. O(objects named).
    pub(super) fn is_about(&self, scene: &Scene) -> bool {
        self.answers.iter().all(|(_, answer)| match answer {
            KeptAnswer::Swept(found) => found.slots().all(|slot| slot < scene.slot_bound()),
            _ => true,
        })
    }
}

/// How much was asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Asked {
    pub(super) questions: u32,
    /// Boxes in them, and groups and loose objects in sweeps.
    pub(super) boxes: u32,
}

impl Asked {
    pub(super) fn count(&mut self, boxes: usize) {
        self.questions += 1;
        self.boxes += boxes as u32;
    }
}

/// A backend that a [`Recorder`](super::Recorder) listens to. It keeps the answers of one frame.
#[derive(Debug)]
pub struct Logged<B> {
    /// The backend itself.
    pub backend: B,
    log: Option<Log>,
}

impl<B> Logged<B> {
    /// A backend that is listened to.
    pub fn new(backend: B) -> Self {
        Self { backend, log: Some(Log::default()) }
    }

    /// A backend that nobody listens to: nothing is kept.
    pub fn silent(backend: B) -> Self {
        Self { backend, log: None }
    }

    /// Whether somebody listens from now on.
    pub fn listen(&mut self, listen: bool) {
        self.log = listen.then(Log::default);
    }

    /// What was kept of the last frame.
    pub(super) fn take(&mut self) -> Option<Log> {
        self.log.as_mut().map(std::mem::take)
    }
}

impl<B: QueryBackend> Logged<B> {
    /// Starts a frame that has begun.
    fn start(&mut self, past: Option<&View>) {
        if let Some(log) = &mut self.log {
            let (owns_depth, draws_if_seen) = (self.backend.owns_depth(), self.backend.draws_if_seen());
            *log = Log { owns_depth, draws_if_seen, past: past.map(RecordedView::new), ..Log::default() };
        }
    }
}

impl<B: QueryBackend> QueryBackend for Logged<B> {
    type Pass = B::Pass;

    fn name(&self) -> &'static str {
        self.backend.name()
    }

    fn can_block(&self) -> bool {
        self.backend.can_block()
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.backend.begin(view)?;
        self.start(None);
        Ok(())
    }

    fn begin_late(&mut self, view: &View, frames: u32) -> Result<Option<View>, Error> {
        let past = self.backend.begin_late(view, frames)?;
        self.start(past.as_ref());
        Ok(past)
    }

    fn owns_depth(&self) -> bool {
        self.backend.owns_depth()
    }

    fn draw(&mut self, record: impl FnOnce(&mut B::Pass)) -> Result<(), Error> {
        self.backend.draw(record)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.backend.draw_objects(objects, record)
    }

    fn draws_if_seen(&self) -> bool {
        self.backend.draws_if_seen()
    }

    fn draw_if_seen(
        &mut self,
        ticket: Ticket,
        objects: &[ObjectRef],
        record: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.backend.draw_if_seen(ticket, objects, record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        if let Some(log) = &mut self.log {
            log.asked.count(boxes.len());
        }
        self.backend.ask(ticket, boxes, want)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        if let Some(log) = &mut self.log {
            log.asked.count(sweep.groups.len() + sweep.loose.len());
        }
        self.backend.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let Some(log) = &mut self.log else { return self.backend.answers(wait, deliver) };
        let mut delivery = Delivery::default();
        let result = self.backend.answers(wait, |ticket, answer| {
            delivery.answers.push((ticket.0, answer.into()));
            deliver(ticket, answer);
        });
        delivery.error = result.as_ref().err().map(ToString::to_string);
        log.deliveries.push(delivery);
        result
    }

    fn draw_time(&self) -> DrawTime {
        self.backend.draw_time()
    }

    fn device_times(&self, frame: u64) -> Option<DeviceTimes> {
        self.backend.device_times(frame)
    }

    fn end(&mut self) -> Result<(), Error> {
        self.backend.end()
    }
}
