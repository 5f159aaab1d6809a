//! The GPU backend: exact answers from the app's own depth buffer, on wgpu.
//!
//! The app owns the device and the attachments ([`FrameTargets`]). Draws and questions are
//! recorded in the order in which they come and submitted once a wave, when answers are called
//! for; counts come back through a ring of buffers. No optional feature of the device is needed.
//!
//! Answers are those of the software backend, to the sample, but for samples within a rounding of
//! their threshold, which are counted as visible here (`pack.rs` has the bound). A target with
//! several samples a pixel counts them all.
//!
//! ```no_run
//! use tercet::Culler;
//! use tercet::geom::View;
//! use tercet::policy::DualQuery;
//! use tercet::query::gpu::{FrameTargets, GpuQueries};
//! use tercet::scene::Scene;
//!
//! fn frame(
//!     (device, queue): (&wgpu::Device, &wgpu::Queue),
//!     (color, depth): (wgpu::TextureView, wgpu::TextureView),
//!     (scene, view): (&Scene, &View),
//! ) -> Result<(), tercet::Error> {
//!     let mut eye = Culler::new(DualQuery::default()); // kept from frame to frame, as is
//!     let mut queries = GpuQueries::new(device, queue)?; // this
//!     let sky = wgpu::LoadOp::Clear(wgpu::Color::BLUE);
//!     queries.target(&FrameTargets::new(depth).with_color(color, sky));
//!     eye.frame(scene, view, &mut queries, |pass, objects| {
//!         // The app's own pipelines: state does not survive from one call to the next.
//!         objects.iter().for_each(|_object| pass.draw(0..3, 0..1));
//!     })?;
//!     Ok(())
//! }
//! ```
//!
//! | file | |
//! |---|---|
//! | `config`, `stats` | dials, and what is counted |
//! | `targets` | what the app draws into, and the passes on it |
//! | `questions`, `pack` | what was asked, as the shaders read it |
//! | `counter`, `bind` | the ways of counting, behind one door |
//! | `count_fragments`, `count_workgroups`, `gather_blocks`, `ask_natively` | one pass each |
//! | `rectangles` | the draw of all proxies, or of what is listed, that passes in fragment shaders share |
//! | `kept_depths` | depths of earlier frames, for late questions |
//! | `frame` | passes are recorded, submitted once a wave, and waited for |
//! | `batch`, `read_back` | buffers of a question pass, from upload to read-back |
//! | `sweep` | many objects at once, from their boxes to verdicts |
//! | `indirect` | frames that the device culls by itself |
//! | `clock` | what passes take, by the device's own clock |
//! | `shaders` | sources; the files are in `shaders/` |
//! | `guard` | what the device reports, as errors instead of panics |
//!
//! # Failures
//!
//! A device that is lost, reports an error, or does not answer within [`GpuConfig::timeout`]: all
//! open questions are answered [`Answer::Unknown`], which draws, and the call returns
//! [`Error::Device`]. Nothing waits longer than that.
//!
//! # OpenGL
//!
//! wgpu emulates the depth range there, so that small depths are stored coarsely; proxies are
//! brought nearer by as much (`pack.rs`), and with reversed z the farthest things are not culled.
//! Multisampled depth is refused: wgpu 30 cannot make a texture of it that can be read.

mod ask_natively;
mod batch;
mod bind;
mod clock;
mod config;
mod count_fragments;
mod count_workgroups;
mod counter;
mod frame;
mod gather_blocks;
mod guard;
mod indirect;
mod kept_depths;
mod pack;
mod questions;
mod read_back;
mod rectangles;
mod shaders;
mod stats;
mod sweep;
mod targets;

use wgpu::{
    Adapter, Backend, Buffer, BufferDescriptor, BufferUsages, Device, Features, Queue, RenderPass,
    TextureView,
};

/// The wgpu that this backend speaks.
pub use wgpu;

pub use config::{AnyBy, GpuConfig};
pub use counter::Counting;
pub use indirect::{BatchMesh, IndirectBatch, IndirectConfig, IndirectCuller, IndirectStats};
pub use shaders::{Shader, Shaders};
pub use stats::GpuStats;
pub use sweep::Level;
pub(crate) use sweep::mirror::Mirrored;
pub use targets::{ColorTarget, DepthTarget, FrameTargets};

