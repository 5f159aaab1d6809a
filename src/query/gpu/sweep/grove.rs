//! Sweeps by rays: the tree and its objects on the device, made ready once a frame, and looked at by
//! as many sweeps as there are.

use std::ops::Range;

use bytemuck::cast_slice;
use wgpu::{Buffer, Device, Queue};

use super::array::DeviceArray;
use super::asked::{self, SEEN, Verdicts};
use super::boxes::PackedBox;
use super::enclose::Nodes;
use super::mirror::Mirrored;
use super::placed::PlacedTree;
use super::rays::{self, Enlist, Rays};
use super::{Bound, Project};
use crate::Error;
use crate::geom::{Frustum, Viewport};
use crate::query::Sweep;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::counter::compiled;
use crate::query::gpu::rectangles::{Draws, Listed};
use crate::query::gpu::shaders::Shaders;
use crate::scene::{ObjectId, ObjectSet, Scene};
use crate::tree::NodeId;

/// The tree on the device, with what its objects' proxies are and where its nodes lie.
#[derive(Debug)]
pub(super) struct Grove {
    tree: PlacedTree,
    enlist: Enlist,
    /// What was known of the tree's objects before any ray.
    first: Verdicts,
    /// The same objects.
    ids: Vec<ObjectId>,
    /// Whether all of it is of this frame.
    is_ready: bool,
}

/// The groups of one sweep; buffers are reused.
#[derive(Debug)]
pub(super) struct Groups {
    indices: DeviceArray<u32>,
    listed: DeviceArray<Listed>,
    /// The places of the objects below them, and what these must meet.
    below: Vec<Range<usize>>,
    frustum: Option<Frustum>,
}

impl Grove {
    pub(super) fn new(device: &Device, shaders: &Shaders) -> Self {
        Self {
            tree: PlacedTree::new(device, shaders),
            enlist: Enlist::new(device, &compiled(device, &shaders.enlist)),
            first: asked::verdicts(device),
            ids: Vec::new(),
            is_ready: false,
        }
    }

    /// Forgets the frame.
    pub(super) fn forget(&mut self) {
        self.is_ready = false;
    }

    /// Uploads what has changed, once a frame, and records the making of proxies; returns the bytes.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many nodes or objects.
    pub(super) fn make_ready(
        &mut self,
        tape: &mut Tape<'_>,
        queue: &Queue,
        making: (&Project, &Bound),
        boxes: &Mirrored<PackedBox>,
        scene: &Scene,
    ) -> Result<u64, Error> {
        if self.is_ready {
            return Ok(0);
        }
        let device = tape.device;
        let uploaded = self.tree.follow(device, queue, scene, &[])?;
        let slots = self.tree.flat.slots();
        self.first.resize(device, slots.len())?;
        let store = scene.objects_store();
        self.ids.clear();
        self.ids.extend(slots.iter().map(|&slot| store.id(slot)));
        self.tree.place(tape, making, boxes.binding());
        let verdicts = self.tree.objects.found().buffer();
        tape.encoder.copy_buffer_to_buffer(verdicts, 0, self.first.buffer(), 0, self.bytes());
        self.is_ready = true;
        Ok(uploaded)
    }

    /// Records the casting of rays into groups, and the way of all verdicts into a buffer, from a place
    /// in it on.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        rays: &mut Rays,
        bound: &Bound,
        groups: &Groups,
        viewport: Viewport,
        (to, at): (&Buffer, u64),
    ) {
        let verdicts = self.tree.objects.found().buffer();
        tape.encoder.copy_buffer_to_buffer(self.first.buffer(), 0, verdicts, 0, self.bytes());
        self.enlist.record(tape, &self.tree.nodes, groups.indices.all(), &groups.listed);
        let list = (groups.listed.buffer(), Draws::Count(groups.count()));
        rays.record(tape, &bound.frame, &self.tree, list, viewport);
        tape.encoder.copy_buffer_to_buffer(verdicts, 0, to, at, self.bytes());
    }

    /// Where nodes lie on the screen, by index.
    pub(super) fn nodes(&self) -> &Nodes {
        &self.tree.nodes
    }

    /// The bytes of all verdicts.
    pub(super) fn bytes(&self) -> u64 {
        self.tree.objects.found().bytes()
    }

    /// Adds those objects below some groups that rays, or nothing, have found in sight.
    pub(super) fn found(
        &self,
        groups: &Groups,
        verdicts: &[u32],
        boxes: &Mirrored<PackedBox>,
        found: &mut ObjectSet,
    ) {
        let Some(frustum) = &groups.frustum else { return };
        for place in groups.below.iter().cloned().flatten() {
            let slot = self.tree.flat.slots()[place] as usize;
            // Rays know nothing of the frustum, and what cannot be asked about is seen anywhere.
            if verdicts.get(place) == Some(&SEEN) && frustum.intersects(&boxes.known()[slot].aabb()) {
                found.insert(self.ids[place]);
            }
        }
    }
}

impl Groups {
    pub(super) fn new(device: &Device) -> Self {
        Self {
            indices: DeviceArray::written(device, "tercet groups"),
            listed: rays::list(device),
            below: Vec::new(),
            frustum: None,
        }
    }

    /// There are none.
    pub(super) fn clear(&mut self) {
        self.frustum = None;
    }

    /// How many there are.
    pub(super) fn count(&self) -> u32 {
        self.listed.count()
    }

    /// How many objects are below them.
    pub(super) fn objects(&self) -> u64 {
        self.below.iter().map(|range| range.len() as u64).sum()
    }

    /// Uploads those of a sweep into which rays are cast. The upload happens when the encoder is submitted.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(super) fn load(
        &mut self,
        device: &Device,
        queue: &Queue,
        grove: &Grove,
        sweep: &Sweep<'_>,
        groups: &[NodeId],
    ) -> Result<(), Error> {
        let indices: Vec<u32> = groups.iter().map(|group| group.index).collect();
        self.below.clear();
        self.below.extend(groups.iter().map(|&group| grove.tree.flat.below(sweep.scene.tree(), group)));
        self.frustum = Some(sweep.frustum.clone());
        self.indices.resize(device, indices.len())?;
        self.listed.resize(device, indices.len())?;
        queue.write_buffer(self.indices.buffer(), 0, cast_slice(&indices));
        Ok(())
    }
}
