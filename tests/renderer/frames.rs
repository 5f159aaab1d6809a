//! A culled frame is the whole one: the same depth in every sample, and the same colour in all
//! but those in which several objects share the nearest depth, where the last one drawn shows.
//!
//! Which samples these are is found by drawing the whole frame twice more, an object at a time, each
//! in a colour of its own: once from the first to the last, once the other way round. Where both
//! show the same object, nobody else is as near.

use std::collections::HashMap;

use tercet::Culler;
use tercet::draw::{Renderer, Shading};
use tercet::geom::{DepthFormat, View, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::QueryBackend;
use tercet::query::gpu::GpuQueries;
use tercet::scene::{ObjectRef, Scene, SceneConfig};
use tercet::worlds::{self, Model};

use crate::pixels::{FORMAT, Shot, Target};
use crate::stage::Stage;
use crate::support::{Gpu, gpus};

const SCREEN: Viewport = Viewport::new(128, 72);
const FRAMES: u32 = 6;
const POLICIES: [&str; 3] = ["dual-query", "stop-and-wait", "statistical"];

/// What a policy's frames came to.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    /// Samples that something was drawn on in the whole frame, and those of them in which several
    /// objects share the nearest depth.
    covered: usize,
    tied: usize,
    /// Samples with another depth; not tied ones with another colour.
    wrong_depth: usize,
    wrong_color: usize,
    /// Objects in the frustum that were not drawn.
    culled: u32,
}

/// Draws the frames of a world, culled by each policy and whole. With `spoil`, the culled ones lack
/// the object that owns the most samples.
fn run(
    gpu: &Gpu,
    (model, seed, churn): (Model, u64, bool),
    samples: u32,
    spoil: bool,
) -> [Outcome; POLICIES.len()] {
    let mut studio = Studio::new(gpu, model, seed, churn);
    let named = |name| Culler::new(policy::by_name(name).expect("a policy of that name"));
    let (mut none, mut frustum) = (named("none"), named("frustum"));
    let mut eyes = POLICIES.map(named);
    let mut outcomes = [Outcome::default(); POLICIES.len()];
    for frame in 0..FRAMES {
        let view = studio.stage.next(frame);
        let format = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus][frame as usize % 2];
        let view = view.clone().with_target(view.depth(), format, samples);
        studio.scene.sync(&studio.stage.world);
        let (whole, _) = studio.frame(&mut none, &view, |_| true);
        let (_, in_frustum) = studio.frame(&mut frustum, &view, |_| true);
        let [last, first] = studio.owners(&view);
        let missing = if spoil { commonest(&last) } else { None };
        for (eye, outcome) in eyes.iter_mut().zip(&mut outcomes) {
            let keep = |object: ObjectRef| Some(color_of(object)) != missing;
            let (culled, drawn) = studio.frame(eye, &view, keep);
            outcome.culled += in_frustum - drawn;
            for i in 0..whole.colors.len() {
                let is_tied = first.colors[i] != last.colors[i];
                outcome.covered += usize::from(last.colors[i] != 0);
                outcome.tied += usize::from(is_tied);
                outcome.wrong_depth += usize::from(culled.nearness[i] != whole.nearness[i]);
                outcome.wrong_color += usize::from(!is_tied && culled.colors[i] != whole.colors[i]);
            }
        }
        studio.scene.adapt(&mut eyes);
    }
    outcomes
}

/// A world, and what draws it.
pub struct Studio<'g> {
    gpu: &'g Gpu,
    pub stage: Stage,
    pub scene: Scene,
    queries: GpuQueries,
    pub renderer: Renderer,
}

impl<'g> Studio<'g> {
    pub fn new(gpu: &'g Gpu, model: Model, seed: u64, churn: bool) -> Self {
        Self {
            gpu,
            stage: Stage::new(model, seed, SCREEN, churn),
            scene: Scene::new(SceneConfig::default()),
            queries: GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend"),
            renderer: Renderer::new(&gpu.device, &gpu.queue, Some(FORMAT)).expect("a renderer"),
        }
    }

