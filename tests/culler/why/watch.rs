//! One view of a scene, whose explanations are checked.

use glam::Vec3;
use tercet::geom::{Aabb, Frustum, Proxy, Question, View};
use tercet::policy::{Policy, Samples};
use tercet::query::software::SoftwarePass;
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig, SceneObject};
use tercet::tree::TreeConfig;
use tercet::{Culler, FrameStats, Why};

use super::listening::Listening;
use crate::SCREEN;
use crate::painter::draw;
use crate::stage::Stage;

/// One view of a scene, and its last frame.
pub(super) struct Watch<P> {
    pub(super) scene: Scene,
    pub(super) eye: Culler<P>,
    pub(super) queries: Listening,
    pub(super) view: View,
}

impl<P: Policy> Watch<P> {
    pub(super) fn new(tree: TreeConfig, policy: P) -> Self {
        let view = View::look_at(Vec3::Z * 10.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let mut eye = Culler::new(policy);
        // Leaves are fine from the start.
        scene.adapt([&mut eye]);
        Self { scene, eye, queries: Listening::default(), view }
    }

    /// Draws a frame of a stage's world.
    pub(super) fn frame(&mut self, stage: &Stage, view: View) -> FrameStats {
        self.view = view;
        self.scene.sync(&stage.world);
        if self.eye.policy().wants_recorded().is_some() {
            let every_third: Vec<ObjectId> = self.scene.objects().map(|o| o.object.id).step_by(3).collect();
            self.eye.policy_mut().give_recorded(&every_third);
        }
        let (view, detail, world) = (&self.view, stage.detail, &stage.world);
        let draw = |pass: &mut SoftwarePass, objects: &[ObjectRef]| draw(world, view, detail, pass, objects);
        self.eye.frame(&self.scene, view, &mut self.queries, draw).expect("a frame")
    }

    pub(super) fn why(&self, object: ObjectId) -> Why {
        self.eye.why(&self.scene, &self.view, object)
    }

    /// Why an object was drawn or culled, if what is said of it can be checked and is true.
    pub(super) fn checked(&self, object: &SceneObject) -> Result<Why, String> {
        let why = self.why(object.object.id);
        let question = |aabb: &Aabb| Question::new(aabb, &self.view);
        let said = |aabb: &Aabb, visible: bool, samples: Option<Samples>| {
            let Question::Ask(proxy) = question(aabb) else { return false };
            let is_it = |s: &(Proxy, bool, Option<Samples>)| {
                s.0 == proxy && s.1 == visible && (samples.is_none() || samples == s.2)
            };
            self.queries.said.iter().any(is_it)
        };
        let is_true = match (why, why.node()) {
            (Why::Always { bad }, _) => object.bounds.is_none() && bad == object.bad,
            (Why::Outside, _) => {
                object.bounds.is_some_and(|bounds| !Frustum::new(&self.view).intersects(&bounds))
            }
            (Why::NoSample(_), Some(node)) => question(&node.bounds) == Question::Outside,
            (Why::Hidden(_) | Why::HiddenNow(_), Some(node)) => said(&node.bounds, false, None),
            (Why::Visible { samples, .. }, Some(node)) => said(&node.bounds, true, samples),
            (Why::Near(_), Some(node)) => question(&node.bounds) == Question::Visible,
            (Why::Remembered { within, .. }, Some(_)) => within != Some(0),
            (Why::Unasked, _) => matches!(self.eye.policy().name(), "none" | "frustum"),
            (Why::Swept { .. }, _) => {
                matches!(self.eye.policy().name(), "roc" | "hroc" | "hi-z" | "hybrid" | "auto")
            }
            (Why::Given { .. }, _) => matches!(self.eye.policy().name(), "opt" | "exact"),
            _ => false,
        };
        let holds = |aabb: &Aabb| object.bounds.is_some_and(|bounds| aabb.contains(&bounds));
        let drawn = self.eye.visible().iter().any(|o| o.id == object.object.id);
        if is_true && why.is_drawn() == drawn && why.node().is_none_or(|node| holds(&node.bounds)) {
            Ok(why)
        } else {
            Err(format!("{}: {object:?}, drawn: {drawn}, but {why:?}", self.eye.policy().name()))
        }
    }
}
