//! Counting in a compute shader: a workgroup for each tile of each proxy's rectangle. Sample by
//! sample or block by block, the pass is the same; the shader and what it binds differ.

use wgpu::{ComputePipeline, ComputePipelineDescriptor, Device, ShaderModule, ShaderStages};

use super::batch::Batch;
use super::bind::{Bound, Layouts};
use super::clock::Tape;

/// The pass.
#[derive(Debug)]
pub(super) struct CountWorkgroups {
    pipeline: ComputePipeline,
    most_groups: u32,
}

impl CountWorkgroups {
    /// The stages that read the frame and the depth.
    pub(super) const STAGES: ShaderStages = ShaderStages::COMPUTE;

    /// Storage buffers of a batch, and whether they are written to.
    pub(super) const BUFFERS: &[(u32, bool)] = &[(0, false), (1, true), (2, false)];

    /// Invocations a workgroup, as the shader has them.
    pub(super) const INVOCATIONS: u32 = 64;

    pub(super) fn new(device: &Device, layouts: &Layouts, module: &ShaderModule) -> Self {
        let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some("tercet count workgroups"),
            layout: Some(&layouts.pipeline),
            module,
            entry_point: Some("count"),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { pipeline, most_groups: device.limits().max_compute_workgroups_per_dimension }
    }

    pub(super) fn record(&self, tape: &mut Tape<'_>, bound: &Bound<'_>, batch: &Batch) {
        let tiles = batch.questions.tiles.len() as u32;
        let rows = tiles.div_ceil(self.most_groups);
        let columns = tiles.div_ceil(rows);
        let mut pass = tape.compute_pass("tercet count workgroups");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound.frame, &[]);
        pass.set_bind_group(1, bound.batch, &[]);
        pass.dispatch_workgroups(columns, rows, 1);
    }
}
