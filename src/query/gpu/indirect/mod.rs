//! Frames that the device culls by itself: the host uploads what has moved and records the same
//! commands every frame, and nothing is read back.
//!
//! ```text
//!   project ─▶ first: what the last frame found visible ─▶ draw ─▶ test all against that depth
//!          ─▶ missed: found, and not drawn yet ─▶ draw ─▶ last: what hides nothing ─▶ draw
//! ```
//!
//! An object that is not drawn has no sample in sight of depth that real objects of *this* frame have
//! left: nothing visible is lost, whatever was remembered, after a camera's cut as well. What is
//! remembered only decides what is drawn first. (Lee et al. 2021 test against the same depth; there, as
//! here, an object that is tested hides itself from no one.)
//!
//! The app says what each [`Batch`](crate::scene::Batch) draws, and gets for each a buffer of object
//! slots, as instances, with the arguments of an indirect draw: one draw a mesh, in the same order of
//! objects from frame to frame. [`draw::BySlot`](crate::draw::BySlot) is what the reference renderer draws
//! them from. No optional feature is needed: no first instance, no count.
//!
//! With an item buffer ([`IndirectCuller::target_ids`]) who was drawn and owns no sample is not drawn first again.
//!
//! By [`SweepTest::Rays`] objects are tested as HROC does: what was drawn first tells which subtrees hold
//! none of it, and rays go down these. The same are found as by [`SweepTest::Raster`].
//!
//! | file | |
//! |---|---|
//! | `config`, `draws` | dials, and what the app draws |
//! | `filter` | occluder filtering, by an item buffer |
//! | `groups` | occludee groups, and rays |
//! | `order` | objects by mesh, and meshes by batch |
//! | `select` | which objects a list holds: a prefix sum |
//! | `compact` | instances and arguments |

mod compact;
mod config;
mod draws;
mod filter;
mod groups;
mod order;
mod select;

use bytemuck::bytes_of;
use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoder, Device, Queue, RenderPass, TextureView};

pub use config::IndirectConfig;
pub use draws::{BatchMesh, IndirectBatch};

use super::clock::Tape;
use super::counter::compiled;
use super::guard::guarded;
use super::pack::{EMULATED_RANGE, PackedFrame};
use super::read_back::{ReadBack, State};
use super::rectangles::List;
use super::sweep::array::exactly;
use super::sweep::asked::Asked;
use super::sweep::boxes::{self, PackedBox};
use super::sweep::mirror::Mirrored;
use super::sweep::view::PackedView;
use super::sweep::{Bound, Passes};
use super::targets::{FrameTargets, Kind};
use crate::Error;
use crate::geom::View;
use crate::query::SweepTest;
use crate::scene::Scene;
use compact::{ARGUMENTS, Compact, Instances, Parts};
use filter::Filter;
use groups::Groups;
use order::Order;
use select::{Select, Source, Which};

/// What a frame came to, as far as the host knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IndirectStats {
    /// Objects that could be drawn.
    pub objects: u32,
    /// Bytes of boxes, meshes and their order that were uploaded: of what has changed.
    pub uploaded: u64,
    /// Of an earlier frame, if counters are asked for: objects drawn because the last frame had found
    /// them visible, because this one has, and of those that hide nothing.
    pub drawn: Option<[u32; 3]>,
    /// The same of what was looked at closely where tests are by rays: groups, and objects by themselves.
    pub tested: Option<[u32; 2]>,
}

