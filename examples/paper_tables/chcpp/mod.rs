//! Mattausch, Bittner & Wimmer 2008, the comparison of CHC++: against the view frustum alone, CHC
//! and the least that asking about boxes can draw, and one of its optimisations after the other.
//!
//! All run in lockstep, each on a tree of its own with the same dials. The constants are the
//! paper's: `n_av` 10, for CHC too, `b` 50, `d_max` 3, `s_max` 1.4.
//!
//! With `--backend wgpu` some of them also go a part of the way on the GPU, with shaders of different
//! complexity ([`shading`]).

mod algorithms;
mod claims;
mod figures;
mod markdown;
mod rows;
mod scenes;
mod shading;

use crate::frames;
use crate::output::Output;
use algorithms::{ALGORITHMS, OPT, PLUS_PLUS, POLICIES, VFC};
use scenes::SCENES;
use support::flags::Flags;
use support::lockstep::Measured;
use support::report::write_csv;

/// How much of the city is built, unless the command line says otherwise.
const SCALE: f32 = 0.25;

/// A scene, measured.
pub struct Outcome {
    /// In words.
    name: &'static str,
    /// By algorithm, as in [`ALGORITHMS`].
    lanes: Vec<Measured>,
}

/// Runs all scenes and writes `chcpp.md`, two tables and two figures into `--out`; with a GPU, one more
/// of each.
pub fn run(flags: &Flags) -> anyhow::Result<()> {
    flags.check_table(&POLICIES)?;
    let flags = &flags.with_default_scale(SCALE);
    let gpu = shading::gpu(flags)?;
    let mut frames = SCENES.len() * ALGORITHMS.len() * flags.frames as usize;
    if gpu.is_some() {
        frames += shading::frames(flags);
    }
    let output = Output::new(flags, "chcpp", frames as u64)?;
    let mut outcomes = Vec::new();
    for scene in SCENES {
        let lanes =
            ALGORITHMS.iter().map(|algorithm| algorithm.lane(flags)).collect::<anyhow::Result<_>>()?;
        let lanes = output.run(scene.build(flags), flags, lanes)?;
        let outcome = Outcome { name: scene.name, lanes };
        output.say(&outcome.line());
        outcomes.push(outcome);
    }

    write_csv(&output.file(".csv"), outcomes.iter().flat_map(rows::rows))?;
    frames::write(&output.file("_frames.csv"), outcomes.iter().flat_map(rows::runs))?;
    figures::write(&output, flags, &outcomes)?;
    let shaded = match &gpu {
        Some(gpu) => shading::run(&output, flags, gpu)?,
        None => Vec::new(),
    };
    output.finish(&markdown::page(flags, &outcomes, &shaded)?)
}

impl Outcome {
    /// What is printed when the scene is done.
    fn line(&self) -> String {
        let ms = |algorithm: usize| self.lanes[algorithm].summary.frame_ms.median;
        format!(
            "{}: {:.2} ms chc++, {:.2} opt, {:.2} the view frustum alone (medians)",
            self.name,
            ms(PLUS_PLUS),
            ms(OPT),
            ms(VFC)
        )
    }
}
