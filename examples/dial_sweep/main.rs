//! Turns each dial of the tree through its values, one dial at a time, in two worlds.
//!
//! ```text
//! cargo run --release --example dial_sweep
//! cargo run --release --example dial_sweep -- --set preset=paper --out out/dial_sweep_paper
//! cargo run --release --example dial_sweep -- --help
//! ```

mod dials;
mod figure;
mod outcome;
mod plan;
mod report;

use std::fs;

use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressStyle};
use outcome::Outcome;
use plan::Plan;
use support::flags::Flags;
use support::lockstep::{self, Lane};
use support::program::Program;
use support::scenario::Scenario;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Choice {
    /// Turn this dial only; may be repeated
    #[arg(long = "dial", value_name = "NAME", value_parser = PossibleValuesParser::new(dials::names()))]
    only: Vec<String>,
}

const PROGRAM: Program = Program {
    name: "dial_sweep",
    about: "Turns each dial of the tree through its values: what does it cost, what does it save?",
    examples: &[
        ("", "every dial, around the default tree"),
        ("--set preset=paper", "around the tree of the 2005 paper"),
        ("--dial o_split --dial bulk_leaf --frames 240", "two dials, for longer"),
        ("--oracle", "with the least that asking about boxes can draw"),
        ("--scale 0.2 --objects 300 --frames 20", "a look in a minute"),
    ],
    frames: "60",
    policy: "dual-query",
    full_detail: false,
    gate: false,
    policies: &[],
    refused: &[
        ("audit", "--audit has no meaning here: --oracle checks every frame"),
        ("backend", "--backend has no meaning here: all lanes run on the software backend"),
    ],
};

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    let plan = Plan::new(&flags.tree()?, &choice.only)?;
    let out = flags.out();
    fs::create_dir_all(&out).with_context(|| format!("cannot make the folder {}", out.display()))?;

    type Build = fn(&Flags) -> anyhow::Result<Scenario>;
    let worlds: [Build; 2] = [
        |flags| Scenario::power_plant(flags, !flags.still),
        |flags| Ok(Scenario::teapots(flags, flags.objects, !flags.still)),
    ];
    let style = "{bar:30} {pos} of {len} frames, {elapsed} so far, {eta} left: {msg}";
    let frames = worlds.len() as u64 * plan.trees.len() as u64 * u64::from(flags.frames);
    let bar = ProgressBar::new(frames).with_style(ProgressStyle::with_template(style)?);
    let mut outcomes = Vec::new();
    for build in worlds {
        let scenario = build(&flags)?;
        let name = scenario.name.clone();
        bar.suspend(|| println!("{name}: {} trees, {} frames", plan.trees.len(), flags.frames));
        bar.set_message(name.clone());
        let lane = |tree: &_| Lane::new(&flags, flags.policy()?, Clone::clone(tree));
        let lanes = plan.trees.iter().map(lane).collect::<anyhow::Result<_>>()?;
        let lanes = lockstep::run(scenario, &flags, lanes, || bar.inc(1))?;
        outcomes.push(Outcome::new(name, lanes));
    }
    bar.finish_and_clear();

    report::write(&out, &flags, &plan, &outcomes)?;
    figure::write(&out.join("dial_sweep.png"), &flags, &plan, &outcomes)?;
    println!("the tables are {}; the figure is beside it", out.join("dial_sweep.md").display());
    Ok(())
}
