//! The tree on the screen: what rays walk through.

use wgpu::{BufferBinding, Device, Queue};

use super::Bound;
use super::asked::Asked;
use super::enclose::{self, Enclose, Nodes};
use super::flat::FlatTree;
use super::project::ProjectBelow;
use crate::Error;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::counter::compiled;
use crate::query::gpu::shaders::Shaders;
use crate::scene::Scene;

/// A tree on the device: where its nodes lie in a view, and the proxies of its objects.
#[derive(Debug)]
pub(in crate::query::gpu) struct PlacedTree {
    pub(in crate::query::gpu) flat: FlatTree,
    enclose: Enclose,
    project: ProjectBelow,
    pub(in crate::query::gpu) nodes: Nodes,
    /// By place.
    pub(in crate::query::gpu) objects: Asked,
}

impl PlacedTree {
    pub(in crate::query::gpu) fn new(device: &Device, shaders: &Shaders) -> Self {
        Self {
            flat: FlatTree::new(device),
            enclose: Enclose::new(device, &compiled(device, &shaders.enclose)),
            project: ProjectBelow::new(device, &compiled(device, &shaders.project)),
            nodes: enclose::nodes(device),
            objects: Asked::new(device),
        }
    }

    /// Takes a scene's tree over, and `others` with it, slots of objects beside those of the tree; returns the
    /// bytes uploaded. O(nodes + objects).
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many nodes or objects.
    pub(in crate::query::gpu) fn follow(
        &mut self,
        device: &Device,
        queue: &Queue,
        scene: &Scene,
        others: &[u32],
    ) -> Result<u64, Error> {
        let uploaded = self.flat.follow(device, queue, scene, others)?;
        self.nodes.resize(device, self.flat.node_count() as usize)?;
        self.objects.resize(device, self.flat.slots().len())?;
        Ok(uploaded)
    }

    /// Records the placing of all nodes in a view.
    pub(in crate::query::gpu) fn place_nodes(&self, tape: &mut Tape<'_>, bound: &Bound) {
        self.enclose.record(tape, &bound.view, &self.flat, &self.nodes);
    }

    /// Records that of objects, once it is known where the nodes lie: those at `wanted` places, so many.
    pub(in crate::query::gpu) fn place_objects(
        &self,
        tape: &mut Tape<'_>,
        bound: &Bound,
        boxes: BufferBinding<'_>,
        wanted: (BufferBinding<'_>, u32),
    ) {
        let boxes = (boxes, self.flat.places());
        self.project.record(tape, &bound.view, boxes, &self.nodes, &self.objects, wanted);
    }
}
