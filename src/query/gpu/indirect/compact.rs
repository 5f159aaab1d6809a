//! Lists of instances, mesh by mesh, and the arguments of their draws.

use bytemuck::{Pod, Zeroable};
use wgpu::util::DrawIndexedIndirectArgs;
use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline, Device, ShaderModule,
    ShaderStages,
};

use super::super::bind::{self, DepthAs, Layouts};
use super::super::clock::Tape;
use super::super::sweep::array::exactly;
use super::super::sweep::{LANES, compute, grid};

/// A mesh's objects in the order of all, and its part of the app's index buffer: the twin of `Mesh`
/// in `shaders/indirect/compact.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(super) struct PackedMesh {
    pub(super) first: u32,
    pub(super) end: u32,
    pub(super) index_count: u32,
    pub(super) first_index: u32,
    pub(super) base_vertex: i32,
    pub(super) unused: u32,
}

/// The bytes of a draw's arguments.
pub(super) const ARGUMENTS: u64 = size_of::<DrawIndexedIndirectArgs>() as u64;

/// What a list is put together from, on the device.
#[derive(Clone, Debug)]
pub(super) struct Parts<'a> {
    pub(super) order: BufferBinding<'a>,
    pub(super) mesh_of: BufferBinding<'a>,
    pub(super) meshes: BufferBinding<'a>,
    pub(super) before: BufferBinding<'a>,
}

/// A list of a frame: slots, and the arguments of the draws.
#[derive(Debug)]
pub(super) struct Instances {
    pub(super) instances: Buffer,
    pub(super) arguments: Buffer,
}

impl Instances {
    pub(super) fn new(device: &Device, objects: u32, meshes: u32) -> Self {
        let buffer = |label, size, usage| {
            let usage = usage | BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let slots = 4 * u64::from(objects.max(1));
        let arguments = ARGUMENTS * u64::from(meshes.max(1));
        Self {
            instances: buffer("tercet instances", slots, BufferUsages::VERTEX),
            arguments: buffer("tercet arguments", arguments, BufferUsages::INDIRECT),
        }
    }

    /// Whether there is room.
    pub(super) fn holds(&self, objects: u32, meshes: u32) -> bool {
        let has = |buffer: &Buffer, bytes| buffer.size() >= bytes;
        has(&self.instances, 4 * u64::from(objects)) && has(&self.arguments, ARGUMENTS * u64::from(meshes))
    }
}

/// The passes.
#[derive(Debug)]
pub(super) struct Compact {
    layouts: Layouts,
    /// Nothing, but group 0 must be something.
    nothing: BindGroup,
    gather: ComputePipeline,
    argue: ComputePipeline,
}

impl Compact {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = [(0, false), (1, false), (2, false), (3, false), (4, true), (5, true)];
        let layouts = Layouts::new(device, ShaderStages::COMPUTE, &buffers, DepthAs::Attachment);
        let unread = device.create_buffer(&BufferDescriptor {
            label: Some("tercet nothing"),
            size: 16,
            usage: BufferUsages::UNIFORM,
            mapped_at_creation: false,
        });
        Self {
            nothing: bind::frame(device, &layouts.frame, &unread, None),
            gather: compute(device, &layouts, module, "gather"),
            argue: compute(device, &layouts, module, "argue"),
            layouts,
        }
    }

    /// Records the making of a list, of so many objects and meshes, from what was selected.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        parts: &Parts<'_>,
        [objects, meshes]: [u32; 2],
        to: &Instances,
    ) {
        let Parts { order, mesh_of, meshes: all, before } = parts.clone();
        let instances = exactly(&to.instances, objects, size_of::<u32>());
        let arguments = exactly(&to.arguments, meshes, ARGUMENTS as usize);
        let buffers = [(0, order), (1, mesh_of), (2, all), (3, before), (4, instances), (5, arguments)];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        let grids = [objects, meshes].map(|count| grid(tape.device, count.div_ceil(LANES)));
        let mut pass = tape.compute_pass("tercet compact");
        pass.set_bind_group(0, &self.nothing, &[]);
        pass.set_bind_group(1, &bindings, &[]);
        for (stage, [columns, rows]) in [&self.gather, &self.argue].into_iter().zip(grids) {
            pass.set_pipeline(stage);
            pass.dispatch_workgroups(columns, rows, 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::super::super::pack::tests::assert_same_layout;
    use super::*;
    use crate::query::gpu::Shaders;

    #[test]
    fn structs_lie_in_memory_as_the_shader_thinks() {
        let module = wgpu::naga::front::wgsl::parse_str(&Shaders::default().compact).expect("it parses");
        assert_same_layout!(
            &module,
            "Mesh",
            PackedMesh,
            [first, end, index_count, first_index, base_vertex, unused]
        );
        assert_same_layout!(
            &module,
            "Arguments",
            DrawIndexedIndirectArgs,
            [index_count, instance_count, first_index, base_vertex, first_instance]
        );
    }
}
