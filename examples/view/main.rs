//! Walks through any glTF scene.
//!
//! ```text
//! cargo run --release --example view -- FILE.glb
//! cargo run --release --example view -- FILE.glb --camera PATH.csv --oracle
//! cargo run --release --example view -- --help
//! ```

use std::path::PathBuf;

use clap::Args;
use support::demo;
use support::flags::Flags;
use support::gltf::GltfScene;
use support::program::Program;

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
    let scene = GltfScene::load(&flags, &scenery.file, scenery.camera.as_deref())?;
    println!("{}", scene.report());
    flags.frames = scene.frames(&flags)?;
    demo::run(&flags, scene.scenario())
}
