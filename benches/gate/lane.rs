//! A policy with a scene and a backend of its own.

use std::time::Instant;

use anyhow::Context;
use tercet::Culler;
use tercet::draw::{Detail, Drawable, Renderer, Shading};
use tercet::policy::Policy;
use tercet::query::gpu::{FrameTargets, GpuQueries, wgpu};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};

use crate::world::{SCREEN, World};

/// A device.
#[derive(Clone)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// In words.
    pub name: String,
}

/// One way of culling.
pub struct Lane {
    scene: Scene,
    eye: Culler<Box<dyn Policy>>,
    backend: Backend,
    /// Frames whose gate was shut.
    pub gated: usize,
}

enum Backend {
    Software(Box<SoftwareQueries>),
    Gpu { gpu: Gpu, queries: Box<GpuQueries>, renderer: Box<Renderer> },
}

impl Gpu {
    /// The most powerful one, if there is any.
    pub fn open() -> anyhow::Result<Option<Self>> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::from_env().unwrap_or_default();
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let instance = wgpu::Instance::new(descriptor);
        let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else { return Ok(None) };
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            required_features: GpuQueries::wanted_features(&adapter),
            required_limits: adapter.limits(),
            ..Default::default()
        });
        let (device, queue) = pollster::block_on(request)?;
        let info = adapter.get_info();
        Ok(Some(Self { device, queue, name: format!("{} ({})", info.name, info.backend) }))
    }

    /// What both ways draw into, each its own.
    fn targets(&self) -> FrameTargets {
        let texture = |format, usage| {
            let texture = self.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: SCREEN.width, height: SCREEN.height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let depth = texture(wgpu::TextureFormat::Depth32Float, wgpu::TextureUsages::TEXTURE_BINDING);
        let color = texture(COLOR, wgpu::TextureUsages::COPY_SRC);
        FrameTargets::new(depth).with_color(color, wgpu::LoadOp::Clear(wgpu::Color::BLUE))
    }
}

const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl Lane {
    /// One that has seen nothing yet, on a device or on the CPU.
    pub fn new(policy: Box<dyn Policy>, gpu: Option<&Gpu>) -> anyhow::Result<Self> {
        let (mut scene, mut eye) = (Scene::new(SceneConfig::default()), Culler::new(policy));
        scene.adapt([&mut eye]);
        let backend = match gpu {
            None => Backend::Software(Box::new(SoftwareQueries::new())),
            Some(gpu) => {
                let mut queries = GpuQueries::new(&gpu.device, &gpu.queue)?;
                queries.target(&gpu.targets());
                let renderer = Renderer::new(&gpu.device, &gpu.queue, Some(COLOR))?;
                Backend::Gpu { gpu: gpu.clone(), queries: Box::new(queries), renderer: Box::new(renderer) }
            }
        };
        Ok(Self { scene, eye, backend, gated: 0 })
    }

    /// Seconds of a frame, its upkeep included, until the device has finished it.
    pub fn frame(&mut self, World { world, .. }: &World, view: &tercet::geom::View) -> anyhow::Result<f64> {
        let start = Instant::now();
        self.scene.sync(world);
        match &mut self.backend {
            Backend::Software(queries) => {
                self.eye.frame(&self.scene, view, &mut **queries, |pass, objects| {
                    for object in objects {
                        let d = world.get::<&Drawable>(object.entity()).expect("it was spawned with one");
                        pass.draw_mesh(&d.mesh, &d.world_from_object);
                    }
                })?;
            }
            Backend::Gpu { gpu, queries, renderer } => {
                renderer.begin(view, Detail::FULL, Shading::Lit);
                self.eye.frame(&self.scene, view, &mut **queries, |pass, objects| {
                    renderer.draw(pass, world, objects);
                })?;
                gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the device")?;
            }
        }
        self.scene.adapt([&mut self.eye]);
        let taken = start.elapsed().as_secs_f64();
        let counters = self.eye.policy().counters();
        self.gated += counters.iter().filter(|c| c.key == "gated_frames" && c.count > 0).count();
        Ok(taken)
    }
}
