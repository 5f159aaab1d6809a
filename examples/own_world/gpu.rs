//! The app's device, buffers and pipelines: plain wgpu. Tercet's views are read for their matrices.

use anyhow::Context;
use hecs::World;
use image::RgbaImage;
use tercet::geom::View;
use tercet::query::gpu::wgpu;
use tercet::scene::Bounds;
use wgpu::{BindingResource, BufferUsages, TextureFormat, TextureUsages, TextureView};

use super::city::{self, Look};

/// Bytes of an object in the instance buffer: its box, and its paint.
const INSTANCE: usize = 2 * 12 + 4;

pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// One a thing of the world, by [`Look::instance`].
    pub instances: wgpu::Buffer,
    frame: wgpu::Buffer,
    shader: wgpu::ShaderModule,
}

impl Gpu {
    /// The device that `WGPU_BACKEND` and `WGPU_ADAPTER_NAME` ask for, or the best there is.
    pub fn new(things: u32) -> anyhow::Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = wgpu::util::initialize_adapter_from_env_or_default(&instance, None);
        let adapter = pollster::block_on(adapter).context(
            "no GPU was found: install its driver, or Mesa's software drivers, \
             or see `--example cpu_culling`, which needs none",
        )?;
        let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
        println!("drawing on {}, {}", adapter.get_info().name, adapter.get_info().backend);
        let buffer = |size: u64, usage| {
            let usage = usage | BufferUsages::COPY_DST;
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let instances = buffer(u64::from(things) * INSTANCE as u64, BufferUsages::VERTEX);
        let frame = buffer(40 * 4, BufferUsages::UNIFORM);
        let shader = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
        Ok(Self { device, queue, instances, frame, shader })
    }

    pub fn texture(
        &self,
        [width, height]: [u32; 2],
        format: TextureFormat,
        usage: TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// Once a frame: where the views are, and where everything stands.
    pub fn upload(&self, world: &World, eye: &View, sun: &View) {
        let matrices = [eye, sun].map(|view| view.clip_from_world().as_mat4().to_cols_array());
        let vectors = [eye.eye().to_array(), city::toward_sun().extend(0.0).to_array()];
        let frame = [matrices.as_flattened(), vectors.as_flattened()].concat();
        self.queue.write_buffer(&self.frame, 0, bytemuck::cast_slice(&frame));
        let mut instances = vec![0; self.instances.size() as usize];
        for (Bounds(aabb), look) in world.query::<(&Bounds, &Look)>().iter() {
            let instance = &mut instances[look.instance as usize * INSTANCE..][..INSTANCE];
            let corners = [aabb.min.to_array(), aabb.max.to_array()];
            instance[..24].copy_from_slice(bytemuck::cast_slice(corners.as_flattened()));
            instance[24..].copy_from_slice(&look.paint);
        }
        self.queue.write_buffer(&self.instances, 0, &instances);
    }

    /// Draws depth alone, as the sun sees it; or colours, in the light of a shadow map.
    pub fn pipeline(&self, light: Option<&TextureView>) -> (wgpu::RenderPipeline, wgpu::BindGroup) {
        let color = [Some(TextureFormat::Rgba8UnormSrgb.into())];
        let fragment = light.map(|_| wgpu::FragmentState {
            module: &self.shader,
            entry_point: Some("shade"),
            compilation_options: Default::default(),
            targets: &color,
        });
        let instances = wgpu::VertexBufferLayout {
            array_stride: INSTANCE as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4],
        };
        let pipeline = self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &self.shader,
                entry_point: Some(if light.is_some() { "eye" } else { "sun" }),
                compilation_options: Default::default(),
                buffers: &[Some(instances)],
            },
            primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
            // Depth is reversed, as in Tercet's views unless they say otherwise.
            depth_stencil: Some(wgpu::DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment,
            multiview_mask: None,
            cache: None,
        });
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let mut entries = vec![entry(0, self.frame.as_entire_binding())];
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        if let Some(shadow_map) = light {
            entries.push(entry(1, BindingResource::TextureView(shadow_map)));
            entries.push(entry(2, BindingResource::Sampler(&sampler)));
        }
        let bindings = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        (pipeline, bindings)
    }

    /// The picture in a texture of four bytes a pixel, whose rows must be multiples of 256 bytes.
    pub fn read(&self, texture: &wgpu::Texture) -> RgbaImage {
        let row = 4 * texture.width();
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * texture.height()),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("a buffer for reading"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let bytes = buffer.get_mapped_range(..).expect("it is mapped").to_vec();
        RgbaImage::from_raw(texture.width(), texture.height(), bytes).expect("four bytes a pixel")
    }
}
