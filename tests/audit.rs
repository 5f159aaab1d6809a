//! Error accounting: what an [`Auditor`] says of a frame is compared with what the oracle and the culler say
//! themselves, and with what a backend that lies has done.

#[path = "support/lying.rs"]
mod lying;
#[path = "support/stage.rs"]
mod stage;

use std::collections::{HashMap, HashSet};

use glam::{Affine3A, Vec3};
use hecs::{Entity, World};
use lying::Lying;
use stage::Stage;
use tercet::audit::{Audit, Auditor, Blame, FalseCull};
use tercet::draw::{Detail, Drawable};
use tercet::geom::{Aabb, Question, View, Viewport};
use tercet::policy::{self, DrawAll, Policy};
use tercet::query::oracle::Oracle;
use tercet::query::software::{SoftwarePass, SoftwareQueries, VisibilityImage};
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;
use tercet::scene::{Bounds, ObjectId, ObjectRef, Scene, SceneConfig, Traits};
use tercet::{Culler, Error, Holder, Latency, Tradeoff, Why, worlds};

const SCREEN: Viewport = Viewport::new(160, 90);
const FRAMES: u32 = 14;

/// A backend whose depth can be looked at.
trait Shown {
    /// The software raster that holds the frame's depth.
    fn shown(&self) -> &SoftwareQueries;
}

impl Shown for SoftwareQueries {
    fn shown(&self) -> &SoftwareQueries {
        self
    }
}

/// A world, one view of it, and who checks what that shows.
struct Watch<B> {
    stage: Stage,
    scene: Scene,
    eye: Culler<Box<dyn Policy>>,
    queries: B,
    view: View,
    auditor: Auditor,
}

