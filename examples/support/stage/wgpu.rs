//! The GPU answers, and draws the finished picture while it does.

use std::time::Instant;

use anyhow::ensure;
use hecs::World;
use tercet::draw::{Detail, Renderer, Shading};
use tercet::geom::{View, Viewport};
use tercet::query::gpu::{FrameTargets, GpuConfig, GpuQueries, wgpu};
use tercet::record::Logged;
use tercet::scene::Scene;
use wgpu::{TextureFormat, TextureUsages, TextureView};

use super::{Drawn, Gpu, Watched};
use crate::run::Eye;

/// The sky, as sRGB shows it.
const SKY: wgpu::Color = wgpu::Color { r: 0.74, g: 0.82, b: 0.91, a: 1.0 };

/// The wgpu backend, with a renderer and what both draw into.
pub struct WgpuStage {
    gpu: Gpu,
    pub(super) queries: Watched<Logged<GpuQueries>>,
    renderer: Renderer,
    look_ups: u32,
    picture: Picture,
    /// Who owns each pixel, while the policy asks.
    ids: Option<TextureView>,
    pub(super) detail: Detail,
}

/// Attachments that are also read: colour by a window, depth by questions.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What is seen.
    pub color: TextureView,
    /// What is asked.
    pub depth: TextureView,
    size: (u32, u32),
}

impl Picture {
    /// The format of its colours, which hold what sRGB shows: windows take them as they are.
    pub const COLOR: TextureFormat = TextureFormat::Rgba8Unorm;

    /// A picture of a viewport's size.
    ///
    /// # Errors
    /// When the device has no textures of that size.
    pub fn new(gpu: &Gpu, viewport: Viewport) -> anyhow::Result<Self> {
        let most = gpu.most_pixels_a_side();
        ensure!(
            viewport.width.max(viewport.height) <= most,
            "{} × {} pixels: {} draws {most} a side at most",
            viewport.width,
            viewport.height,
            gpu.adapter()
        );
        let texture = |format| attachment(gpu, viewport, format, TextureUsages::COPY_SRC);
        Ok(Self {
            color: texture(Self::COLOR),
            depth: texture(TextureFormat::Depth32Float),
            size: (viewport.width, viewport.height),
        })
    }

    /// Whether it has a viewport's size.
    pub fn fits(&self, viewport: Viewport) -> bool {
        self.size == (viewport.width, viewport.height)
    }

    /// A pass on it, on top of what is there or on a new sky; on black for `dark`.
    pub fn pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        clear: bool,
        dark: bool,
    ) -> wgpu::RenderPass<'static> {
        let sky = if dark { wgpu::Color::BLACK } else { SKY };
        let color = if clear { wgpu::LoadOp::Clear(sky) } else { wgpu::LoadOp::Load };
        let depth = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
        let descriptor = wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: color, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: depth, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        };
        encoder.begin_render_pass(&descriptor).forget_lifetime()
    }

    /// As the engine takes it: cleared by each frame.
    pub fn targets(&self) -> FrameTargets {
        FrameTargets::new(self.depth.clone()).with_color(self.color.clone(), wgpu::LoadOp::Clear(SKY))
    }
}

/// What can be drawn into, and read.
fn attachment(gpu: &Gpu, viewport: Viewport, format: TextureFormat, usage: TextureUsages) -> TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width: viewport.width, height: viewport.height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl WgpuStage {
    /// Draws as finely as `detail` says.
    pub fn new(gpu: Gpu, detail: Detail) -> anyhow::Result<Self> {
        Self::with_config(gpu, detail, GpuConfig::default())
    }

    /// The same with other dials of the backend.
    ///
    /// # Errors
    /// As [`WgpuStage::new`].
    pub fn with_config(gpu: Gpu, detail: Detail, config: GpuConfig) -> anyhow::Result<Self> {
        let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config)?;
        let picture = Picture::new(&gpu, Viewport::new(1, 1))?;
        queries.target(&picture.targets());
        Ok(Self {
            queries: Watched::new(Logged::silent(queries)),
            renderer: Renderer::new(&gpu.device, &gpu.queue, Some(Picture::COLOR))?,
            look_ups: 0,
            picture,
            ids: None,
            gpu,
            detail,
        })
    }

    /// What it runs on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The backend, as a recorder listens to it.
    pub fn log(&mut self) -> &mut Logged<GpuQueries> {
        self.queries.backend()
    }

    /// Shades each fragment with so many look-ups from now on; see [`Renderer::set_look_ups`].
    pub fn set_look_ups(&mut self, count: u32) {
        self.look_ups = count;
        self.renderer.set_look_ups(count);
    }

    /// What was drawn last.
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    /// See [`Stage::frame`](super::Stage::frame). It returns when the GPU has finished: a time that
    /// leaves out what is still to be done would say nothing.
    pub fn frame(
        &mut self,
        eye: &mut Eye,
        scene: &Scene,
        world: &World,
        view: &View,
    ) -> anyhow::Result<Drawn> {
        self.equip(view.viewport(), eye.policy().asks_owners())?;
        let Self { queries, renderer, .. } = self;
        renderer.begin(view, self.detail, Shading::Lit);
        let mut triangles = 0;
        let mut stats = eye.frame(scene, view, queries, |pass, objects| {
            triangles += renderer.draw(pass, world, objects).triangles;
        })?;
        let start = Instant::now();
        self.gpu.wait()?;
        stats.wait += start.elapsed();
        Ok(Drawn { stats, triangles })
    }

    /// Makes what is drawn into anew, if another size is wanted, or an item buffer now or no longer.
    fn equip(&mut self, viewport: Viewport, asks_owners: bool) -> anyhow::Result<()> {
        let Self { gpu, queries, renderer, .. } = self;
        let is_other = asks_owners != self.ids.is_some();
        if is_other {
            let color = Some(Picture::COLOR);
            *renderer = match asks_owners {
                true => Renderer::with_ids(&gpu.device, &gpu.queue, color)?,
                false => Renderer::new(&gpu.device, &gpu.queue, color)?,
            };
            renderer.set_look_ups(self.look_ups);
        }
        if self.picture.fits(viewport) && !is_other {
            return Ok(());
        }
        self.picture = Picture::new(gpu, viewport)?;
        self.ids = asks_owners.then(|| attachment(gpu, viewport, Renderer::IDS, TextureUsages::empty()));
        let mut targets = self.picture.targets();
        if let Some(ids) = &self.ids {
            targets = targets.with_color(ids.clone(), wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT));
        }
        let queries = &mut queries.backend().backend;
        queries.target(&targets);
        queries.target_ids(self.ids.as_ref());
        Ok(())
    }
}
