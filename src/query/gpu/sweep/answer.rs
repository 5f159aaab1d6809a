//! Sweeps that a policy asks for: the device looks, and the host reads the verdicts back.

use bytemuck::{bytes_of, cast_slice, try_cast_slice};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoder, Device, Queue};

use super::array::DeviceArray;
use super::asked::{Asked, SEEN};
use super::boxes::{self, PackedBox};
use super::grove::{Groups, Grove};
use super::mirror::Mirrored;
use super::view::PackedView;
use super::{Bound, Passes};
use crate::Error;
use crate::geom::PlaneMask;
use crate::query::gpu::read_back::{ReadBack, State};
use crate::query::gpu::{GpuQueries, frame, guard};
use crate::query::{Answer, Sweep, SweepTest, Ticket};
use crate::scene::{ObjectId, ObjectSet};
use crate::tree::NodeId;

/// What sweeps need, made by the first one.
#[derive(Debug)]
pub(in crate::query::gpu) struct Sweeps {
    /// For targets with one sample a pixel and with several.
    pub(super) passes: [Option<Passes>; 2],
    pub(super) boxes: Mirrored<PackedBox>,
    /// Reused by uploads.
    scratch: Vec<PackedBox>,
    view: Buffer,
    /// Whether the boxes are those of this frame.
    is_uploaded: bool,
    /// Made by the first sweep by rays.
    grove: Option<Grove>,
    /// Of this frame, if it has swept.
    pub(super) bound: Option<Bound>,
    pub(super) sweeps: Vec<Swept>,
    /// What could not be asked.
    refused: Vec<Ticket>,
    /// Reused by walks through the tree.
    stack: Vec<(NodeId, PlaneMask)>,
}

/// One sweep, from upload to read-back; its buffers are reused.
#[derive(Debug)]
pub(super) struct Swept {
    ticket: Option<Ticket>,
    pub(super) ids: Vec<ObjectId>,
    slots: DeviceArray<u32>,
    pub(super) asked: Asked,
    /// Whether verdicts are those of slots, instead of the objects listed here.
    by_slot: bool,
    /// Into which rays are cast.
    groups: Groups,
    /// Verdicts of the objects listed here; after them those of the tree, if rays were cast.
    read_back: ReadBack,
}

