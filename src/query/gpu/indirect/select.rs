//! Which objects a list of the frame holds: predicate and prefix sum.

use bytemuck::{Pod, Zeroable, bytes_of};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline, Device, Queue,
    ShaderModule, ShaderStages,
};

use super::super::bind::{self, DepthAs, Layouts};
use super::super::clock::Tape;
use super::super::sweep::array::exactly;
use super::super::sweep::{compute, grid};

/// The lists of a frame, in the order of drawing: the twins of the constants in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// What the last frame found visible.
    First,
    /// What tests have found since.
    Missed,
    /// What hides nothing.
    Last,
}

impl Which {
    pub(super) const ALL: [Self; 3] = [Self::First, Self::Missed, Self::Last];
}

/// The twin of `List` in `shaders/indirect/select.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct PackedList {
    which: u32,
    count: u32,
    unused: [u32; 2],
}

/// Invocations a workgroup, as the shader has them.
const LANES: u32 = 256;

/// What a list is selected from, on the device.
#[derive(Clone, Debug)]
pub(super) struct Source<'a> {
    pub(super) boxes: BufferBinding<'a>,
    pub(super) order: BufferBinding<'a>,
    pub(super) verdicts: BufferBinding<'a>,
    pub(super) remembered: BufferBinding<'a>,
}

/// The passes, and what they add up in.
#[derive(Debug)]
pub(super) struct Select {
    layouts: Layouts,
    stages: [ComputePipeline; 3],
    lists: [Buffer; 3],
    uniforms: [BindGroup; 3],
    sums: Buffer,
    before: Buffer,
    count: u32,
}

impl Select {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = [(0, false), (1, false), (2, false), (3, true), (4, true), (5, true)];
        let layouts = Layouts::new(device, ShaderStages::COMPUTE, &buffers, DepthAs::Attachment);
        let lists = Which::ALL.map(|_| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("tercet list"),
                contents: bytes_of(&PackedList::default()),
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            })
        });
        Self {
            stages: ["count", "add_up", "number"].map(|entry| compute(device, &layouts, module, entry)),
            uniforms: lists.each_ref().map(|list| bind::frame(device, &layouts.frame, list, None)),
            layouts,
            lists,
            sums: words(device, 1),
            before: words(device, 2),
            count: 0,
        }
    }

    /// Makes room for a number of objects.
    pub(super) fn resize(&mut self, device: &Device, queue: &Queue, count: u32) {
        if u64::from(count) * 4 + 4 > self.before.size() {
            let room = count + count / 2;
            (self.sums, self.before) = (words(device, room.div_ceil(LANES)), words(device, room + 1));
        }
        self.count = count;
        for (which, list) in Which::ALL.into_iter().zip(&self.lists) {
            queue.write_buffer(list, 0, bytes_of(&PackedList { which: which as u32, count, unused: [0; 2] }));
        }
    }

    /// How many of the list that was selected last come before each object, and before the end.
    pub(super) fn before(&self) -> BufferBinding<'_> {
        exactly(&self.before, self.count + 1, size_of::<u32>())
    }

    /// Records the selection of a list. What is remembered of objects changes with it.
    pub(super) fn record(&self, tape: &mut Tape<'_>, which: Which, source: &Source<'_>) {
        let sums = exactly(&self.sums, self.count.div_ceil(LANES), size_of::<u32>());
        let Source { boxes, order, verdicts, remembered } = source.clone();
        let buffers = [(0, boxes), (1, order), (2, verdicts), (3, remembered), (4, sums), (5, self.before())];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        let [columns, rows] = grid(tape.device, self.count.div_ceil(LANES));
        let mut pass = tape.compute_pass("tercet select");
        pass.set_bind_group(0, &self.uniforms[which as usize], &[]);
        pass.set_bind_group(1, &bindings, &[]);
        for (stage, [columns, rows]) in self.stages.iter().zip([[columns, rows], [1, 1], [columns, rows]]) {
            pass.set_pipeline(stage);
            pass.dispatch_workgroups(columns, rows, 1);
        }
    }
}

fn words(device: &Device, count: u32) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet sums"),
        size: 4 * u64::from(count.max(1)),
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
    fn structs_lie_in_memory_as_the_shader_thinks() {
        let module = wgpu::naga::front::wgsl::parse_str(&Shaders::default().select).expect("it parses");
        assert_same_layout!(&module, "List", PackedList, [which, count, unused]);
        super::super::super::sweep::boxes::PackedBox::assert_layout(&module);
    }
}
