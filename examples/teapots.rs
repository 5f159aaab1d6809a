//! A cloud of teapots, all moving and each of 6 400 triangles: little is hidden, and what is, is
//! hidden by other teapots. Culling has the most to lose here.
//!
//! ```text
//! cargo run --release --example teapots
//! cargo run --release --example teapots -- --static --oracle
//! cargo run --release --example teapots -- --help
//! ```

pub mod support;

use support::flags::Flags;
use support::run::{Frame, Run};
use tercet::Culler;
use tercet::geom::View;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds::{self, Swarm, teapots};

/// Nothing is drawn that is nearer to the eye, metres.
const NEAR: f32 = 0.1;

fn main() -> anyhow::Result<()> {
    let flags =
        Flags::parse("teapots", "A cloud of teapots, --objects × --scale of them, that hide each other.");

    let count = (flags.objects as f64 * f64::from(flags.scale)).round() as usize;
    anyhow::ensure!(count > 0, "{} × {} teapots: a cloud needs at least one", flags.objects, flags.scale);

    // The app's world. The cloud's room grows with the number of teapots, not their density.
    let mut world = hecs::World::new();
    let swarm = Swarm::new(flags.seed, count, worlds::teapot_mesh(), teapots::room(count));
    swarm.spawn(&mut world);
    let flight = teapots::path(count);

    // The engine, as in the example moving_bunnies.
    let mut scene = Scene::new(SceneConfig { tree: flags.tree()?, ..Default::default() });
    let mut eye = Culler::new(flags.policy()?);
    let mut queries = SoftwareQueries::new();

    let mut run = Run::new(&flags, &name(&flags, count), &world)?;
    let painter = run.painter();
    while let Some(t) = run.advance() {
        if !flags.still {
            swarm.step(&mut world, Swarm::STEP);
        }
        let pose = flight.pose(t);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, NEAR, flags.viewport())?;

        let synced = scene.sync(&world);
        run.look(&scene, &world, &view, &mut eye)?;

        let mut triangles = 0;
        let stats = eye.frame(&scene, &view, &mut queries, |pass, objects| {
            triangles += painter.draw(&world, &view, pass, objects);
        })?;

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
fn name(flags: &Flags, count: usize) -> String {
    let manner = if flags.still { "static" } else { "moving" };
    let teapots = if count == 1 { "teapot" } else { "teapots" };
    format!("{count} {manner} {teapots}")
}
