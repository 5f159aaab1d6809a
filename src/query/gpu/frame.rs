//! One frame: passes are recorded, submitted once a wave, and waited for.

use std::time::Instant;

use bytemuck::bytes_of;
use wgpu::{
    Backend, BindGroup, CommandEncoder, CommandEncoderDescriptor, Device, RenderPass, SubmissionIndex,
    TextureView,
};

use super::ask_natively::{self, AskNatively};
use super::batch::{Batch, State};
use super::bind;
use super::clock::{Clock, Tape};
use super::counter::Counters;
use super::kept_depths::can_be_kept;
use super::pack::PackedFrame;
use super::questions::Terms;
use super::sweep::answer::Sweeps;
use super::sweep::owners;
use super::targets::{FrameTargets, Kind};
use super::{GpuConfig, GpuQueries, guard};
use crate::Error;
use crate::geom::View;
use crate::query::Wait;

/// What lives from `begin` to `end`.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) view: View,
    pub(super) targets: FrameTargets,
    /// The app's item buffer, if it has one.
    pub(super) ids: Option<TextureView>,
    pub(super) terms: Terms,
    bindings: BindGroup,
    /// The same for native queries, if there are any.
    native_bindings: Option<BindGroup>,
    /// Whether questions see an earlier depth.
    pub(super) is_late: bool,
    /// How many depths are kept, this one's among them.
    keeps: usize,
    /// What was recorded since the last submission.
    pub(super) encoder: Option<CommandEncoder>,
    /// The same of late questions, which wait for none of this frame's draws.
    late: Option<CommandEncoder>,
    /// Whether a pass has cleared the attachments, or loaded them for the first time.
    opened: bool,
    pub(super) last_submission: Option<SubmissionIndex>,
}

impl GpuQueries {
    /// Begins a frame whose questions see the depth of so many frames ago, 0 for its own; returns the view
    /// of that frame, if there is such a depth.
    pub(super) fn begin_frame(&mut self, view: &View, late: usize) -> Result<Option<View>, Error> {
        let Some(targets) = self.targets.clone() else {
            return Err(Error::Target { why: "there are none: call GpuQueries::target first".into() });
        };
        targets.check(view, self.backend)?;
        let ids = self.ids.clone();
        if let Some(ids) = &ids {
            owners::check(ids, view.viewport(), view.samples())?;
        }
        // Native queries see what is attached. OpenGL's emulation copies no depth.
        let can_be_late = self.native.is_none() && self.backend != Backend::Gl;
        let keeps = if can_be_late && can_be_kept(targets.depth.view.texture()) { late } else { 0 };
        let past = if keeps > 0 { self.kept.ago(late, view, &targets) } else { None };
        let depth = past.map_or(targets.readable_depth(), |past| &past.readable);
        let several = view.samples() > 1;
        let counters = match &mut self.counters[usize::from(several)] {
            Some(counters) => counters,
            none => {
                let GpuConfig { counting, shaders, .. } = &self.config;
                none.insert(Counters::new(&self.device, *counting, shaders, several)?)
            }
        };
        counters.depth_changed();
        self.clock.iter_mut().for_each(Clock::begin_frame);
        let (bindings, native_bindings) = guard::guarded(&self.device, || {
            self.queue.write_buffer(&self.uniforms, 0, bytes_of(&PackedFrame::new(view)));
            let bind =
                |pass: &AskNatively| bind::frame(&self.device, &pass.layouts.frame, &self.uniforms, None);
            let counting = counters.bind_frame(&self.device, &self.uniforms, depth);
            (counting, self.native.as_ref().map(bind))
        })?;
        let native_slack = self.native.as_ref().map(|_| ask_natively::slack(view.format()));
        let past = past.map(|past| past.view.clone());
        self.frame = Some(Frame {
            is_late: past.is_some(),
            keeps,
            late: None,
            view: view.clone(),
            targets,
            ids,
            terms: Terms::new(view, self.slack, native_slack, &self.device.limits()),
            bindings,
            native_bindings,
            encoder: None,
            opened: false,
            last_submission: None,
        });
        Ok(past)
    }

