//! The objects in the order in which they are drawn: by mesh, and then by slot.

use std::ops::Range;

use bytemuck::Zeroable;
use wgpu::{Device, Queue};

use super::BatchMesh;
use super::compact::PackedMesh;
use crate::Error;
use crate::query::gpu::sweep::mirror::Mirrored;
use crate::scene::{Batch, Scene};

/// The order, on the host and on the device. It changes with what is there, not with what moves.
#[derive(Debug)]
pub(super) struct Order {
    pub(super) slots: Mirrored<u32>,
    pub(super) mesh_of: Mirrored<u32>,
    pub(super) meshes: Mirrored<PackedMesh>,
    /// Where each mesh's objects begin, and the end.
    firsts: Vec<u32>,
    has_late: bool,
    /// Reused by uploads.
    scratch: (Vec<u32>, Vec<u32>, Vec<PackedMesh>),
}

impl Order {
    pub(super) fn new(device: &Device) -> Self {
        Self {
            slots: Mirrored::new(device, "tercet order"),
            mesh_of: Mirrored::new(device, "tercet meshes of objects"),
            meshes: Mirrored::new(device, "tercet meshes"),
            firsts: vec![0],
            has_late: false,
            scratch: Default::default(),
        }
    }

    /// Takes a scene's objects over; returns the bytes uploaded. A counting sort: O(slots + meshes).
    pub(super) fn follow(
        &mut self,
        device: &Device,
        queue: &Queue,
        scene: &Scene,
        meshes: &[BatchMesh],
    ) -> Result<u64, Error> {
        let store = scene.objects_store();
        let (slots, mesh_of, packed) = &mut self.scratch;
        self.has_late = false;
        self.firsts.clear();
        self.firsts.resize(meshes.len() + 1, 0);
        for slot in store.slots() {
            let batch = store.traits(slot).batch;
            let Some(mesh) = batch.filter(|batch| (batch.0 as usize) < meshes.len()) else {
                return Err(Error::Batch { object: store.object(slot), batch, meshes: meshes.len() });
            };
            self.firsts[mesh.0 as usize + 1] += 1;
            self.has_late |= !store.is_occluder(slot);
        }
        for mesh in 0..meshes.len() {
            self.firsts[mesh + 1] += self.firsts[mesh];
        }
        let count = self.firsts[meshes.len()] as usize;
        for list in [&mut *slots, &mut *mesh_of] {
            list.clear();
            list.resize(count, 0);
        }
        let mut next = self.firsts.clone();
        for slot in store.slots() {
            let mesh = store.traits(slot).batch.unwrap_or_default().0;
            let at = &mut next[mesh as usize];
            (slots[*at as usize], mesh_of[*at as usize]) = (slot, mesh);
            *at += 1;
        }
        packed.clear();
        packed.extend(meshes.iter().zip(self.firsts.windows(2)).map(|(mesh, range)| PackedMesh {
            first: range[0],
            end: range[1],
            index_count: mesh.index_count,
            first_index: mesh.first_index,
            base_vertex: mesh.base_vertex,
            ..PackedMesh::zeroed()
        }));
        let uploaded = self.slots.follow(device, queue, slots)?
            + self.mesh_of.follow(device, queue, mesh_of)?
            + self.meshes.follow(device, queue, packed)?;
        Ok(uploaded)
    }

    /// How many objects there are.
    pub(super) fn objects(&self) -> u32 {
        self.firsts.last().copied().unwrap_or(0)
    }

    /// Whether some object hides nothing.
    pub(super) fn has_late(&self) -> bool {
        self.has_late
    }

    /// Each mesh's objects, as places in the order.
    pub(super) fn runs(&self) -> impl Iterator<Item = (Batch, Range<u32>)> {
        let runs = self.firsts.windows(2).map(|range| range[0]..range[1]);
        (0..).map(Batch).zip(runs)
    }
}
