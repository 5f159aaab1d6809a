//! What the tests share: adapters, targets, depth that can be read, triangles in clip space.

use std::io::Write;

use glam::{Vec3, Vec4};
use tercet::geom::{DepthDirection, DepthFormat, View};
use tercet::query::QueryBackend;
use tercet::query::gpu::{Counting, DepthTarget, FrameTargets, GpuConfig, GpuQueries};
use wgpu::util::DeviceExt;

/// A device of its own.
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub backend: wgpu::Backend,
    /// Whether a CPU does the work.
    pub is_software: bool,
}

impl Gpu {
    /// The samples a pixel that depth can have and be read.
    pub fn sample_counts(&self) -> &'static [u32] {
        if self.backend == wgpu::Backend::Gl { &[1] } else { &[1, 4] }
    }

    /// A backend with some dials, without allowance for emulated depth ranges: answers are
    /// compared sample by sample with the depth that is there. Rays are cast, however few objects there are.
    pub fn exact_queries(&self, config: GpuConfig) -> GpuQueries {
        let config = GpuConfig { depth_slack: Some(0.0), rays_from: 0, ..config };
        GpuQueries::with_config(&self.device, &self.queue, config).expect("a backend")
    }
}

/// A device, without optional features, on each adapter that there is; `WGPU_BACKEND` chooses among
/// them. Without any the test passes, aloud, unless `TERCET_REQUIRE_GPU` is 1.
pub fn gpus() -> Vec<Gpu> {
    gpus_with(wgpu::Limits::default())
}

/// The same with other limits.
pub fn gpus_with(limits: wgpu::Limits) -> Vec<Gpu> {
    let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY | wgpu::Backends::GL);
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    let adapters = pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(backends));
    let gpus: Vec<Gpu> = adapters
        .iter()
        .map(|adapter| {
            let descriptor = wgpu::DeviceDescriptor {
                required_features: GpuQueries::wanted_features(adapter),
                required_limits: limits.clone(),
                ..Default::default()
            };
            let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
            let info = adapter.get_info();
            let is_software = info.device_type == wgpu::DeviceType::Cpu;
            Gpu { device, queue, backend: info.backend, is_software }
        })
        .collect();
    if gpus.is_empty() {
        skip(&format!("there is no adapter for {backends:?}"));
    }
    gpus
}

/// Says aloud why a test, or a part of it, is not done; with `TERCET_REQUIRE_GPU=1` it must be.
pub fn skip(why: &str) {
    let required = std::env::var("TERCET_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(!required, "{why}, and TERCET_REQUIRE_GPU is 1");
    // Not captured by the test harness.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {why}");
}

/// Each way of counting that a device supports.
pub fn supported(gpu: &Gpu) -> impl Iterator<Item = Counting> {
    Counting::ALL.into_iter().filter(|counting| counting.is_supported(&gpu.device))
}

/// Each of them by itself, and what is chosen by default.
pub fn ways(gpu: &Gpu) -> impl Iterator<Item = Option<Counting>> {
    supported(gpu).map(Some).chain([None])
}

/// A depth texture that a view can be drawn into.
pub fn depth_texture(gpu: &Gpu, view: &View) -> wgpu::Texture {
    let viewport = view.viewport();
    let format = match view.format() {
        DepthFormat::Depth32Float => wgpu::TextureFormat::Depth32Float,
        DepthFormat::Depth24Plus => wgpu::TextureFormat::Depth24Plus,
    };
    // A little larger than the viewport, to find out who looks beside it.
    let size = [viewport.x + viewport.width + 3, viewport.y + viewport.height + 2];
    texture(gpu, format, size, view.samples())
}

/// A texture to draw into and to read.
pub fn texture(gpu: &Gpu, format: wgpu::TextureFormat, size: [u32; 2], samples: u32) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// Targets of depth alone.
pub fn targets(depth: &wgpu::Texture, keep: bool) -> FrameTargets {
    let view = depth.create_view(&Default::default());
    FrameTargets { colors: Vec::new(), depth: DepthTarget { view, depth_only: None, keep } }
}

/// The nearness of a viewport's samples: all of a pixel together, pixels row by row.
pub struct Nearness {
    pub width: u32,
    pub samples: u32,
    pub values: Vec<f32>,
}

impl Nearness {
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        let first = ((y * self.width + x) * self.samples) as usize;
        &self.values[first..first + self.samples as usize]
    }

    /// The samples that something was drawn on: their pixel and nearness.
    pub fn drawn(&self, cleared: f32) -> impl Iterator<Item = (u32, u32, f32)> {
        let pixel = |sample: usize| sample as u32 / self.samples;
        let place = move |sample| (pixel(sample) % self.width, pixel(sample) / self.width);
        let drawn = self.values.iter().enumerate().filter(move |&(_, &nearness)| nearness > cleared);
        drawn.map(move |(sample, &nearness)| (place(sample).0, place(sample).1, nearness))
    }
}

