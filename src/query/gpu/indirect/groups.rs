//! Occludee groups without the host (HROC, stages 2 and 3): what was drawn first marks the tree's nodes,
//! the largest subtrees without any of it are the groups, and rays go down these.
//!
//! ```text
//!   mark ─▶ extract ─┬─ groups ─▶ rays ───┬─▶ verdicts, by place ─▶ spread ─▶ by mesh
//!                    └─ loose ──▶ raster ─┘
//! ```
//!
//! What the pyramid shows to be hidden is left out before (`prune`). The objects of nodes that hold an occluder, or
//! were opened, are loose: each is drawn by itself; so are those of groups in which few pixels are open. A
//! group that may hold the eye, or covers more than a share of the screen, is opened. Lists are in no
//! particular order; what is found does not depend on it.

use bytemuck::bytes_of;
use wgpu::{BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, CommandEncoder, Device, Queue};

use super::super::clock::Tape;
use super::super::counter::compiled;
use super::super::shaders::Shaders;
use super::super::sweep::array::DeviceArray;
use super::super::sweep::mirror::Mirrored;
use super::super::sweep::placed::PlacedTree;
use super::super::sweep::rays::Lists;
use super::super::sweep::stage::Stage;
use super::super::sweep::{Bound, Passes};
use crate::Error;
use crate::geom::{View, Viewport};
use crate::scene::Scene;

/// The tree on the device, and what is made of it in a frame.
#[derive(Debug)]
pub(super) struct Groups {
    tree: PlacedTree,
    /// Places in the order of meshes.
    places: Mirrored<u32>,
    /// All places, in their own order.
    every: Mirrored<u32>,
    mark: Stage,
    extract: Stage,
    spread: Stage,
    /// By mesh.
    verdicts: DeviceArray<u32>,
    marks: DeviceArray<u32>,
    lists: Lists,
    /// How large a group may be.
    most: Buffer,
    /// The same, as all stages bind it.
    uniforms: BindGroup,
    scratch: (Vec<u32>, Vec<u32>),
}

