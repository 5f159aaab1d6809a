//! A power plant through which thousands of bunnies fly: the main demo.
//!
//! ```text
//! cargo run --release --example moving_bunnies
//! cargo run --release --example moving_bunnies -- --headless --frames 60 --oracle
//! cargo run --release --example moving_bunnies -- --help
//! ```
//!
//! The engine is used in `support/headless.rs` and `support/window/`.

use support::demo;
use support::flags::Flags;
use support::scenario::Scenario;

fn main() -> anyhow::Result<()> {
    let flags = Flags::parse("moving_bunnies", "Bunnies fly through a power plant; most of it is hidden.");
    let scenario = Scenario::power_plant(&flags, !flags.still)?;
    demo::run(&flags, scenario)
}