    /// A pass on the app's attachments.
    pub(super) fn open_pass(&mut self) -> Result<RenderPass<'static>, Error> {
        self.stats.draw_passes += 1;
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        if !frame.is_late {
            self.counters.iter_mut().flatten().for_each(Counters::depth_changed);
        }
        Ok(frame.pass(&self.device, &mut self.clock, false))
    }

    /// Sees to it that the attachments have been cleared, or loaded.
    pub(super) fn open_first(&mut self) -> Result<(), Error> {
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        if !frame.opened {
            drop(frame.pass(&self.device, &mut self.clock, false));
        }
        Ok(())
    }

    /// Records the counting of all questions that are open.
    pub(super) fn record_questions(&mut self) -> Result<(), Error> {
        if self.open.asked.is_empty() {
            return Ok(());
        }
        if !self.is_late() {
            self.open_first()?;
        }
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        let counters = self.counters[usize::from(frame.view.samples() > 1)].as_mut();
        let counters = counters.expect("they were made when the frame began");
        self.stats.question_passes += 1;
        guard::guarded(&self.device, || {
            let batch = free(&mut self.batches, &self.device);
            batch.load(&self.device, &self.queue, &mut self.open);
            let viewport = frame.view.viewport();
            // The clock follows what is drawn, and is read when that is submitted.
            let (encoder, clock) = match frame.is_late {
                true => (&mut frame.late, &mut None),
                false => (&mut frame.encoder, &mut self.clock),
            };
            let mut tape = tape(encoder, &self.device, clock);
            counters.record(&mut tape, &frame.bindings, batch, viewport);
            let native = self.native.as_mut().filter(|_| !batch.questions.queries.is_empty());
            if let (Some(native), Some(bindings)) = (native, &frame.native_bindings) {
                let depth = &frame.targets.depth.view;
                native.record(&mut tape, bindings, batch, (&frame.view, depth));
            }
        })
    }

    /// Submits what was asked and looks, or waits, for what has arrived.
    pub(super) fn bring_answers(&mut self, wait: Wait) -> Result<(), Error> {
        self.record_questions()?;
        if self.awaits(State::Recorded) {
            // Late questions go by themselves: then nobody waits for what was drawn. Sweeps see it.
            let sweeps = self.sweeps.as_ref().is_some_and(|sweeps| sweeps.any(State::Recorded));
            let frame = self.frame.as_mut().ok_or_else(not_begun)?;
            match frame.late.take() {
                Some(late) if !sweeps => self.submit_recorded(None, Some(late))?,
                late => {
                    let drawn = frame.encoder.take();
                    self.submit_recorded(drawn, late)?;
                }
            }
        }
        match wait {
            Wait::Poll => guard::poll(&self.device)?,
            Wait::Block => self.block()?,
        }
        if self.awaits(State::Lost) {
            return Err(guard::failed("counts could not be read back"));
        }
        Ok(())
    }

    /// The last pass: what must be cleared, although nothing was drawn, and what must be resolved.
    pub(super) fn finish_frame(&mut self) -> Result<(), Error> {
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        if !frame.opened || frame.targets.resolves() {
            drop(frame.pass(&self.device, &mut self.clock, true));
        }
        if frame.keeps > 0 {
            let depth = (&frame.view, frame.targets.depth.view.texture());
            let tape = tape(&mut frame.encoder, &self.device, &mut self.clock);
            guard::guarded(&self.device, || self.kept.keep(&self.device, tape.encoder, depth, frame.keeps))?;
        }
        self.submit()
    }

    /// Submits what was recorded since the last time.
    pub(super) fn submit(&mut self) -> Result<(), Error> {
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        let (drawn, late) = (frame.encoder.take(), frame.late.take());
        self.submit_recorded(drawn, late)
    }

    /// Submits what was drawn, and late questions.
    fn submit_recorded(
        &mut self,
        drawn: Option<CommandEncoder>,
        late: Option<CommandEncoder>,
    ) -> Result<(), Error> {
        let frame = self.frame.as_mut().ok_or_else(not_begun)?;
        let is_timed = drawn.is_some();
        if !is_timed && late.is_none() {
            return Ok(());
        }
        self.stats.submits += 1;
        // The app's own mistakes in a pass come to light when its recording is finished.
        let finish = |encoder: CommandEncoder| guard::guarded(&self.device, || encoder.finish());
        let finished: Result<Vec<_>, Error> = drawn.into_iter().chain(late).map(finish).collect();
        let submitted = finished.and_then(|commands| {
            guard::guarded(&self.device, || {
                let index = self.queue.submit(commands);
                let recorded = self.batches.iter().filter(|batch| batch.state() == State::Recorded);
                recorded.for_each(Batch::await_results);
                self.sweeps.iter().for_each(Sweeps::submitted);
                self.clock.iter_mut().filter(|_| is_timed).for_each(Clock::submitted);
                index
            })
        });
        if submitted.is_err() {
            self.clock.iter_mut().filter(|_| is_timed).for_each(Clock::dropped);
        }
        frame.last_submission = Some(submitted?);
        Ok(())
    }

    /// Waits until every batch that was submitted has arrived.
    fn block(&mut self) -> Result<(), Error> {
        let frame = self.frame.as_ref().ok_or_else(not_begun)?;
        let Some(index) = &frame.last_submission else { return Ok(()) };
        let deadline = Instant::now() + self.config.timeout;
        while self.awaits(State::Submitted) {
            let left = deadline.saturating_duration_since(Instant::now());
            guard::wait(&self.device, index.clone(), left)?;
            // Another thread that polls the device may still be about to say that they arrived.
            if left.is_zero() && self.awaits(State::Submitted) {
                return Err(guard::failed(format!("no answer in {:?}", self.config.timeout)));
            }
        }
        Ok(())
    }

    /// Whether answers that somebody waits for have got so far.
    fn awaits(&self, state: State) -> bool {
        let is_awaited = |batch: &Batch| batch.state() == state && !batch.questions.asked.is_empty();
        self.batches.iter().any(is_awaited) || self.sweeps.as_ref().is_some_and(|sweeps| sweeps.any(state))
    }
}

