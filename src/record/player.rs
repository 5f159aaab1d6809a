//! Living through a recording again.

use std::collections::VecDeque;
use std::io::Read;

use super::chunk::{self, Digest, Frame, Header, RecordedView, failed};
use super::log::{Asked, Delivery};
use crate::geom::{Proxy, View};
use crate::policy::{self, Gated, Policy};
use crate::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use crate::scene::{Scene, SceneConfig};
use crate::tree::TreeConfig;
use crate::{Culler, Dial, Error, FrameStats};

/// The dial of a policy that is behind a gate.
const GATE: &str = "gate";

/// A frame that was lived through again.
#[derive(Clone, Debug)]
pub struct Played {
    /// Its number, from 0.
    pub number: u32,
    /// What was seen.
    pub view: View,
    /// What the frame did. Times are those of this machine, now.
    pub stats: FrameStats,
    /// What the backend had reported, if the frame failed; its figures are zeros then.
    pub error: Option<String>,
}

/// Goes through a recording frame by frame. Its scene and its view's culler are as those of the app were.
pub struct Player<R: Read> {
    file: R,
    header: Header,
    scene: Scene,
    eye: Culler<Box<dyn Policy>>,
    backend: Replay,
    frames: u32,
    is_over: bool,
}

impl<R: Read> Player<R> {
    /// Opens a recording. Hand in a buffered reader if `file` is a file.
    ///
    /// # Errors
    /// [`Error::Recording`] if it is none, of another version, or damaged; and if there is no such policy
    /// or dial any more.
    pub fn new(mut file: R) -> Result<Self, Error> {
        let header = chunk::read_start(&mut file)?;
        let mut tree = TreeConfig::default();
        header.tree.iter().try_for_each(|(key, value)| tree.set(key, value)).map_err(unknown)?;
        let mut policy = policy::by_name(&header.policy).map_err(unknown)?;
        let has = |dials: Vec<Dial>| dials.iter().any(|dial| dial.key == GATE);
        if header.dials.iter().any(|(key, _)| key == GATE) && !has(policy.dials()) {
            policy = Box::new(Gated::new(policy));
        }
        header.dials.iter().try_for_each(|(key, value)| policy.set(key, value)).map_err(unknown)?;
        let mut eye = Culler::new(policy);
        eye.detects_cuts = header.detects_cuts;
        let scene = Scene::new(SceneConfig { tree, origin: header.origin });
        let backend = Replay::default();
        Ok(Self { file, header, scene, eye, backend, frames: 0, is_over: false })
    }

    /// What the recording is of.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The scene, as it was at the frame that was played last.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The view's culler, as it was after the frame that was played last.
    pub fn eye(&self) -> &Culler<Box<dyn Policy>> {
        &self.eye
    }

    /// Plays the next frame; None after the last. O(what the frame did), without drawing.
    ///
    /// # Errors
    /// [`Error::Recording`] if the file is damaged or cut short here, and if the frame draws or asks
    /// otherwise than it did when it was recorded: then another engine replays than the one that recorded.
    /// Nothing can be played after that.
    pub fn next_frame(&mut self) -> Result<Option<Played>, Error> {
        if self.is_over {
            return Ok(None);
        }
        // Whatever goes wrong, there is nothing to go on from.
        self.is_over = true;
        let number = self.frames;
        let Some(frame) = chunk::read::<Frame>(&mut self.file, &format!("frame {number}"))? else {
            let frames = chunk::read_end(&mut self.file)?;
            return if frames == number {
                Ok(None)
            } else {
                Err(failed(format!("it has {number} frames and claims to have {frames}")))
            };
        };
        let played = self.play(number, frame)?;
        self.is_over = false;
        self.frames += 1;
        Ok(Some(played))
    }

    fn play(&mut self, number: u32, frame: Frame) -> Result<Played, Error> {
        let Self { scene, eye, backend, .. } = self;
        for edit in &frame.edits {
            scene.redo(edit, &mut [&mut *eye]);
        }
        if !frame.log.deliveries.iter().all(|delivery| delivery.is_about(scene)) {
            return Err(failed(format!("frame {number} was answered about objects that were never there")));
        }
        let view = frame.view.view()?;
        eye.tradeoff = frame.tradeoff;
        if frame.cut {
            eye.cut();
        }
        eye.set_costs(frame.costs);
        // Time ran out then after so many questions. Now it may not.
        if eye.tradeoff.budget.time.take().is_some() {
            eye.tradeoff.budget.queries = Some(frame.log.asked.questions);
        }
        backend.asked = Asked::default();
        backend.owns_depth = frame.log.owns_depth;
        backend.draws_if_seen = frame.log.draws_if_seen;
        backend.past = frame.log.past.as_ref().map(RecordedView::view).transpose()?;
        backend.deliveries = frame.log.deliveries.into();
        let (stats, error) = match eye.frame(scene, &view, backend, |(), _| {}) {
            Ok(stats) => (stats, None),
            Err(Error::Device { why }) => (FrameStats::default(), Some(why)),
            Err(error) => return Err(error),
        };
        let differs = |what: &str, before: u32, now: u32| {
            failed(format!(
                "frame {number} {what} {now} instead of {before}: the engine that replays is not the one that \
                 recorded"
            ))
        };
        let drawn = Digest::of(eye.visible());
        if drawn.count != frame.drawn.count {
            return Err(differs("draws as many objects as", frame.drawn.count, drawn.count));
        }
        if drawn != frame.drawn {
            return Err(differs("draws others: their checksum is", frame.drawn.checksum, drawn.checksum));
        }
        if backend.asked != frame.log.asked {
            return Err(differs("asks about as many boxes as", frame.log.asked.boxes, backend.asked.boxes));
        }
        Ok(Played { number, view, stats, error })
    }
}

fn unknown(error: Error) -> Error {
    failed(format!("it needs what this engine has not: {error}"))
}

/// Draws nothing, and answers what was answered before.
#[derive(Debug, Default)]
struct Replay {
    owns_depth: bool,
    draws_if_seen: bool,
    past: Option<View>,
    asked: Asked,
    deliveries: VecDeque<Delivery>,
}

impl QueryBackend for Replay {
    type Pass = ();

    fn name(&self) -> &'static str {
        "replay"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, _: &View) -> Result<(), Error> {
        Ok(())
    }

    fn begin_late(&mut self, _: &View, _: u32) -> Result<Option<View>, Error> {
        Ok(self.past.take())
    }

    fn owns_depth(&self) -> bool {
        self.owns_depth
    }

    fn draws_if_seen(&self) -> bool {
        self.draws_if_seen
    }

    fn draw(&mut self, record: impl FnOnce(&mut ())) -> Result<(), Error> {
        record(&mut ());
        Ok(())
    }

    fn ask(&mut self, _: Ticket, boxes: &[Proxy], _: Want) -> Result<(), Error> {
        self.asked.count(boxes.len());
        Ok(())
    }

    fn sweep(&mut self, _: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.asked.count(sweep.groups.len() + sweep.loose.len());
        Ok(())
    }

    fn answers(&mut self, _: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let Some(Delivery { answers, error }) = self.deliveries.pop_front() else { return Ok(()) };
        answers.iter().for_each(|(ticket, kept)| kept.deliver(Ticket(*ticket), &mut deliver));
        error.map_or(Ok(()), |why| Err(Error::Device { why }))
    }

    fn end(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
