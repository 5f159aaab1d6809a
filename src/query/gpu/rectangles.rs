//! The rectangles of all proxies in one instanced draw, for fragment shaders that write to buffers.
//!
//! The pass draws into a colour target of the viewport's size that nothing is written to, since a pass
//! must have an attachment.

use wgpu::{
    BindGroup, Buffer, Color, ColorTargetState, ColorWrites, Device, Extent3d, FragmentState, LoadOp,
    Operations, PrimitiveState, PrimitiveTopology, RenderPassColorAttachment, RenderPassDescriptor,
    RenderPipeline, RenderPipelineDescriptor, ShaderModule, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureView, VertexState,
};

use super::bind::Layouts;
use super::clock::{Purpose, Tape};
use super::pack::PackedProxy;
use crate::geom::Viewport;

/// What the target holds does not matter.
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// A pass over rectangles.
#[derive(Debug)]
pub(super) struct Rectangles {
    label: &'static str,
    pipeline: RenderPipeline,
    canvas: Canvas,
}

impl Rectangles {
    /// The pass of a shader that has the vertex stage `rectangle` and this fragment stage.
    pub(super) fn new(
        device: &Device,
        layouts: &Layouts,
        module: &ShaderModule,
        label: &'static str,
        fragment: &str,
    ) -> Self {
        let nothing = ColorTargetState { format: FORMAT, blend: None, write_mask: ColorWrites::empty() };
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(label),
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
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(nothing)],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { label, pipeline, canvas: Canvas::default() }
    }

    /// Records the pass over the first so many proxies of a buffer, with these bind groups in order.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        groups: [&BindGroup; 2],
        (proxies, count): (&Buffer, u32),
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
            label: Some(self.label),
            color_attachments: &attachments,
            ..Default::default()
        };
        let mut pass = tape.render_pass(Purpose::Question, descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, groups[0], &[]);
        pass.set_bind_group(1, groups[1], &[]);
        pass.set_vertex_buffer(0, proxies.slice(..));
        pass.draw(0..4, 0..count);
    }
}

/// What passes draw into that write nothing to it, and its size.
#[derive(Debug, Default)]
struct Canvas(Option<(TextureView, [u32; 2])>);

impl Canvas {
    /// One of a viewport's size.
    fn of(&mut self, device: &Device, viewport: Viewport) -> &TextureView {
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