use super::{Answer, DeviceTimes, DrawTime, QueryBackend, Sweep, Ticket, Wait, Want};
use crate::Error;
use crate::geom::{Proxy, View};
use ask_natively::AskNatively;
use batch::Batch;
use clock::{Clock, Times};
use counter::Counters;
use frame::Frame;
use kept_depths::KeptDepths;
use pack::{EMULATED_RANGE, PackedFrame};
use questions::Questions;
use sweep::answer::Sweeps;

/// The GPU backend: it draws into the app's attachments and asks about what is there.
///
/// Draws of one wave are submitted together; those of the whole frame, if questions are late. So what
/// `Queue::write_buffer` writes during a draw is there for all of these draws: data that differs between calls
/// of the closure needs a place for each.
#[derive(Debug)]
pub struct GpuQueries {
    device: Device,
    queue: Queue,
    config: GpuConfig,
    backend: Backend,
    slack: f32,
    /// For targets with one sample a pixel and with several.
    counters: [Option<Counters>; 2],
    native: Option<AskNatively>,
    clock: Option<Clock>,
    uniforms: Buffer,
    targets: Option<FrameTargets>,
    /// The app's item buffer, if it has one.
    ids: Option<TextureView>,
    frame: Option<Frame>,
    /// Asked and not yet recorded.
    open: Questions,
    batches: Vec<Batch>,
    kept: KeptDepths,
    sweeps: Option<Sweeps>,
    stats: GpuStats,
}

impl GpuQueries {
    /// A backend on the app's device, whose handles it clones.
    ///
    /// # Errors
    /// [`Error::Device`] if the device has no storage buffers in shaders, or refuses ours.
    pub fn new(device: &Device, queue: &Queue) -> Result<Self, Error> {
        Self::with_config(device, queue, GpuConfig::default())
    }

    /// The same with other dials.
    ///
    /// # Errors
    /// As [`GpuQueries::new`]; also if the device does not support the way of counting.
    pub fn with_config(device: &Device, queue: &Queue, config: GpuConfig) -> Result<Self, Error> {
        let backend = device.adapter_info().backend;
        let api_slack = if backend == Backend::Gl { EMULATED_RANGE } else { 0.0 };
        let slack = config.depth_slack.unwrap_or(api_slack);
        let counters = Counters::new(device, config.counting, &config.shaders, false)?;
        let native = (config.any == AnyBy::Native)
            .then(|| {
                guard::guarded(device, || {
                    AskNatively::new(device, counter::compiled(device, &config.shaders.ask_natively))
                })
            })
            .transpose()?;
        let uniforms = guard::guarded(device, || {
            device.create_buffer(&BufferDescriptor {
                label: Some("tercet frame"),
                size: size_of::<PackedFrame>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })?;
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            config,
            backend,
            slack,
            counters: [Some(counters), None],
            native,
            clock: guard::guarded(device, || Clock::new(device, queue))?,
            uniforms,
            targets: None,
            ids: None,
            frame: None,
            open: Questions::default(),
            batches: Vec::new(),
            kept: KeptDepths::default(),
            sweeps: None,
            stats: GpuStats::default(),
        })
    }

    /// The optional features that a device should be asked for, of those that the adapter has.
    /// Without them everything works, but for the times in [`GpuStats`]; what
    /// [`Counting::Subgroups`] would count, [`Counting::Workgroups`] does.
    pub fn wanted_features(adapter: &Adapter) -> Features {
        adapter.features() & (Features::TIMESTAMP_QUERY | Features::SUBGROUP)
    }

    /// Says what the next frames draw into. They are checked when a frame begins.
    pub fn target(&mut self, targets: &FrameTargets) {
        self.targets = Some(targets.clone());
    }

    /// Says where the next frames' *item buffer* is, if there is one: a texture of Rg16Uint or R32Uint,
    /// with as many samples a pixel as the depth, in which each sample that somebody owns has one more
    /// than the object's [slot](crate::scene::ObjectId::slot), and all others 0. Of Rg16Uint the first
    /// channel has the lower 16 bits. (R32Uint has one sample a pixel on most devices.)
    ///
    /// The app writes it while it draws: it is one of its colour attachments, cleared with 0. So
    /// [`SweepTest::Owners`](super::SweepTest::Owners) is answered without drawing anything twice; of
    /// several objects at the same depth the one that was drawn last owns the sample. Without an item
    /// buffer the answer is [`Answer::Unknown`]. It is checked when a frame begins.
    pub fn target_ids(&mut self, ids: Option<&TextureView>) {
        self.ids = ids.cloned();
    }

