//! Where the nodes of the tree lie on the screen: a rectangle and a nearest point each.
//!
//! # Why rays find what rasters find
//!
//! *Claim.* If the proxy of an object that is asked about covers a pixel with an entry nearness of at
//! least some n, then each node above the object has a rectangle that holds the pixel, and a nearest
//! point of at least n. So a ray through the pixel comes to the object.
//!
//! An object's proxy lies within its rectangle, and is nowhere nearer than its nearest point; so it is
//! enough that a node's rectangle holds those of its objects, and its point is as near. (Its outline
//! and planes would not do. Their slopes are those of edges as they were computed, and where two short
//! ones meet in f32, an outline may reach beyond that of a larger box.)
//!
//! Both come from the same stage (`place` in the shader), but a node's errors are taken three times.
//! Let e be by how much a computed corner may be wrong, and r how far a rectangle is moved outward for
//! that and everything else. Exactly, the node's corners lie no further inside than the object's; so
//! it is enough that 3r of the node is at least e of both and r of the object. By `project.rs`, e is
//! less than r/2; and r grows with coordinates and falls with the least w, which are the node's own
//! but for e again, at most a twelfth of w. The same holds for nearness.
//!
//! Who is *outside* with three times the error is outside with one. A box that may reach behind the
//! eye is outside only if it lies 100 pixels beside the view: an object below it that is asked about
//! has an r below 32 pixels, and a rectangle that is empty. Objects that cannot be asked about are
//! seen, whatever becomes of their nodes.

use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline, Device, ShaderModule,
    ShaderStages,
};

use super::asked::exactly;
use super::flat::FlatTree;
use super::{compute, dispatch};
use crate::Error;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;
use crate::query::gpu::guard::failed;

/// The twin of `Node` in `shaders/shared/nodes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(in crate::query::gpu) struct PackedNode {
    rect: [u32; 4],
    nearest: f32,
    enter: u32,
    skip: u32,
    first: u32,
    end: u32,
    parent: u32,
    verdict: u32,
    unused: u32,
}

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Enclose {
    layouts: Layouts,
    pipeline: ComputePipeline,
}

impl Enclose {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true)];
        let layouts = Layouts::new(device, ShaderStages::COMPUTE, buffers, DepthAs::Attachment);
        let pipeline = compute(device, &layouts, module, "enclose");
        Self { layouts, pipeline }
    }

    /// Records the enclosing of all nodes.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        view: &BindGroup,
        tree: &FlatTree,
        nodes: &Nodes,
    ) {
        let [boxes, links] = tree.nodes();
        let buffers = [(0, boxes), (1, links), (2, nodes.all())];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        dispatch(tape, "tercet enclose", &self.pipeline, [view, &bindings], nodes.count());
    }
}

/// The nodes of a tree on the screen.
#[derive(Debug)]
pub(in crate::query::gpu) struct Nodes {
    buffer: Buffer,
    count: u32,
}

impl Nodes {
    pub(in crate::query::gpu) fn new(device: &Device) -> Self {
        Self { buffer: buffer(device, 64), count: 0 }
    }

    /// Makes room for a number of nodes. What was there is lost.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(in crate::query::gpu) fn resize(&mut self, device: &Device, count: u32) -> Result<(), Error> {
        let most = device.limits().max_storage_buffer_binding_size / size_of::<PackedNode>() as u64;
        if u64::from(count) > most {
            return Err(failed(format!("it binds {most} nodes at most, and there are {count}")));
        }
        if u64::from(count) * size_of::<PackedNode>() as u64 > self.buffer.size() {
            self.buffer = buffer(device, u64::from(count + count / 2).min(most));
        }
        self.count = count;
        Ok(())
    }

    pub(in crate::query::gpu) fn count(&self) -> u32 {
        self.count
    }

    /// All nodes, and no more.
    pub(in crate::query::gpu) fn all(&self) -> BufferBinding<'_> {
        exactly(&self.buffer, self.count, size_of::<PackedNode>())
    }
}

fn buffer(device: &Device, nodes: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet nodes"),
        size: nodes * size_of::<PackedNode>() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::super::super::pack::tests::assert_same_layout;
    use super::*;
    use crate::query::gpu::Shaders;

    #[test]
    fn structs_lie_in_memory_as_the_shaders_think() {
        let Shaders { enclose, enlist, sweep_rays, .. } = Shaders::default();
        for source in [&enclose, &enlist, &sweep_rays.single, &sweep_rays.multisampled] {
            let module = wgpu::naga::front::wgsl::parse_str(source).expect("it parses");
            assert_same_layout!(
                &module,
                "Node",
                PackedNode,
                [rect, nearest, enter, skip, first, end, parent, verdict, unused]
            );
        }
    }
}
