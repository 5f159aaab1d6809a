//! The rays of HROC (Lee et al. 2021, stage 3): the rectangles of groups are drawn, and each fragment
//! sends a ray down its group's subtree.
//!
//! The paper draws a group's box, and only what passes the depth test casts a ray. Here the first
//! node that a ray looks at is the group itself, and one that does not meet it ends there: the depth
//! is read anyway.

use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline, Device, ShaderModule,
    ShaderStages,
};

use super::asked::{Asked, exactly};
use super::enclose::Nodes;
use super::{STAGES, compute, dispatch};
use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Draws, Listed, Of, Rectangles};

/// The pass that casts rays.
#[derive(Debug)]
pub(in crate::query::gpu) struct Rays {
    layouts: Layouts,
    rectangles: Rectangles,
}

impl Rays {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let layouts = Layouts::new(device, STAGES, &[(0, false), (2, true), (3, false)], depth);
        let rectangles = Rectangles::new(device, &layouts, module, Of::List, ("tercet rays", "cast_ray"));
        Self { layouts, rectangles }
    }

    /// Records the casting of the rays of all groups in a list. `objects` are those of the tree, by
    /// place.
    pub(in crate::query::gpu) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        (nodes, objects): (&Nodes, &Asked),
        list: (&Buffer, Draws<'_>),
        viewport: Viewport,
    ) {
        let buffers = [(0, objects.proxies()), (2, objects.verdicts()), (3, nodes.all())];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        self.rectangles.record(tape, [frame, &bindings], list, viewport);
    }
}

/// The pass that lists the groups of a sweep.
#[derive(Debug)]
pub(super) struct Enlist {
    layouts: Layouts,
    /// Nothing, but group 0 must be something.
    nothing: BindGroup,
    pipeline: ComputePipeline,
}

impl Enlist {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true)];
        let layouts = Layouts::new(device, ShaderStages::COMPUTE, buffers, DepthAs::Attachment);
        let unread = device.create_buffer(&BufferDescriptor {
            label: Some("tercet nothing"),
            size: 16,
            usage: BufferUsages::UNIFORM,
            mapped_at_creation: false,
        });
        let pipeline = compute(device, &layouts, module, "enlist");
        Self { nothing: bind::frame(device, &layouts.frame, &unread, None), layouts, pipeline }
    }

    /// Records the listing of so many groups, which are indices of nodes.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        nodes: &Nodes,
        (groups, count): (BufferBinding<'_>, u32),
        to: &Buffer,
    ) {
        let buffers = [(0, nodes.all()), (1, groups), (2, exactly(to, count, size_of::<Listed>()))];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        dispatch(tape, "tercet enlist", &self.pipeline, [&self.nothing, &bindings], count);
    }
}

/// Room for a list of so many.
pub(in crate::query::gpu) fn list(device: &Device, count: usize) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet listed"),
        size: (count.max(1) * size_of::<Listed>()) as u64,
        usage: BufferUsages::STORAGE | BufferUsages::VERTEX,
        mapped_at_creation: false,
    })
}
