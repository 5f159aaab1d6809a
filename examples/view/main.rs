//! Walks through any glTF scene.
//!
//! ```text
//! cargo run --release --example view -- FILE.glb
//! cargo run --release --example view -- FILE.glb --camera PATH.csv --oracle
//! cargo run --release --example view -- --help
//! ```

mod camera_file;
#[path = "../support/mod.rs"]
pub mod support;
mod walk;

use std::path::PathBuf;

use anyhow::ensure;
use clap::Args;
use support::flags::Flags;
use support::run::{Frame, Run};
use tercet::Culler;
use tercet::geom::{Aabb, View};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig, import};
use tercet::worlds::Pose;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Scenery {
    /// The scene: a .glb or .gltf file
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Where the camera goes, a frame a line: eye_x,eye_y,eye_z,target_x,target_y,target_z,fov_y_degrees.
    /// It says how many frames there are. Without it, the camera walks through the middle of the
    /// scene, or around it where there is only one thing to see
    #[arg(long, value_name = "PATH")]
    camera: Option<PathBuf>,
}

fn main() -> anyhow::Result<()> {
    let (mut flags, scenery) = Flags::parse_with::<Scenery>("view", "A walk through any glTF scene.");
    let imported = import::load(&scenery.file)?;
    #[cfg(feature = "lod")]
    let imported = with_levels(imported, &flags)?;
    println!("{}", imported.report);
    let model = &imported.model;
    ensure!(!model.objects.is_empty(), "{}: there is nothing to see in it", scenery.file.display());

    let mut path: Vec<Pose> = match &scenery.camera {
        Some(file) => camera_file::read(file)?,
        None => {
            let boxes: Vec<Aabb> = model.objects.iter().map(|o| o.bounds).collect();
            let flight = walk::through(&model.bounds, &boxes);
            let last = (flags.frames - 1).max(1) as f32;
            (0..flags.frames).map(|n| flight.pose(n as f32 / last)).collect()
        }
    };
    let flown = flags.flight_end()? * path.len() as f32;
    path.truncate((flown.ceil() as usize).max(1));
    flags.frames = path.len() as u32;
    let near = walk::near(&model.bounds);

    let mut world = hecs::World::new();
    imported.spawn(&mut world);
    let mut scene = Scene::new(SceneConfig { tree: flags.tree()?, ..Default::default() });
    let mut eye = Culler::new(flags.policy()?);
    let mut queries = SoftwareQueries::new();

    let mut run = Run::new(&flags, &model.name, &world)?;
    let painter = run.painter();
    for pose in path {
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, near, flags.viewport())?;
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

/// A file says nothing of levels of detail: they are made here, unless nobody wants them.
#[cfg(feature = "lod")]
fn with_levels(mut imported: import::Imported, flags: &Flags) -> anyhow::Result<import::Imported> {
    const LEAST_TRIANGLES: usize = 64;
    if !flags.full_detail {
        imported.generate_levels(LEAST_TRIANGLES)?;
    }
    Ok(imported)
}