impl Frame {
    fn pass(&mut self, device: &Device, clock: &mut Option<Clock>, last: bool) -> RenderPass<'static> {
        let first = !std::mem::replace(&mut self.opened, true);
        let mut tape = tape(&mut self.encoder, device, clock);
        self.targets.pass(&mut tape, &self.view, Kind { first, last })
    }
}

/// A batch that nobody uses.
fn free<'a>(batches: &'a mut Vec<Batch>, device: &Device) -> &'a mut Batch {
    let found = batches.iter_mut().position(|batch| batch.reclaim());
    let index = found.unwrap_or(batches.len());
    if found.is_none() {
        batches.push(Batch::new(device));
    }
    &mut batches[index]
}

/// What was recorded since the last submission, to be recorded on.
pub(super) fn tape<'a>(
    encoder: &'a mut Option<CommandEncoder>,
    device: &'a Device,
    clock: &'a mut Option<Clock>,
) -> Tape<'a> {
    let mut clock = clock.as_mut();
    let encoder = encoder.get_or_insert_with(|| {
        let descriptor = CommandEncoderDescriptor { label: Some("tercet") };
        let mut encoder = device.create_command_encoder(&descriptor);
        if let Some(clock) = &mut clock {
            clock.read_back(device, &mut encoder);
        }
        encoder
    });
    Tape { device, encoder, clock }
}

pub(super) fn not_begun() -> Error {
    Error::Target { why: "no frame has begun".into() }
}
