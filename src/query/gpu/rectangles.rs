//! Rectangles in one instanced draw, of all proxies or of what is listed, for fragment shaders that
//! write to buffers.
//!
//! The pass draws into a colour target of the viewport's size that nothing is written to, since a pass
//! must have an attachment.

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable, bytes_of};
use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferUsages, Color, ColorTargetState, ColorWrites, CommandEncoder,
    Device, Extent3d, FragmentState, LoadOp, Operations, PrimitiveState, PrimitiveTopology, Queue,
    RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline, RenderPipelineDescriptor, ShaderModule,
    StoreOp, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView, VertexAttribute,
    VertexBufferLayout, VertexFormat, VertexState, VertexStepMode,
};

use super::bind::Layouts;
use super::clock::{Purpose, Tape};
use super::pack::PackedProxy;
use super::sweep::array::DeviceArray;
use crate::Error;
use crate::geom::Viewport;

/// What the target holds does not matter.
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// Something in a list whose rectangle is drawn: the twin of the struct in `shaders/shared/listed.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Listed {
    rect: [u32; 4],
    index: u32,
    unused: [u32; 3],
}

/// What the device lists to be drawn: the arguments of the draw, in the room of one thing, and after them the
/// things.
#[derive(Debug)]
pub(super) struct List(DeviceArray<Listed>);

impl List {
    pub(super) fn new(device: &Device) -> Self {
        let read = BufferUsages::VERTEX | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST | read;
        Self(DeviceArray::new(device, "tercet list", usage))
    }

    /// Makes room for so many things. The upload happens when the encoder is submitted.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(super) fn resize(&mut self, device: &Device, queue: &Queue, things: usize) -> Result<(), Error> {
        self.0.resize(device, things.max(1) + 1)?;
        queue.write_buffer(self.0.buffer(), 0, bytes_of(&CORNERS));
        Ok(())
    }

    /// Records that it holds nothing.
    pub(super) fn clear(&self, encoder: &mut CommandEncoder) {
        encoder.clear_buffer(self.0.buffer(), COUNT_AT, Some(4));
    }

    /// Records the way of how many things it holds into a buffer, from a byte on.
    pub(super) fn copy_count(&self, encoder: &mut CommandEncoder, to: &Buffer, at: u64) {
        encoder.copy_buffer_to_buffer(self.0.buffer(), COUNT_AT, to, at, 4);
    }

    /// What stages bind that list things.
    pub(super) fn all(&self) -> BufferBinding<'_> {
        self.0.all()
    }
}

/// Vertices of a rectangle.
const CORNERS: u32 = 4;
/// The byte of a list where the number of its things is.
const COUNT_AT: u64 = 4;

/// Whose rectangles are drawn, as instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// Every proxy of a buffer.
    Proxies,
    /// What a [`List`] holds.
    List,
}

impl Of {
    /// The vertex stage.
    fn entry(self) -> &'static str {
        match self {
            Self::Proxies => "rectangle",
            Self::List => "listed_rectangle",
        }
    }

    fn layout(self) -> VertexBufferLayout<'static> {
        const LISTED: VertexBufferLayout<'static> = VertexBufferLayout {
            array_stride: size_of::<Listed>() as u64,
            step_mode: VertexStepMode::Instance,
            attributes: &[
                VertexAttribute {
                    format: VertexFormat::Uint32x4,
                    offset: offset_of!(Listed, rect) as u64,
                    shader_location: 0,
                },
                VertexAttribute {
                    format: VertexFormat::Uint32,
                    offset: offset_of!(Listed, index) as u64,
                    shader_location: 1,
                },
            ],
        };
        match self {
            Self::Proxies => PackedProxy::LAYOUT,
            Self::List => LISTED,
        }
    }
}

/// Which instances are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Instances<'a> {
    /// The first proxies of a buffer.
    Proxies(&'a Buffer, u32),
    Listed(&'a List),
}

/// A pass over rectangles.
#[derive(Debug)]
pub(super) struct Rectangles {
    label: &'static str,
    pipeline: RenderPipeline,
    canvas: Canvas,
}

impl Rectangles {
    /// The pass of a shader that has this fragment stage.
    pub(super) fn new(
        device: &Device,
        layouts: &Layouts,
        module: &ShaderModule,
        of: Of,
        (label, fragment): (&'static str, &str),
    ) -> Self {
        let nothing = ColorTargetState { format: FORMAT, blend: None, write_mask: ColorWrites::empty() };
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&layouts.pipeline),
            vertex: VertexState {
                module,
                entry_point: Some(of.entry()),
                compilation_options: Default::default(),
                buffers: &[Some(of.layout())],
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

    /// Records the pass over instances of the kind that it was made for, with these bind groups in order.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        groups: [&BindGroup; 2],
        instances: Instances<'_>,
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
        match instances {
            Instances::Proxies(proxies, count) => {
                pass.set_vertex_buffer(0, proxies.slice(..));
                pass.draw(0..CORNERS, 0..count);
            }
            Instances::Listed(List(list)) => {
                pass.set_vertex_buffer(0, list.buffer().slice(size_of::<Listed>() as u64..));
                pass.draw_indirect(list.buffer(), 0);
            }
        }
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

#[cfg(test)]
mod tests {
    use super::super::Shaders;
    use super::super::pack::tests::layout;
    use super::*;

    #[test]
    fn structs_lie_in_memory_as_the_shader_thinks() {
        let module = wgpu::naga::front::wgsl::parse_str(&Shaders::default().enlist).expect("it parses");
        let (members, _) = layout(&module, "List");
        assert_eq!(members[1], ("things".to_owned(), size_of::<Listed>() as u32));
        let (members, span) = layout(&module, "Listed");
        let index = offset_of!(Listed, index) as u32;
        assert_eq!(members, [("rect".to_owned(), 0), ("index".to_owned(), index)]);
        assert_eq!(span as usize, size_of::<Listed>());
    }
}