/// A view that the device culls: passes, buffers, and what was visible in the last frame.
///
/// ```no_run
/// use tercet::geom::View;
/// use tercet::query::gpu::{BatchMesh, FrameTargets, IndirectConfig, IndirectCuller, wgpu};
/// use tercet::scene::Scene;
///
/// fn frame(
///     (device, queue, eye): (&wgpu::Device, &wgpu::Queue, &mut IndirectCuller),
///     (scene, view, targets): (&Scene, &View, &FrameTargets),
///     (meshes, pipeline): (&[BatchMesh], &wgpu::RenderPipeline),
/// ) -> Result<(), tercet::Error> {
///     let mut encoder = device.create_command_encoder(&Default::default());
///     eye.frame(scene, view, targets, meshes, &mut encoder, |pass, batches| {
///         pass.set_pipeline(pipeline); // and the app's vertices, indices and transforms by slot
///         batches.iter().for_each(|batch| batch.draw(pass, 1));
///     })?;
///     queue.submit([encoder.finish()]);
///     Ok(())
/// }
/// ```
#[derive(Debug)]
pub struct IndirectCuller {
    device: Device,
    queue: Queue,
    config: IndirectConfig,
    slack: f32,
    /// For targets with one sample a pixel and with several.
    passes: [Option<Passes>; 2],
    select: Select,
    compact: Compact,
    view: Buffer,
    uniforms: Buffer,
    boxes: Mirrored<PackedBox>,
    scratch: Vec<PackedBox>,
    order: Order,
    asked: Asked,
    /// Those of them that must be looked at closely.
    open: List,
    /// For tests by rays; then nothing else is asked.
    groups: Option<Groups>,
    /// By slot, across frames.
    remembered: Buffer,
    lists: [Instances; 3],
    /// The app's item buffer, if it has one, and what looks through it.
    ids: Option<TextureView>,
    filter: Option<Filter>,
    counters: Option<ReadBack>,
    counted: Option<[u32; 5]>,
}

