//! Writing a recording, frame by frame.

use std::io::Write;

use super::Logged;
use super::chunk::{self, Digest, Frame, Header, RecordedView, failed};
use crate::geom::View;
use crate::policy::Policy;
use crate::scene::{ObjectRef, Scene, SceneConfig};
use crate::{Culler, Dial, Error};

/// Writes a recording of one view while an app runs; see [`record`](super) for how.
#[derive(Debug)]
pub struct Recorder<W: Write> {
    file: W,
    /// The frame that has begun.
    frame: Option<Frame>,
    frames: u32,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording, and the scene's tape. Hand in a buffered writer if `file` is a file.
    ///
    /// # Errors
    /// [`Error::Recording`] if something was done to the scene before, if the policy is a reference, which
    /// draws what it is given, and if the file cannot be written.
    pub fn new<P: Policy>(
        mut file: W,
        config: &SceneConfig,
        scene: &mut Scene,
        eye: &Culler<P>,
        about: &str,
    ) -> Result<Self, Error> {
        if !scene.is_pristine() {
            return Err(failed("it must begin before the first edit of the scene".to_owned()));
        }
        let policy = eye.policy();
        if policy.wants_recorded().is_some() {
            return Err(failed(format!(
                "policy {} draws what it is given, so there is nothing to replay: choose another",
                policy.name()
            )));
        }
        let texts =
            |dials: Vec<Dial>| dials.into_iter().map(|dial| (dial.key.to_owned(), dial.value)).collect();
        let header = Header {
            about: about.to_owned(),
            policy: policy.name().to_owned(),
            dials: texts(policy.dials()),
            tree: texts(config.tree.dials()),
            origin: config.origin,
            detects_cuts: eye.detects_cuts,
        };
        chunk::write_start(&mut file, &header)?;
        scene.start_tape();
        Ok(Self { file, frame: None, frames: 0 })
    }

    /// To be called just before [`Culler::frame`], with the same scene and view. O(edits since the last
    /// frame).
    pub fn begin<P>(&mut self, scene: &mut Scene, view: &View, eye: &Culler<P>) {
        self.frame = Some(Frame {
            edits: scene.take_tape(),
            view: RecordedView::new(view),
            tradeoff: eye.tradeoff,
            cut: eye.expects_cut(),
            costs: eye.costs(),
            log: super::log::Log::default(),
            drawn: Digest::default(),
        });
    }

    /// To be called after [`Culler::frame`], also after one in which waiting for answers failed. One that failed
    /// otherwise (its targets, its drawing) cannot be replayed: a player stops there. O(answers + objects drawn).
    ///
    /// # Errors
    /// [`Error::Recording`] if no frame has begun, if nobody listened to the backend, and if the file
    /// cannot be written.
    pub fn end<P, B>(&mut self, eye: &Culler<P>, queries: &mut Logged<B>) -> Result<(), Error> {
        let begun = self.frame.take();
        let mut frame = begun.ok_or_else(|| failed("a frame ends that has not begun".to_owned()))?;
        let log = queries.take();
        frame.log = log.ok_or_else(|| failed("nobody listens to the backend: see Logged".to_owned()))?;
        frame.drawn = Digest::of(eye.visible());
        self.frames += 1;
        chunk::write(&mut self.file, &frame)
    }

    /// Frames written so far.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Writes the end. Without it, players say that the file was cut short.
    ///
    /// # Errors
    /// [`Error::Recording`] if the file cannot be written.
    pub fn finish(mut self) -> Result<W, Error> {
        chunk::write_end(&mut self.file, self.frames)?;
        Ok(self.file)
    }
}

impl Digest {
    /// Of objects in the order of drawing.
    pub(super) fn of(drawn: &[ObjectRef]) -> Self {
        let mut hasher = crc32fast::Hasher::new();
        for object in drawn {
            hasher.update(&(object.id.slot() as u32).to_le_bytes());
            hasher.update(&object.id.generation().to_le_bytes());
        }
        Self { count: drawn.len() as u32, checksum: hasher.finalize() }
    }
}
