//! A world, one view of it, and the audit as it should be, by other means.

use std::collections::{HashMap, HashSet};

use glam::Vec3;
use tercet::audit::{Audit, Auditor};
use tercet::geom::{Aabb, Question, View};
use tercet::policy::{self, Policy};
use tercet::query::oracle::Oracle;
use tercet::query::software::{SoftwarePass, SoftwareQueries, VisibilityImage};
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};
use tercet::scene::{ObjectId, Scene, SceneConfig};
use tercet::{Culler, Tradeoff, worlds};

use crate::SCREEN;
use crate::painter::draw;
use crate::stage::Stage;

pub(super) const FRAMES: u32 = 14;

/// A backend whose depth can be looked at.
pub(super) trait Shown {
    /// The software raster that holds the frame's depth.
    fn shown(&self) -> &SoftwareQueries;
}

impl Shown for SoftwareQueries {
    fn shown(&self) -> &SoftwareQueries {
        self
    }
}

/// A world, one view of it, and who checks what that shows.
pub(super) struct Watch<B> {
    pub(super) stage: Stage,
    pub(super) scene: Scene,
    pub(super) eye: Culler<Box<dyn Policy>>,
    pub(super) queries: B,
    pub(super) view: View,
    auditor: Auditor,
}

impl<B: QueryBackend<Pass = SoftwarePass> + Shown> Watch<B> {
    pub(super) fn new(policy: &str, seed: u64, tradeoff: Tradeoff, queries: B) -> Self {
        let mut scene = Scene::new(SceneConfig::default());
        let mut eye = Culler::new(policy::by_name(policy).expect("its name"));
        eye.tradeoff = tradeoff;
        scene.adapt([&mut eye]);
        let view = View::look_at(Vec3::Z, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
        let stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
        Self { stage, scene, eye, queries, view, auditor: Auditor::new(1) }
    }

    pub(super) fn frame(&mut self, number: u32) {
        self.view = self.stage.next(number);
        self.scene.sync(&self.stage.world);
        let Self { stage: Stage { world, detail, .. }, scene, eye, queries, view, .. } = self;
        eye.frame(scene, view, queries, |pass, objects| draw(world, view, *detail, pass, objects))
            .expect("a frame");
    }

    fn check(&mut self) -> Audit {
        let Self { stage: Stage { world, detail, .. }, scene, eye, view, auditor, .. } = self;
        let audit =
            auditor.check(scene, view, eye, |pass, objects| draw(world, view, *detail, pass, objects));
        audit.expect("it looks").expect("a frame that is due").clone()
    }

    /// Calls `each` with every frame and its audit.
    pub(super) fn run(mut self, mut each: impl FnMut(&Self, &Audit)) -> Auditor {
        for number in 0..FRAMES {
            self.frame(number);
            let audit = self.check();
            each(&self, &audit);
            self.scene.adapt([&mut self.eye]);
        }
        self.auditor
    }

    /// How much of a box is in sight of what was drawn and hides, at 1/`divisor` of the resolution.
    pub(super) fn in_sight(&self, aabb: &Aabb, divisor: u32) -> u32 {
        let Self { stage: Stage { world, detail, .. }, scene, eye, view, .. } = self;
        let coarse = view.coarsened(divisor);
        let proxy = match Question::new(aabb, &coarse) {
            Question::Ask(proxy) => proxy,
            Question::Outside => return 0,
            // It was asked about as it was seen from elsewhere.
            Question::Visible => return u32::MAX,
        };
        let hides = |id: ObjectId| scene.object(id).is_some_and(|o| !o.traits.not_occluder);
        let occluders: Vec<_> = eye.visible().iter().copied().filter(|o| hides(o.id)).collect();
        let mut queries = SoftwareQueries::new();
        queries.begin(&coarse).expect("a frame");
        queries.draw(|pass| draw(world, view, *detail, pass, &occluders)).expect("a pass");
        queries.ask(Ticket(0), &[proxy], Want::Dual).expect("a question");
        let mut counted = None;
        let take = |_, answer: Answer<'_>| {
            if let Answer::Dual { visible, .. } = answer {
                counted = Some(visible);
            }
        };
        queries.answers(Wait::Block, take).expect("an answer");
        counted.expect("a count")
    }

    /// The audit as it should be, by other means: what is lost, and how much it owns of the picture;
    /// and how many samples are wrong.
    pub(super) fn expected(&self) -> (HashMap<ObjectId, u32>, u64) {
        let Self { stage: Stage { world, detail, .. }, scene, eye, view, .. } = self;
        let mut oracle = Oracle::new();
        let truth = oracle
            .look(scene, view, |pass, objects| draw(world, view, *detail, pass, objects))
            .expect("it looks");
        let drawn: HashSet<ObjectId> = eye.visible().iter().map(|o| o.id).collect();
        let ids = scene.objects().map(|o| o.object.id);
        let lost = ids.filter(|&id| truth.exact.contains(id) && !drawn.contains(&id));
        let mut lost: HashMap<ObjectId, u32> = lost.map(|id| (id, 0)).collect();
        // At full resolution, whatever the questions were put to.
        let mut shown = SoftwareQueries::new();
        shown.begin(view).expect("a frame");
        shown.draw(|pass| draw(world, view, *detail, pass, eye.visible())).expect("a pass");
        let (image, depth) = (oracle.image(), shown.depth());
        let mut wrong = 0;
        for y in 0..image.height {
            for x in 0..image.width {
                let at = (y * image.width + x) as usize;
                wrong += u64::from(depth.at(x, y) != image.nearness[at]);
                if image.call[at] != VisibilityImage::NOTHING
                    && let Some(samples) = lost.get_mut(&oracle.owner(image.call[at]).id)
                {
                    *samples += 1;
                }
            }
        }
        (lost, wrong)
    }
}
