//! A stage of a sweep: a shader, what it binds, and how many invocations it takes.

use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline,
    ComputePipelineDescriptor, Device, ShaderModule, ShaderStages, TextureView,
};

use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Instances, Of, Rectangles};

/// The stages that read the frame and the depth.
pub(super) const STAGES: ShaderStages = ShaderStages::VERTEX_FRAGMENT.union(ShaderStages::COMPUTE);

/// Invocations a workgroup of the stages that look at boxes, as the shaders have them.
pub(in crate::query::gpu) const LANES: u32 = 64;

/// The bindings of a stage's storage buffers, and whether each is written to.
pub(in crate::query::gpu) type Writes<'a> = &'a [(u32, bool)];

/// What a stage binds at them.
pub(in crate::query::gpu) type Buffers<'a> = &'a [(u32, BufferBinding<'a>)];

/// A stage that computes.
#[derive(Debug)]
pub(in crate::query::gpu) struct Stage {
    label: &'static str,
    layouts: Layouts,
    pipeline: ComputePipeline,
}

impl Stage {
    /// A stage that looks at no texture.
    pub(in crate::query::gpu) fn new(
        device: &Device,
        module: &ShaderModule,
        names: (&'static str, &str),
        buffers: Writes<'_>,
    ) -> Self {
        let layouts = Layouts::new(device, ShaderStages::COMPUTE, buffers, DepthAs::Attachment);
        Self::of(device, module, names, layouts)
    }

    /// One that looks at the frame's depth, or at its item buffer.
    pub(super) fn on_texture(
        device: &Device,
        module: &ShaderModule,
        names: (&'static str, &str),
        buffers: Writes<'_>,
        texture: DepthAs,
    ) -> Self {
        Self::of(device, module, names, Layouts::new(device, STAGES, buffers, texture))
    }

    fn of(
        device: &Device,
        module: &ShaderModule,
        (label, entry): (&'static str, &str),
        layouts: Layouts,
    ) -> Self {
        Self { label, pipeline: compute(device, &layouts, module, entry), layouts }
    }

    /// Binds its uniforms, and the texture that it looks at.
    pub(in crate::query::gpu) fn bind(
        &self,
        device: &Device,
        uniforms: &Buffer,
        texture: Option<&TextureView>,
    ) -> BindGroup {
        bind::frame(device, &self.layouts.frame, uniforms, texture)
    }

    /// Binds nothing that it reads: group 0 must be something.
    pub(in crate::query::gpu) fn bind_nothing(&self, device: &Device) -> BindGroup {
        let unread = device.create_buffer(&BufferDescriptor {
            label: Some("tercet nothing"),
            size: 16,
            usage: BufferUsages::UNIFORM,
            mapped_at_creation: false,
        });
        self.bind(device, &unread, None)
    }

    /// Records an invocation each for a number of things, and some that have none.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        buffers: Buffers<'_>,
        count: u32,
    ) {
        let workgroups = grid(tape.device, count.div_ceil(LANES));
        self.dispatch(tape, frame, buffers, workgroups);
    }

    /// Records an invocation a pixel, and some beside the viewport.
    pub(super) fn record_pixels(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        buffers: Buffers<'_>,
        viewport: Viewport,
    ) {
        self.dispatch(tape, frame, buffers, tiles([viewport.width, viewport.height]));
    }

    fn dispatch(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        buffers: Buffers<'_>,
        [columns, rows]: [u32; 2],
    ) {
        let bindings = bind::storage(tape.device, &self.layouts.batch, buffers);
        let mut pass = tape.compute_pass(self.label);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &bindings, &[]);
        pass.dispatch_workgroups(columns, rows, 1);
    }
}

/// A stage whose invocations are the fragments of rectangles.
#[derive(Debug)]
pub(super) struct Drawn {
    layouts: Layouts,
    rectangles: Rectangles,
}

impl Drawn {
    pub(super) fn new(
        device: &Device,
        module: &ShaderModule,
        names: (&'static str, &str),
        buffers: Writes<'_>,
        (of, depth): (Of, DepthAs),
    ) -> Self {
        let layouts = Layouts::new(device, STAGES, buffers, depth);
        let rectangles = Rectangles::new(device, &layouts, module, of, names);
        Self { layouts, rectangles }
    }

    /// Records the drawing of instances of the kind that it was made for.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        buffers: Buffers<'_>,
        instances: Instances<'_>,
        viewport: Viewport,
    ) {
        let bindings = bind::storage(tape.device, &self.layouts.batch, buffers);
        self.rectangles.record(tape, [frame, &bindings], instances, viewport);
    }
}

/// A pipeline of a stage that computes.
pub(in crate::query::gpu) fn compute(
    device: &Device,
    layouts: &Layouts,
    module: &ShaderModule,
    entry: &str,
) -> ComputePipeline {
    device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some("tercet sweep"),
        layout: Some(&layouts.pipeline),
        module,
        entry_point: Some(entry),
        compilation_options: Default::default(),
        cache: None,
    })
}

/// Columns and rows of at least so many workgroups.
pub(in crate::query::gpu) fn grid(device: &Device, groups: u32) -> [u32; 2] {
    let rows = groups.div_ceil(device.limits().max_compute_workgroups_per_dimension).max(1);
    [groups.div_ceil(rows), rows]
}

/// Workgroups, across and down, of the stages that look at pixels, as the shaders have them.
pub(super) fn tiles(pixels: [u32; 2]) -> [u32; 2] {
    const SIDE: u32 = 8;
    pixels.map(|side| side.div_ceil(SIDE))
}
