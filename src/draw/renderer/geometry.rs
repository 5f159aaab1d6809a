//! Meshes on the device.

use std::collections::HashMap;

use bytemuck::cast_slice;
use rayon::prelude::*;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages, Device};

use super::normals::{Vertex, with_normals};
use crate::scene::mesh::{Mesh, MeshId};

/// The meshes that have been drawn, a *group* for each of their levels.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    /// The group of a mesh's level 0; the other levels follow.
    first: HashMap<MeshId, u32>,
    groups: Vec<Group>,
}

/// A level of a mesh.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) vertices: Buffer,
    pub(super) indices: Buffer,
    pub(super) index_count: u32,
}

impl Geometry {
    /// The group of a mesh's level 0. Uploads all levels of a mesh that is new.
    pub(super) fn first_group(&mut self, device: &Device, mesh: &Mesh) -> u32 {
        *self.first.entry(mesh.id()).or_insert_with(|| {
            let first = self.groups.len() as u32;
            let levels: Vec<_> = mesh.levels().par_iter().map(with_normals).collect();
            self.groups
                .extend(levels.iter().map(|(vertices, indices)| Group::new(device, vertices, indices)));
            first
        })
    }

    pub(super) fn group(&self, group: u32) -> &Group {
        &self.groups[group as usize]
    }

    /// Drops a mesh's buffers, if it has some. O(meshes + levels).
    pub(super) fn forget(&mut self, mesh: &Mesh) {
        let Some(gone) = self.first.remove(&mesh.id()) else { return };
        let levels = mesh.levels().len() as u32;
        self.groups.drain(gone as usize..(gone + levels) as usize);
        self.first.values_mut().filter(|first| **first > gone).for_each(|first| *first -= levels);
    }

    /// How many meshes there are, and their bytes.
    pub(super) fn size(&self) -> (usize, u64) {
        let bytes = |group: &Group| group.vertices.size() + group.indices.size();
        (self.first.len(), self.groups.iter().map(bytes).sum())
    }
}

impl Group {
    fn new(device: &Device, vertices: &[Vertex], indices: &[u32]) -> Self {
        let buffer = |label, contents: &[u8], usage| {
            // There are no empty buffers.
            let contents = if contents.is_empty() { &[0; 4] } else { contents };
            device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents, usage })
        };
        Self {
            vertices: buffer("tercet vertices", cast_slice(vertices), BufferUsages::VERTEX),
            indices: buffer("tercet indices", cast_slice(indices), BufferUsages::INDEX),
            index_count: indices.len() as u32,
        }
    }
}
