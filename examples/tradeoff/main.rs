//! Turns the dials between speed and accuracy: what does each save, and what goes wrong then?
//!
//! ```text
//! cargo run --release --example tradeoff
//! cargo run --release --example tradeoff -- --world city --allow 0.1%
//! cargo run --release --example tradeoff -- --help
//! ```

mod dials;
mod figure;
mod figures;
mod finder;
mod outcome;
mod pareto;
mod report;
mod resume;
mod runner;
mod search;
mod together;
mod worlds;

use std::fs;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;
use dials::Setting;
use indicatif::{ProgressBar, ProgressStyle};
use resume::{Identity, Resume};
use runner::Runner;
use search::Search;
use support::flags::Flags;
use support::program::Program;
use worlds::{Made, World};

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Choice {
    /// Where; several are run one after the other
    #[arg(long, value_enum, value_name = "NAME", value_delimiter = ',', default_value = "moving_bunnies")]
    world: Vec<Made>,

    /// A scene of your own instead: a .glb or .gltf file
    #[arg(long, value_name = "FILE", conflicts_with = "world")]
    gltf: Option<PathBuf>,

    /// The camera's way through it, a frame a line, as the example `view` takes it
    #[arg(long, value_name = "PATH", requires = "gltf")]
    camera: Option<PathBuf>,

    /// Turn these dials only, one at a time
    #[arg(long = "dial", value_name = "NAME", value_delimiter = ',',
          value_parser = PossibleValuesParser::new(dials::names()))]
    only: Vec<String>,

    /// Run every combination of these dials; one at a time only those that --dial names
    #[arg(long, value_name = "NAME", value_delimiter = ',',
          value_parser = PossibleValuesParser::new(dials::names()))]
    grid: Vec<String>,

    /// Find the fastest setting with so many wrong samples at most in the mean frame: 0.1%. It searches
    /// among the combinations of --grid, or else of all dials (of max_error_px, only if --dial names it)
    #[arg(long, value_name = "SHARE", value_parser = share)]
    allow: Option<f64>,

    /// Throw away what an interrupted run has finished
    #[arg(long)]
    restart: bool,
}

const PROGRAM: Program = Program {
    name: "tradeoff",
    about: "Turns the dials between speed and accuracy: what does each save, and what goes wrong then?",
    examples: &[
        ("", "every dial of speed against accuracy, one at a time, in the power plant"),
        ("--world city,factory --dial visible_pixels,latency", "two dials in two worlds"),
        ("--gltf assets/bunny.glb --camera PATH.csv", "a scene of your own, with the camera of `view`"),
        ("--allow 0.1%", "and the fastest combination with at most one wrong sample in a thousand"),
        (
            "--grid visible_pixels,resolution_divisor --allow 0.1%",
            "all combinations of two dials, and how near the search comes to the best of them",
        ),
        ("--policy chc++ --set n_av=3", "another policy, and a base of your own"),
        ("--scale 0.2 --objects 300 --frames 20 --size 640x360", "a look in a minute"),
    ],
    frames: "60",
    policy: "dual-query",
    full_detail: false,
    gate: false,
    policies: &[],
    refused: &[
        ("audit", "--audit has no meaning here: every frame is checked"),
        ("backend", "--backend has no meaning here: all lanes run on the software backend"),
        ("record", "--record has no meaning here: many settings run"),
    ],
};

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    let (base, usable) = (Setting::new(flags.tradeoff()?), dials::names_for(&*flags.policy()?));
    let search = Search::new(base, &usable, &choice.only, &choice.grid, choice.allow)?;
    let worlds = match &choice.gltf {
        Some(file) => vec![World::load(&flags, file, choice.camera.as_deref())?],
        None => choice.world.iter().map(|made| World::Made(*made)).collect(),
    };
    let out = flags.out();
    fs::create_dir_all(&out).with_context(|| format!("cannot make the folder {}", out.display()))?;
    let path = out.join("tradeoff.jsonl");
    let mut resume = Resume::open(&path, &identity(&flags, &choice), choice.restart)?;
    if resume.len() > 0 {
        println!("going on from {}: {} settings are finished", path.display(), resume.len());
    }

    let style = "{bar:30} {pos} of {len} frames, {elapsed} so far, {eta} left: {msg}";
    let bar = ProgressBar::new(0).with_style(ProgressStyle::with_template(style)?);
    let mut outcomes = Vec::new();
    for world in &worlds {
        bar.set_message(world.key());
        let mut runner = Runner::new(&flags, world, search.base.clone(), &mut resume, &bar)?;
        let outcome = search.run(&mut runner)?;
        let (all, ran) = (outcome.rows.len(), runner.ran);
        bar.suspend(|| println!("{}: {all} settings, {ran} of them run now", outcome.world));
        if let Some(found) = &outcome.found {
            bar.suspend(|| println!("{}", report::found(found).trim()));
        }
        outcomes.push(outcome);
    }
    bar.finish_and_clear();

    report::write(&out, &flags, &search.base.name, &outcomes)?;
    figure::write(&out, &flags, &outcomes)?;
    println!("the tables are {}; the plots are beside it", out.join("tradeoff.md").display());
    Ok(())
}

/// What must be the same when an interrupted run goes on. Worlds, dials and what is allowed may change:
/// finished settings stay finished.
fn identity(flags: &Flags, choice: &Choice) -> Identity {
    let dials: Vec<String> = flags.dials.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let camera = choice.camera.as_ref().map_or("none".to_owned(), |path| path.display().to_string());
    [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("policy", flags.policy.clone()),
        ("set", dials.join(" ")),
        ("frames", flags.frames.to_string()),
        ("size", format!("{}x{}", flags.size.0, flags.size.1)),
        ("objects", flags.objects.to_string()),
        ("scale", flags.scale.to_string()),
        ("seed", flags.seed.to_string()),
        ("static", flags.still.to_string()),
        ("full_detail", flags.full_detail.to_string()),
        ("camera", camera),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}

/// Reads a share: 0.1%, or 0.001.
fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let share = number.trim().parse().ok().map(|number: f64| number * unit);
    share.filter(|share| (0.0..=1.0).contains(share)).ok_or_else(|| "write it as 0.1%".to_owned())
}
