//! A power plant through which thousands of bunnies fly: the main demo, and a tour of the engine.
//!
//! ```text
//! cargo run --release --example moving_bunnies
//! cargo run --release --example moving_bunnies -- --frames 60 --oracle
//! cargo run --release --example moving_bunnies -- --help
//! ```

pub mod support;

use support::flags::Flags;
use support::run::{Frame, Run};
use tercet::Culler;
use tercet::geom::View;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds::{self, Swarm, power_plant};

/// Nothing is drawn that is nearer to the eye, metres.
const NEAR: f32 = 0.1;

fn main() -> anyhow::Result<()> {
    let flags = Flags::parse("moving_bunnies", "Bunnies fly through a power plant; most of it is hidden.");

    // The app's world: entities with a `Bounds` component, which the engine reads, and whatever
    // the app draws them from, here a `Drawable`.
    let mut world = hecs::World::new();
    let plant = worlds::power_plant(flags.seed, flags.scale);
    plant.spawn(&mut world);
    let room = power_plant::interior(flags.scale);
    let swarm = Swarm::new(flags.seed, flags.objects, worlds::bunny_mesh()?, room);
    swarm.spawn(&mut world);
    let flight = power_plant::path(flags.scale);

    // The engine: the scene knows where things are, the culler what one camera sees, and the
    // backend answers whether a box is hidden.
    let mut scene = Scene::new(SceneConfig { tree: flags.tree()?, ..Default::default() });
    let mut eye = Culler::new(flags.policy()?);
    let mut queries = SoftwareQueries::new();

    let mut run = Run::new(&flags, &name(&flags), &world)?;
    let painter = run.painter();
    while let Some(t) = run.advance() {
        // The world goes its own way.
        if !flags.still {
            swarm.step(&mut world, Swarm::STEP);
        }
        let pose = flight.pose(t);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, NEAR, flags.viewport())?;

        // 1. What has changed? Spawned, moved and despawned entities become edits of the tree.
        let synced = scene.sync(&world);
        run.look(&scene, &world, &view, &mut eye)?;

        // 2. Draw, without what is hidden. The closure is the app's own renderer: it is handed
        //    the objects to draw, in several batches, and the engine asks its questions between.
        let mut triangles = 0;
        let stats = eye.frame(&scene, &view, &mut queries, |pass, objects| {
            triangles += painter.draw(&world, &view, pass, objects);
        })?;

        // 3. What was seen tells the tree where to be finer, and where coarser.
        let adapted = scene.adapt([&mut eye]);

        run.record(Frame {
            scene: &scene,
            view: &view,
            eye: &eye,
            queries: &queries,
            synced,
            stats,
            adapted,
            triangles,
        });
    }
    run.finish(&scene, &world, &eye)?;
    Ok(())
}

/// The world in words, for the report.
fn name(flags: &Flags) -> String {
    let manner = if flags.still { "static" } else { "moving" };
    match flags.objects {
        0 => "power plant alone".to_owned(),
        1 => format!("power plant + 1 {manner} bunny"),
        n => format!("power plant + {n} {manner} bunnies"),
    }
}
