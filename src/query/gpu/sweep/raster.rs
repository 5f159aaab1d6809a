//! The test of ROC (Lee et al. 2021, and those before): proxies are drawn, and a fragment in sight
//! stores a flag. See `count_fragments.rs` for why no early depth test is forced.

use wgpu::{
    BindGroup, Color, ColorTargetState, ColorWrites, Device, FragmentState, LoadOp, Operations,
    PrimitiveState, PrimitiveTopology, RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline,
    RenderPipelineDescriptor, ShaderModule, StoreOp, VertexState,
};

use super::STAGES;
use super::asked::Asked;
use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::{Purpose, Tape};
use crate::query::gpu::count_fragments::{Canvas, FORMAT};
use crate::query::gpu::pack::PackedProxy;

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Raster {
    layouts: Layouts,
    pipeline: RenderPipeline,
    canvas: Canvas,
}

impl Raster {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let layouts = Layouts::new(device, STAGES, &[(0, false), (2, true)], depth);
        let nothing = ColorTargetState { format: FORMAT, blend: None, write_mask: ColorWrites::empty() };
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("tercet raster"),
            layout: Some(&layouts.pipeline),
            vertex: VertexState {
                module,
                entry_point: Some("rectangle"),
                compilation_options: Default::default(),
                buffers: &[Some(PackedProxy::LAYOUT)],
            },
            primitive: PrimitiveState { topology: PrimitiveTopology::TriangleStrip, ..Default::default() },
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(FragmentState {
                module,
                entry_point: Some("look"),
                compilation_options: Default::default(),
                targets: &[Some(nothing)],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { layouts, pipeline, canvas: Canvas::default() }
    }

    /// Records the looking for samples in sight, of all proxies that have a rectangle.
    pub(in crate::query::gpu) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        asked: &Asked,
        viewport: Viewport,
    ) {
        let buffers = [(0, asked.proxies()), (2, asked.verdicts())];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        let attachment = RenderPassColorAttachment {
            view: self.canvas.of(tape.device, viewport),
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: LoadOp::Clear(Color::BLACK), store: StoreOp::Discard },
        };
        let attachments = [Some(attachment)];
        let descriptor = RenderPassDescriptor {
            label: Some("tercet raster"),
            color_attachments: &attachments,
            ..Default::default()
        };
        let mut pass = tape.render_pass(Purpose::Question, descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &bindings, &[]);
        pass.set_vertex_buffer(0, asked.instances().slice(..));
        pass.draw(0..4, 0..asked.count());
    }
}
