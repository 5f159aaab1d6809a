//! Cull on the CPU, draw elsewhere: for an app that has a renderer of its own.
//!
//! ```text
//! cargo run --release --example cpu_culling
//! cargo run --release --example cpu_culling -- --help
//! ```
//!
//! The app gives the engine a box for each thing, and for things that hide others a simple mesh
//! that lies *inside* them. After each frame it takes what became visible and what is no longer.
//! Nothing here needs a window or a GPU.

use std::collections::HashSet;

use clap::Parser;
use glam::{Affine3A, Quat, Vec3};
use hecs::World;
use tercet::geom::{Aabb, View, Viewport};
use tercet::policy::DualQuery;
use tercet::query::software::SoftwareQueries;
use tercet::scene::mesh::Mesh;
use tercet::scene::{Bounds, ObjectRef, OccluderMesh, Scene, SceneConfig};
use tercet::{Culler, Error};

/// What the app's own renderer calls a thing.
struct DrawId(u32);
/// Where a house's occluder mesh stands.
struct Place(Affine3A);
/// Drives along its street, in metres a second.
struct Speed(f32);

/// A town of 40 × 40 blocks, 30 m a block.
const BLOCKS: u32 = 40;
const BLOCK: f32 = 30.0;
const CAR: Vec3 = Vec3::new(0.9, 0.7, 2.2);

/// Culls a drive through a town on the CPU, for an app that draws elsewhere, and prints what its renderer
/// is told
#[derive(Parser)]
#[command(after_long_help = "\
Examples:
  cargo run --release --example cpu_culling
      a line every 50 frames
  cargo run --release --example cpu_culling -- --every 1 --frames 60
      the same way in a tenth of the frames, and a line for each")]
struct Arguments {
    /// How many frames the drive is cut into
    #[arg(long, value_name = "N", default_value = "600", value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,

    /// Print what the renderer is told in every N-th frame
    #[arg(long, value_name = "N", default_value = "50", value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
}

fn main() -> Result<(), Error> {
    let Arguments { frames, every } = Arguments::parse();
    let mut world = build_town()?;
    let mut scene = Scene::new(SceneConfig::default());
    let mut eye = Culler::new(DualQuery::default());
    let mut queries = SoftwareQueries::new();

    // The app's renderer. All that it needs to know is which ids to draw.
    let mut draw_list: HashSet<u32> = HashSet::new();

    println!("A drive through a town, culled on the CPU: what the renderer is told, every {every} frames.");
    println!("frame  objects  visible  entered  left  questions  culling");
    for frame in 0..=frames {
        drive(&mut world);
        let t = frame as f32 / frames as f32;
        let position = Vec3::new(-1.5, 1.7, BLOCK * (2.0 + 30.0 * t));
        let direction = Vec3::new((9.0 * t).sin(), 0.0, (9.0 * t).cos());
        let view = View::look_at(position, position + direction, 60.0, 0.1, Viewport::new(640, 360))?;

        // The scene finds out by itself what has moved, appeared or gone.
        scene.sync(&world);

        // The engine hands the closure what it has found visible so far, to learn what that
        // hides. The app draws occluder meshes here, and nothing for things that have none.
        let stats = eye.frame(&scene, &view, &mut queries, |pass, objects| {
            for object in objects {
                let mut house = world.query_one::<(&OccluderMesh, &Place)>(object.entity());
                if let Ok((walls, place)) = house.get() {
                    pass.draw_mesh(&walls.0, &place.0);
                }
            }
        })?;
        scene.adapt([&mut eye]);

        // What changed goes to the renderer; `eye.visible()` would be the whole list.
        let id = |object: ObjectRef| world.get::<&DrawId>(object.entity()).ok().map(|id| id.0);
        let entered: Vec<u32> = eye.entered().iter().copied().filter_map(id).collect();
        let left: HashSet<u32> = eye.left().filter_map(id).collect();
        draw_list.extend(&entered);
        draw_list.retain(|id| !left.contains(id));
        assert_eq!(draw_list.len(), eye.visible().len());

        if frame % every == 0 {
            let (objects, visible, questions) = (scene.len(), draw_list.len(), stats.queries);
            let (entered, left) = (entered.len(), left.len());
            let culling = stats.policy + stats.draw + stats.query + stats.wait;
            println!(
                "{frame:5}  {objects:7}  {visible:7}  {entered:7}  {left:4}  {questions:9}  {:5.1} ms",
                culling.as_secs_f64() * 1e3
            );
        }
    }
    Ok(())
}

fn build_town() -> Result<World, Error> {
    let cube = Aabb::from_center(Vec3::ZERO, Vec3::ONE);
    // Two triangles a side, by the numbers of the cube's corners.
    let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let indices = sides.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let walls = Mesh::new("walls", cube.corners().to_vec(), indices)?;
    let mut world = World::new();
    for (x, z) in (0..BLOCKS).flat_map(|x| (0..BLOCKS).map(move |z| (x, z))) {
        let street = (x as f32 - 0.5 * BLOCKS as f32) * BLOCK;
        let half = Vec3::new(11.0, 5.0 + ((x * 7 + z * 13) % 17) as f32, 11.0);
        let center = Vec3::new(street + 0.5 * BLOCK, half.y, (z as f32 + 0.5) * BLOCK);
        // A house has balconies, which its box makes room for. Its walls lie inside all that, and
        // are what it surely hides others with.
        let place =
            Affine3A::from_scale_rotation_translation(half - Vec3::splat(1.5), Quat::IDENTITY, center);
        let (bounds, id) = (Bounds(Aabb::from_center(center, half)), DrawId(world.len()));
        world.spawn((bounds, OccluderMesh(walls.clone()), Place(place), id));

        let car = Aabb::from_center(Vec3::new(street + 1.5, CAR.y, z as f32 * BLOCK), CAR);
        let (speed, id) = (Speed(8.0 + (z % 5) as f32), DrawId(world.len()));
        world.spawn((Bounds(car), speed, id));
    }
    Ok(world)
}

fn drive(world: &mut World) {
    for (Bounds(bounds), speed) in world.query_mut::<(&mut Bounds, &Speed)>() {
        let mut center = bounds.center() + Vec3::Z * speed.0 / 60.0;
        center.z %= BLOCKS as f32 * BLOCK;
        *bounds = Aabb::from_center(center, CAR);
    }
}
