//! How much depends on the app's fragment shader: the walk through the streets once more, on the GPU,
//! with none, one and forty texture look-ups a fragment.
//!
//! The paper drew its scenes with as many. What culling saves grows with what a fragment costs, what
//! asking costs does not.

mod figure;
mod page;
mod rows;

use super::algorithms::{ALGORITHMS, CHC, OPT, PLUS_PLUS, VFC};
use super::scenes::SCENES;
use crate::algorithm::Algorithm;
use crate::output::Output;
use support::flags::{Backend, Flags};
use support::lockstep::Measured;
use support::report::write_csv;
use support::stage::{Gpu, Stage, WgpuStage};

pub use page::section;

/// Look-ups a fragment.
const LOOK_UPS: [u32; 3] = [0, 1, 40];

/// Indices into [`ALGORITHMS`]: the first is what the others are compared with.
const COMPARED: [usize; 4] = [VFC, CHC, PLUS_PLUS, OPT];

/// The part of the walk that is gone, at the same speed: where a CPU plays the GPU's part, a frame with
/// forty look-ups takes a second.
const PART: u32 = 4;

/// A number of look-ups, measured.
pub struct Shaded {
    look_ups: u32,
    /// By algorithm, as in [`COMPARED`].
    lanes: Vec<Measured>,
}

/// The GPU, if the command line asks for it and there is one. If there is none, it says so.
pub fn gpu(flags: &Flags) -> anyhow::Result<Option<Gpu>> {
    if flags.backend != Backend::Wgpu {
        return Ok(None);
    }
    let gpu = Gpu::open()?;
    if gpu.is_none() {
        println!("--backend wgpu: no graphics adapter was found; {}.", Gpu::remedy());
        println!("The part on shader complexity is left out.");
    }
    Ok(gpu)
}

/// Frames that all lanes have together.
pub fn frames(flags: &Flags) -> usize {
    LOOK_UPS.len() * COMPARED.len() * frames_each(flags) as usize
}

/// Runs it, and writes `chcpp_shading.csv` and `chcpp_shading.png`.
pub fn run(output: &Output, flags: &Flags, gpu: &Gpu) -> anyhow::Result<Vec<Shaded>> {
    let flags = &Flags { frames: frames_each(flags), ..flags.clone() };
    let mut all = Vec::new();
    for look_ups in LOOK_UPS {
        let lane = |algorithm: &Algorithm| {
            let mut stage = WgpuStage::new(gpu.clone(), flags.detail()?)?;
            stage.set_look_ups(look_ups);
            algorithm.lane_on(Stage::Wgpu(Box::new(stage)), flags)
        };
        let lanes = COMPARED.iter().map(|&n| lane(&ALGORITHMS[n])).collect::<anyhow::Result<_>>()?;
        let mut scenario = SCENES[0].build(flags).part(0.0, 1.0 / PART as f32);
        scenario.name = format!("{}, {look_ups} look-ups", scenario.name);
        let shaded = Shaded { look_ups, lanes: output.run(scenario, flags, lanes)? };
        output.say(&shaded.line());
        all.push(shaded);
    }
    write_csv(&output.file("_shading.csv"), all.iter().flat_map(rows::rows))?;
    figure::write(output, flags, gpu, &all)?;
    Ok(all)
}

fn frames_each(flags: &Flags) -> u32 {
    // Two at least: the first one builds everything.
    (flags.frames / PART).max(2)
}

impl Shaded {
    /// The algorithms with what they measured.
    fn by_algorithm(&self) -> impl Iterator<Item = (&'static Algorithm, &Measured)> {
        COMPARED.iter().map(|&n| &ALGORITHMS[n]).zip(&self.lanes)
    }

    /// A lane's time over the view frustum's: the median of the ratios frame by frame.
    fn over_vfc(&self, lane: &Measured) -> f64 {
        lane.time_over(self.lanes[0].times())
    }

    /// What is printed when it is done.
    fn line(&self) -> String {
        let each = self.by_algorithm();
        let each: Vec<String> =
            each.map(|(a, lane)| format!("{:.2} {}", lane.summary.frame_ms.median, a.name)).collect();
        format!("{} look-ups on the GPU: {} (median milliseconds)", self.look_ups, each.join(", "))
    }
}
