//! Turns each dial of the tree through its values, one dial at a time, in two worlds.
//!
//! ```text
//! cargo run --release --example dial_sweep
//! cargo run --release --example dial_sweep -- --set preset=paper --out out/dial_sweep_paper
//! cargo run --release --example dial_sweep -- --help
//! ```

mod dials;
mod figure;
mod plan;
mod report;
#[path = "../support/mod.rs"]
pub mod support;

use std::fs;

use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressStyle};
use plan::Plan;
use support::flags::Flags;
use support::lockstep::{self, Lane, Measured};
use support::program::Program;
use support::report::percentile;
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
    full_detail: false,
    refused: &[],
};

/// A world, and what every lane of the plan measured in it.
struct Outcome {
    name: String,
    lanes: Vec<Measured>,
}

impl Outcome {
    /// What a tree drew over what the base drew.
    fn drawn_of_base(&self, tree: usize) -> f64 {
        let drawn = |tree: usize| self.lanes[tree].summary.drawn.mean;
        if drawn(0) > 0.0 { drawn(tree) / drawn(0) } else { 1.0 }
    }

    /// A tree's time over the base's: the median over the frames of the ratio in each. Frames
    /// differ more than trees, and both had the same ones.
    fn time_of_base(&self, tree: usize) -> f64 {
        let (these, base) = (&self.lanes[tree].frames, &self.lanes[0].frames);
        let ratios: Vec<f64> = these.iter().zip(base).map(|(a, b)| a.frame_ms / b.frame_ms).collect();
        percentile(&ratios, 50.0)
    }

    /// The least and the greatest time over the base's of trees that did in every frame what the
    /// base did: the noise of the measurement. None where a dial always changed something.
    fn noise(&self) -> Option<(f64, f64)> {
        let work = |lane: &Measured| -> Vec<_> {
            lane.frames.iter().map(|f| (f.drawn, f.drawn_triangles, f.queries, f.waves)).collect()
        };
        let base = work(self.lanes.first()?);
        let same = (1..self.lanes.len()).filter(|&tree| work(&self.lanes[tree]) == base);
        same.map(|tree| self.time_of_base(tree)).fold(None, |range, x| {
            range.map_or(Some((x, x)), |(a, b): (f64, f64)| Some((a.min(x), b.max(x))))
        })
    }
}

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    let plan = Plan::new(&flags.tree()?, &choice.only)?;
    let out = flags.out();
    fs::create_dir_all(&out).with_context(|| format!("cannot make the folder {}", out.display()))?;

    type Build = fn(&Flags) -> anyhow::Result<Scenario>;
    let worlds: [Build; 2] = [
        |flags| Scenario::power_plant(flags, !flags.still),
        |flags| Ok(Scenario::teapots(flags, !flags.still)),
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
        let lane = |tree: &_| Lane::new(flags.policy()?, Clone::clone(tree));
        let lanes = plan.trees.iter().map(lane).collect::<anyhow::Result<_>>()?;
        let lanes = lockstep::run(scenario, &flags, lanes, || bar.inc(1))?;
        outcomes.push(Outcome { name, lanes });
    }
    bar.finish_and_clear();

    report::write(&out, &flags, &plan, &outcomes)?;
    figure::write(&out.join("dial_sweep.png"), &flags, &plan, &outcomes)?;
    println!("the tables are {}; the figure is beside it", out.join("dial_sweep.md").display());
    Ok(())
}
