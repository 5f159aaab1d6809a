//! A backend that keeps what it was asked, to be looked at.

use std::collections::HashMap;
use std::ops::Range;

use tercet::Error;
use tercet::geom::{Proxy, View};
use tercet::query::{Answer, DeviceTimes, DrawTime, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::ObjectRef;

use super::{Inspected, Level};

/// A backend, and the questions and the pyramid of its last frame if anybody wants them.
pub struct Watched<B> {
    backend: B,
    log: Option<QuestionLog>,
    pyramid: Option<Vec<Level>>,
}

/// The questions of a frame.
#[derive(Default)]
struct QuestionLog {
    asked: Vec<Asked>,
    /// Whose the boxes are in `asked`, by ticket.
    ranges: HashMap<Ticket, Range<usize>>,
}

/// A box that was asked about.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What the question rasterised.
    pub proxy: Proxy,
    /// What came back; None if nothing did.
    pub visible: Option<bool>,
}

impl<B> Watched<B> {
    /// Keeps nothing, until it is told to.
    pub fn new(backend: B) -> Self {
        Self { backend, log: None, pyramid: None }
    }

    /// The backend itself.
    pub fn backend(&mut self) -> &mut B {
        &mut self.backend
    }

    /// Whether the questions of the next frames are kept.
    pub fn keep(&mut self, keep: bool) {
        if keep {
            self.log.get_or_insert_default();
        } else {
            self.log = None;
        }
    }

    /// Whether the pyramids of the next frames are kept.
    pub fn keep_pyramid(&mut self, keep: bool) {
        if keep {
            self.pyramid.get_or_insert_default();
        } else {
            self.pyramid = None;
        }
    }

    /// The levels of the last frame's pyramid, if it was kept.
    pub fn pyramid(&self) -> &[Level] {
        self.pyramid.as_deref().unwrap_or_default()
    }

    /// The questions of the last frame, if they were kept.
    pub fn asked(&self) -> &[Asked] {
        self.log.as_ref().map_or(&[], |log| &log.asked)
    }
}

impl<B> Watched<B> {
    fn forget(&mut self) {
        if let Some(log) = &mut self.log {
            log.asked.clear();
            log.ranges.clear();
        }
    }
}

impl<B: Inspected> QueryBackend for Watched<B> {
    type Pass = B::Pass;

    fn name(&self) -> &'static str {
        self.backend.name()
    }

    fn can_block(&self) -> bool {
        self.backend.can_block()
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.forget();
        self.backend.begin(view)
    }

    fn begin_late(&mut self, view: &View, frames: u32) -> Result<Option<View>, Error> {
        self.forget();
        self.backend.begin_late(view, frames)
    }

    fn owns_depth(&self) -> bool {
        self.backend.owns_depth()
    }

    fn draw(&mut self, record: impl FnOnce(&mut B::Pass)) -> Result<(), Error> {
        self.backend.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        if let Some(log) = &mut self.log {
            let start = log.asked.len();
            log.asked.extend(boxes.iter().map(|proxy| Asked { proxy: *proxy, visible: None }));
            log.ranges.insert(ticket, start..log.asked.len());
        }
        self.backend.ask(ticket, boxes, want)
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

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.backend.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let log = &mut self.log;
        self.backend.answers(wait, |ticket, answer| {
            if let Some(log) = log
                && let Some(range) = log.ranges.get(&ticket)
            {
                // A sweep's boxes are not kept.
                log.asked[range.clone()]
                    .iter_mut()
                    .for_each(|asked| asked.visible = Some(answer.is_visible(0)));
            }
            deliver(ticket, answer);
        })
    }

    fn draw_time(&self) -> DrawTime {
        self.backend.draw_time()
    }

    fn device_times(&self, frame: u64) -> Option<DeviceTimes> {
        self.backend.device_times(frame)
    }

    fn end(&mut self) -> Result<(), Error> {
        let levels = self.pyramid.as_mut().map(|levels| self.backend.levels().map(|new| *levels = new));
        // The frame ends, whatever is to be looked at.
        self.backend.end().and(levels.unwrap_or(Ok(())))
    }
}
