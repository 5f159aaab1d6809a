//! The rays of HROC (Lee et al. 2021, stage 3): the rectangles of groups are drawn, and each fragment
//! sends a ray down its group's subtree.
//!
//! The paper draws a group's box, and only what passes the depth test casts a ray. Here the first
//! node that a ray looks at is the group itself, and one that does not meet it ends there: the depth
//! is read anyway.
//!
//! No ray is cast for a group that holds the eye, nor for one that covers more of the screen than its asker's
//! share: a policy opens both before it asks, and `targets` whatever the device cannot place.

use wgpu::{BindGroup, Buffer, BufferBinding, BufferUsages, Device, ShaderModule};

use super::array::DeviceArray;
use super::enclose::Nodes;
use super::placed::PlacedTree;
use super::stage::{Drawn, Stage};
use crate::geom::Viewport;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Draws, Listed, Of};

/// The pass that casts rays.
#[derive(Debug)]
pub(in crate::query::gpu) struct Rays(Drawn);

impl Rays {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let buffers = &[(0, false), (2, true), (3, false)];
        Self(Drawn::new(device, module, ("tercet rays", "cast_ray"), buffers, (Of::List, depth)))
    }

    /// Records the casting of the rays of all groups in a list.
    pub(in crate::query::gpu) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        tree: &PlacedTree,
        list: (&Buffer, Draws<'_>),
        viewport: Viewport,
    ) {
        let PlacedTree { objects, nodes, .. } = tree;
        let buffers = [(0, objects.proxies()), (2, objects.verdicts()), (3, nodes.all())];
        self.0.record(tape, frame, &buffers, list, viewport);
    }
}

/// The pass that lists the groups of a sweep.
#[derive(Debug)]
pub(super) struct Enlist {
    stage: Stage,
    nothing: BindGroup,
}

impl Enlist {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true)];
        let stage = Stage::new(device, module, ("tercet enlist", "enlist"), buffers);
        Self { nothing: stage.bind_nothing(device), stage }
    }

    /// Records the listing of groups, which are indices of nodes.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        nodes: &Nodes,
        groups: BufferBinding<'_>,
        to: &DeviceArray<Listed>,
    ) {
        let buffers = [(0, nodes.all()), (1, groups), (2, to.all())];
        self.stage.record(tape, &self.nothing, &buffers, to.count());
    }
}

/// A list whose rectangles are drawn.
pub(in crate::query::gpu) fn list(device: &Device) -> DeviceArray<Listed> {
    DeviceArray::new(device, "tercet listed", BufferUsages::STORAGE | BufferUsages::VERTEX)
}
