//! Occludee groups without the host (HROC, stages 2 and 3): what was drawn first marks the tree's nodes,
//! the largest subtrees without any of it are the groups, and rays go down these.
//!
//! ```text
//!   mark ─▶ extract ─┬─ groups ─▶ rays ───┬─▶ verdicts, by place ─▶ spread ─▶ by mesh
//!                    └─ loose ──▶ raster ─┘
//! ```
//!
//! The objects of nodes that hold an occluder, or were opened, are loose: each is drawn by itself. A
//! group that may hold the eye, or covers more than a share of the screen, is opened. Lists are in no
//! particular order; what is found does not depend on it.

use bytemuck::{bytes_of, cast_slice};
use wgpu::{BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, CommandEncoder, Device, Queue};

use super::super::bind::DepthAs;
use super::super::clock::Tape;
use super::super::counter::compiled;
use super::super::rectangles::{Draws, Listed, Of};
use super::super::shaders::Shaders;
use super::super::sweep::array::DeviceArray;
use super::super::sweep::mirror::Mirrored;
use super::super::sweep::placed::PlacedTree;
use super::super::sweep::raster::Raster;
use super::super::sweep::rays::{self, Rays};
use super::super::sweep::stage::Stage;
use super::super::sweep::{Bound, Project};
use crate::Error;
use crate::geom::{View, Viewport};
use crate::scene::Scene;

/// The tree on the device, and what is made of it in a frame.
#[derive(Debug)]
pub(super) struct Groups {
    tree: PlacedTree,
    /// Places in the order of meshes.
    places: Mirrored<u32>,
    mark: Stage,
    extract: Stage,
    spread: Stage,
    /// For targets with one sample a pixel and with several.
    looks: [Option<(Rays, Raster)>; 2],
    /// By mesh.
    verdicts: DeviceArray<u32>,
    marks: DeviceArray<u32>,
    groups: DeviceArray<Listed>,
    loose: DeviceArray<Listed>,
    draws: Buffer,
    /// How large a group may be.
    most: Buffer,
    /// The same, as all stages bind it.
    uniforms: BindGroup,
    scratch: (Vec<u32>, Vec<u32>),
}

/// The draws of both lists: vertices, instances, and two times 0.
const DRAWS: [[u32; 4]; 2] = [[4, 0, 0, 0]; 2];

impl Groups {
    pub(super) fn new(device: &Device, shaders: &Shaders) -> Self {
        let most = buffer(device, 16, BufferUsages::UNIFORM);
        let draws = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        let draws = buffer(device, size_of_val(&DRAWS) as u64, draws);
        let stage = |source, names, buffers: &[(u32, bool)]| {
            Stage::new(device, &compiled(device, source), names, buffers)
        };
        let marking = [(0, false), (1, false), (2, false), (3, true)];
        let extracting = [(0, false), (1, false), (2, false), (3, true), (4, true), (5, true)];
        let spreading = [(0, false), (1, false), (2, true)];
        let mark = stage(&shaders.mark, ("tercet mark", "mark"), &marking);
        Self {
            tree: PlacedTree::new(device, shaders),
            places: Mirrored::new(device, "tercet places by mesh"),
            uniforms: mark.bind(device, &most, None),
            mark,
            extract: stage(&shaders.extract, ("tercet extract", "extract"), &extracting),
            spread: stage(&shaders.spread, ("tercet spread", "spread"), &spreading),
            looks: [None, None],
            verdicts: DeviceArray::written(device, "tercet verdicts by mesh"),
            marks: DeviceArray::written(device, "tercet marks"),
            groups: rays::list(device),
            loose: rays::list(device),
            draws,
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
        let nodes = self.tree.nodes.count() as usize;
        self.marks.resize(device, nodes)?;
        self.groups.resize(device, nodes)?;
        self.verdicts.resize(device, order.len())?;
        self.loose.resize(device, order.len())?;
        let Viewport { width, height, .. } = view.viewport();
        let pixels = share * (width as f32 * height as f32);
        queue.write_buffer(&self.most, 0, bytes_of(&[pixels, 0.0, 0.0, 0.0]));
        queue.write_buffer(&self.draws, 0, cast_slice(&DRAWS));
        Ok(uploaded)
    }

    /// Records the making of proxies and of what is known without a test.
    pub(super) fn project(
        &self,
        tape: &mut Tape<'_>,
        project: &Project,
        bound: &Bound,
        boxes: BufferBinding<'_>,
    ) {
        self.tree.place(tape, (project, bound), boxes);
        self.spread(tape);
    }

    /// Records the test of all objects, against what has been drawn: groups by rays, and the others by
    /// themselves.
    pub(super) fn look(
        &mut self,
        tape: &mut Tape<'_>,
        shaders: &Shaders,
        bound: &Bound,
        view: &View,
        remembered: BufferBinding<'_>,
    ) {
        tape.encoder.clear_buffer(self.marks.buffer(), 0, Some(self.marks.bytes()));
        let Self { tree, marks, groups, loose, uniforms, .. } = &*self;
        let PlacedTree { flat, nodes, objects, .. } = tree;
        let all = [(0, nodes.all()), (1, flat.places()), (2, remembered), (3, marks.all())];
        self.mark.record(tape, uniforms, &all, nodes.count());
        let draws = self.draws.as_entire_buffer_binding();
        let all = [
            (0, nodes.all()),
            (1, marks.all()),
            (2, objects.proxies()),
            (3, groups.all()),
            (4, loose.all()),
            (5, draws),
        ];
        self.extract.record(tape, uniforms, &all, nodes.count());
        let several = view.samples() > 1;
        let (rays, raster) = self.looks[usize::from(several)].get_or_insert_with(|| {
            let depth = DepthAs::texture(several);
            let module = |source| compiled(tape.device, source);
            (
                Rays::new(tape.device, &module(shaders.sweep_rays.source(several)), depth),
                Raster::new(tape.device, &module(shaders.sweep_raster.source(several)), depth, Of::List),
            )
        });
        let draws = |which: u64| Draws::Indirect(&self.draws, which * size_of_val(&DRAWS[0]) as u64);
        let viewport = view.viewport();
        rays.record(tape, &bound.frame, &self.tree, (self.groups.buffer(), draws(0)), viewport);
        raster.record(tape, &bound.frame, &self.tree.objects, (self.loose.buffer(), draws(1)), viewport);
        self.spread(tape);
    }

    /// Records the way of how many groups and loose objects there were into a buffer, from a byte on.
    pub(super) fn copy_counts(&self, encoder: &mut CommandEncoder, to: &Buffer, at: u64) {
        for which in 0..2 {
            let from = which * size_of_val(&DRAWS[0]) as u64 + 4;
            encoder.copy_buffer_to_buffer(&self.draws, from, to, at + 4 * which, 4);
        }
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

/// A buffer that the host also writes to.
fn buffer(device: &Device, size: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet extraction"),
        size,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
