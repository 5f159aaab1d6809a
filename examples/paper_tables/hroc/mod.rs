//! Lee et al. 2021, the comparison of hierarchical raster occlusion culling: against everything
//! drawn, the view frustum, CHC++, raster occlusion without a hierarchy, a Hi-Z map, and the exact
//! visible set, in worlds after the paper's four and in the moving bunnies.
//!
//! All run in lockstep on the software backend, or with `--backend wgpu` on the GPU, each on a tree of its
//! own with the same dials. The paper's figures are of a GPU: shares and ratios compare, milliseconds do not.

mod algorithms;
mod figures;
mod markdown;
mod published;
mod rows;
mod scenes;

use anyhow::ensure;
use tercet::draw::Detail;

use crate::algorithm::Algorithm;
use crate::frames;
use crate::output::Output;
use algorithms::{ALGORITHMS, FILTERED, GPU_DRIVEN, HROC, REF, VFC};
use scenes::{SCENES, Scene};
use support::flags::{Backend, Flags};
use support::lockstep::{Lane, Measured};
use support::report::write_csv;
use support::stage::{Gpu, Stage, WgpuStage};
use tercet::query::gpu::GpuConfig;

/// How much of each world is built, unless the command line says otherwise.
const SCALE: f32 = 0.25;

/// A scene, measured.
pub struct Outcome {
    scene: &'static Scene,
    /// By algorithm, as in [`algorithms::all`].
    lanes: Vec<Measured>,
}

/// Runs all scenes and writes `hroc.md`, two tables and two figures into `--out`.
pub fn run(flags: &Flags) -> anyhow::Result<()> {
    let flags = &flags.with_default_scale(SCALE);
    let is_wanted = flags.backend == Backend::Wgpu;
    let gpu = is_wanted.then(|| Gpu::found(Gpu::open()?)).transpose()?;
    ensure!(
        gpu.is_none() || flags.detail()? == Detail::FULL,
        "on the GPU this table draws every mesh with all its triangles: leave out max_error_px"
    );
    let count = ALGORITHMS.len() + if gpu.is_some() { GPU_DRIVEN.len() } else { 0 };
    let frames = SCENES.len() * count * flags.frames as usize;
    let output = Output::new(flags, "hroc", frames as u64)?;
    let mut outcomes = Vec::new();
    for scene in &SCENES {
        let lanes = output.run(scene.build(flags)?, flags, lanes(flags, gpu.as_ref())?)?;
        let outcome = Outcome { scene, lanes };
        output.say(&outcome.line());
        outcomes.push(outcome);
    }

    write_csv(&output.file(".csv"), outcomes.iter().flat_map(rows::rows))?;
    frames::write(&output.file("_frames.csv"), outcomes.iter().flat_map(rows::runs))?;
    figures::write(&output, flags, &outcomes)?;
    output.finish(&markdown::page(flags, &outcomes)?)
}

/// A lane an algorithm, on the GPU if there is one: there HROC casts the paper's rays, however few objects there
/// are.
fn lanes(flags: &Flags, gpu: Option<&Gpu>) -> anyhow::Result<Vec<Lane>> {
    let detail = flags.detail()?;
    let stage = |n: usize| -> anyhow::Result<Stage> {
        let Some(gpu) = gpu else { return Ok(Stage::software(detail)) };
        let config = match n {
            HROC | FILTERED => GpuConfig { rays_from: 0, ..GpuConfig::default() },
            _ => GpuConfig::default(),
        };
        Ok(Stage::Wgpu(Box::new(WgpuStage::with_config(gpu.clone(), detail, config)?)))
    };
    let host = ALGORITHMS.iter().enumerate().map(|(n, algorithm)| algorithm.lane_on(stage(n)?, flags));
    let device = gpu
        .into_iter()
        .flat_map(|gpu| GPU_DRIVEN.iter().map(|&(_, test)| Lane::gpu_driven(gpu.clone(), flags, test)));
    host.chain(device).collect()
}

/// What draws, if it is not the software backend.
fn adapter(outcomes: &[Outcome]) -> Option<&str> {
    outcomes.first()?.lanes[REF].summary.adapter.as_deref()
}

/// What ran, in the order of the page.
fn algorithms(outcomes: &[Outcome]) -> impl Iterator<Item = &'static Algorithm> {
    let lanes = outcomes.first().map_or(0, |outcome| outcome.lanes.len());
    algorithms::all().take(lanes)
}

impl Outcome {
    /// What is printed when the scene is done.
    fn line(&self) -> String {
        let ms = |algorithm: usize| self.lanes[algorithm].summary.frame_ms.median;
        format!(
            "{}: {:.2} ms hroc with filtering, {:.2} the exact set, {:.2} the view frustum alone (medians)",
            self.scene.name,
            ms(FILTERED),
            ms(REF),
            ms(VFC)
        )
    }

    /// Of all objects that the exact set leaves out, how many an algorithm leaves out, 0 to 1: the
    /// paper's C/R.
    fn culled(&self, algorithm: usize) -> f64 {
        let s = &self.lanes[algorithm].summary;
        (s.objects as f64 - s.drawn.mean) / (s.objects as f64 - self.visible()).max(1.0)
    }

    /// The same of the objects in the frustum alone: what occlusion culling is there for.
    fn culled_of_hidden(&self, algorithm: usize) -> f64 {
        let s = &self.lanes[algorithm].summary;
        let inside = s.in_frustum.mean;
        // Who draws what is outside of the frustum, too, culls nothing inside of it.
        (inside - s.drawn.mean).max(0.0) / (inside - self.visible()).max(1.0)
    }

    /// The same of whoever asks about boxes and knows the finished depth beforehand: no box test culls more.
    /// Known where the oracle looked.
    fn boxes_cull_of_hidden(&self) -> Option<f64> {
        let s = &self.lanes[REF].summary;
        let boxes = s.box_visible.as_ref()?.mean;
        Some((s.in_frustum.mean - boxes).max(0.0) / (s.in_frustum.mean - self.visible()).max(1.0))
    }

    /// Triangles drawn over those of the exact set: what drawing too much costs.
    fn overdraw(&self, algorithm: usize) -> f64 {
        let triangles = |n: usize| self.lanes[n].summary.drawn_triangles.mean;
        triangles(algorithm) / triangles(REF).max(1.0)
    }

    /// An algorithm's time over that of drawing the exact set: the median of the ratios frame by frame.
    fn time_over_ref(&self, algorithm: usize) -> f64 {
        self.lanes[algorithm].time_over(self.lanes[REF].times())
    }

    /// Objects that own a pixel, a frame: what REF draws.
    fn visible(&self) -> f64 {
        self.lanes[REF].summary.drawn.mean
    }
}
