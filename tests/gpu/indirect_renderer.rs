//! What an app draws an indirect frame with: one vertex and one index buffer, transforms by slot.
//! And the truth about a frame, by drawing everything with the same pipeline.

use std::collections::HashMap;

use glam::Mat4;
use hecs::{Entity, World};
use tercet::draw::{Detail, Drawable};
use tercet::geom::{DepthDirection, DepthFormat, View};
use tercet::query::gpu::{BatchMesh, IndirectBatch};
use tercet::scene::{Batch, ObjectSet, Scene};
use wgpu::util::DeviceExt;

use crate::support::{Gpu, depth_state, depth_texture, read_buffer};

const SHADER: &str = "
    @group(0) @binding(0) var<uniform> clip_from_world: mat4x4<f32>;
    @group(0) @binding(1) var<storage, read> world_from_object: array<mat4x4<f32>>;
    @vertex fn main(@location(0) p: vec3<f32>, @location(1) slot: u32)
        -> @builtin(position) @invariant vec4<f32> {
        return clip_from_world * (world_from_object[slot] * vec4<f32>(p, 1.0));
    }";

pub struct Renderer<'g> {
    gpu: &'g Gpu,
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    /// By the address of a level's vertices, which its mesh keeps.
    known: HashMap<usize, Batch>,
    pub meshes: Vec<BatchMesh>,
    positions: Vec<u8>,
    indices: Vec<u8>,
    /// By direction, format and samples of the depth, and whether they write it.
    pipelines: HashMap<(bool, bool, u32, bool), wgpu::RenderPipeline>,
    frame: Option<Frame>,
}

struct Frame {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// 0, 1, 2 and so on: an instance by itself for each slot.
    slots: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    /// That does not write depth, and that does.
    pipelines: [wgpu::RenderPipeline; 2],
}

