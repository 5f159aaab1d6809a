//! Several ways of culling the same world, side by side: each frame is run by all of them before
//! the next one comes, and their order changes from frame to frame. What else the machine does
//! meanwhile then hits all of them alike.

use anyhow::Context;
use hecs::World;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use tercet::draw::Detail;
use tercet::geom::View;
use tercet::policy::Policy;
use tercet::query::SweepTest;
use tercet::scene::{Scene, SceneConfig};
use tercet::tree::{TreeConfig, TreeStats};
use tercet::{Culler, Tradeoff};

use super::flags::Flags;
use super::painter::Painter;
use super::reference::Reference;
use super::report::{FrameRecord, Setting, Summary, TreeFigures, percentile};
use super::run::{Eye, Frame};
use super::scenario::Scenario;
use super::stage::{Gpu, Listed, Stage, gpu_driven};
use super::twin::Twin;

/// One way of culling: a scene, an eye and a backend of its own.
pub struct Lane {
    scene: Scene,
    eye: Eye,
    stage: Stage,
    /// The world, if the stage adds to it.
    twin: Option<Twin>,
    /// Finds what a policy draws that is itself a reference.
    reference: Reference,
    records: Vec<FrameRecord>,
    /// The tree's counters after the first frame, which builds it.
    built: TreeStats,
}

/// What a lane measured.
pub struct Measured {
    /// All frames together.
    pub summary: Summary,
    /// Frame by frame.
    pub frames: Vec<FrameRecord>,
}

impl Measured {
    /// Its time over others', frame by frame: the median of the ratios. Frames differ more than ways
    /// of culling do, and all lanes had the same ones.
    pub fn time_over(&self, others: impl Iterator<Item = f64>) -> f64 {
        let ratios: Vec<f64> =
            self.frames.iter().zip(others).map(|(frame, other)| frame.frame_ms / other).collect();
        percentile(&ratios, 50.0)
    }

    /// The mean a frame of what its policy counts itself, if it counts that.
    pub fn counter(&self, key: &str) -> Option<f64> {
        self.summary.counters.get(key).map(|counter| counter.mean)
    }

    /// The median of the app's draws by the device's own clock, milliseconds, if it has one.
    pub fn device_draw_ms(&self) -> Option<f64> {
        let known: Vec<f64> = self.frames.iter().filter_map(|frame| frame.device_draw_ms).collect();
        (!known.is_empty()).then(|| percentile(&known, 50.0))
    }

    /// The time of each frame, milliseconds.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        self.frames.iter().map(|frame| frame.frame_ms)
    }
}

impl Lane {
    /// A lane that has seen nothing yet, and draws as finely as the flags say, on the software backend.
    pub fn new(flags: &Flags, policy: Box<dyn Policy>, tree: TreeConfig) -> anyhow::Result<Self> {
        Self::on(Stage::software(flags.detail()?), flags, policy, tree)
    }

    /// The same on a backend that draws as finely.
    pub fn on(
        stage: Stage,
        flags: &Flags,
        policy: Box<dyn Policy>,
        tree: TreeConfig,
    ) -> anyhow::Result<Self> {
        let (mut scene, mut eye) =
            (Scene::new(SceneConfig { tree, ..Default::default() }), Culler::new(policy));
        eye.tradeoff = flags.tradeoff()?;
        scene.adapt([&mut eye]);
        let detail = flags.detail()?;
        Ok(Self {
            scene,
            eye,
            stage,
            twin: None,
            reference: Reference::new(Painter { detail }, false),
            records: Vec::new(),
            built: TreeStats::default(),
        })
    }

    /// A lane in which the device culls by itself, by a test; for `hroc` in a fine tree.
    ///
    /// # Errors
    /// Where the flags ask for less than full detail, or the device cannot do it.
    pub fn gpu_driven(gpu: Gpu, flags: &Flags, test: SweepTest) -> anyhow::Result<Self> {
        let stage = Stage::gpu_driven(gpu, test, flags.detail()?)?;
        let tree = flags.tree_from(gpu_driven::tree(test, TreeConfig::default()))?;
        Self::on(stage, flags, Box::new(Listed::new(test)), tree)
    }

