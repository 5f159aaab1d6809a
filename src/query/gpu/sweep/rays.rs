//! The rays of HROC (Lee et al. 2021, stage 3): the rectangles of groups are drawn, and each fragment
//! sends a ray down its group's subtree.
//!
//! The paper draws a group's box, and only what passes the depth test casts a ray. Here the first
//! node that a ray looks at is the group itself, and one that does not meet it ends there: the depth
//! is read anyway.
//!
//! No ray is cast for a group that holds the eye, nor for one that covers more of the screen than its asker's
//! share: a policy opens both before it asks, and `targets` whatever the device cannot place.

use wgpu::{BindGroup, BufferBinding, CommandEncoder, Device, Queue, ShaderModule};

use super::placed::PlacedTree;
use super::stage::{Drawn, Stage};
use crate::Error;
use crate::geom::Viewport;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Instances, List, Of};

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
        groups: &List,
        viewport: Viewport,
    ) {
        let PlacedTree { objects, nodes, .. } = tree;
        let buffers = [(0, objects.proxies()), (2, objects.verdicts()), (3, nodes.all())];
        self.0.record(tape, frame, &buffers, Instances::Listed(groups), viewport);
    }
}

/// What is looked at of groups: these by rays, and objects that are cheaper to look at by themselves.
#[derive(Debug)]
pub(in crate::query::gpu) struct Lists {
    pub(in crate::query::gpu) groups: List,
    pub(in crate::query::gpu) loose: List,
}

impl Lists {
    pub(in crate::query::gpu) fn new(device: &Device) -> Self {
        Self { groups: List::new(device), loose: List::new(device) }
    }

    /// Makes room for so many groups, and for all objects below them.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(in crate::query::gpu) fn resize(
        &mut self,
        (device, queue): (&Device, &Queue),
        groups: usize,
        objects: usize,
    ) -> Result<(), Error> {
        self.groups.resize(device, queue, groups)?;
        self.loose.resize(device, queue, objects)
    }

    /// Records that they hold nothing.
    pub(in crate::query::gpu) fn clear(&self, encoder: &mut CommandEncoder) {
        self.groups.clear(encoder);
        self.loose.clear(encoder);
    }
}

/// The pass that lists what is looked at of the groups of a sweep.
#[derive(Debug)]
pub(super) struct Enlist {
    stage: Stage,
    nothing: BindGroup,
}

impl Enlist {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, false), (3, false), (4, true), (5, true)];
        let stage = Stage::new(device, module, ("tercet enlist", "enlist"), buffers);
        Self { nothing: stage.bind_nothing(device), stage }
    }

    /// Records the listing of what is not known yet below groups, which are indices of nodes of a tree; `count`
    /// of them.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        tree: &PlacedTree,
        (groups, count): (BufferBinding<'_>, u32),
        to: &Lists,
    ) {
        let PlacedTree { nodes, objects, .. } = tree;
        to.clear(tape.encoder);
        let buffers = [
            (0, nodes.all()),
            (1, groups),
            (2, objects.proxies()),
            (3, objects.verdicts()),
            (4, to.groups.all()),
            (5, to.loose.all()),
        ];
        self.stage.record(tape, &self.nothing, &buffers, count);
    }
}
