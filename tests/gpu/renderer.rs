//! The least renderer that an app could have: a vertex buffer a mesh, a draw call an object. And
//! the truth about a frame, by drawing everything with it.

use std::collections::HashMap;

use glam::Mat4;
use hecs::{Entity, World};
use tercet::draw::{Detail, Drawable};
use tercet::geom::{DepthDirection, DepthFormat, View};
use tercet::scene::mesh::Level;
use tercet::scene::{ObjectRef, ObjectSet, Scene};
use wgpu::util::DeviceExt;

use crate::support::{Gpu, depth_state, depth_texture, read_buffer};

/// Bytes from one object's matrices to the next.
const STRIDE: usize = 256;

/// As an app's vertex shader does it, in f32.
const SHADER: &str = "
    struct Place { clip_from_world: mat4x4<f32>, world_from_object: mat4x4<f32> }
    @group(0) @binding(0) var<uniform> place: Place;
    @vertex fn main(@location(0) p: vec3<f32>) -> @builtin(position) @invariant vec4<f32> {
        return place.clip_from_world * (place.world_from_object * vec4<f32>(p, 1.0));
    }";

pub struct Renderer<'g> {
    gpu: &'g Gpu,
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    pipelines: HashMap<(bool, bool, u32, bool), wgpu::RenderPipeline>,
    /// By the address of a level's vertices, which its mesh keeps.
    geometry: HashMap<usize, Geometry>,
    frame: Frame,
}

struct Geometry {
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

/// What is drawn in a frame.
struct Frame {
    group: wgpu::BindGroup,
    /// Where each object's matrices are, and what it is drawn with.
    objects: HashMap<Entity, (u32, usize)>,
}

impl<'g> Renderer<'g> {
    pub fn new(gpu: &'g Gpu) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let frame = Frame::new(gpu, &layout, &[0; STRIDE]);
        Self { gpu, module, layout, pipelines: HashMap::new(), geometry: HashMap::new(), frame }
    }

    /// Uploads where everything stands, and the meshes that are new.
    pub fn prepare(&mut self, world: &World, view: &View, detail: Detail) {
        self.pipeline(view, true);
        let clip_from_world = view.clip_from_view() * view.view_from_world();
        let mut matrices = Vec::new();
        let mut objects = HashMap::new();
        for (entity, drawable) in world.query::<(Entity, &Drawable)>().iter() {
            let place = drawable.world_from_object;
            let level = &drawable.mesh.levels()[detail.level(&drawable.mesh, &place, view)];
            let key = level.positions.as_ptr() as usize;
            self.geometry.entry(key).or_insert_with(|| Geometry::new(self.gpu, level));
            objects.insert(entity, (matrices.len() as u32, key));
            for matrix in [clip_from_world, Mat4::from(place)] {
                matrices.extend(matrix.to_cols_array().iter().flat_map(|f| f.to_le_bytes()));
            }
            matrices.resize(matrices.len().next_multiple_of(STRIDE), 0);
        }
        matrices.resize(matrices.len().max(STRIDE), 0);
        self.frame = Frame::new(self.gpu, &self.layout, &matrices);
        self.frame.objects = objects;
    }

    /// Draws objects into a pass; see [`Renderer::prepare`].
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'static>, view: &View, objects: &[ObjectRef]) {
        pass.set_pipeline(&self.pipelines[&key(view, true)]);
        objects.iter().for_each(|object| self.draw_one(pass, object.entity()));
    }

