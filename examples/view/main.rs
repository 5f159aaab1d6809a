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

use anyhow::{Context, ensure};
use clap::Args;
use support::demo;
use support::flags::Flags;
use support::program::Program;
use support::scenario::{Flight, Scenario};
use tercet::geom::Aabb;
use tercet::scene::import;

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

const PROGRAM: Program = Program {
    examples: &[
        ("assets/bunny.glb", "a window to fly about in; the next line's run where there is no display"),
        ("assets/bunny.glb --headless", "one walk, with its figures and pictures"),
        ("assets/bunny.glb --camera PATH.csv --oracle", "check each frame against the exact visible set"),
    ],
    refused: &[
        ("objects", "--objects has no meaning here: the file says what there is"),
        ("scale", "--scale has no meaning here: the file says how much there is"),
        ("seed", "--seed has no meaning here: nothing is made by chance"),
        ("still", "--static has no meaning here: nothing moves"),
    ],
    ..Program::demo("view", "A walk through any glTF scene.")
};

fn main() -> anyhow::Result<()> {
    let (mut flags, scenery) = Flags::parse_for::<Scenery>(&PROGRAM);
    let imported = import::load(&scenery.file)
        .with_context(|| format!("{} is to be a .glb or .gltf file", scenery.file.display()))?;
    #[cfg(feature = "lod")]
    let imported = with_levels(imported, &flags)?;
    println!("{}", imported.report);
    let model = &imported.model;
    ensure!(!model.objects.is_empty(), "{}: there is nothing to see in it", scenery.file.display());

    let flight = match &scenery.camera {
        Some(file) => Flight::Poses(camera_file::read(file)?),
        None => {
            let boxes: Vec<Aabb> = model.objects.iter().map(|o| o.bounds).collect();
            Flight::Path(walk::through(&model.bounds, &boxes))
        }
    };
    if let Flight::Poses(poses) = &flight {
        let flown = flags.flight_end()? * poses.len() as f32;
        flags.frames = (flown.ceil() as u32).max(1);
    }
    let (name, near) = (model.name.clone(), walk::near(&model.bounds));
    let mut world = hecs::World::new();
    imported.spawn(&mut world);
    demo::run(&flags, Scenario { name, world, swarm: None, flight, near })
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
