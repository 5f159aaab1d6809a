//! Counting in a fragment shader: the rectangles of all proxies in one instanced draw.
//!
//! It needs nothing but storage buffers in fragment shaders. The pass draws into a colour target
//! of the viewport's size that nothing is written to, since a pass must have an attachment.
//!
//! # No forced early depth test
//!
//! `@early_depth_test(force)` would spare hidden fragments their invocations where a device has it.
//! It is not used. Forced, the test sees the depth of the triangles, not one that the shader writes;
//! the entry depth is not planar, and the corners of its faces are snapped, which moves a tilted
//! plane by more than the bound in `pack.rs`. So it could decide no answer exactly: only sort out
//! what lies behind a proxy's nearest point. And hidden fragments must run all the same, to be
//! counted in the total: it would take a second draw of everything. On a software adapter, to
//! rasterise the pixels of large boxes twice without any fragment shader already takes about as long
//! as to count them in blocks (docs/measurements/queries.md).

use wgpu::{
    Color, ColorTargetState, ColorWrites, Device, Extent3d, FragmentState, LoadOp, Operations,
    PrimitiveState, PrimitiveTopology, RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline,
    RenderPipelineDescriptor, ShaderModule, ShaderStages, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureView, VertexState,
};

use super::batch::Batch;
use super::bind::{Bound, Layouts};
use super::clock::{Purpose, Tape};
use super::pack::PackedProxy;
use crate::geom::Viewport;

/// What the target holds does not matter.
pub(super) const FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// The pass.
#[derive(Debug)]
pub(super) struct CountFragments {
    pipeline: RenderPipeline,
    canvas: Canvas,
}

impl CountFragments {
    /// The stages that read the frame and the depth.
    pub(super) const STAGES: ShaderStages = ShaderStages::VERTEX_FRAGMENT;

    /// Storage buffers of a batch, and whether they are written to.
    pub(super) const BUFFERS: &[(u32, bool)] = &[(0, false), (1, true)];

    pub(super) fn new(device: &Device, layouts: &Layouts, module: &ShaderModule) -> Self {
        let nothing = ColorTargetState { format: FORMAT, blend: None, write_mask: ColorWrites::empty() };
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("tercet count fragments"),
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
                entry_point: Some("count"),
                compilation_options: Default::default(),
                targets: &[Some(nothing)],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, canvas: Canvas::default() }
    }

    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        bound: &Bound<'_>,
        batch: &Batch,
        viewport: Viewport,
    ) {
        let attachment = RenderPassColorAttachment {
            view: self.canvas.of(tape.device, viewport),
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: LoadOp::Clear(Color::BLACK), store: StoreOp::Discard },
        };
        let attachments = [Some(attachment)];
        let descriptor = RenderPassDescriptor {
            label: Some("tercet count fragments"),
            color_attachments: &attachments,
            ..Default::default()
        };
        let mut pass = tape.render_pass(Purpose::Question, descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound.frame, &[]);
        pass.set_bind_group(1, bound.batch, &[]);
        pass.set_vertex_buffer(0, batch.proxies.slice(..));
        pass.draw(0..4, 0..batch.questions.proxies.len() as u32);
    }
}

/// What passes draw into that write nothing to it, and its size.
#[derive(Debug, Default)]
pub(super) struct Canvas(Option<(TextureView, [u32; 2])>);

impl Canvas {
    /// One of a viewport's size.
    pub(super) fn of(&mut self, device: &Device, viewport: Viewport) -> &TextureView {
        let size = [viewport.width, viewport.height];
        let canvas = self.0.take().filter(|&(_, had)| had == size);
        &self.0.insert(canvas.unwrap_or_else(|| (canvas_of(device, size), size))).0
    }
}

fn canvas_of(device: &Device, [width, height]: [u32; 2]) -> TextureView {
    let descriptor = TextureDescriptor {
        label: Some("tercet canvas"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: FORMAT,
        usage: TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    };
    device.create_texture(&descriptor).create_view(&Default::default())
}
