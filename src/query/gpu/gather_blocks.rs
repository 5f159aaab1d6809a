//! Gathering the least and greatest nearness of each block of pixels, for
//! [`Counting::Blocks`](super::Counting::Blocks).

use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline,
    ComputePipelineDescriptor, Device, ShaderModule,
};

use super::bind::{self, DepthAs, Layouts};
use super::clock::Tape;
use super::count_workgroups::CountWorkgroups;
use super::pack::BLOCK;
use crate::geom::Viewport;

/// The binding of the blocks, here and where they are read.
pub(super) const BINDING: u32 = 3;

/// The pass.
#[derive(Debug)]
pub(super) struct GatherBlocks {
    layouts: Layouts,
    pipeline: ComputePipeline,
    /// The blocks of the viewport, what the pass binds of them, and how many columns and rows.
    blocks: Option<(Buffer, BindGroup, [u32; 2])>,
}

impl GatherBlocks {
    pub(super) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let layouts = Layouts::new(device, CountWorkgroups::STAGES, &[(BINDING, true)], depth);
        let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some("tercet gather blocks"),
            layout: Some(&layouts.pipeline),
            module,
            entry_point: Some("gather"),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { layouts, pipeline, blocks: None }
    }

    /// Makes room for a viewport's blocks. They hold nothing yet if the size is new.
    pub(super) fn resize(&mut self, device: &Device, viewport: Viewport) {
        let grid = [viewport.width.div_ceil(BLOCK), viewport.height.div_ceil(BLOCK)];
        if self.blocks.as_ref().is_some_and(|(_, _, had)| *had == grid) {
            return;
        }
        let buffer = device.create_buffer(&BufferDescriptor {
            label: Some("tercet blocks"),
            size: 8 * u64::from(grid[0]) * u64::from(grid[1]),
            usage: BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let bindings =
            bind::storage(device, &self.layouts.batch, &[(BINDING, buffer.as_entire_buffer_binding())]);
        self.blocks = Some((buffer, bindings, grid));
    }

    /// What was gathered last.
    pub(super) fn binding(&self) -> Option<BufferBinding<'_>> {
        self.blocks.as_ref().map(|(buffer, _, _)| buffer.as_entire_buffer_binding())
    }

    /// Records the gathering from the depth of a frame.
    pub(super) fn record(&self, tape: &mut Tape<'_>, frame: &BindGroup) {
        /// Invocations along each side of a workgroup, as the shader has them.
        const SIDE: u32 = 8;
        let Some((_, bindings, [columns, rows])) = &self.blocks else { return };
        let mut pass = tape.compute_pass("tercet gather blocks");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, bindings, &[]);
        pass.dispatch_workgroups(columns.div_ceil(SIDE), rows.div_ceil(SIDE), 1);
    }
}