    fn draw_one(&self, pass: &mut wgpu::RenderPass<'_>, entity: Entity) {
        let Some((offset, geometry)) = self.frame.objects.get(&entity) else { return };
        let geometry = &self.geometry[geometry];
        pass.set_bind_group(0, &self.frame.group, &[*offset]);
        pass.set_vertex_buffer(0, geometry.positions.slice(..));
        pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..geometry.count, 0, 0..1);
    }

    /// Draws everything, and finds the objects with at least one sample that is not behind the
    /// depth of what hides; ties all count. Returns them, and the depth of the finished frame.
    pub fn truth(&mut self, scene: &Scene, view: &View) -> (ObjectSet, wgpu::Texture) {
        self.pipeline(view, false);
        let device = &self.gpu.device;
        let depth = depth_texture(self.gpu, view);
        let objects: Vec<_> = scene.objects().map(|o| (o.object, o.traits.not_occluder)).collect();
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Occlusion,
            count: objects.len().max(1) as u32,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let depth_view = depth.create_view(&Default::default());
        let mut pass = |clears: bool, writes: bool, queries: Option<&wgpu::QuerySet>, wanted: &[bool]| {
            let clear = wgpu::LoadOp::Clear(view.depth().cleared().abs());
            let load = if clears { clear } else { wgpu::LoadOp::Load };
            let attachment = wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(attachment),
                occlusion_query_set: queries,
                ..Default::default()
            });
            let viewport = view.viewport();
            pass.set_viewport(0.0, 0.0, viewport.width as f32, viewport.height as f32, 0.0, 1.0);
            pass.set_pipeline(&self.pipelines[&key(view, writes)]);
            for (i, (object, not_occluder)) in objects.iter().enumerate() {
                if !wanted.contains(not_occluder) {
                    continue;
                }
                if queries.is_some() {
                    pass.begin_occlusion_query(i as u32);
                }
                self.draw_one(&mut pass, object.entity());
                if queries.is_some() {
                    pass.end_occlusion_query();
                }
            }
        };
        pass(true, true, None, &[false]);
        pass(false, false, Some(&queries), &[false, true]);
        pass(false, true, None, &[true]);
        let size = 8 * objects.len().max(1) as u64;
        let buffer = |usage| {
            let label = None;
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let back = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        encoder.resolve_query_set(&queries, 0..objects.len().max(1) as u32, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &back, 0, size);
        self.gpu.queue.submit([encoder.finish()]);
        let bytes = read_buffer(self.gpu, &back);
        let mut seen = ObjectSet::default();
        for ((object, _), samples) in objects.iter().zip(bytes.as_chunks::<8>().0) {
            if u64::from_le_bytes(*samples) != 0 {
                seen.insert(object.id);
            }
        }
        (seen, depth)
    }

    fn pipeline(&mut self, view: &View, writes: bool) {
        let device = &self.gpu.device;
        self.pipelines.entry(key(view, writes)).or_insert_with(|| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&self.layout)],
                immediate_size: 0,
            });
            let position = wgpu::VertexAttribute {
                format: wgpu::VertexFormat::Float32x3,
                offset: 0,
                shader_location: 0,
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &self.module,
                    entry_point: Some("main"),
                    compilation_options: Default::default(),
                    buffers: &[Some(wgpu::VertexBufferLayout {
                        array_stride: 12,
                        step_mode: wgpu::VertexStepMode::Vertex,
                        attributes: &[position],
                    })],
                },
                primitive: Default::default(),
                depth_stencil: Some(depth_state(view, writes)),
                multisample: wgpu::MultisampleState { count: view.samples(), ..Default::default() },
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        });
    }
}

impl Geometry {
    fn new(gpu: &Gpu, level: &Level) -> Self {
        let positions = level.positions.iter().flat_map(|p| p.to_array()).flat_map(|f| f.to_le_bytes());
        let indices = level.indices.iter().flat_map(|i| i.to_le_bytes());
        let buffer = |bytes: Vec<u8>, usage| {
            let contents = if bytes.is_empty() { &[0; 4] } else { bytes.as_slice() };
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        Self {
            positions: buffer(positions.collect(), wgpu::BufferUsages::VERTEX),
            indices: buffer(indices.collect(), wgpu::BufferUsages::INDEX),
            count: level.indices.len() as u32,
        }
    }
}

impl Frame {
    fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, matrices: &[u8]) -> Self {
        let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: matrices,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let one = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: std::num::NonZeroU64::new(128) };
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(one) }],
        });
        Self { group, objects: HashMap::new() }
    }
}

/// What a pipeline depends on.
fn key(view: &View, writes: bool) -> (bool, bool, u32, bool) {
    let reversed = view.depth() == DepthDirection::Reversed;
    (reversed, view.format() == DepthFormat::Depth32Float, view.samples(), writes)
}