    /// The same with another way between speed and accuracy, as finely drawn as that says. The tree is
    /// the caller's: [`Tradeoff::tree`].
    pub fn with_tradeoff(mut self, tradeoff: Tradeoff) -> Self {
        let detail = tradeoff.detail(self.detail());
        self.eye.tradeoff = tradeoff;
        self.stage.set_detail(detail);
        self.reference.painter.detail = detail;
        self
    }

    fn detail(&self) -> Detail {
        self.reference.painter.detail
    }

    /// Runs one frame, clocked as in the demos: sync, cull with its draws, adapt. A reference finds
    /// what it is to draw outside the clock.
    fn frame(&mut self, world: &World, view: &View) -> anyhow::Result<()> {
        let Self { scene, eye, stage, twin, reference, .. } = self;
        let world = match stage {
            Stage::GpuDriven(stage) => {
                let twin = twin.get_or_insert_with(|| Twin::new(world));
                twin.follow(world);
                stage.dress(&mut twin.world);
                &twin.world
            }
            _ => world,
        };
        let synced = scene.sync(world);
        reference.look(scene, world, view, eye)?;
        let drawn = stage.frame(eye, scene, world, view)?;
        let adapted = scene.adapt([&mut *eye]);
        let frame = Frame { scene, view, eye, synced, drawn, adapted };
        let record = frame.record(self.records.len() as u32);
        if self.records.is_empty() {
            self.built = self.scene.tree().stats();
        }
        self.records.push(record);
        Ok(())
    }

    fn finish(self, setting: Setting) -> Measured {
        let tree = TreeFigures::new(&self.built, &self.scene.tree().stats(), self.records.len());
        Measured { summary: Summary::new(setting, tree, &self.records), frames: self.records }
    }
}

/// Runs all lanes through a scenario and returns what each measured, in their order. `tick` is
/// called whenever a lane has done a frame.
///
/// With `--oracle`, it looks once a frame, after all lanes, and judges each: once a level of detail, since
/// the truth about culling is that of what is drawn. What the level itself changes is found apart.
pub fn run(
    mut scenario: Scenario,
    flags: &Flags,
    mut lanes: Vec<Lane>,
    mut tick: impl FnMut(),
) -> anyhow::Result<Vec<Measured>> {
    let mut references = vec![Reference::new(Painter { detail: flags.detail()? }, flags.oracle)];
    let mut judges = Vec::with_capacity(lanes.len());
    for lane in &lanes {
        let detail = lane.detail();
        let known = references.iter().position(|reference| reference.painter.detail == detail);
        judges.push(known.unwrap_or(references.len()));
        if known.is_none() {
            references.push(Reference::new(Painter { detail }, flags.oracle));
        }
    }
    let mut order: Vec<usize> = (0..lanes.len()).collect();
    let mut dice = ChaCha8Rng::seed_from_u64(flags.seed);
    for frame in 0..flags.frames {
        // Every other frame takes the last one's order backwards: nobody goes first more often,
        // and of two, each goes first in every other frame or twice in a row at most.
        if frame.is_multiple_of(2) {
            order.shuffle(&mut dice);
        } else {
            order.reverse();
        }
        scenario.step();
        let view = scenario.view(frame, flags)?;
        for &lane in &order {
            lanes[lane].frame(&scenario.world, &view)?;
            tick();
        }
        if flags.oracle {
            judge(&mut references, &judges, &mut lanes, &scenario.world, &view)?;
        }
    }
    let setting = |lane: &Lane| Setting {
        backend: lane.stage.backend().to_owned(),
        adapter: lane.stage.adapter(),
        ..Setting::new(flags, &scenario.name, lane.eye.policy().name(), &scenario.world)
    };
    Ok(lanes
        .into_iter()
        .map(|lane| {
            let setting = setting(&lane);
            lane.finish(setting)
        })
        .collect())
}

