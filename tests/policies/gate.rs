//! A gate before a policy: with scripted answers and times, so every run is the same.

use glam::Vec3;
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::policy::{self, Action, Context, Extent, Gated, Policy};
use tercet::query::{Answer, Ticket, Want};
use tercet::scene::{Scene, SceneConfig, Traits};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Costs, FrameCost, Tradeoff};

/// Two walls of cubes, before the eye and behind it. Whoever is asked about before it is visible,
/// and behind it hidden, but for one in some questions.
struct Rig {
    scene: Scene,
    frame: u32,
    costs: Costs,
    /// Seconds a question.
    question: f32,
    /// Behind the eye, one question in so many finds something visible; and each about many objects.
    one_in: u32,
}

/// What a frame did.
#[derive(Clone, Debug, PartialEq)]
struct Did {
    drawn: u32,
    questions: u32,
    gated: bool,
    seconds: f32,
    actions: Vec<String>,
}

const OBJECTS: u32 = 900;
/// Seconds an object.
const OBJECT: f32 = 1e-6;

impl Rig {
    fn new() -> Self {
        // Times are the gate's alone.
        let tree = TreeConfig { leaf_size: LeafSize::Fixed, ..TreeConfig::stable() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        for i in 0..2 * OBJECTS {
            let (column, row) = ((i / 2 % 30) as f32 - 14.5, (i / 60) as f32 - 14.5);
            let depth = if i % 2 == 0 { -40.0 } else { 40.0 };
            let cube = Aabb::from_center(Vec3::new(column, row, depth), Vec3::splat(0.4));
            scene.insert(cube, Traits::default());
        }
        scene.update();
        Self { scene, frame: 0, costs: Costs::default(), question: 0.5 * OBJECT, one_in: 10 }
    }

    /// A frame that looks forward, or back.
    fn frame(&mut self, policy: &mut dyn Policy, back: bool) -> Did {
        self.frame += 1;
        let target = if back { Vec3::Z } else { Vec3::NEG_Z };
        let view = View::look_at(Vec3::ZERO, target, 60.0, 0.1, Viewport::new(640, 360)).expect("a view");
        let frustum = Frustum::new(&view);
        let tree = self.scene.tree();
        let cx = context(&self.scene, &view, &frustum, self.frame, self.costs);
        let (mut drawn, mut questions, mut open, mut actions) = (0, 0, Vec::new(), Vec::new());
        policy.begin(&cx);
        loop {
            let action = policy.next(&cx);
            actions.push(format!("{action:?}"));
            match action {
                Action::Draw(node, Extent::Own) => drawn += tree.own_count(node) as u32,
                // Half of all is in view.
                Action::Draw(node, _) if node == tree.root() => drawn += OBJECTS,
                Action::Draw(node, _) => drawn += tree.count(node) as u32,
                Action::Ask { ticket, boxes, want } => {
                    questions += 1;
                    let rect = boxes[0].rect;
                    let is_large = (rect.x1 - rect.x0) * (rect.y1 - rect.y0) > 1000;
                    let visible = !back || is_large || questions % self.one_in == 0;
                    open.push((ticket, want, visible));
                }
                Action::Wait(_) => {
                    for (ticket, want, visible) in open.drain(..) {
                        policy.answer(&cx, ticket, answer(want, visible));
                    }
                }
                Action::Done => break,
                other => unreachable!("{other:?}"),
            }
        }
        let seconds = drawn as f32 * OBJECT + questions as f32 * self.question;
        let draw = drawn as f32 * OBJECT;
        self.costs = self.costs.after(FrameCost { total: seconds, draw, drawn, ago: 1 });
        let gated = policy.counters().iter().any(|c| c.key == "gated_frames" && c.count > 0);
        Did { drawn, questions, gated, seconds, actions }
    }
}

fn answer(want: Want, visible: bool) -> Answer<'static> {
    match want {
        Want::Any => Answer::Any(visible),
        Want::Dual => Answer::Dual { visible: if visible { 50 } else { 0 }, total: 100 },
    }
}

