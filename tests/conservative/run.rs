//! Runs policies over a stage, and counts what was lost.

use rayon::prelude::*;
use tercet::geom::View;
use tercet::policy::{Policy, Recording, StopAndWait};
use tercet::query::QueryBackend;
use tercet::query::oracle::{Oracle, Truth};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::{ObjectId, ObjectSet, Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::{Culler, Tradeoff};

use crate::painter::draw;
use crate::stage::Stage;

/// What a run of a policy over a stage came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// Objects that owned a sample and were not drawn, over all frames.
    pub lost: usize,
    /// Objects in the frustum that owned no sample, over all frames.
    pub hidden: usize,
    /// Those of them that were not drawn.
    pub culled: usize,
    /// Objects drawn, over all frames.
    pub drawn: usize,
    /// Objects that owned a sample, over all frames.
    pub visible: usize,
    /// Samples in which the culled frame differs from the whole one.
    pub wrong_pixels: u64,
}

impl Outcome {
    /// Adds another run's counts.
    pub fn add(&mut self, other: Self) {
        self.lost += other.lost;
        self.hidden += other.hidden;
        self.culled += other.culled;
        self.drawn += other.drawn;
        self.visible += other.visible;
        self.wrong_pixels += other.wrong_pixels;
    }
}

/// A policy on its way through a stage: its own scene and tree, the tree adapting.
pub struct Lane<P, B> {
    scene: Scene,
    eye: Culler<P>,
    backend: B,
    /// What those are handed that repeat what stop-and-wait has found.
    reference: (Culler<StopAndWait>, SoftwareQueries),
    pub outcome: Outcome,
}

impl<P, B> Lane<P, B>
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown,
{
    pub fn new(tree: TreeConfig, policy: P, backend: B) -> Self {
        let scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let reference = (Culler::new(StopAndWait::default()), SoftwareQueries::new());
        Self { scene, eye: Culler::new(policy), backend, reference, outcome: Outcome::default() }
    }

    fn sync(&mut self, stage: &Stage) {
        let report = self.scene.sync(&stage.world);
        self.scene.tree().validate().expect("a valid tree");
        assert_eq!(report.bad, self.scene.objects().filter(|o| o.bad).count());
    }

    /// Gives the policy what it does not find out by itself.
    fn tell(&mut self, stage: &Stage, view: &View, truth: &Truth) {
        let told: Vec<ObjectId> = match self.eye.policy().wants_recorded() {
            None => return,
            Some(Recording::ExactSet) => {
                self.scene.objects().map(|o| o.object.id).filter(|&id| truth.exact.contains(id)).collect()
            }
            Some(Recording::StopAndWait) => {
                let (eye, queries) = &mut self.reference;
                eye.frame(&self.scene, view, queries, |pass, objects| {
                    draw(&stage.world, view, stage.detail, pass, objects);
                })
                .expect("the reference draws");
                eye.visible().iter().map(|o| o.id).collect()
            }
        };
        self.eye.policy_mut().give_recorded(&told);
    }

    /// Draws a frame, and compares it with what the oracle has seen.
    fn frame(&mut self, stage: &Stage, view: &View, oracle: &Oracle, truth: &Truth) {
        self.tell(stage, view, truth);
        let Self { scene, eye, backend, outcome, .. } = self;
        let stats = eye
            .frame(scene, view, backend, |pass, objects| {
                draw(&stage.world, view, stage.detail, pass, objects);
            })
            .expect("a frame");
        let mut drawn = ObjectSet::default();
        for object in eye.visible() {
            assert!(drawn.insert(object.id), "an object was drawn twice");
        }
        // What owns nothing in the end was drawn, and counts as left out.
        let handed = stats.drawn + stats.left_out;
        assert!((stats.drawn..=handed).contains(&(eye.visible().len() as u32)), "{stats:?}");
        assert!(eye.policy().asks_owners() || stats.drawn as usize == eye.visible().len(), "{stats:?}");
        for object in scene.objects() {
            let id = object.object.id;
            let visible = truth.exact.contains(id);
            outcome.visible += usize::from(visible);
            outcome.lost += usize::from(visible && !drawn.contains(id));
            if object.bounds.is_none() {
                assert!(drawn.contains(id), "what is outside of the tree is drawn always");
            } else if !visible && truth.in_frustum.contains(id) {
                outcome.hidden += 1;
                outcome.culled += usize::from(!drawn.contains(id));
            }
        }
        outcome.drawn += eye.visible().len();
        outcome.wrong_pixels += oracle.wrong_pixels(backend.shown());
        scene.adapt([eye]);
        scene.tree().validate().expect("a valid tree after adapting");
    }
}

/// Runs policies side by side over one stage for some frames. What is really visible is the same for
/// all of them, and found out once.
pub fn run_together<P, B>(stage: &mut Stage, lanes: &mut [Lane<P, B>], frames: u32)
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown + Send,
{
    let mut oracle = Oracle::new();
    for frame in 0..frames {
        let view = stage.next(frame);
        lanes.par_iter_mut().for_each(|lane| lane.sync(stage));
        let Some(Lane { scene, .. }) = lanes.first() else { return };
        let truth = oracle
            .look(scene, &view, |pass, objects| draw(&stage.world, &view, stage.detail, pass, objects))
            .expect("the oracle looks");
        // The truth names objects by their handles.
        let handles = |scene: &Scene| scene.objects().map(|o| o.object).collect::<Vec<_>>();
        let known = handles(scene);
        lanes.par_iter_mut().for_each(|lane| {
            assert_eq!(handles(&lane.scene), known, "scenes that mirror one world have the same handles");
            lane.frame(stage, &view, &oracle, &truth);
        });
    }
}

/// Runs one policy.
pub fn run<P, B>(stage: &mut Stage, tree: TreeConfig, policy: P, backend: B, frames: u32) -> Outcome
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown + Send,
{
    run_with(Tradeoff::EXACT, stage, tree, policy, backend, frames)
}

/// The same with a tradeoff. With a coarser depth, all samples count as wrong.
pub fn run_with<P, B>(
    tradeoff: Tradeoff,
    stage: &mut Stage,
    tree: TreeConfig,
    policy: P,
    backend: B,
    frames: u32,
) -> Outcome
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown + Send,
{
    let mut lane = Lane::new(tree, policy, backend);
    lane.eye.tradeoff = tradeoff;
    run_together(stage, std::slice::from_mut(&mut lane), frames);
    lane.outcome
}

/// A backend whose depth can be looked at.
pub trait Shown {
    /// The software raster that holds the frame's depth.
    fn shown(&self) -> &SoftwareQueries;
}

impl Shown for SoftwareQueries {
    fn shown(&self) -> &SoftwareQueries {
        self
    }
}
