//! Sweeps by rays: the tree and its objects on the device, made ready once a frame, and looked at by
//! as many sweeps as there are.

use std::ops::Range;

use bytemuck::cast_slice;
use wgpu::{Buffer, BufferBinding, Device, Queue};

use super::array::DeviceArray;
use super::asked::SEEN;
use super::boxes::PackedBox;
use super::enclose::Nodes;
use super::mirror::Mirrored;
use super::placed::PlacedTree;
use super::rays::{Enlist, Lists};
use super::{Bound, Passes};
use crate::Error;
use crate::geom::{Frustum, Viewport};
use crate::query::Sweep;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::counter::compiled;
use crate::query::gpu::shaders::Shaders;
use crate::scene::{ObjectId, ObjectSet, Scene};
use crate::tree::NodeId;

/// The tree on the device, with what its objects' proxies are and where its nodes lie.
#[derive(Debug)]
pub(super) struct Grove {
    tree: PlacedTree,
    enlist: Enlist,
    /// Its objects, by place.
    ids: Vec<ObjectId>,
    /// Whether its nodes are placed in this frame.
    is_ready: bool,
}

/// The groups of one sweep; buffers are reused.
#[derive(Debug)]
pub(super) struct Groups {
    indices: DeviceArray<u32>,
    lists: Lists,
    /// The places of the objects below them, and what these must meet.
    below: Vec<Range<usize>>,
    /// The same places one by one.
    places: DeviceArray<u32>,
    frustum: Option<Frustum>,
}

impl Grove {
    pub(super) fn new(device: &Device, shaders: &Shaders) -> Self {
        Self {
            tree: PlacedTree::new(device, shaders),
            enlist: Enlist::new(device, &compiled(device, &shaders.enlist)),
            ids: Vec::new(),
            is_ready: false,
        }
    }

    /// Forgets the frame.
    pub(super) fn forget(&mut self) {
        self.is_ready = false;
    }

    /// Uploads what has changed, once a frame; returns the bytes.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many nodes or objects.
    pub(super) fn follow(&mut self, device: &Device, queue: &Queue, scene: &Scene) -> Result<u64, Error> {
        if self.is_ready {
            return Ok(0);
        }
        let uploaded = self.tree.follow(device, queue, scene, &[])?;
        let slots = self.tree.flat.slots();
        let store = scene.objects_store();
        self.ids.clear();
        self.ids.extend(slots.iter().map(|&slot| store.id(slot)));
        Ok(uploaded)
    }

    /// Records a sweep by rays into groups, and the way of all verdicts into a buffer, from a place in it on;
    /// with the pyramid, if it has been built. The first one of a frame places the nodes.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        passes: &mut Passes,
        (bound, boxes): (&Bound, BufferBinding<'_>),
        groups: &Groups,
        (viewport, has_pyramid): (Viewport, bool),
        (to, at): (&Buffer, u64),
    ) {
        let Self { tree, enlist, is_ready, .. } = self;
        if !std::mem::replace(is_ready, true) {
            tree.place_nodes(tape, bound);
        }
        if has_pyramid {
            passes.prune_nodes(tape, bound, tree);
        }
        tree.place_objects(tape, bound, boxes, groups.wanted());
        if has_pyramid {
            passes.prune_objects(tape, bound, tree, groups.wanted());
        }
        enlist.record(tape, tree, (groups.indices.all(), groups.count()), &groups.lists);
        passes.look_below(tape, bound, tree, &groups.lists, viewport);
        let found = tree.objects.found();
        tape.encoder.copy_buffer_to_buffer(found.buffer(), 0, to, at, found.bytes());
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
            lists: Lists::new(device),
            below: Vec::new(),
            places: DeviceArray::written(device, "tercet places below groups"),
            frustum: None,
        }
    }

    /// There are none.
    pub(super) fn clear(&mut self) {
        self.frustum = None;
    }

    /// How many there are.
    pub(super) fn count(&self) -> u32 {
        self.indices.count()
    }

    /// How many objects are below them.
    pub(super) fn objects(&self) -> u64 {
        self.below.iter().map(|range| range.len() as u64).sum()
    }

    /// The places of these, and how many there are.
    fn wanted(&self) -> (BufferBinding<'_>, u32) {
        (self.places.all(), self.places.count())
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
        self.lists.resize((device, queue), indices.len(), self.objects() as usize)?;
        queue.write_buffer(self.indices.buffer(), 0, cast_slice(&indices));
        let places: Vec<u32> = self.below.iter().cloned().flatten().map(|place| place as u32).collect();
        self.places.resize(device, places.len())?;
        queue.write_buffer(self.places.buffer(), 0, cast_slice(&places));
        Ok(())
    }
}
