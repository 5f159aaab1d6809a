//! Sweeps that look at boxes: what they need on the device, and how one is recorded.

use bytemuck::bytes_of;
use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device};

use super::boxes::{self, PackedBox};
use super::enclose::Nodes;
use super::grove::{Groups, Grove};
use super::mirror::Mirrored;
use super::swept::{Looked, Swept, copy_verdicts};
use super::targets::Targets;
use super::view::PackedView;
use super::{Bound, Passes};
use crate::Error;
use crate::geom::PlaneMask;
use crate::query::gpu::{GpuQueries, frame, guard};
use crate::query::{Sweep, SweepTest};
use crate::scene::ObjectSet;
use crate::tree::NodeId;

/// What these sweeps need.
#[derive(Debug)]
pub(super) struct Looks {
    /// For targets with one sample a pixel and with several.
    pub(super) passes: [Option<Passes>; 2],
    boxes: Mirrored<PackedBox>,
    /// Reused by uploads.
    scratch: Vec<PackedBox>,
    view: Buffer,
    /// Whether the boxes are those of this frame.
    is_uploaded: bool,
    /// Made by the first sweep by rays.
    grove: Option<Grove>,
    /// Of this frame, if it has swept.
    pub(super) bound: Option<Bound>,
    /// Reused by walks through the tree.
    stack: Vec<(NodeId, PlaneMask)>,
}

impl Looks {
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
            stack: Vec::new(),
        }
    }

    /// Forgets the frame.
    pub(super) fn forget(&mut self) {
        (self.is_uploaded, self.bound) = (false, None);
        self.grove.iter_mut().for_each(Grove::forget);
    }

    /// The tree's nodes on the screen, if rays were cast.
    pub(super) fn nodes(&self) -> Option<&Nodes> {
        self.grove.as_ref().map(Grove::nodes)
    }

    /// Adds those objects below some groups that the tree's verdicts are in favour of.
    pub(super) fn found_below(&self, groups: &Groups, verdicts: &[u32], found: &mut ObjectSet) {
        if let Some(grove) = &self.grove {
            grove.found(groups, verdicts, &self.boxes, found);
        }
    }
}

impl GpuQueries {
    /// Records the passes of a sweep, without a test only those that make proxies; returns which
    /// sweep it is.
    pub(super) fn record_looks(
        &mut self,
        sweep: &Sweep<'_>,
        test: Option<SweepTest>,
    ) -> Result<usize, Error> {
        self.bind_looks()?;
        let (device, queue) = (&self.device, &self.queue);
        let frame = self.frame.as_mut().expect("sweeps are bound in a frame");
        let sweeps = self.sweeps.as_mut().expect("they are bound");
        let looks = sweeps.looks.as_mut().expect("they are bound");
        let Looks { passes, boxes, scratch, is_uploaded, grove, bound, stack, .. } = looks;
        let several = frame.view.samples() > 1;
        let passes = passes[usize::from(several)].as_mut().expect("made when bound");
        let bound = bound.as_ref().expect("they are bound");
        guard::guarded(device, || {
            let index = Swept::free(&mut sweeps.sweeps, device);
            let swept = &mut sweeps.sweeps[index];
            swept.is_for_owners = false;
            swept.targets.list(sweep, test == Some(SweepTest::Rays), stack);
            let Targets { groups, ids } = &swept.targets;
            let looked = swept.looked.get_or_insert_with(|| Looked::new(device));
            looked.groups.clear();
            if !*is_uploaded {
                boxes::collect(sweep.scene, scratch);
                self.stats.uploaded += boxes.follow(device, queue, scratch)?;
                *is_uploaded = true;
            }
            looked.load(device, queue, ids)?;
            let viewport = frame.view.viewport();
            let mut tape = frame::tape(&mut frame.encoder, device, &mut self.clock);
            let grove = if !groups.is_empty() {
                let shaders = &self.config.shaders;
                let grove = match grove {
                    Some(grove) => grove,
                    none => none.insert(guard::guarded(device, || Grove::new(device, shaders))?),
                };
                // Now, if it cannot be made, nothing of it is recorded.
                passes.open_rays(device, shaders, several)?;
                self.stats.uploaded += grove.follow(device, queue, sweep.scene)?;
                looked.groups.load(device, queue, grove, sweep, groups)?;
                Some(grove)
            } else {
                None
            };
            let verdicts = looked.asked.found();
            let more = grove.as_ref().map_or(0, |grove| grove.bytes());
            swept.read_back.claim(device, verdicts.bytes() + more);
            let below = if grove.is_some() { looked.groups.objects() } else { 0 };
            let is_worth_it = ids.len() + below as usize >= self.config.prune_from;
            let has_pyramid = test.is_some_and(|test| is_worth_it || test == SweepTest::HiZ)
                && passes.build_pyramid(&mut tape, bound, viewport);
            if let Some(grove) = grove {
                let to = (swept.read_back.buffer(), verdicts.bytes());
                let how = (viewport, has_pyramid);
                grove.record(&mut tape, passes, (bound, boxes.binding()), &looked.groups, how, to);
                self.stats.groups += u64::from(looked.groups.count());
                self.stats.swept += below;
            }
            let slots = looked.slots.all();
            passes.project.record(&mut tape, &bound.view, boxes.binding(), slots, &looked.asked);
            if let Some(test) = test {
                let asked = (&looked.asked, &looked.open);
                passes.record_test(&mut tape, bound, asked, viewport, (test, has_pyramid));
            }
            copy_verdicts(tape.encoder, verdicts, &swept.read_back);
            self.stats.sweeps += 1;
            self.stats.swept += ids.len() as u64;
            Ok(index)
        })?
    }

    /// Binds what these sweeps need of the frame, once a frame.
    pub(super) fn bind_looks(&mut self) -> Result<(), Error> {
        self.open_sweeps()?;
        let frame = self.frame.as_ref().ok_or_else(frame::not_begun)?;
        let sweeps = self.sweeps.as_mut().expect("they are open");
        let looks = match &mut sweeps.looks {
            Some(looks) => looks,
            none => none.insert(guard::guarded(&self.device, || Looks::new(&self.device))?),
        };
        if looks.bound.is_some() {
            return Ok(());
        }
        let several = frame.view.samples() > 1;
        let passes = match &mut looks.passes[usize::from(several)] {
            Some(passes) => passes,
            none => none.insert(Passes::new(&self.device, &self.config.shaders, several)?),
        };
        looks.bound = Some(guard::guarded(&self.device, || {
            let packed = PackedView::new(&frame.view, self.slack);
            self.queue.write_buffer(&looks.view, 0, bytes_of(&packed));
            passes.bind(&self.device, &looks.view, &self.uniforms, frame.targets.readable_depth())
        })?);
        Ok(())
    }
}
