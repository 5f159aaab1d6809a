//! Targets with a colour, and what is in them.

use hecs::World;
use tercet::draw::{Detail, Renderer, Shading};
use tercet::geom::View;
use tercet::query::QueryBackend;
use tercet::query::gpu::{FrameTargets, GpuQueries};
use tercet::scene::{ObjectRef, Scene, SceneConfig};
use wgpu::{RenderPass, Texture, TextureFormat};

use crate::support::{Gpu, depth_texture, read_buffer, read_depth, texture};

/// What all pictures are drawn in.
pub const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// Attachments for a view.
pub struct Target {
    color: Texture,
    depth: Texture,
}

/// What is in them, sample by sample: all of a pixel together, pixels row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Red in the lowest byte, alpha in the highest; 0 where nothing was drawn.
    pub colors: Vec<u32>,
    pub nearness: Vec<f32>,
}

impl Target {
    pub fn new(gpu: &Gpu, view: &View) -> Self {
        Self::with_format(gpu, view, FORMAT)
    }

    pub fn with_format(gpu: &Gpu, view: &View, format: TextureFormat) -> Self {
        let viewport = view.viewport();
        let depth = depth_texture(gpu, view);
        assert_eq!((viewport.x, viewport.y), (0, 0), "pixels of the viewport are those of the target");
        let color = texture(gpu, format, [depth.width(), depth.height()], view.samples());
        Self { color, depth }
    }

    /// Both attachments, cleared by each frame.
    pub fn frame_targets(&self) -> FrameTargets {
        let [color, depth] = [&self.color, &self.depth].map(|t| t.create_view(&Default::default()));
        FrameTargets::new(depth).with_color(color, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))
    }

    /// The depth alone.
    pub fn depth_targets(&self) -> FrameTargets {
        FrameTargets::new(self.depth.create_view(&Default::default()))
    }

    pub fn shot(&self, gpu: &Gpu, view: &View) -> Shot {
        Shot { colors: self.colors(gpu, view), nearness: read_depth(gpu, &self.depth, view).values }
    }

    /// Reads the colours by a compute shader: several samples a pixel cannot be copied.
    fn colors(&self, gpu: &Gpu, view: &View) -> Vec<u32> {
        let [width, height, samples] = [view.viewport().width, view.viewport().height, view.samples()];
        let (texture_type, sample) =
            if samples > 1 { ("texture_multisampled_2d<f32>", "i32(k)") } else { ("texture_2d<f32>", "0") };
        let source = format!(
            "@group(0) @binding(0) var color: {texture_type};
             @group(0) @binding(1) var<storage, read_write> out: array<u32>;
             @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {{
                 if at.x >= {width}u || at.y >= {height}u {{ return; }}
                 for (var k = 0u; k < {samples}u; k++) {{
                     let texel = textureLoad(color, vec2<i32>(at.xy), {sample});
                     out[(at.y * {width}u + at.x) * {samples}u + k] = pack4x8unorm(texel);
                 }}
             }}"
        );
        let device = &gpu.device;
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
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: samples > 1,
        };
        let storage = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[entry(0, texture), entry(1, storage)],
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
        let size = u64::from(width * height * samples) * 4;
        let buffer = |usage| {
            let label = None;
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let out = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let back = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let color = self.color.create_view(&Default::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&color) },
                wgpu::BindGroupEntry { binding: 1, resource: out.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
        }
        encoder.copy_buffer_to_buffer(&out, 0, &back, 0, size);
        gpu.queue.submit([encoder.finish()]);
        let bytes = read_buffer(gpu, &back);
        bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
    }
}

/// All objects of a world.
pub fn objects(world: &World) -> Vec<ObjectRef> {
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(world);
    scene.objects().map(|object| object.object).collect()
}

/// Draws one frame of one pass, without a culler, and reads it.
pub fn shoot(
    gpu: &Gpu,
    view: &View,
    shading: Shading,
    record: impl FnOnce(&mut Renderer, &mut RenderPass<'static>),
) -> Shot {
    let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, Some(FORMAT)).expect("a renderer");
    let target = Target::new(gpu, view);
    queries.target(&target.frame_targets());
    renderer.begin(view, Detail::FULL, shading);
    queries.begin(view).expect("begin");
    queries.draw(|pass| record(&mut renderer, pass)).expect("draw");
    queries.end().expect("end");
    target.shot(gpu, view)
}