    /// Counters since the frame began, and times of an earlier one.
    pub fn stats(&self) -> GpuStats {
        let times = self.clock.as_ref().and_then(Clock::times);
        GpuStats {
            draw_time: times.map(|times| times.draw),
            awaited_draw_time: times.map(|times| times.awaited_draw),
            question_time: times.map(|times| times.question),
            ..self.stats
        }
    }

    /// Everything that is open will not be answered.
    fn deliver_unknown(&mut self, deliver: &mut impl FnMut(Ticket, Answer<'_>)) {
        self.batches.iter().for_each(|batch| batch.questions.deliver(None, deliver));
        self.open.deliver(None, deliver);
        self.forget();
    }

    /// Whether the frame's questions see an earlier depth.
    fn is_late(&self) -> bool {
        self.frame.as_ref().is_some_and(|frame| frame.is_late)
    }

    /// What the device drew of a frame.
    fn drawing(&self, Times { draw, awaited_draw, .. }: Times) -> DeviceTimes {
        // Late questions wait for what the last frame drew, and for nothing else.
        DeviceTimes { total: draw, awaited: if self.is_late() { draw } else { awaited_draw } }
    }

    /// Forgets the last frame.
    fn restart(&mut self) {
        self.forget();
        self.sweeps.iter_mut().for_each(Sweeps::restart);
        self.frame = None;
        self.stats = GpuStats::default();
    }

    /// Forgets all questions.
    fn forget(&mut self) {
        self.open.clear();
        self.batches.iter_mut().for_each(Batch::forget);
        self.batches.retain(|batch| batch.state() != batch::State::Lost);
        self.sweeps.iter_mut().for_each(Sweeps::forget);
    }
}

impl QueryBackend for GpuQueries {
    type Pass = RenderPass<'static>;

    fn name(&self) -> &'static str {
        "wgpu"
    }

    fn can_block(&self) -> bool {
        !cfg!(target_arch = "wasm32")
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.kept.clear();
        self.restart();
        self.begin_frame(view, 0).map(drop)
    }

    fn begin_late(&mut self, view: &View, frames: u32) -> Result<Option<View>, Error> {
        if self.frame.is_some() {
            // It never ended, and left no depth: who counts frames would miss it.
            self.kept.clear();
        }
        self.restart();
        self.begin_frame(view, frames as usize).inspect_err(|_| self.kept.clear())
    }

    fn draw(&mut self, record: impl FnOnce(&mut RenderPass<'static>)) -> Result<(), Error> {
        // What was asked before must not see what is drawn now. Late questions cannot.
        if !self.is_late() {
            self.record_questions()?;
        }
        record(&mut self.open_pass()?);
        Ok(())
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        let frame = self.frame.as_ref().ok_or_else(frame::not_begun)?;
        self.open.ask(ticket, boxes, want, &frame.terms);
        self.stats.boxes += boxes.len() as u64;
        Ok(())
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.record_sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let result = self.bring_answers(wait);
        for batch in &mut self.batches {
            let arrived = batch.read(|counts| batch.questions.deliver(Some(counts), &mut deliver));
            if arrived.is_some() {
                batch.forget();
            }
        }
        if let Some(sweeps) = &mut self.sweeps {
            sweeps.deliver(result.is_err(), &mut deliver);
        }
        if result.is_err() {
            self.deliver_unknown(&mut deliver);
        }
        result
    }

    fn draw_time(&self) -> DrawTime {
        let Some(clock) = &self.clock else { return DrawTime::Unknown };
        clock.times().map_or(DrawTime::Unknown, |times| DrawTime::Device {
            times: self.drawing(times),
            now: clock.now(),
        })
    }

    fn device_times(&self, frame: u64) -> Option<DeviceTimes> {
        self.clock.as_ref()?.times_of(frame).map(|times| self.drawing(times))
    }

    fn end(&mut self) -> Result<(), Error> {
        let result = self.finish_frame();
        if result.is_err() {
            // Nobody knows what the copy holds.
            self.kept.clear();
        }
        self.forget();
        self.frame = None;
        result
    }
}