/// Reads a depth texture.
pub fn read_depth(gpu: &Gpu, depth: &wgpu::Texture, view: &View) -> Nearness {
    let sign = match view.depth() {
        DepthDirection::Reversed => 1.0,
        DepthDirection::Standard => -1.0,
    };
    let words = read_texels(gpu, depth, view, "bitcast<u32>(texel.x)");
    let values = words.into_iter().map(|word| sign * f32::from_bits(word)).collect();
    Nearness { width: view.viewport().width, samples: view.samples(), values }
}

/// Reads the samples of a view's viewport, all of a pixel together and pixels row by row: of each
/// `texel` the `word` that an expression in WGSL makes of it. It takes a compute shader: OpenGL
/// cannot copy depth, and nobody can copy several samples a pixel. All drawing must have ended by
/// then: Mesa's OpenGL on the CPU (22.3) begins to compute in a submission of its own while it still
/// draws what is read, if another target was drawn on in between.
pub fn read_texels(gpu: &Gpu, texture: &wgpu::Texture, view: &View, word: &str) -> Vec<u32> {
    let viewport = view.viewport();
    let samples = view.samples();
    let (texture_type, sample) =
        if samples > 1 { ("texture_multisampled_2d", "i32(k)") } else { ("texture_2d", "0") };
    let (scalar, sample_type) = match texture.format().sample_type(None, None) {
        Some(wgpu::TextureSampleType::Uint) => ("u32", wgpu::TextureSampleType::Uint),
        _ => ("f32", wgpu::TextureSampleType::Float { filterable: false }),
    };
    let source = format!(
        "@group(0) @binding(0) var texture: {texture_type}<{scalar}>;
         @group(0) @binding(1) var<storage, read_write> out: array<u32>;
         @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {{
             if at.x >= {w}u || at.y >= {h}u {{ return; }}
             for (var k = 0u; k < {samples}u; k++) {{
                 let texel = textureLoad(texture, vec2<i32>(at.xy + vec2<u32>({x}u, {y}u)), {sample});
                 out[(at.y * {w}u + at.x) * {samples}u + k] = {word};
             }}
         }}",
        w = viewport.width,
        h = viewport.height,
        x = viewport.x,
        y = viewport.y,
    );
    let device = &gpu.device;
    device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[
            entry(
                0,
                wgpu::BindingType::Texture {
                    sample_type,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: samples > 1,
                },
            ),
            entry(
                1,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only: false },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            ),
        ],
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let size = u64::from(viewport.width * viewport.height * samples) * 4;
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let out = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let back = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let texture_view = texture.create_view(&Default::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&texture_view) },
            wgpu::BindGroupEntry { binding: 1, resource: out.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(viewport.width.div_ceil(8), viewport.height.div_ceil(8), 1);
    }
    encoder.copy_buffer_to_buffer(&out, 0, &back, 0, size);
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_buffer(gpu, &back);
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
}