impl<B: QueryBackend<Pass = SoftwarePass> + Shown> Watch<B> {
    fn new(policy: &str, seed: u64, tradeoff: Tradeoff, queries: B) -> Self {
        let mut scene = Scene::new(SceneConfig::default());
        let mut eye = Culler::new(policy::by_name(policy).expect("its name"));
        eye.tradeoff = tradeoff;
        scene.adapt([&mut eye]);
        let view = View::look_at(Vec3::Z, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
        let stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
        Self { stage, scene, eye, queries, view, auditor: Auditor::new(1) }
    }

    fn frame(&mut self, number: u32) {
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
    fn run(mut self, mut each: impl FnMut(&Self, &Audit)) -> Auditor {
        for number in 0..FRAMES {
            self.frame(number);
            let audit = self.check();
            each(&self, &audit);
            self.scene.adapt([&mut self.eye]);
        }
        self.auditor
    }

    /// How much of a box is in sight of what was drawn and hides, at 1/`divisor` of the resolution.
    fn in_sight(&self, aabb: &Aabb, divisor: u32) -> u32 {
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
    fn expected(&self) -> (HashMap<ObjectId, u32>, u64) {
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

fn draw(world: &World, view: &View, detail: Detail, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
    for object in objects {
        let d = world.get::<&Drawable>(object.entity()).expect("an object has a mesh");
        pass.draw_level(&d.mesh, detail.level(&d.mesh, &d.world_from_object, view), &d.world_from_object);
    }
}

#[test]
fn what_is_exact_loses_nothing() {
    for name in ["dual-query", "chc++", "hroc", "hierarchy-b"] {
        let mut culled = 0;
        for seed in 0..4 {
            let auditor = Watch::new(name, seed, Tradeoff::EXACT, SoftwareQueries::new()).run(|_, audit| {
                assert_eq!((audit.lost.len(), audit.wrong_pixels), (0, 0), "{name}");
                assert!(audit.visible <= audit.drawn);
                culled += audit.culled;
            });
            let estimate = auditor.estimate();
            assert_eq!((estimate.frames, estimate.lost, estimate.wrong_share.mean), (FRAMES, 0, 0.0));
            assert!((estimate.lossy_frames.high - (1.0 - 0.05f64.powf(1.0 / 14.0))).abs() < 1e-9);
            assert!(estimate.to_string().starts_with("14 frames checked, nothing lost"), "{estimate}");
            assert_eq!(auditor.blamed().count(), 0);
        }
        assert!(culled > 500, "{name} culled {culled}");
    }
}

#[test]
fn what_a_threshold_loses_is_reported_to_the_sample() {
    for name in ["dual-query", "chc", "nohc"] {
        let (mut all, mut owned, mut frames_with) = (0, 0, 0);
        for seed in 0..4 {
            let tradeoff = Tradeoff { visible_pixels: 60, ..Tradeoff::EXACT };
            let (mut sum, mut wrong_shares) = (0, Vec::new());
            let auditor = Watch::new(name, seed, tradeoff, SoftwareQueries::new()).run(|watch, audit| {
                let (lost, wrong) = watch.expected();
                let reported: HashMap<ObjectId, u32> =
                    audit.lost.iter().map(|lost| (lost.object.id, lost.samples)).collect();
                assert_eq!(reported, lost, "{name}, seed {seed}");
                assert_eq!((audit.lost.len(), audit.wrong_pixels), (lost.len(), wrong));
                for lost in &audit.lost {
                    assert_eq!(lost.dial(), Some("visible_pixels"), "{lost}");
                    assert_eq!(lost.share, f64::from(lost.samples) / 14_400.0);
                    assert_eq!(lost.bounds, watch.scene.object(lost.object.id).and_then(|o| o.bounds));
                    assert!(matches!(lost.why, Why::Hidden(_)) && !lost.why.is_drawn());
                    let recount = lost.recount.expect("a box that was asked about");
                    assert!((lost.samples.max(1)..=60).contains(&recount.visible), "{lost}");
                    owned += lost.samples;
                }
                sum += audit.lost.len() as u64;
                frames_with += u32::from(sum > 0);
                wrong_shares.push(wrong as f64 / 14_400.0);
            });
            let estimate = auditor.estimate();
            assert_eq!(estimate.lost, sum);
            assert!((estimate.wrong_share.mean - wrong_shares.iter().sum::<f64>() / 14.0).abs() < 1e-12);
            assert_eq!(estimate.worst_wrong_share, wrong_shares.into_iter().fold(0.0, f64::max));
            let blamed: Vec<_> = auditor.blamed().collect();
            assert_eq!(blamed, if sum > 0 { vec![(Blame::Dial("visible_pixels"), sum)] } else { vec![] });
            all += sum;
        }
        assert!(all > 100 && owned > 500 && frames_with > 20, "{name}: {all} lost, {owned} samples");
    }
}

/// What is said to be hidden although it is in sight.
#[test]
fn lies_are_defects() {
    for (threshold, expected) in [(0, &["A DEFECT"] as &[_]), (8, &["A DEFECT", "visible_pixels"])] {
        let mut found = HashSet::new();
        for seed in 0..4 {
            let tradeoff = Tradeoff { visible_pixels: threshold, ..Tradeoff::EXACT };
            let liar = Lying(SoftwareQueries::new());
            Watch::new("dual-query", seed, tradeoff, liar).run(|watch, audit| {
                assert_eq!(audit.lost.len(), watch.expected().0.len());
                for lost in &audit.lost {
                    // It lies about fewer than 20 samples; the box had no more when it was asked about.
                    let visible = lost.recount.expect("it was asked about").visible;
                    assert!((1..20).contains(&visible), "{lost}");
                    let is_within = visible <= threshold;
                    assert_eq!(lost.dial(), is_within.then_some("visible_pixels"), "{lost}");
                    assert_eq!(lost.blame == Blame::Defect, !is_within);
                    let text = lost.to_string();
                    found.extend(
                        ["A DEFECT", "visible_pixels"].into_iter().filter(|word| text.contains(word)),
                    );
                }
            });
        }
        assert_eq!(found, expected.iter().copied().collect(), "threshold {threshold}");
    }
}

#[test]
fn frames_that_are_not_due_are_left_alone() {
    let mut watch = Watch::new("dual-query", 1, Tradeoff::EXACT, SoftwareQueries::new());
    let mut auditor = Auditor::new(4);
    assert!(auditor.last().is_none());
    let mut checked = Vec::new();
    for number in 0..10 {
        watch.frame(number);
        let Watch { stage: Stage { world, detail, .. }, scene, eye, view, .. } = &watch;
        let mut calls = 0;
        let audit = auditor.check(scene, view, eye, |pass, objects| {
            calls += 1;
            draw(world, view, *detail, pass, objects);
        });
        match audit.expect("it looks") {
            None => assert_eq!(calls, 0),
            Some(audit) => {
                assert_eq!(calls, scene.len() + 2, "each object, and what was drawn");
                checked.push(audit.frame);
            }
        }
    }
    assert_eq!(checked, [4, 8]);
    assert_eq!((auditor.estimate().frames, auditor.last().map(|audit| audit.frame)), (2, Some(8)));
}

/// Runs with dials that each lose something, and returns how much each is blamed for. The names of what is
/// lost are compared with what should be.
fn blamed(
    name: &str,
    tradeoff: Tradeoff,
    coarse: u32,
    each: impl Fn(&Watch<SoftwareQueries>, &FalseCull),
) -> HashMap<Blame, u64> {
    let mut all = HashMap::new();
    for seed in 0..6 {
        let auditor = Watch::new(name, seed, tradeoff, SoftwareQueries::new()).run(|watch, audit| {
            assert_eq!(watch.queries.shown().depth().width(), SCREEN.width / coarse);
            let (lost, wrong) = watch.expected();
            let reported: HashMap<ObjectId, u32> =
                audit.lost.iter().map(|lost| (lost.object.id, lost.samples)).collect();
            assert_eq!((reported, audit.wrong_pixels), (lost, wrong), "{name}, seed {seed}");
            audit.lost.iter().for_each(|lost| each(watch, lost));
        });
        auditor.blamed().for_each(|(blame, lost)| *all.entry(blame).or_default() += lost);
    }
    all
}

#[test]
fn a_coarse_depth_is_blamed() {
    for name in ["dual-query", "chc++", "roc", "hroc"] {
        let tradeoff = Tradeoff { resolution_divisor: 4, ..Tradeoff::EXACT };
        let blamed = blamed(name, tradeoff, 4, |_, _| {});
        assert!(blamed[&Blame::Dial("resolution_divisor")] > 10 && blamed.len() == 1, "{name}: {blamed:?}");
    }
}

#[test]
fn late_questions_are_blamed() {
    for name in ["dual-query", "chc", "statistical"] {
        let tradeoff = Tradeoff { latency: Latency::Late(2), ..Tradeoff::EXACT };
        let blamed = blamed(name, tradeoff, 1, |_, _| {});
        assert!(blamed[&Blame::Dial("latency")] > 10 && blamed.len() == 1, "{name}: {blamed:?}");
    }
}

#[test]
fn of_several_dials_each_gets_its_share() {
    let (latency, visible_pixels) = (Latency::Late(2), 12);
    let tradeoff = Tradeoff { latency, visible_pixels, resolution_divisor: 2, ..Tradeoff::EXACT };
    let blamed = blamed("dual-query", tradeoff, 2, |watch, lost| {
        let Why::Hidden(Holder { bounds: node, .. }) = lost.why else { return };
        let (full, coarse) = (watch.in_sight(&node, 1), watch.in_sight(&node, 2));
        assert_eq!(lost.recount.map_or(u32::MAX, |samples| samples.visible), full);
        // Twelve pixels are three samples of a depth of half as many columns and rows.
        let dial = match (full <= 12, coarse <= 3) {
            (_, false) => "latency",
            (true, true) => "visible_pixels",
            (false, true) => "resolution_divisor",
        };
        assert_eq!(lost.dial(), Some(dial), "{full}, {coarse}: {lost}");
    });
    for key in ["visible_pixels", "resolution_divisor", "latency"] {
        assert!(blamed.get(&Blame::Dial(key)).is_some_and(|&lost| lost > 5), "{key}: {blamed:?}");
    }
    assert_eq!(blamed.len(), 3, "{blamed:?}");
}

/// Whatever a policy asks about, and in whichever way: what a dial explains is no defect.
#[test]
fn no_policys_loss_is_called_a_defect() {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    for name in policy::NAMES.iter().copied().filter(|name| finds_out(name)) {
        let late = Tradeoff { latency: Latency::Late(2), ..Tradeoff::FAST };
        let coarse = Tradeoff { resolution_divisor: 4, ..Tradeoff::FAST };
        let mut all = 0;
        for (seed, tradeoff) in [coarse, late, Tradeoff { swept: true, ..late }].into_iter().enumerate() {
            Watch::new(name, seed as u64, tradeoff, SoftwareQueries::new()).run(|_, audit| {
                audit.lost.iter().for_each(|lost| assert_ne!(lost.dial(), None, "{name}: {lost}"));
                all += audit.lost.len();
            });
        }
        assert_eq!(all == 0, matches!(name, "none" | "frustum"), "{name} lost {all}");
    }
}

/// A square of side 2 that faces the camera.
fn square() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    Mesh::new("square", corners, vec![0, 1, 2, 0, 2, 3]).expect("a sound mesh")
}

/// A wall, and a small square behind it that is drawn as far to the side as `aside`, metres, from its box.
fn behind_a_wall(aside: f32, policy: impl Policy) -> (Audit, Entity) {
    let square = square();
    let mut world = World::new();
    let wall = Affine3A::from_scale(Vec3::splat(2.0));
    let small =
        Affine3A::from_translation(Vec3::new(1.0, 0.0, -1.0)) * Affine3A::from_scale(Vec3::splat(0.5));
    world.spawn((Bounds(square.bounds().transformed(&wall)), wall));
    let moved = Affine3A::from_translation(Vec3::X * aside) * small;
    let entity = world.spawn((Bounds(square.bounds().transformed(&small)), moved));
    let (mut scene, mut eye) = (Scene::new(SceneConfig::default()), Culler::new(policy));
    scene.adapt([&mut eye]);
    scene.sync(&world);
    let view = View::look_at(Vec3::Z * 8.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    let draw = |pass: &mut SoftwarePass, objects: &[ObjectRef]| {
        for object in objects {
            pass.draw_mesh(&square, &world.get::<&Affine3A>(object.entity()).expect("its place"));
        }
    };
    let mut queries = SoftwareQueries::new();
    for _ in 0..3 {
        eye.frame(&scene, &view, &mut queries, draw).expect("a frame");
    }
    let mut auditor = Auditor::new(1);
    let audit = auditor.check(&scene, &view, &eye, draw).expect("it looks").expect("it is due");
    (audit.clone(), entity)
}

#[test]
fn an_object_that_leaves_its_box_is_the_apps_own_error() {
    // It asks about each object by itself.
    let roc = || policy::by_name("roc").expect("its name");
    let (audit, _) = behind_a_wall(0.0, roc());
    assert_eq!((audit.lost.len(), audit.culled, audit.drawn), (0, 1, 1));
    let (audit, entity) = behind_a_wall(3.0, roc());
    assert_eq!(audit.lost.len(), 1);
    let lost = audit.lost[0];
    assert_eq!((lost.object.entity(), lost.blame, lost.dial()), (entity, Blame::Bounds, None));
    assert_eq!((u64::from(lost.samples), lost.recount.map(|r| r.visible)), (audit.wrong_pixels, Some(0)));
    assert!(lost.samples > 50 && lost.to_string().contains("Bounds"), "{lost}");
}

#[test]
fn a_list_that_was_given_is_to_blame_itself() {
    let mut given = policy::by_name("exact").expect("its name");
    given.give_recorded(&[]);
    let (audit, _) = behind_a_wall(0.0, given);
    // The wall; and the small square hides behind nothing that was drawn, but it does so in the whole frame.
    assert_eq!(audit.lost.len(), 1);
    assert_eq!((audit.lost[0].blame, audit.lost[0].why), (Blame::List, Why::Given { drawn: false }));
    assert!(audit.lost[0].to_string().contains("the list that the policy was given"));
}

#[test]
fn a_scene_with_edits_under_way_is_refused() {
    let mut scene = Scene::new(SceneConfig::default());
    scene.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
    let view = View::look_at(Vec3::Z * 8.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    let eye = Culler::new(DrawAll::default());
    let refused = Auditor::new(0).check(&scene, &view, &eye, |_, _| {}).map(|audit| audit.is_some());
    assert!(matches!(refused, Err(Error::PendingEdits(1))));
}