/// Looks at a frame at each level of detail (the first is what the flags say), and judges each lane
/// by its own: `judges` has an index for each lane.
fn judge(
    references: &mut [Reference],
    judges: &[usize],
    lanes: &mut [Lane],
    world: &World,
    view: &View,
) -> anyhow::Result<()> {
    let Some(first) = lanes.first() else { return Ok(()) };
    for reference in &mut *references {
        reference.compare(&first.scene, world, view)?;
    }
    let (base, others) = references.split_first().context("the flags say at which level to look")?;
    let apart: Vec<u64> =
        std::iter::once(0).chain(others.iter().map(|other| other.differs_from(base))).collect();
    for (Lane { eye, records, .. }, &judge) in lanes.iter_mut().zip(judges) {
        if let Some(record) = records.last_mut() {
            references[judge].judge(world, view, eye, record)?;
            record.detail_pixels = Some(apart[judge]);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::env;

    use clap::Parser;
    use tercet::policy;
    use tercet::scene::Bounds;

    use super::*;

    /// Bunnies move, and each lane sees them: what the device drew is read back whole, and nothing is lost.
    #[test]
    fn lanes_in_which_the_device_culls_are_judged_as_the_others_are() -> anyhow::Result<()> {
        let line = "example --frames 5 --size 96x54 --scale 0.03 --objects 8 --full-detail --oracle";
        let flags = Flags::try_parse_from(line.split_whitespace())?;
        let Some(gpu) = Gpu::open()? else {
            let required = env::var("TERCET_REQUIRE_GPU").is_ok_and(|value| value == "1");
            anyhow::ensure!(!required, "there is no adapter, and TERCET_REQUIRE_GPU is 1");
            eprintln!("SKIPPED: there is no adapter");
            return Ok(());
        };
        let mut lanes = vec![Lane::new(&flags, policy::by_name("roc")?, flags.tree()?)?];
        for test in [SweepTest::HiZ, SweepTest::Raster, SweepTest::Rays] {
            lanes.push(Lane::gpu_driven(gpu.clone(), &flags, test)?);
        }
        let measured = run(Scenario::power_plant(&flags, true)?, &flags, lanes, || ())?;
        let names: Vec<_> = measured.iter().map(|lane| lane.summary.policy.as_str()).collect();
        assert_eq!(names, ["roc", "hi-z", "roc", "hroc"]);
        for Measured { summary, frames } in &measured {
            assert_eq!(summary.false_culls, Some(0), "{summary:?}");
            for frame in frames {
                assert_eq!(frame.wrong_pixels, Some(0), "{frame:?}");
                assert!(frame.exact_visible.is_some_and(|exact| exact <= frame.drawn), "{frame:?}");
            }
        }
        let drawn = |lane: usize| measured[lane].frames.iter().map(|frame| frame.drawn).collect::<Vec<_>>();
        assert_eq!(drawn(2), drawn(3), "rays find what rasters find");
        assert!(measured[2].summary.drawn.mean < measured[2].summary.in_frustum.mean);
        assert!(measured[2].frames.iter().all(|frame| frame.drawn_triangles > u64::from(frame.drawn)));

        let mut scenario = Scenario::power_plant(&flags, true)?;
        let mut lane = Lane::gpu_driven(gpu, &flags, SweepTest::Raster)?;
        for frame in 0..3 {
            scenario.step();
            lane.frame(&scenario.world, &scenario.view(frame, &flags)?)?;
        }
        for object in lane.scene.objects() {
            let bounds = scenario.world.get::<&Bounds>(object.object.entity())?.0;
            assert_eq!(object.bounds, Some(bounds), "the lane knows where everything is");
        }
        Ok(())
    }
}