    /// A shaded frame, and how many objects the culler drew.
    pub fn frame(
        &mut self,
        eye: &mut Culler<Box<dyn Policy>>,
        view: &View,
        keep: impl Fn(ObjectRef) -> bool,
    ) -> (Shot, u32) {
        let target = Target::new(self.gpu, view);
        let Self { stage, scene, queries, renderer, .. } = self;
        queries.target(&target.frame_targets());
        renderer.begin(view, stage.detail, Shading::Lit);
        let stats = eye.frame(scene, view, queries, |pass, objects| {
            let kept: Vec<_> = objects.iter().copied().filter(|&object| keep(object)).collect();
            renderer.draw(pass, &stage.world, &kept);
        });
        (target.shot(self.gpu, view), stats.expect("a frame").drawn)
    }

    /// The whole frame, an object at a time in a colour of its own: from first to last, and the
    /// other way round. What hides nothing is drawn after the rest, as the culler does.
    pub fn owners(&mut self, view: &View) -> [Shot; 2] {
        let mut objects: Vec<_> = self.scene.objects().map(|o| (o.traits.not_occluder, o.object)).collect();
        let target = Target::new(self.gpu, view);
        [false, true].map(|backward| {
            if backward {
                objects.reverse();
            }
            objects.sort_by_key(|&(not_occluder, _)| not_occluder);
            let Self { stage, queries, renderer, .. } = self;
            queries.target(&target.frame_targets());
            renderer.begin(view, stage.detail, Shading::Unlit);
            queries.begin(view).expect("begin");
            let record = |pass: &mut _| {
                for &(_, object) in &objects {
                    renderer.draw_tinted(pass, &stage.world, [(object, color_of(object).to_le_bytes())]);
                }
            };
            queries.draw(record).expect("draw");
            queries.end().expect("end");
            target.shot(self.gpu, view)
        })
    }
}

/// A colour that no other object has, opaque.
fn color_of(object: ObjectRef) -> u32 {
    0xff00_0000 | object.id.slot() as u32
}

/// The colour of the most samples, but for those that nothing was drawn on.
fn commonest(shot: &Shot) -> Option<u32> {
    let mut counts = HashMap::new();
    shot.colors.iter().filter(|&&color| color != 0).for_each(|&color| *counts.entry(color).or_insert(0) += 1);
    counts.into_iter().max_by_key(|&(color, count)| (count, color)).map(|(color, _)| color)
}

fn assert_same_frames(world: impl Fn() -> (Model, u64, bool)) {
    for gpu in gpus() {
        for &samples in gpu.sample_counts() {
            for (policy, outcome) in POLICIES.iter().zip(run(&gpu, world(), samples, false)) {
                let run = format!("{:?}, {samples} samples, {policy}: {outcome:?}", gpu.backend);
                println!("{run}");
                assert_eq!((outcome.wrong_depth, outcome.wrong_color), (0, 0), "{run}");
                assert!(outcome.culled > 100, "there is something to cull: {run}");
                assert!(outcome.covered > 5000 && outcome.tied * 4 < outcome.covered, "{run}");
            }
        }
    }
}

#[test]
fn culled_frames_of_a_power_plant_are_the_whole_ones() {
    assert_same_frames(|| (worlds::power_plant(3, 0.05), 1, false));
}

#[test]
fn culled_frames_of_a_changing_world_are_the_whole_ones() {
    assert_same_frames(|| (worlds::random(5, 300), 2, true));
}

/// One object less must be found out, or the two tests above prove nothing.
#[test]
fn a_lost_object_is_found_out() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    for outcome in run(&gpu, (worlds::power_plant(3, 0.05), 1, false), 1, true) {
        assert!(outcome.wrong_depth > 0 && outcome.wrong_color > 0, "{outcome:?}");
    }
}