impl IndirectCuller {
    /// A view on the app's device, whose handles it clones.
    ///
    /// # Errors
    /// [`Error::Device`] if the device lacks compute shaders or storage buffers, or refuses ours.
    pub fn new(device: &Device, queue: &Queue, config: IndirectConfig) -> Result<Self, Error> {
        // Refused here rather than in the first frame.
        let single = Passes::new(device, &config.shaders, false)?;
        let emulated = device.adapter_info().backend == wgpu::Backend::Gl;
        let slack = config.depth_slack.unwrap_or(if emulated { EMULATED_RANGE } else { 0.0 });
        guarded(device, || {
            let uniform = |label, size: usize| {
                device.create_buffer(&BufferDescriptor {
                    label: Some(label),
                    size: size as u64,
                    usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            };
            Self {
                device: device.clone(),
                queue: queue.clone(),
                slack,
                passes: [Some(single), None],
                select: Select::new(device, &compiled(device, &config.shaders.select)),
                compact: Compact::new(device, &compiled(device, &config.shaders.compact)),
                view: uniform("tercet view", size_of::<PackedView>()),
                uniforms: uniform("tercet frame", size_of::<PackedFrame>()),
                boxes: Mirrored::new(device, "tercet boxes"),
                scratch: Vec::new(),
                order: Order::new(device),
                asked: Asked::new(device),
                open: List::new(device),
                groups: (config.test == SweepTest::Rays).then(|| Groups::new(device, &config.shaders)),
                remembered: remembered(device, 64),
                lists: std::array::from_fn(|_| Instances::new(device, 64, 16)),
                ids: None,
                filter: None,
                counters: config.counters.then(|| ReadBack::new(device, COUNTERS)),
                counted: None,
                config,
            }
        })
    }

    /// Records one frame of a scene, without what is hidden.
    ///
    /// `draw` is called two or three times, each for a pass of its own on the targets: no state
    /// survives from one call to the next. Each call gets the same batches, in the order of their
    /// numbers, with other objects. Objects that are no occluders come in the last call. `meshes` says
    /// what each [`Batch`](crate::scene::Batch) draws, by its number.
    ///
    /// The commands must be submitted before the next frame of this view is recorded. Nothing is
    /// submitted here, and nothing is waited for. O(slots) on the host: a comparison with what the
    /// device has.
    ///
    /// # Errors
    /// [`Error::PendingEdits`] if the scene was edited since its last update; [`Error::Target`] for
    /// targets that cannot be used; [`Error::Batch`] for an object without a mesh; [`Error::Device`]
    /// for more objects than the device's buffers hold, and what it reports.
    pub fn frame(
        &mut self,
        scene: &Scene,
        view: &View,
        targets: &FrameTargets,
        meshes: &[BatchMesh],
        encoder: &mut CommandEncoder,
        mut draw: impl FnMut(&mut RenderPass<'static>, &[IndirectBatch<'_>]),
    ) -> Result<IndirectStats, Error> {
        scene.check_updated()?;
        targets.check(view, self.device.adapter_info().backend)?;
        self.check_ids(view)?;
        let device = self.device.clone();
        guarded(&device, || {
            self.take_counters();
            let uploaded = self.upload(scene, view, meshes)?;
            let bound = self.bind(view, targets.readable_depth())?;
            let mut tape = Tape { device: &device, encoder, clock: None };
            self.record_proxies(&mut tape, &bound, view);
            let has_last = self.order.has_late() || targets.resolves();
            for (which, is_wanted) in Which::ALL.into_iter().zip([true, true, has_last]) {
                if which == Which::Missed {
                    self.record_test(&mut tape, &bound, view);
                }
                if is_wanted {
                    self.record_list(&mut tape, which);
                    let kind = Kind { first: which == Which::First, last: which == Which::Last };
                    let mut pass = targets.pass(&mut tape, view, kind);
                    draw(&mut pass, &self.batches(which));
                }
            }
            self.record_filter(&mut tape, view)?;
            Ok(self.stats(uploaded))
        })?
    }

    fn stats(&self, uploaded: u64) -> IndirectStats {
        IndirectStats {
            objects: self.order.objects(),
            uploaded,
            drawn: self.counted.map(|[first, missed, last, ..]| [first, missed, last]),
            tested: self.counted.filter(|_| self.groups.is_some()).map(|[.., groups, loose]| [groups, loose]),
        }
    }

    /// Brings everything on the device up to date; returns the bytes uploaded.
    fn upload(&mut self, scene: &Scene, view: &View, meshes: &[BatchMesh]) -> Result<u64, Error> {
        let Self { device, queue, .. } = self;
        boxes::collect(scene, &mut self.scratch);
        let mut uploaded = self.boxes.follow(device, queue, &mut self.scratch)?;
        uploaded += self.order.follow(device, queue, scene, meshes)?;
        let (objects, count) = (self.order.objects(), meshes.len() as u32);
        if 4 * scene.slot_bound() as u64 > self.remembered.size() {
            // Nothing is remembered: as after a cut.
            self.remembered = remembered(device, scene.slot_bound() + scene.slot_bound() / 2);
        }
        match &mut self.groups {
            Some(groups) => {
                let (order, share) = (self.order.slots.known(), self.config.share);
                uploaded += groups.follow((device, queue), scene, order, (view, share))?;
            }
            None => {
                self.asked.resize(device, objects as usize)?;
                self.open.resize(device, queue, objects as usize)?;
            }
        }
        self.select.resize(device, queue, objects);
        if !self.lists[0].holds(objects, count) {
            self.lists = std::array::from_fn(|_| Instances::new(device, objects + objects / 2, count));
        }
        queue.write_buffer(&self.view, 0, bytes_of(&PackedView::new(view, self.slack)));
        queue.write_buffer(&self.uniforms, 0, bytes_of(&PackedFrame::new(view)));
        Ok(uploaded)
    }

    fn bind(&mut self, view: &View, depth: &TextureView) -> Result<Bound, Error> {
        let several = view.samples() > 1;
        let passes = match &mut self.passes[usize::from(several)] {
            Some(passes) => passes,
            none => none.insert(Passes::new(&self.device, &self.config.shaders, several)?),
        };
        if self.groups.is_some() {
            passes.open_rays(&self.device, &self.config.shaders, several)?;
        }
        Ok(passes.bind(&self.device, &self.view, &self.uniforms, depth))
    }

    fn record_proxies(&self, tape: &mut Tape<'_>, bound: &Bound, view: &View) {
        if self.order.objects() == 0 {
            return;
        }
        let passes = self.passes[usize::from(view.samples() > 1)].as_ref().expect("made when bound");
        let boxes = self.boxes.binding();
        match &self.groups {
            Some(groups) => groups.project(tape, bound, boxes),
            None => {
                let slots = self.order.slots.binding();
                passes.project.record(tape, &bound.view, boxes, slots, &self.asked);
            }
        }
    }

    /// Records the test of all objects against what was drawn first.
    fn record_test(&mut self, tape: &mut Tape<'_>, bound: &Bound, view: &View) {
        if self.order.objects() == 0 {
            return;
        }
        let passes = self.passes[usize::from(view.samples() > 1)].as_mut().expect("made when bound");
        let test = self.config.test;
        let prunes = self.order.objects() as usize >= self.config.prune_from;
        let has_pyramid =
            (test == SweepTest::HiZ || prunes) && passes.build_pyramid(tape, bound, view.viewport());
        if let Some(groups) = &mut self.groups {
            if has_pyramid {
                groups.prune(tape, passes, bound);
            }
            let remembered = exactly(&self.remembered, self.boxes.len() as u32, size_of::<u32>());
            groups.look(tape, passes, bound, view.viewport(), remembered);
            if let Some(counters) = self.counters.as_ref().filter(|it| it.state() == State::Recorded) {
                groups.copy_counts(tape.encoder, counters.buffer(), size_of::<[u32; 3]>() as u64);
            }
            return;
        }
        let asked = (&self.asked, &self.open);
        passes.record_test(tape, bound, asked, view.viewport(), (test, has_pyramid));
    }

    fn record_list(&self, tape: &mut Tape<'_>, which: Which) {
        let objects = self.order.objects();
        if objects == 0 {
            return;
        }
        let order = self.order.slots.binding();
        let source = Source {
            boxes: self.boxes.binding(),
            order: order.clone(),
            verdicts: self.groups.as_ref().map_or_else(|| self.asked.verdicts(), Groups::verdicts),
            remembered: exactly(&self.remembered, self.boxes.len() as u32, size_of::<u32>()),
        };
        self.select.record(tape, which, &source);
        let before = self.select.before();
        let parts = Parts {
            order,
            mesh_of: self.order.mesh_of.binding(),
            meshes: self.order.meshes.binding(),
            before: before.clone(),
        };
        let list = &self.lists[which as usize];
        let meshes = self.order.meshes.len() as u32;
        self.compact.record(tape, &parts, [objects, meshes], list);
        if let Some(counters) = &self.counters
            && counters.state() == State::Recorded
        {
            let (from, to) = (4 * u64::from(objects), 4 * which as u64);
            tape.encoder.copy_buffer_to_buffer(before.buffer, from, counters.buffer(), to, 4);
        }
    }

    /// The draws of a list: of those meshes that have objects.
    fn batches(&self, which: Which) -> Vec<IndirectBatch<'_>> {
        let list = &self.lists[which as usize];
        let draws = self.order.runs().filter(|(_, objects)| !objects.is_empty());
        draws
            .map(|(batch, objects)| IndirectBatch {
                batch,
                instances: &list.instances,
                instances_offset: 4 * u64::from(objects.start),
                arguments: &list.arguments,
                arguments_offset: ARGUMENTS * u64::from(batch.0),
            })
            .collect()
    }

    /// Reads the counters of an earlier frame if they have come, and has them filled anew.
    fn take_counters(&mut self) {
        let Some(counters) = &mut self.counters else { return };
        match counters.state() {
            // By now the frame before has been submitted.
            State::Recorded => counters.await_bytes(),
            State::Arrived => {
                self.counted = counters.read(bytemuck::pod_read_unaligned).or(self.counted);
                counters.reclaim();
            }
            _ => {}
        }
        if counters.state() == State::Free {
            counters.claim(&self.device, COUNTERS);
        }
    }
}

/// The bytes of all counters: what was drawn of each list, and what was tested.
const COUNTERS: u64 = size_of::<[u32; 5]>() as u64;

fn remembered(device: &Device, slots: usize) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet remembered"),
        size: 4 * slots.max(1) as u64,
        usage: BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}