/// The bytes of a buffer that can be mapped.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u8> {
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("it can be mapped"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
    let bytes = buffer.get_mapped_range(..).expect("it is mapped").to_vec();
    buffer.unmap();
    bytes
}

/// Draws loose triangles that are given in clip space.
pub struct ClipSpace {
    pipeline: wgpu::RenderPipeline,
    vertices: wgpu::Buffer,
    count: u32,
}

impl ClipSpace {
    pub fn new(gpu: &Gpu, view: &View, triangles: &[[Vec4; 3]]) -> Self {
        Self::with_color(gpu, view, triangles, None)
    }

    /// The same, in red, into a colour attachment of a format.
    pub fn with_color(
        gpu: &Gpu,
        view: &View,
        triangles: &[[Vec4; 3]],
        color: Option<wgpu::TextureFormat>,
    ) -> Self {
        let source = "
            @vertex fn place(@location(0) p: vec4<f32>) -> @builtin(position) vec4<f32> { return p; }
            @fragment fn red() -> @location(0) vec4<f32> { return vec4<f32>(1.0, 0.0, 0.0, 1.0); }";
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let attribute =
            wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x4, offset: 0, shader_location: 0 };
        let red = color.map(|format| [Some(wgpu::ColorTargetState::from(format))]);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("place"),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 16,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &[attribute],
                })],
            },
            primitive: Default::default(),
            depth_stencil: Some(depth_state(view, true)),
            multisample: wgpu::MultisampleState { count: view.samples(), ..Default::default() },
            fragment: red.as_ref().map(|targets| wgpu::FragmentState {
                module: &module,
                entry_point: Some("red"),
                compilation_options: Default::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        let mut floats: Vec<f32> = triangles.iter().flatten().flat_map(|p| p.to_array()).collect();
        floats.resize(floats.len().max(4), 0.0);
        let vertices = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: &floats.iter().flat_map(|f| f.to_le_bytes()).collect::<Vec<u8>>(),
            usage: wgpu::BufferUsages::VERTEX,
        });
        Self { pipeline, vertices, count: 3 * triangles.len() as u32 }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'static>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.draw(0..self.count, 0..1);
    }
}

/// How an app tests depth: nearer or as near passes.
pub fn depth_state(view: &View, write: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: match view.format() {
            DepthFormat::Depth32Float => wgpu::TextureFormat::Depth32Float,
            DepthFormat::Depth24Plus => wgpu::TextureFormat::Depth24Plus,
        },
        depth_write_enabled: Some(write),
        depth_compare: Some(match view.depth() {
            DepthDirection::Reversed => wgpu::CompareFunction::GreaterEqual,
            DepthDirection::Standard => wgpu::CompareFunction::LessEqual,
        }),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

/// Draws triangles into a frame of their own, and reads the depth.
pub fn depth_of(
    gpu: &Gpu,
    queries: &mut GpuQueries,
    view: &View,
    triangles: &[[Vec4; 3]],
) -> (wgpu::Texture, Nearness) {
    let depth = depth_texture(gpu, view);
    let drawer = ClipSpace::new(gpu, view, triangles);
    queries.target(&targets(&depth, false));
    queries.begin(view).expect("begin");
    queries.draw(|pass| drawer.draw(pass)).expect("draw");
    queries.end().expect("end");
    let nearness = read_depth(gpu, &depth, view);
    (depth, nearness)
}

/// A pixel of the viewport, and a nearness, in clip space.
pub fn clip(view: &View, pixel: [f32; 2], nearness: f32) -> Vec4 {
    let viewport = view.viewport();
    let x = 2.0 * pixel[0] / viewport.width as f32 - 1.0;
    let y = 1.0 - 2.0 * pixel[1] / viewport.height as f32;
    Vec3::new(x, y, nearness.abs()).extend(1.0)
}
