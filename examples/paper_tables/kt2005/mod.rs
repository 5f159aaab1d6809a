//! Kovalčík & Tobola 2005, table 1 and figures 7 and 8: the *new* algorithm, dual queries on a
//! ternary tree that they shape, against the *old* one, statistically optimised queries on a
//! binary tree.
//!
//! Both run on the same tree with the same dials, but for two things: the old one's straddlers
//! stay in their parent, and its tree is not shaped by what is seen, since it takes no votes. Both
//! keep to the rules that were fixed before anything was measured.

mod figures;
mod markdown;
mod rows;
mod scenes;

use anyhow::Context;
use tercet::policy::Statistical;
use tercet::tree::Straddlers;

use crate::frames;
use crate::output::Output;
use scenes::{SCENES, Scene};
use support::flags::Flags;
use support::lockstep::{Lane, Measured};
use support::report::write_csv;
use support::table::count;

/// A scene of the table, measured.
pub struct Outcome {
    /// What the paper says of it.
    scene: Scene,
    /// In words.
    name: String,
    new: Measured,
    old: Measured,
}

/// Runs all scenes and writes `kt2005.md`, two tables and two figures into `--out`.
pub fn run(flags: &Flags) -> anyhow::Result<()> {
    flags.check_dials(&[&flags.policy])?;
    let output = Output::new(flags, "kt2005", 2 * SCENES.len() as u64 * u64::from(flags.frames))?;
    let mut outcomes = Vec::new();
    for scene in SCENES {
        let scenario = scene.build(flags)?;
        let name = scenario.name.clone();
        let [new, old] = both(output.run(scenario, flags, lanes(flags)?)?)?;
        output.say(&line(&name, &new, &old));
        outcomes.push(Outcome { scene, name, new, old });
    }

    write_csv(&output.file(".csv"), outcomes.iter().flat_map(rows::rows))?;
    frames::write(&output.file("_frames.csv"), outcomes.iter().flat_map(rows::runs))?;
    figures::write(&output, flags, &outcomes)?;
    output.finish(&markdown::page(flags, &outcomes)?)
}

/// The new algorithm and the old one.
fn lanes(flags: &Flags) -> anyhow::Result<Vec<Lane>> {
    let tree = flags.tree()?;
    let mut binary = tree.clone();
    binary.straddlers = Straddlers::StayInParent;
    Ok(vec![
        Lane::new(flags, flags.policy()?, tree)?,
        Lane::new(flags, Box::new(Statistical::default()), binary)?,
    ])
}

fn both(measured: Vec<Measured>) -> anyhow::Result<[Measured; 2]> {
    measured.try_into().ok().context("two lanes ran")
}

/// What is printed when a scene is done.
fn line(name: &str, new: &Measured, old: &Measured) -> String {
    format!(
        "{name}: {:.1} / {:.1} s, drawn {} / {}, queries {} / {} (new / old)",
        rows::seconds(new),
        rows::seconds(old),
        count(new.summary.drawn.mean),
        count(old.summary.drawn.mean),
        count(new.summary.queries.mean),
        count(old.summary.queries.mean),
    )
}
