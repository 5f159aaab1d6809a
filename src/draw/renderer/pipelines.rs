//! The pipelines, made when they are first needed.

use std::collections::HashMap;

use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Buffer, BufferBinding, BufferBindingType,
    ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, Device, FragmentState,
    MultisampleState, PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, PrimitiveState,
    Queue, RenderPass, RenderPipeline, RenderPipelineDescriptor, ShaderModule, ShaderModuleDescriptor,
    ShaderSource, ShaderStages, TextureFormat, VertexState,
};

use super::Renderer;
use super::kinds::{Depth, Kind, Recipe, Source};
use super::look_ups::LookUps;
use crate::geom::{DepthDirection, DepthFormat, View};

/// The shaders' sources: surfaces, and what lies over them. WGSL has no includes: the parts are put
/// together when the crate is built.
pub(super) const SOURCES: [&str; 2] = [
    concat!(
        include_str!("../../../shaders/shared/camera.wgsl"),
        include_str!("../../../shaders/surfaces.wgsl"),
        include_str!("../../../shaders/with_id.wgsl"),
        include_str!("../../../shaders/by_slot.wgsl")
    ),
    concat!(
        include_str!("../../../shaders/shared/camera.wgsl"),
        include_str!("../../../shaders/overlays.wgsl")
    ),
];

/// What else it depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    kind: Kind,
    source: Source,
    is_reversed: bool,
    is_float: bool,
    samples: u32,
}

#[derive(Debug)]
pub(super) struct Pipelines {
    color: Option<TextureFormat>,
    has_ids: bool,
    modules: [ShaderModule; 2],
    camera: BindGroupLayout,
    /// The same with objects by slot. Made when first needed: not every device has storage buffers in
    /// vertex shaders.
    by_slot: Option<BindGroupLayout>,
    /// Made when they are first needed, too.
    look_ups: Option<LookUps>,
    made: HashMap<Key, RenderPipeline>,
}

impl Pipelines {
    pub(super) fn new(device: &Device, color: Option<TextureFormat>, has_ids: bool) -> Self {
        let modules = SOURCES.map(|source| {
            device.create_shader_module(ShaderModuleDescriptor {
                label: Some("tercet renderer"),
                source: ShaderSource::Wgsl(source.into()),
            })
        });
        let camera = group_layout(device, &[CAMERA]);
        Self { color, has_ids, modules, camera, by_slot: None, look_ups: None, made: HashMap::new() }
    }

    /// Binds the uniforms, for [`Source::Instances`].
    pub(super) fn bind(&self, device: &Device, uniforms: &Buffer) -> BindGroup {
        bind(device, &self.camera, [uniforms.as_entire_binding()])
    }

    /// Binds them with all objects, for [`Source::Slots`].
    pub(super) fn bind_by_slot(
        &mut self,
        device: &Device,
        uniforms: &Buffer,
        objects: BufferBinding<'_>,
    ) -> BindGroup {
        let layout = layout_by_slot(&mut self.by_slot, device);
        bind(device, layout, [uniforms.as_entire_binding(), BindingResource::Buffer(objects)])
    }

    /// Sets the pipeline for a view's target, and what it reads beside group 0.
    pub(super) fn set(
        &mut self,
        pass: &mut RenderPass<'static>,
        (device, queue): (&Device, &Queue),
        kind: Kind,
        source: Source,
        view: &View,
    ) {
        let key = Key {
            kind,
            source,
            is_reversed: view.depth() == DepthDirection::Reversed,
            is_float: view.format() == DepthFormat::Depth32Float,
            samples: view.samples(),
        };
        let Self { color, has_ids, modules, camera, by_slot, look_ups, made } = self;
        let look_ups = match kind {
            Kind::LookUps(_) => Some(&*look_ups.get_or_insert_with(|| LookUps::new(device, queue))),
            _ => None,
        };
        if let Some(look_ups) = look_ups {
            pass.set_bind_group(1, &look_ups.bindings, &[]);
        }
        let pipeline = made.entry(key).or_insert_with(|| {
            let first = match source {
                Source::Instances | Source::Identified => &*camera,
                Source::Slots => layout_by_slot(by_slot, device),
            };
            let groups: Vec<_> =
                std::iter::once(Some(first)).chain(look_ups.map(|it| Some(&it.layout))).collect();
            let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some("tercet renderer"),
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            key.make(device, modules, &layout, (*color, *has_ids))
        });
        pass.set_pipeline(pipeline);
    }
}

const CAMERA: (ShaderStages, BufferBindingType) = (ShaderStages::VERTEX_FRAGMENT, BufferBindingType::Uniform);
const OBJECTS: (ShaderStages, BufferBindingType) =
    (ShaderStages::VERTEX, BufferBindingType::Storage { read_only: true });

fn layout_by_slot<'a>(layout: &'a mut Option<BindGroupLayout>, device: &Device) -> &'a BindGroupLayout {
    layout.get_or_insert_with(|| group_layout(device, &[CAMERA, OBJECTS]))
}

