//! The boxes drawn as engines draw them, within native occlusion queries or without.

use std::ops::Range;

use tercet::geom::Aabb;
use wgpu::util::DeviceExt;

use crate::scene::Scene;

/// A vertex of a box's twelve triangles from its number.
const SHADER: &str = "
    @group(0) @binding(0) var<uniform> clip_from_world: mat4x4<f32>;
    @vertex fn corner(
        @builtin(vertex_index) vertex: u32,
        @location(0) low: vec3<f32>,
        @location(1) high: vec3<f32>,
    ) -> @builtin(position) vec4<f32> {
        let face = vertex / 6u;
        let axis = face >> 1u;
        // The corners of a face, as two triangles.
        let turn = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[vertex % 6u];
        var at = vec3<u32>(0u);
        at[axis] = face & 1u;
        at[(axis + 1u) % 3u] = turn & 1u;
        at[(axis + 2u) % 3u] = turn >> 1u;
        return clip_from_world * vec4<f32>(select(low, high, at != vec3<u32>(0u)), 1.0);
    }";

/// Draws boxes.
pub struct Drawer<'g> {
    device: &'g wgpu::Device,
    queue: &'g wgpu::Queue,
    depth: wgpu::TextureView,
    pipeline: wgpu::RenderPipeline,
    uniforms: wgpu::BindGroup,
    boxes: wgpu::Buffer,
    count: u32,
    writes: bool,
}

impl<'g> Drawer<'g> {
    /// With or without writing depth, which with is cleared first.
    pub fn new(scene: &Scene<'g>, boxes: &[Aabb], writes: bool) -> Self {
        let device = scene.device;
        let buffer = |floats: Vec<f32>, usage| {
            let bytes: Vec<u8> = floats.iter().flat_map(|float| float.to_le_bytes()).collect();
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: &bytes,
                usage,
            })
        };
        let matrix = scene.view.clip_from_world().as_mat4().to_cols_array().to_vec();
        let uniforms = buffer(matrix, wgpu::BufferUsages::UNIFORM);
        let corners =
            boxes.iter().flat_map(|b| [b.min, b.max]).flat_map(|corner| corner.to_array()).collect();
        let pipeline = pipeline(device, writes);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        Self {
            device,
            queue: scene.queue,
            depth: scene.depth.create_view(&Default::default()),
            pipeline,
            uniforms: bindings,
            boxes: buffer(corners, wgpu::BufferUsages::VERTEX),
            count: boxes.len() as u32,
            writes,
        }
    }

    /// Draws all in one call.
    pub fn draw_all(&self) {
        let mut encoder = self.encoder();
        self.pass(&mut encoder, None, |pass| pass.draw(0..36, 0..self.count));
        self.queue.submit([encoder.finish()]);
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&Default::default())
    }

    fn pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        queries: Option<&wgpu::QuerySet>,
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let operations = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: self.writes.then_some(operations),
                stencil_ops: None,
            }),
            occlusion_query_set: queries,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.uniforms, &[]);
        pass.set_vertex_buffer(0, self.boxes.slice(..));
        record(&mut pass);
    }
}

/// Boxes, each with a query.
pub struct Conventional<'g> {
    drawer: Drawer<'g>,
    sets: Vec<(wgpu::QuerySet, Range<u32>)>,
    resolved: wgpu::Buffer,
    back: wgpu::Buffer,
}

impl<'g> Conventional<'g> {
    pub fn new(scene: &Scene<'g>) -> Self {
        let device = scene.device;
        let count = scene.boxes.len() as u32;
        let set = |first| {
            let boxes = first..count.min(first + wgpu::QUERY_SET_MAX_QUERIES);
            let ty = wgpu::QueryType::Occlusion;
            let set = wgpu::QuerySetDescriptor { label: None, ty, count: boxes.len() as u32 };
            (device.create_query_set(&set), boxes)
        };
        let size = 8 * u64::from(count);
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            drawer: Drawer::new(scene, &scene.boxes, false),
            sets: (0..count).step_by(wgpu::QUERY_SET_MAX_QUERIES as usize).map(set).collect(),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            back: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        }
    }

    /// Draws them without queries.
    pub fn submit_draw(&self) {
        self.drawer.draw_all();
    }

    /// Draws each in its query, and asks for the results.
    pub fn submit_queries(&self) {
        let mut encoder = self.drawer.encoder();
        for (set, boxes) in &self.sets {
            self.drawer.pass(&mut encoder, Some(set), |pass| {
                for (query, which) in (0..).zip(boxes.clone()) {
                    pass.begin_occlusion_query(query);
                    pass.draw(0..36, which..which + 1);
                    pass.end_occlusion_query();
                }
            });
            let queries = 0..boxes.len() as u32;
            encoder.resolve_query_set(set, queries, &self.resolved, 8 * u64::from(boxes.start));
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.back, 0, self.back.size());
        self.drawer.queue.submit([encoder.finish()]);
        self.back.map_async(wgpu::MapMode::Read, .., |result| result.expect("it can be mapped"));
    }

    /// How many are in sight, once the device is done.
    pub fn read(&self) -> usize {
        let bytes = self.back.get_mapped_range(..).expect("it is mapped");
        let visible = bytes.as_chunks::<8>().0.iter().filter(|result| **result != [0; 8]).count();
        drop(bytes);
        self.back.unmap();
        visible
    }
}

fn pipeline(device: &wgpu::Device, writes: bool) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 24,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(writes),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}
