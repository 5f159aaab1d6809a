//! Targets with a colour, and what is in them.

use hecs::World;
use tercet::draw::{Detail, Renderer, Shading};
use tercet::geom::View;
use tercet::query::QueryBackend;
use tercet::query::gpu::{FrameTargets, GpuQueries};
use tercet::scene::{ObjectRef, Scene, SceneConfig};
use wgpu::{RenderPass, Texture, TextureFormat};

use crate::support::{Gpu, depth_texture, read_depth, read_texels, texture};

/// What all pictures are drawn in.
pub const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// Every shading, and how many look-ups it takes.
pub const SHADINGS: [(Shading, u32); 4] =
    [(Shading::Lit, 0), (Shading::Lit, 3), (Shading::Unlit, 0), (Shading::Overdraw, 0)];

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

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        [self.color.width(), self.color.height()]
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
        let colors = read_texels(gpu, &self.color, view, "pack4x8unorm(texel)");
        Shot { colors, nearness: read_depth(gpu, &self.depth, view).values }
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