/// A group of buffers, from binding 0 on.
fn group_layout(device: &Device, buffers: &[(ShaderStages, BufferBindingType)]) -> BindGroupLayout {
    let entry = |(binding, &(visibility, ty))| BindGroupLayoutEntry {
        binding,
        visibility,
        ty: BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let entries: Vec<_> = (0..).zip(buffers).map(entry).collect();
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some("tercet camera"),
        entries: &entries,
    })
}

fn bind<const N: usize>(
    device: &Device,
    layout: &BindGroupLayout,
    resources: [BindingResource<'_>; N],
) -> BindGroup {
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&BindGroupDescriptor { label: Some("tercet camera"), layout, entries: &entries })
}

impl Key {
    fn make(
        &self,
        device: &Device,
        [surfaces, overlays]: &[ShaderModule; 2],
        layout: &PipelineLayout,
        (color, has_ids): (Option<TextureFormat>, bool),
    ) -> RenderPipeline {
        let Recipe { stages, buffers, topology, blend, draws_color, draws_ids, depth } =
            self.kind.recipe(self.source);
        let constants: Vec<(&str, f64)> = match self.kind {
            Kind::LookUps(count) => vec![("look_ups", count.into())],
            _ => Vec::new(),
        };
        let module = if self.kind.is_surface() { surfaces } else { overlays };
        let mask = |writes| if writes { ColorWrites::ALL } else { ColorWrites::empty() };
        let write_mask = mask(draws_color);
        let color = color.map(|format| ColorTargetState { format, blend, write_mask });
        let write_mask = mask(draws_ids);
        let ids = ColorTargetState { format: Renderer::IDS, blend: None, write_mask };
        let targets = if has_ids { vec![color, Some(ids)] } else { vec![color] };
        let fragment = targets.iter().any(Option::is_some).then_some(FragmentState {
            module,
            entry_point: Some(stages[1]),
            compilation_options: PipelineCompilationOptions { constants: &constants, ..Default::default() },
            targets: &targets,
        });
        let buffers: Vec<_> = buffers.into_iter().map(Some).collect();
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("tercet renderer"),
            layout: Some(layout),
            vertex: VertexState {
                module,
                entry_point: Some(stages[0]),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: PrimitiveState { topology, ..Default::default() },
            depth_stencil: Some(DepthStencilState {
                format: if self.is_float { TextureFormat::Depth32Float } else { TextureFormat::Depth24Plus },
                depth_write_enabled: Some(depth == Depth::TestedAndWritten),
                depth_compare: Some(match (depth, self.is_reversed) {
                    (Depth::Ignored, _) => CompareFunction::Always,
                    (_, true) => CompareFunction::GreaterEqual,
                    (_, false) => CompareFunction::LessEqual,
                }),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: MultisampleState { count: self.samples, ..Default::default() },
            fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use wgpu::naga::ShaderStage;
    use wgpu::naga::back::{glsl, pipeline_constants};
    use wgpu::naga::front::wgsl;
    use wgpu::naga::proc::BoundsCheckPolicies;
    use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    const KINDS: [Kind; 9] = [
        Kind::Lit,
        Kind::LookUps(1),
        Kind::Unlit,
        Kind::Depth,
        Kind::Layers,
        Kind::Edges,
        Kind::XRayEdges,
        Kind::Polygons,
        Kind::Borders,
    ];

    /// Without a device: valid WGSL that needs no optional capability and can be written as the
    /// GLSL that OpenGL takes, with the stages that the pipelines start.
    #[test]
    fn shaders_are_valid_and_portable() {
        for (source, of_surfaces) in SOURCES.into_iter().zip([true, false]) {
            let module =
                wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
            let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
            let constants = Default::default();
            let (module, info) = pipeline_constants::process_overrides(&module, &info, None, &constants)
                .expect("every constant has a default");
            for entry in &module.entry_points {
                let options = glsl::Options {
                    version: glsl::Version::Embedded { version: 310, is_webgl: false },
                    ..glsl::Options::default()
                };
                let pipeline = glsl::PipelineOptions {
                    shader_stage: entry.stage,
                    entry_point: entry.name.clone(),
                    multiview: None,
                };
                let (mut out, policies) = (String::new(), BoundsCheckPolicies::default());
                let writer = glsl::Writer::new(&mut out, &module, &info, &options, &pipeline, policies);
                let written = writer.and_then(|mut writer| writer.write());
                written.unwrap_or_else(|error| panic!("{}: {error}", entry.name));
            }
            let wanted = KINDS.iter().filter(|kind| kind.is_surface() == of_surfaces);
            let sources = [Source::Instances, Source::Identified, Source::Slots];
            let wanted = wanted.flat_map(|kind| sources.map(|source| kind.recipe(source).stages));
            let wanted: Vec<_> = wanted.flatten().collect();
            let exists = |name: &str, stage| {
                module.entry_points.iter().any(|entry| entry.name == name && entry.stage == stage)
            };
            for pair in wanted.as_chunks::<2>().0 {
                assert!(exists(pair[0], ShaderStage::Vertex) && exists(pair[1], ShaderStage::Fragment));
            }
            assert!(module.entry_points.iter().all(|entry| wanted.contains(&entry.name.as_str())));
        }
    }
}
