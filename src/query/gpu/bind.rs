//! What the shaders bind: group 0 is the frame (view and depth), group 1 a batch of questions.

use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Buffer, BufferBinding, BufferBindingType, Device,
    PipelineLayout, PipelineLayoutDescriptor, ShaderStages, TextureSampleType, TextureView,
    TextureViewDimension,
};

/// The binding of the proxies, wherever they are read.
pub(super) const PROXIES: u32 = 0;

/// How a pass uses the depth of the app.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthAs {
    /// It loads texels of one sample.
    Texture,
    /// It loads texels of several samples.
    Multisampled,
    /// It does not, but loads those of an item buffer in its place.
    Ids { multisampled: bool },
    /// The depth test reads it: nothing is bound.
    Attachment,
}

impl DepthAs {
    /// What a counting pass reads.
    pub(super) fn texture(multisampled: bool) -> Self {
        if multisampled { Self::Multisampled } else { Self::Texture }
    }
}

/// The layouts of a pass.
#[derive(Debug)]
pub(super) struct Layouts {
    pub(super) frame: BindGroupLayout,
    pub(super) batch: BindGroupLayout,
    pub(super) pipeline: PipelineLayout,
}

/// What a recorded pass binds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound<'a> {
    pub(super) frame: &'a BindGroup,
    pub(super) batch: &'a BindGroup,
}

impl Layouts {
    /// `frame_stages` read the frame; the last of them, the one that counts, reads the rest.
    /// `buffers` are the bindings of the storage buffers of a batch, and whether each is written to.
    pub(super) fn new(
        device: &Device,
        frame_stages: ShaderStages,
        buffers: &[(u32, bool)],
        depth: DepthAs,
    ) -> Self {
        let counting = frame_stages.difference(ShaderStages::VERTEX);
        let mut frame = vec![entry(0, frame_stages, buffer(BufferBindingType::Uniform))];
        if depth != DepthAs::Attachment {
            let (sample_type, multisampled) = match depth {
                DepthAs::Ids { multisampled } => (TextureSampleType::Uint, multisampled),
                // Depth as plain numbers: depth textures cannot be loaded from on OpenGL.
                _ => (TextureSampleType::Float { filterable: false }, depth == DepthAs::Multisampled),
            };
            let texture =
                BindingType::Texture { sample_type, view_dimension: TextureViewDimension::D2, multisampled };
            frame.push(entry(1, counting, texture));
        }
        let storage = |&(binding, written): &(u32, bool)| {
            entry(binding, counting, buffer(BufferBindingType::Storage { read_only: !written }))
        };
        let batch: Vec<_> = buffers.iter().map(storage).collect();
        let layout = |label, entries: &[BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let (frame, batch) = (layout("tercet frame", &frame), layout("tercet batch", &batch));
        let pipeline = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some("tercet count"),
            bind_group_layouts: &[Some(&frame), Some(&batch)],
            immediate_size: 0,
        });
        Self { frame, batch, pipeline }
    }
}

/// Binds a frame; the depth, or an item buffer, for passes that bind it.
pub(super) fn frame(
    device: &Device,
    layout: &BindGroupLayout,
    uniforms: &Buffer,
    depth: Option<&TextureView>,
) -> BindGroup {
    let mut entries = vec![BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }];
    let texture = |view| BindGroupEntry { binding: 1, resource: BindingResource::TextureView(view) };
    entries.extend(depth.map(texture));
    device.create_bind_group(&BindGroupDescriptor { label: Some("tercet frame"), layout, entries: &entries })
}

/// Binds storage buffers.
pub(super) fn storage(
    device: &Device,
    layout: &BindGroupLayout,
    buffers: &[(u32, BufferBinding<'_>)],
) -> BindGroup {
    let bound = |buffer: &_| BindingResource::Buffer(BufferBinding::clone(buffer));
    let entries: Vec<_> = buffers
        .iter()
        .map(|(binding, buffer)| BindGroupEntry { binding: *binding, resource: bound(buffer) })
        .collect();
    device.create_bind_group(&BindGroupDescriptor { label: Some("tercet batch"), layout, entries: &entries })
}

fn entry(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}