fn gated(name: &str) -> Gated<Box<dyn Policy>> {
    Gated::new(policy::by_name(name).expect("a policy of that name"))
}

const POLICIES: [&str; 5] = ["dual-query", "chc", "chc++", "nohc", "statistical"];

#[test]
fn where_everything_is_visible_the_gate_costs_less_than_three_per_cent() {
    for name in POLICIES {
        let (mut rig, mut policy) = (Rig::new(), gated(name));
        // Dear: a probe alone takes as long as drawing half of all.
        rig.question = 15.0 * OBJECT;
        let frames: Vec<Did> = (0..1000).map(|_| rig.frame(&mut policy, false)).collect();
        assert!(frames.iter().all(|did| did.gated && did.drawn == OBJECTS), "{name}");
        let seconds: f64 = frames.iter().map(|did| f64::from(did.seconds)).sum();
        let alone = 1000.0 * f64::from(OBJECTS as f32 * OBJECT);
        assert!(seconds < 1.03 * alone, "{name}: {}", seconds / alone);
        assert!(!policy.asks(), "the tree may stay coarse");
    }
}

/// `probe` frames until it is noticed, and the next one asks; but if it is not known yet what drawing
/// takes, for want of a frame without a probe, that comes first.
#[test]
fn hidden_objects_are_noticed_within_the_probe_interval() {
    for name in POLICIES {
        for (before, probe) in [(200, 32), (201, 32), (217, 32), (300, 5), (50, 1)] {
            let (mut rig, mut policy) = (Rig::new(), gated(name));
            policy.probe = probe;
            (0..before).for_each(|_| assert!(rig.frame(&mut policy, false).gated));
            let first = (1..).find(|_| !rig.frame(&mut policy, true).gated).expect("it asks at last");
            assert!(first <= probe.max(2) + 1, "{name} asked in frame {first}, probe = {probe}");
            // And it pays: the gate stays open, but for looks where the two ways come near each other.
            let later: Vec<Did> = (0..500).map(|_| rig.frame(&mut policy, true)).collect();
            let shut = later.iter().filter(|did| did.gated).count();
            assert!(shut <= 30, "{name}: shut in {shut} frames");
            let drawn = later.last().expect("500").drawn;
            assert!(drawn < OBJECTS / 2, "{name} draws {drawn}");
        }
    }
}

/// Much is hidden, and yet asking takes longer than drawing all: tried again and again, ever more
/// rarely.
#[test]
fn asking_that_does_not_pay_is_given_up() {
    for name in POLICIES {
        let (mut rig, mut policy) = (Rig::new(), gated(name));
        (rig.question, rig.one_in) = (100.0 * OBJECT, 2);
        let frames: Vec<Did> = (0..4000).map(|_| rig.frame(&mut policy, true)).collect();
        let asked = frames.iter().filter(|did| !did.gated).count();
        assert!((2..100).contains(&asked), "{name} asked in {asked} of 4000 frames");
    }
}

#[test]
fn a_gate_that_is_open_shuts_where_nothing_is_hidden_any_more() {
    for name in POLICIES {
        let (mut rig, mut policy) = (Rig::new(), gated(name));
        (0..100).for_each(|_| drop(rig.frame(&mut policy, true)));
        assert!(policy.asks(), "{name}");
        rig.question = 4.0 * OBJECT;
        let mut ahead = (0..200).map(|_| rig.frame(&mut policy, false));
        let shut = ahead.position(|did| did.gated);
        assert!(shut.is_some_and(|frames| frames < 64), "{name} went on asking for {shut:?} frames");
    }
}