impl<'g> Renderer<'g> {
    pub fn new(gpu: &'g Gpu) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[
                entry(0, wgpu::BufferBindingType::Uniform),
                entry(1, wgpu::BufferBindingType::Storage { read_only: true }),
            ],
        });
        let (known, meshes) = (HashMap::new(), Vec::new());
        Self {
            gpu,
            module,
            layout,
            known,
            meshes,
            positions: vec![],
            indices: vec![],
            pipelines: HashMap::new(),
            frame: None,
        }
    }

    /// Gives every entity the batch of the level of detail that it is drawn with; before the scene is
    /// brought up to date.
    pub fn dress(&mut self, world: &mut World, view: &View, detail: Detail) {
        let mut batches = Vec::new();
        for (entity, drawable) in world.query::<(Entity, &Drawable)>().iter() {
            let level =
                &drawable.mesh.levels()[detail.level(&drawable.mesh, &drawable.world_from_object, view)];
            let next = Batch(self.meshes.len() as u32);
            let batch = *self.known.entry(level.positions.as_ptr() as usize).or_insert_with(|| {
                self.meshes.push(BatchMesh {
                    index_count: level.indices.len() as u32,
                    first_index: self.indices.len() as u32 / 4,
                    base_vertex: self.positions.len() as i32 / 12,
                });
                self.positions
                    .extend(level.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
                self.indices.extend(level.indices.iter().flat_map(|i| i.to_le_bytes()));
                next
            });
            batches.push((entity, batch));
        }
        batches.into_iter().for_each(|(entity, batch)| world.insert_one(entity, batch).expect("it is there"));
    }

    /// Uploads where everything stands; after the scene was brought up to date.
    pub fn prepare(&mut self, world: &World, scene: &Scene, view: &View) {
        let pipelines = [false, true].map(|writes| self.pipeline(view, writes));
        let device = &self.gpu.device;
        let mut matrices = vec![[0.0f32; 16]; scene.slot_bound().max(1)];
        for object in scene.objects() {
            let drawable = world.get::<&Drawable>(object.object.entity()).expect("all can be drawn");
            matrices[object.object.id.slot()] = Mat4::from(drawable.world_from_object).to_cols_array();
        }
        let buffer = |bytes: Vec<u8>, usage| {
            let contents = if bytes.is_empty() { &[0; 16] } else { bytes.as_slice() };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let clip_from_world = (view.clip_from_view() * view.view_from_world()).to_cols_array();
        let uniforms = buffer(
            clip_from_world.into_iter().flat_map(f32::to_le_bytes).collect(),
            wgpu::BufferUsages::UNIFORM,
        );
        let slots = (0..matrices.len() as u32).flat_map(u32::to_le_bytes).collect();
        let matrices = matrices.into_iter().flatten().flat_map(f32::to_le_bytes).collect();
        let matrices = buffer(matrices, wgpu::BufferUsages::STORAGE);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: matrices.as_entire_binding() },
            ],
        });
        self.frame = Some(Frame {
            vertices: buffer(self.positions.clone(), wgpu::BufferUsages::VERTEX),
            indices: buffer(self.indices.clone(), wgpu::BufferUsages::INDEX),
            slots: buffer(slots, wgpu::BufferUsages::VERTEX),
            bindings,
            pipelines,
        });
    }

    /// Draws batches into a pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'static>, batches: &[IndirectBatch<'_>]) {
        self.frame.as_ref().expect("it was prepared").begin(pass, true);
        batches.iter().for_each(|batch| batch.draw(pass, 1));
    }

    /// Draws everything, and finds the objects with at least one sample that is not behind the
    /// depth of what hides; ties all count. Returns them, and the depth of the finished frame.
    pub fn truth(&self, scene: &Scene, view: &View) -> (ObjectSet, wgpu::Texture) {
        let device = &self.gpu.device;
        let frame = self.frame.as_ref().expect("it was prepared");
        let depth = depth_texture(self.gpu, view);
        let objects: Vec<_> = scene.objects().collect();
        let count = objects.len().max(1) as u32;
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Occlusion,
            count,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let depth_view = depth.create_view(&Default::default());
        let mut pass = |clears: bool, writes: bool, wanted: &[bool]| {
            let clear = wgpu::LoadOp::Clear(view.depth().cleared().abs());
            let load = if clears { clear } else { wgpu::LoadOp::Load };
            let attachment = wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(attachment),
                occlusion_query_set: (!writes).then_some(&queries),
                ..Default::default()
            });
            let viewport = view.viewport();
            pass.set_viewport(0.0, 0.0, viewport.width as f32, viewport.height as f32, 0.0, 1.0);
            frame.begin(&mut pass, writes);
            for (i, object) in (0..).zip(&objects) {
                if !wanted.contains(&object.traits.not_occluder) {
                    continue;
                }
                let mesh = &self.meshes[object.traits.batch.expect("all are dressed").0 as usize];
                pass.set_vertex_buffer(1, frame.slots.slice(4 * object.object.id.slot() as u64..));
                if !writes {
                    pass.begin_occlusion_query(i);
                }
                let indices = mesh.first_index..mesh.first_index + mesh.index_count;
                pass.draw_indexed(indices, mesh.base_vertex, 0..1);
                if !writes {
                    pass.end_occlusion_query();
                }
            }
        };
        pass(true, true, &[false]);
        pass(false, false, &[false, true]);
        pass(false, true, &[true]);
        let size = 8 * u64::from(count);
        let buffer = |usage| {
            let label = None;
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let back = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        encoder.resolve_query_set(&queries, 0..count, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &back, 0, size);
        self.gpu.queue.submit([encoder.finish()]);
        let bytes = read_buffer(self.gpu, &back);
        let mut seen = ObjectSet::default();
        for (object, samples) in objects.iter().zip(bytes.as_chunks::<8>().0) {
            if u64::from_le_bytes(*samples) != 0 {
                seen.insert(object.object.id);
            }
        }
        (seen, depth)
    }

    fn pipeline(&mut self, view: &View, writes: bool) -> wgpu::RenderPipeline {
        let (reversed, float) =
            (view.depth() == DepthDirection::Reversed, view.format() == DepthFormat::Depth32Float);
        let Self { gpu, module, layout, pipelines, .. } = self;
        let make = || pipeline(gpu, module, layout, view, writes);
        pipelines.entry((reversed, float, view.samples(), writes)).or_insert_with(make).clone()
    }
}

impl Frame {
    fn begin(&self, pass: &mut wgpu::RenderPass<'_>, writes: bool) {
        pass.set_pipeline(&self.pipelines[usize::from(writes)]);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

fn pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    layout: &wgpu::BindGroupLayout,
    view: &View,
    writes: bool,
) -> wgpu::RenderPipeline {
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let attribute = |format, shader_location| wgpu::VertexAttribute { format, offset: 0, shader_location };
    let (position, slot) =
        (attribute(wgpu::VertexFormat::Float32x3, 0), attribute(wgpu::VertexFormat::Uint32, 1));
    let (position, slot) = ([position], [slot]);
    let buffer = |array_stride, step_mode, attributes| wgpu::VertexBufferLayout {
        array_stride,
        step_mode,
        attributes,
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            buffers: &[
                Some(buffer(12, wgpu::VertexStepMode::Vertex, &position)),
                Some(buffer(4, wgpu::VertexStepMode::Instance, &slot)),
            ],
        },
        primitive: Default::default(),
        depth_stencil: Some(depth_state(view, writes)),
        multisample: wgpu::MultisampleState { count: view.samples(), ..Default::default() },
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}
