//! A walk through a city of 200 000 objects: houses, what stands on their roofs, and what stands in
//! the streets. From the street hardly any of it is visible; from above the roofs, much.
//!
//! ```text
//! cargo run --release --example city
//! cargo run --release --example city -- --headless --fast
//! cargo run --release --example city -- --help
//! ```

use clap::Args;
use support::demo;
use support::flags::Flags;
use support::program::Program;
use support::scenario::Scenario;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Pace {
    /// Run instead of walking: twice backwards, with quick turns that show what was behind
    #[arg(long)]
    fast: bool,
}

const PROGRAM: Program = Program {
    examples: &[
        ("", "a window to walk about in; the next line's run where there is no display"),
        ("--headless", "the whole walk, with its figures and pictures"),
        ("--headless --fast", "the same streets at a run, with quick turns"),
        ("--scale 0.1 --oracle", "a tenth of the city; check each frame against the exact visible set"),
        ("--headless --policy frustum", "what the view frustum alone would leave to draw"),
    ],
    refused: &[
        ("objects", "--objects has no meaning here: nothing moves about; --scale says how large the city is"),
        ("still", "--static has no meaning here: nothing moves about"),
    ],
    ..Program::demo(
        "city",
        "A city of low houses and countless small things, walked through at street level.",
    )
};

fn main() -> anyhow::Result<()> {
    let (flags, pace) = Flags::parse_for::<Pace>(&PROGRAM);
    demo::run(&flags, Scenario::city(&flags, pace.fast))
}