#[test]
fn the_same_times_and_answers_make_the_same_frames() {
    for name in POLICIES {
        let run = || {
            let (mut rig, mut policy) = (Rig::new(), gated(name));
            (0..200).map(|n| rig.frame(&mut policy, n / 50 % 2 == 1)).collect::<Vec<Did>>()
        };
        assert_eq!(run(), run(), "{name}");
    }
}

#[test]
fn without_its_gate_it_is_the_policy() {
    for name in POLICIES {
        let (mut one, mut other) = (Rig::new(), Rig::new());
        let (mut plain, mut open) = (policy::by_name(name).expect("it is known"), gated(name));
        open.set("gate", "off").expect("a dial");
        assert_eq!((open.name(), open.asks()), (plain.name(), plain.asks()));
        for n in 0..60 {
            let back = n / 20 == 1;
            assert_eq!(one.frame(&mut plain, back), other.frame(&mut open, back), "{name}, frame {n}");
        }
        assert_eq!(open.counters(), plain.counters());
    }
}

#[test]
fn dials_of_both_are_there_and_a_policy_that_asks_nothing_has_no_gate() {
    let mut policy = gated("chc++");
    policy.set("n_av", "3").expect("the policy's own");
    policy.set("probe", "7").expect("the gate's");
    assert_eq!(policy.probe, 7);
    let value = |key| policy.dials().into_iter().find(|dial| dial.key == key).map(|dial| dial.value);
    assert_eq!((value("n_av").as_deref(), value("gate").as_deref()), (Some("3"), Some("on")));
    assert!(gated("chc").set("b", "5").is_err(), "a dial of neither");
    let mut frustum = gated("frustum");
    let has_gate = frustum.dials().iter().any(|dial| dial.key == "gate");
    assert!(!has_gate && frustum.set("gate", "off").is_err());
    assert!(frustum.counters().is_empty());
}

/// The same keys in every frame, and nothing of a frame that was before.
#[test]
fn counters_are_those_of_the_frame() {
    let (mut rig, mut policy) = (Rig::new(), gated("chc++"));
    let mut keys = Vec::new();
    for n in 0..100 {
        let did = rig.frame(&mut policy, n > 50);
        let counters = policy.counters();
        keys.push(counters.iter().map(|counter| counter.key).collect::<Vec<_>>());
        let batches = counters.iter().find(|c| c.key == "batches").expect("it counts them").count;
        assert!(!did.gated || batches == 0);
    }
    keys.dedup();
    assert_eq!(keys.len(), 1);
    assert!(keys[0].ends_with(&["gated_frames", "probes"]));
}

/// What a policy may look at in a frame of the rig.
fn context<'a>(
    scene: &'a Scene,
    view: &'a View,
    frustum: &'a Frustum,
    frame: u32,
    costs: Costs,
) -> Context<'a> {
    Context { scene, tree: scene.tree(), view, frustum, frame, tradeoff: &Tradeoff::EXACT, costs, past: None }
}

/// An answer that is lost counts as visible.
#[test]
fn lost_answers_do_not_open_the_gate() {
    let (mut rig, mut policy) = (Rig::new(), gated("dual-query"));
    let view = View::look_at(Vec3::ZERO, Vec3::Z, 60.0, 0.1, Viewport::new(640, 360)).expect("a view");
    let frustum = Frustum::new(&view);
    for frame in 1..100 {
        let cx = context(&rig.scene, &view, &frustum, frame, rig.costs);
        policy.begin(&cx);
        let mut asked: u32 = 0;
        loop {
            match policy.next(&cx) {
                Action::Ask { .. } => asked += 1,
                Action::Wait(_) => {
                    (0..asked).for_each(|ticket| policy.answer(&cx, Ticket(ticket), Answer::Unknown));
                }
                Action::Done => break,
                _ => {}
            }
        }
        rig.costs = rig.costs.after(FrameCost { total: 1e-3, draw: 1e-3, drawn: OBJECTS, ago: 1 });
        assert!(!policy.asks());
    }
}
