//! Tercet inside an app that has its own world, its own device and its own pipelines.
//!
//! ```text
//! cargo run --release --example own_world
//! cargo run --release --example own_world -- --help
//! ```
//!
//! A camera and the sun look at a city. Both views share one scene; each has its own culler and its
//! own questions, so the shadow map is culled just as the picture is. The last frame goes to
//! `out/own_world.png`: bit for bit what it is without culling (`--policy none` draws it so). No window
//! is needed; `WGPU_BACKEND` chooses between Vulkan, OpenGL and the rest.
//!
//! What an app with a renderer has anyway is in `gpu.rs`, `city.rs` and `shader.wgsl`.

mod city;
mod gpu;

use city::{Look, Velocity};
use clap::Parser;
use clap::builder::PossibleValuesParser;
use gpu::Gpu;
use hecs::World;
use image::{RgbaImage, imageops};
use tercet::geom::View;
use tercet::policy::{self, Policy};
use tercet::query::gpu::{FrameTargets, GpuQueries, wgpu};
use tercet::scene::{Bounds, Scene, SceneConfig};
use tercet::{Culler, Error, FrameStats};
use wgpu::{TextureFormat, TextureUsages, TextureView};

/// The shadow map's sides, in pixels.
const SHADOW_MAP: [u32; 2] = [2048; 2];

/// Draws a city with an app's own pipelines, shadows included, and culls both the picture and the
/// shadow map; the last frame goes to out/own_world.png
#[derive(Parser)]
#[command(name = "own_world")]
#[command(after_long_help = "\
Examples:
  cargo run --release --example own_world
      how much is drawn in the picture and in the shadow map, frame by frame
  cargo run --release --example own_world -- --policy none
      nothing is culled, and the picture is the same to the bit
  WGPU_BACKEND=gl cargo run --release --example own_world -- --policy chc++ --frames 10
      another algorithm, on OpenGL, for a shorter time")]
struct Arguments {
    /// The culling algorithm of both views; README.md says what each does
    #[arg(long, value_name = "NAME", default_value = "dual-query", value_parser = PossibleValuesParser::new(policies()))]
    policy: String,

    /// How many frames are drawn
    #[arg(long, value_name = "N", default_value = "40", value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
}

fn main() -> anyhow::Result<()> {
    let Arguments { policy, frames } = Arguments::parse();
    let Frame { picture, .. } = run(&policy, frames, [1920, 1080])?;
    std::fs::create_dir_all("out")?;
    // At half the size, edges are smooth.
    imageops::thumbnail(&picture, 960, 540).save("out/own_world.png")?;
    println!("out/own_world.png is the last frame");
    Ok(())
}

/// Those that find out by themselves what they draw.
fn policies() -> impl Iterator<Item = &'static str> {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    policy::NAMES.iter().copied().filter(move |name| finds_out(name))
}

/// A frame.
#[derive(Default)]
pub struct Frame {
    /// What the camera sees.
    pub picture: RgbaImage,
    /// Objects in the scene.
    pub all: u32,
    /// Those of them that were drawn in the picture.
    pub seen: u32,
    /// Those that were drawn in the shadow map.
    pub cast: u32,
}

/// Draws some frames and returns the last one.
pub fn run(policy: &str, frames: u32, size: [u32; 2]) -> anyhow::Result<Frame> {
    let mut world = city::build();
    let gpu = Gpu::new(world.len())?;
    // Depth is what questions are put to, so shaders must be able to read it.
    let (attachment, readable) = (TextureUsages::RENDER_ATTACHMENT, TextureUsages::TEXTURE_BINDING);
    let shadows = gpu.texture(SHADOW_MAP, TextureFormat::Depth32Float, attachment | readable);
    let depth = gpu.texture(size, TextureFormat::Depth32Float, attachment | readable);
    let color = gpu.texture(size, TextureFormat::Rgba8UnormSrgb, attachment | TextureUsages::COPY_SRC);
    let [shadow_map, depth, colors] = [&shadows, &depth, &color].map(|t| t.create_view(&Default::default()));

    // Where things are: one a world.
    let mut scene = Scene::new(SceneConfig::default());
    // Who looks: one a view.
    let mut sun = Camera::new(&gpu, policy, FrameTargets::new(shadow_map.clone()), None)?;
    let sky = wgpu::LoadOp::Clear(city::HAZE);
    let targets = FrameTargets::new(depth).with_color(colors, sky);
    let mut eye = Camera::new(&gpu, policy, targets, Some(&shadow_map))?;

    let mut last = Frame::default();
    for frame in 0..frames {
        // The app moves its things as it likes. The scene finds out which ones have moved.
        for (bounds, velocity) in world.query_mut::<(&mut Bounds, &Velocity)>() {
            *bounds = city::driven(bounds, velocity);
        }
        scene.sync(&world);

        let (eye_view, sun_view) = (city::eye_view(frame, size)?, city::sun_view(frame, SHADOW_MAP)?);
        gpu.upload(&world, &eye_view, &sun_view);
        // In turn, because the picture is lit by the shadow map. Views that need nothing of one
        // another (split screens, two lamps) can be drawn at once, in `std::thread::scope`: a
        // culler only reads the scene.
        let cast = sun.draw(&scene, &world, &sun_view)?;
        let seen = eye.draw(&scene, &world, &eye_view)?;
        // What both views have seen decides how finely the scene divides space.
        scene.adapt([&mut sun.culler, &mut eye.culler]);

        let (all, seen, cast) = (scene.len() as u32, seen.drawn, cast.drawn);
        println!("frame {frame:2}: of {all} objects, {seen} drawn in the picture, {cast} in the shadow map");
        last = Frame { all, seen, cast, ..Frame::default() };
    }
    Ok(Frame { picture: gpu.read(&color), ..last })
}

/// A view, with what it draws with.
struct Camera {
    culler: Culler<Box<dyn Policy>>,
    queries: GpuQueries,
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
    instances: wgpu::Buffer,
}

impl Camera {
    /// A view that draws into `targets`: depth alone, or colours in the light that a shadow map
    /// lets through.
    fn new(
        gpu: &Gpu,
        policy: &str,
        targets: FrameTargets,
        light: Option<&TextureView>,
    ) -> Result<Self, Error> {
        let culler = Culler::new(policy::by_name(policy)?);
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue)?;
        queries.target(&targets);
        let (pipeline, bindings) = gpu.pipeline(light);
        Ok(Self { culler, queries, pipeline, bindings, instances: gpu.instances.clone() })
    }

    fn draw(&mut self, scene: &Scene, world: &World, view: &View) -> Result<FrameStats, Error> {
        self.culler.frame(scene, view, &mut self.queries, |pass, objects| {
            // Called several times a frame: first with what must be in front, then with what was
            // found visible behind it. Each call is a pass of its own, so state is set each time.
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            pass.set_vertex_buffer(0, self.instances.slice(..));
            for object in objects {
                if let Ok(look) = world.get::<&Look>(object.entity()) {
                    pass.draw(look.vertices.clone(), look.instance..look.instance + 1);
                }
            }
        })
    }
}
