//! What the suites share: worlds that change every frame, cameras that jump, and the count of
//! what was lost.

pub mod lying;
pub mod stage;
pub mod suite;

use hecs::{Entity, World};
use tercet::draw::{Detail, Drawable};
use tercet::geom::View;
use tercet::policy::{Policy, Recording, StopAndWait};
use tercet::query::QueryBackend;
use tercet::query::oracle::Oracle;
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::{ObjectId, ObjectRef, ObjectSet, Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::{Culler, Tradeoff};

use stage::Stage;

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

/// Draws an app's objects, as finely as a view asks for.
pub fn draw(world: &World, view: &View, detail: Detail, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
    for object in objects {
        let entity: Entity = object.entity();
        if let Ok(d) = world.get::<&Drawable>(entity) {
            pass.draw_level(&d.mesh, detail.level(&d.mesh, &d.world_from_object, view), &d.world_from_object);
        }
    }
}

/// Runs a policy over a stage for some frames, the tree adapting, and compares each frame with the
/// oracle's.
pub fn run<P, B>(stage: &mut Stage, tree: TreeConfig, policy: P, backend: &mut B, frames: u32) -> Outcome
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown,
{
    run_with(Tradeoff::EXACT, stage, tree, policy, backend, frames)
}

/// The same with a tradeoff. With a coarser depth, all samples count as wrong.
pub fn run_with<P, B>(
    tradeoff: Tradeoff,
    stage: &mut Stage,
    tree: TreeConfig,
    policy: P,
    backend: &mut B,
    frames: u32,
) -> Outcome
where
    P: Policy,
    B: QueryBackend<Pass = SoftwarePass> + Shown,
{
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let mut eye = Culler::new(policy);
    eye.tradeoff = tradeoff;
    let mut reference = Culler::new(StopAndWait::default());
    let mut reference_queries = SoftwareQueries::new();
    let mut oracle = Oracle::new();
    let mut outcome = Outcome::default();
    let detail = stage.detail;
    for frame in 0..frames {
        let view = stage.next(frame);
        let world = &stage.world;
        let report = scene.sync(world);
        scene.tree().validate().expect("a valid tree");
        let truth = oracle
            .look(&scene, &view, |pass, objects| draw(world, &view, detail, pass, objects))
            .expect("the oracle looks");
        match eye.policy().wants_recorded() {
            None => {}
            Some(Recording::ExactSet) => {
                let exact = scene.objects().map(|o| o.object.id).filter(|&id| truth.exact.contains(id));
                let exact: Vec<ObjectId> = exact.collect();
                eye.policy_mut().give_recorded(&exact);
            }
            Some(Recording::StopAndWait) => {
                reference
                    .frame(&scene, &view, &mut reference_queries, |pass, objects| {
                        draw(world, &view, detail, pass, objects);
                    })
                    .expect("the reference draws");
                let ids: Vec<ObjectId> = reference.visible().iter().map(|o| o.id).collect();
                eye.policy_mut().give_recorded(&ids);
            }
        }
        let stats = eye
            .frame(&scene, &view, backend, |pass, objects| draw(world, &view, detail, pass, objects))
            .expect("a frame");
        let mut drawn = ObjectSet::default();
        for object in eye.visible() {
            assert!(drawn.insert(object.id), "an object was drawn twice");
        }
        assert_eq!(stats.drawn as usize, eye.visible().len());
        assert_eq!(report.bad, scene.objects().filter(|o| o.bad).count());
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
        scene.adapt([&mut eye]);
        scene.tree().validate().expect("a valid tree after adapting");
    }
    outcome
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