impl Groups {
    pub(super) fn new(device: &Device, shaders: &Shaders) -> Self {
        let most = device.create_buffer(&BufferDescriptor {
            label: Some("tercet extraction"),
            size: 16,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let stage = |source, names, buffers: &[(u32, bool)]| {
            Stage::new(device, &compiled(device, source), names, buffers)
        };
        let marking = [(0, false), (1, false), (2, false), (3, true)];
        let extracting = [(0, false), (1, false), (2, false), (3, false), (4, true), (5, true)];
        let spreading = [(0, false), (1, false), (2, true)];
        let mark = stage(&shaders.mark, ("tercet mark", "mark"), &marking);
        Self {
            tree: PlacedTree::new(device, shaders),
            places: Mirrored::new(device, "tercet places by mesh"),
            every: Mirrored::new(device, "tercet places"),
            uniforms: mark.bind(device, &most, None),
            mark,
            extract: stage(&shaders.extract, ("tercet extract", "extract"), &extracting),
            spread: stage(&shaders.spread, ("tercet spread", "spread"), &spreading),
            verdicts: DeviceArray::written(device, "tercet verdicts by mesh"),
            marks: DeviceArray::written(device, "tercet marks"),
            lists: Lists::new(device),
            most,
            scratch: Default::default(),
        }
    }

    /// Brings the tree on the device up to date; returns the bytes uploaded. `order` has the slots of
    /// all objects in the order of their meshes. A group that covers more than `share` of the screen is
    /// opened. O(nodes + objects).
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many nodes or objects.
    pub(super) fn follow(
        &mut self,
        (device, queue): (&Device, &Queue),
        scene: &Scene,
        order: &[u32],
        (view, share): (&View, f32),
    ) -> Result<u64, Error> {
        // Who is not in the tree is drawn always; its proxy says so.
        let mut uploaded = self.tree.follow(device, queue, scene, scene.objects_store().always())?;
        let (place_of, places) = &mut self.scratch;
        place_of.clear();
        place_of.resize(scene.slot_bound(), 0);
        for (place, &slot) in (0..).zip(self.tree.flat.slots()) {
            place_of[slot as usize] = place;
        }
        places.clear();
        places.extend(order.iter().map(|&slot| place_of[slot as usize]));
        uploaded += self.places.follow(device, queue, places)?;
        places.clear();
        places.extend(0..self.tree.objects.count());
        uploaded += self.every.follow(device, queue, places)?;
        let nodes = self.tree.nodes.count() as usize;
        self.marks.resize(device, nodes)?;
        self.verdicts.resize(device, order.len())?;
        self.lists.resize((device, queue), nodes, self.tree.objects.count() as usize)?;
        let Viewport { width, height, .. } = view.viewport();
        let pixels = share * (width as f32 * height as f32);
        queue.write_buffer(&self.most, 0, bytes_of(&[pixels, 0.0, 0.0, 0.0]));
        Ok(uploaded)
    }

    /// Records the making of proxies and of what is known without a test.
    pub(super) fn project(&self, tape: &mut Tape<'_>, bound: &Bound, boxes: BufferBinding<'_>) {
        self.tree.place_nodes(tape, bound);
        self.tree.place_objects(tape, bound, boxes, self.wanted());
        self.spread(tape);
    }

    /// Records the leaving out of what the pyramid, which has been built, shows to be hidden.
    pub(super) fn prune(&self, tape: &mut Tape<'_>, passes: &Passes, bound: &Bound) {
        passes.prune_nodes(tape, bound, &self.tree);
        passes.prune_objects(tape, bound, &self.tree, self.wanted());
    }

    /// All places, and how many there are.
    fn wanted(&self) -> (BufferBinding<'_>, u32) {
        (self.every.binding(), self.every.len() as u32)
    }

    /// Records the test of all objects, against what has been drawn: groups by rays, and the others by
    /// themselves.
    pub(super) fn look(
        &mut self,
        tape: &mut Tape<'_>,
        passes: &mut Passes,
        bound: &Bound,
        viewport: Viewport,
        remembered: BufferBinding<'_>,
    ) {
        tape.encoder.clear_buffer(self.marks.buffer(), 0, Some(self.marks.bytes()));
        self.lists.clear(tape.encoder);
        let Self { tree, marks, lists, uniforms, .. } = &*self;
        let PlacedTree { flat, nodes, objects, .. } = tree;
        let all = [(0, nodes.all()), (1, flat.places()), (2, remembered), (3, marks.all())];
        self.mark.record(tape, uniforms, &all, nodes.count());
        let all = [
            (0, nodes.all()),
            (1, marks.all()),
            (2, objects.proxies()),
            (3, objects.verdicts()),
            (4, lists.groups.all()),
            (5, lists.loose.all()),
        ];
        self.extract.record(tape, uniforms, &all, nodes.count());
        passes.look_below(tape, bound, tree, lists, viewport);
        self.spread(tape);
    }

    /// Records the way of how many groups and loose objects there were into a buffer, from a byte on.
    pub(super) fn copy_counts(&self, encoder: &mut CommandEncoder, to: &Buffer, at: u64) {
        self.lists.groups.copy_count(encoder, to, at);
        self.lists.loose.copy_count(encoder, to, at + 4);
    }

    /// What is known of all objects, in the order of meshes.
    pub(super) fn verdicts(&self) -> BufferBinding<'_> {
        self.verdicts.all()
    }

    fn spread(&self, tape: &mut Tape<'_>) {
        let found = &self.tree.objects;
        let all = [(0, found.verdicts()), (1, self.places.binding()), (2, self.verdicts())];
        self.spread.record(tape, &self.uniforms, &all, found.count());
    }
}
