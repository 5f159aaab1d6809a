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

use std::fs;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use tercet::policy::Statistical;
use tercet::tree::Straddlers;

use crate::support::flags::Flags;
use crate::support::lockstep::{self, Lane, Measured};
use crate::support::report::write_csv;
use crate::support::table::count;
use scenes::{SCENES, Scene};

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
    let out = flags.out();
    fs::create_dir_all(&out).with_context(|| format!("cannot make the folder {}", out.display()))?;
    let style = "{bar:30} frame {pos} of {len}, {elapsed} so far, {eta} left: {msg}";
    let bar = ProgressBar::new(2 * SCENES.len() as u64 * u64::from(flags.frames))
        .with_style(ProgressStyle::with_template(style)?);
    let mut outcomes = Vec::new();
    for scene in SCENES {
        let scenario = scene.build(flags)?;
        let name = scenario.name.clone();
        bar.set_message(name.clone());
        let [new, old] = both(lockstep::run(scenario, flags, lanes(flags)?, || bar.inc(1))?)?;
        bar.suspend(|| println!("{}", line(&name, &new, &old)));
        outcomes.push(Outcome { scene, name, new, old });
    }
    bar.finish_and_clear();

    write_csv(&out.join("kt2005.csv"), outcomes.iter().flat_map(rows::rows))?;
    rows::write_frames(&out.join("kt2005_frames.csv"), &outcomes)?;
    figures::write(&out, flags, &outcomes)?;
    let text = markdown::page(flags, &outcomes)?;
    let path = out.join("kt2005.md");
    fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    println!("the table is {}; figures are beside it", path.display());
    Ok(())
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
