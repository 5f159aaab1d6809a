//! Three worlds of many triangles, each hiding things in its own way: a valley of few complex
//! objects, a wide factory full of machines, and satellites made of thousands of detailed parts.
//!
//! ```text
//! cargo run --release --example worlds -- --world fantasy
//! cargo run --release --example worlds -- --world factory --headless
//! cargo run --release --example worlds -- --help
//! ```

use clap::{Args, ValueEnum};
use support::demo;
use support::flags::Flags;
use support::program::Program;
use support::scenario::Scenario;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Choice {
    /// Which world
    #[arg(long, value_enum, default_value = "fantasy")]
    world: World,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum World {
    /// A castle, a village and a wood: 600 objects of 10 000 triangles
    Fantasy,
    /// Machines in cells between aisles and walls: 16 000 objects
    Factory,
    /// Parts of 80 satellites in formation: 20 320 objects
    Satellites,
}

const PROGRAM: Program = Program {
    examples: &[
        ("--world fantasy", "a window to fly about in; the next line's run where there is no display"),
        ("--world factory --headless", "the whole way through the factory, with its figures and pictures"),
        (
            "--world satellites --scale 0.2 --oracle",
            "a fifth of them; check each frame against the exact set",
        ),
        ("--world factory --headless --policy frustum", "what the view frustum alone would leave to draw"),
    ],
    refused: &[
        (
            "objects",
            "--objects has no meaning here: nothing moves about; --scale says how large the world is",
        ),
        ("still", "--static has no meaning here: nothing moves about"),
    ],
    ..Program::demo("worlds", "Worlds of many triangles that hide things in different ways.")
};

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    let scenario = match choice.world {
        World::Fantasy => Scenario::fantasy(&flags),
        World::Factory => Scenario::factory(&flags),
        World::Satellites => Scenario::satellites(&flags),
    };
    demo::run(&flags, scenario)
}