impl Sweeps {
    fn new(device: &Device) -> Self {
        Self {
            passes: [None, None],
            boxes: Mirrored::new(device, "tercet boxes"),
            scratch: Vec::new(),
            view: device.create_buffer(&BufferDescriptor {
                label: Some("tercet view"),
                size: size_of::<PackedView>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            is_uploaded: false,
            grove: None,
            bound: None,
            sweeps: Vec::new(),
            refused: Vec::new(),
            stack: Vec::new(),
        }
    }

    /// Forgets all sweeps, and the frame.
    pub(in crate::query::gpu) fn forget(&mut self) {
        (self.is_uploaded, self.bound) = (false, None);
        self.refused.clear();
        self.grove.iter_mut().for_each(Grove::forget);
        for swept in &mut self.sweeps {
            swept.ticket = None;
            swept.read_back.reclaim();
        }
        self.sweeps.retain(|swept| swept.read_back.state() != State::Lost);
    }

    /// Whether the read-back of some sweep is in a state, and somebody waits for it.
    pub(in crate::query::gpu) fn any(&self, state: State) -> bool {
        self.sweeps.iter().any(|swept| swept.ticket.is_some() && swept.read_back.state() == state)
    }

    /// Asks for the verdicts of what was recorded; to be called when it has been submitted.
    pub(in crate::query::gpu) fn submitted(&self) {
        let recorded = self.sweeps.iter().filter(|swept| swept.read_back.state() == State::Recorded);
        recorded.for_each(|swept| swept.read_back.await_bytes());
    }

    /// Hands out what has arrived; with `all`, everything else as unknown.
    pub(in crate::query::gpu) fn deliver(&mut self, all: bool, deliver: &mut impl FnMut(Ticket, Answer<'_>)) {
        for ticket in self.refused.drain(..) {
            deliver(ticket, Answer::Unknown);
        }
        let mut found = ObjectSet::default();
        for swept in &mut self.sweeps {
            let Some(ticket) = swept.ticket else { continue };
            found.clear();
            let arrived = swept.read_back.read(|bytes| {
                let verdicts: &[u32] = try_cast_slice(bytes).unwrap_or(&[]);
                for (index, &id) in swept.ids.iter().enumerate() {
                    let index = if swept.by_slot { id.slot() } else { index };
                    if verdicts.get(index) == Some(&SEEN) {
                        found.insert(id);
                    }
                }
                if let Some(grove) = &self.grove {
                    let below = verdicts.get(swept.asked.found().bound()..).unwrap_or(&[]);
                    grove.found(&swept.groups, below, &self.boxes, &mut found);
                }
            });
            match arrived {
                Some(()) => deliver(ticket, Answer::Swept(&found)),
                None if all => deliver(ticket, Answer::Unknown),
                None => continue,
            }
            swept.ticket = None;
            swept.read_back.reclaim();
        }
    }
}

impl GpuQueries {
    /// Records a sweep against what has been drawn so far. What the device cannot hold is unknown.
    pub(in crate::query::gpu) fn record_sweep(
        &mut self,
        ticket: Ticket,
        sweep: &Sweep<'_>,
    ) -> Result<(), Error> {
        self.bind_sweeps()?;
        let recorded = match sweep.test {
            SweepTest::Owners => self.record_owners(sweep).or_else(refused)?,
            SweepTest::Rays => match self.record_looks(sweep, Some(sweep.test)).map(Some).or_else(refused)? {
                // The tree is more than the device can bind: its objects may not be.
                None => self.record_looks(sweep, Some(SweepTest::Raster)).map(Some).or_else(refused)?,
                recorded => recorded,
            },
            test => self.record_looks(sweep, Some(test)).map(Some).or_else(refused)?,
        };
        let sweeps = self.sweeps.as_mut().expect("they are bound");
        match recorded {
            Some(index) => sweeps.sweeps[index].ticket = Some(ticket),
            None => sweeps.refused.push(ticket),
        }
        Ok(())
    }

    /// Records the looking through the item buffer, if there is one; returns which sweep it is.
    fn record_owners(&mut self, sweep: &Sweep<'_>) -> Result<Option<usize>, Error> {
        let (device, several) = (&self.device, sweep.view.samples() > 1);
        let (Some(frame), Some(sweeps)) = (&mut self.frame, &mut self.sweeps) else { return Ok(None) };
        let Some(ids) = frame.ids.as_ref() else { return Ok(None) };
        let passes = sweeps.passes[usize::from(several)].as_mut().expect("made when bound");
        let owners = passes.owners(device, &self.config.shaders, several)?;
        let index = free(&mut sweeps.sweeps, device);
        let swept = &mut sweeps.sweeps[index];
        swept.groups.clear();
        swept.ids.clear();
        swept.ids.extend_from_slice(sweep.loose);
        swept.by_slot = true;
        guard::guarded(device, || {
            swept.asked.resize(device, sweep.scene.slot_bound())?;
            swept.claim(device, 0);
            let mut tape = frame::tape(&mut frame.encoder, device, &mut self.clock);
            let verdicts = swept.asked.found();
            owners.record(&mut tape, (&self.uniforms, ids), verdicts, frame.view.viewport());
            swept.copy_verdicts(tape.encoder);
            self.stats.sweeps += 1;
            self.stats.swept += swept.ids.len() as u64;
            Ok(Some(index))
        })?
    }

    /// Records the passes of a sweep, without a test only those that make proxies; returns which
    /// sweep it is.
    pub(super) fn record_looks(
        &mut self,
        sweep: &Sweep<'_>,
        test: Option<SweepTest>,
    ) -> Result<usize, Error> {
        self.bind_sweeps()?;
        let (device, queue) = (&self.device, &self.queue);
        let frame = self.frame.as_mut().expect("sweeps are bound in a frame");
        let Sweeps { passes, boxes, scratch, is_uploaded, grove, bound, sweeps, stack, .. } =
            self.sweeps.as_mut().expect("they are bound");
        let several = frame.view.samples() > 1;
        let passes = passes[usize::from(several)].as_mut().expect("made when bound");
        let bound = bound.as_ref().expect("they are bound");
        let index = free(sweeps, device);
        let swept = &mut sweeps[index];
        let by_rays = test == Some(SweepTest::Rays) && !sweep.groups.is_empty();
        let one_by_one = Sweep { groups: if by_rays { &[] } else { sweep.groups }, ..*sweep };
        list(&one_by_one, stack, &mut swept.ids);
        swept.groups.clear();
        swept.by_slot = false;
        guard::guarded(device, || {
            if !*is_uploaded {
                boxes::collect(sweep.scene, scratch);
                self.stats.uploaded += boxes.follow(device, queue, scratch)?;
                *is_uploaded = true;
            }
            swept.load(device, queue)?;
            let viewport = frame.view.viewport();
            let mut tape = frame::tape(&mut frame.encoder, device, &mut self.clock);
            let grove = if by_rays {
                let shaders = &self.config.shaders;
                let grove = match grove {
                    Some(grove) => grove,
                    none => none.insert(guard::guarded(device, || Grove::new(device, shaders))?),
                };
                // Now, if it cannot be made, nothing of it is recorded.
                passes.rays(device, shaders, several)?;
                let making = (&passes.project, bound);
                self.stats.uploaded += grove.make_ready(&mut tape, queue, making, boxes, sweep.scene)?;
                swept.groups.load(device, queue, grove, sweep)?;
                Some(grove)
            } else {
                None
            };
            swept.claim(device, grove.as_ref().map_or(0, |grove| grove.bytes()));
            if let Some(grove) = grove {
                let rays = passes.rays(device, &self.config.shaders, several)?;
                let to = (swept.read_back.buffer(), swept.asked.found().bytes());
                grove.record(&mut tape, rays, bound, &swept.groups, viewport, to);
                self.stats.groups += u64::from(swept.groups.count());
                self.stats.swept += swept.groups.objects();
            }
            passes.project.record(&mut tape, &bound.view, boxes.binding(), swept.slots.all(), &swept.asked);
            if let Some(test) = test {
                let by_pyramid = test == SweepTest::HiZ;
                passes.record_test(&mut tape, bound, &swept.asked, viewport, by_pyramid);
            }
            swept.copy_verdicts(tape.encoder);
            self.stats.sweeps += 1;
            self.stats.swept += swept.ids.len() as u64;
            Ok(index)
        })?
    }

    /// Binds what sweeps need of the frame, once a frame. What was asked before is recorded first: it
    /// is about the same depth.
    pub(super) fn bind_sweeps(&mut self) -> Result<(), Error> {
        self.record_questions()?;
        self.open_first()?;
        let frame = self.frame.as_ref().ok_or_else(frame::not_begun)?;
        let sweeps = match &mut self.sweeps {
            Some(sweeps) => sweeps,
            none => none.insert(guard::guarded(&self.device, || Sweeps::new(&self.device))?),
        };
        if sweeps.bound.is_some() {
            return Ok(());
        }
        let several = frame.view.samples() > 1;
        let passes = match &mut sweeps.passes[usize::from(several)] {
            Some(passes) => passes,
            none => none.insert(Passes::new(&self.device, &self.config.shaders, several)?),
        };
        sweeps.bound = Some(guard::guarded(&self.device, || {
            let packed = PackedView::new(&frame.view, self.slack);
            self.queue.write_buffer(&sweeps.view, 0, bytes_of(&packed));
            passes.bind(&self.device, &sweeps.view, &self.uniforms, frame.targets.readable_depth())
        })?);
        Ok(())
    }
}

/// What the device cannot do for a sweep is not the frame's failure.
fn refused(error: Error) -> Result<Option<usize>, Error> {
    if matches!(error, Error::Device { .. }) { Ok(None) } else { Err(error) }
}

impl Swept {
    /// Uploads which objects are asked about. The upload happens when the encoder is submitted.
    fn load(&mut self, device: &Device, queue: &Queue) -> Result<(), Error> {
        self.asked.resize(device, self.ids.len())?;
        self.slots.resize(device, self.ids.len())?;
        let listed: Vec<u32> = self.ids.iter().map(|id| id.slot() as u32).collect();
        queue.write_buffer(self.slots.buffer(), 0, cast_slice(&listed));
        Ok(())
    }

    /// Makes room for the verdicts to come back, and for so many bytes after them.
    fn claim(&mut self, device: &Device, more: u64) {
        self.read_back.claim(device, self.asked.found().bytes() + more);
    }

    /// Records the way of the verdicts into memory that can be read.
    fn copy_verdicts(&self, encoder: &mut CommandEncoder) {
        let verdicts = self.asked.found();
        encoder.copy_buffer_to_buffer(verdicts.buffer(), 0, self.read_back.buffer(), 0, verdicts.bytes());
    }
}

/// A sweep that nobody uses.
fn free(sweeps: &mut Vec<Swept>, device: &Device) -> usize {
    let found = sweeps.iter().position(|swept| swept.ticket.is_none() && swept.read_back.reclaim());
    found.unwrap_or_else(|| {
        sweeps.push(Swept {
            ticket: None,
            ids: Vec::new(),
            slots: DeviceArray::written(device, "tercet swept slots"),
            asked: Asked::new(device),
            by_slot: false,
            groups: Groups::new(device),
            read_back: ReadBack::new(device, 256),
        });
        sweeps.len() - 1
    })
}

/// Lists the objects of a sweep that meet the frustum: those of groups by walking down, with the
/// planes that their nodes cross.
fn list(sweep: &Sweep<'_>, stack: &mut Vec<(NodeId, PlaneMask)>, ids: &mut Vec<ObjectId>) {
    let (tree, store, frustum) = (sweep.scene.tree(), sweep.scene.objects_store(), sweep.frustum);
    ids.clear();
    ids.extend(sweep.loose.iter().filter(|&&id| {
        let bounds = store.slot(id).and_then(|slot| tree.aabb_of(slot));
        bounds.is_some_and(|bounds| frustum.intersects(&bounds))
    }));
    stack.clear();
    stack.extend(sweep.groups.iter().map(|&group| (group, PlaneMask::ALL)));
    while let Some((node, mask)) = stack.pop() {
        if tree.count(node) == 0 {
            continue;
        }
        let Some(mask) = frustum.classify(&tree.bounds(node), mask) else { continue };
        let inside = tree.own_inside(node, frustum, mask);
        ids.extend(inside.map(|(block, lane)| store.id(block.slots[lane])));
        stack.extend(tree.children(node).into_iter().flatten().map(|child| (child, mask)));
    }
}
