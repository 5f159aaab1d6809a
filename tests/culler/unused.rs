//! What a scene has not costs nothing: exact counts. That it takes no memory either, frame by frame, is in
//! `tests/steady`; times are in `benches/scene_cost`.

use glam::Vec3;
use hecs::World;
use tercet::geom::{View, Viewport};
use tercet::policy::{self, Policy, Recording};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Batch, Mobility, NeverCull, NotOccluder, Scene, SceneConfig, Slack};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Culler, FrameStats};

use crate::boxes::{Place, draw, spawn};

/// What a frame did, without its times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Counts {
    passes: u32,
    drawn: u32,
    questions: u32,
    boxes: u32,
    waves: u32,
}

fn view() -> View {
    View::look_at(Vec3::new(0.0, 1.0, 14.0), Vec3::ZERO, 60.0, 0.1, Viewport::new(64, 36)).expect("a view")
}

/// A policy that decides by what it sees, whatever this machine's times are.
fn policy(name: &str) -> Box<dyn Policy> {
    let mut policy = policy::by_name(name).expect("a policy of that name");
    let repeatable = match name {
        "auto" => policy.set("race", "false"),
        "nohc" => policy.set("caution", "0"),
        "dual-query" => policy.set("n_skip", "0"),
        _ => Ok(()),
    };
    repeatable.expect("its dials");
    policy
}

fn scene() -> Scene {
    let tree = TreeConfig { leaf_size: LeafSize::Fixed, ..TreeConfig::default() };
    Scene::new(SceneConfig { tree, ..SceneConfig::default() })
}

/// A wall with a crowd behind it.
fn crowd() -> World {
    let mut world = World::new();
    spawn(&mut world, Place::new(Vec3::ZERO, Vec3::new(9.0, 6.0, 0.2)));
    let part = |i: usize, step: f32| (i as f32 * step).fract() * 2.0 - 1.0;
    for i in 0..100 {
        let at = Vec3::new(6.0 * part(i, 0.819_173), 3.0 * part(i, 0.671_044), -6.0 + 4.0 * part(i, 0.5497));
        spawn(&mut world, Place::new(at, Vec3::splat(0.2)));
    }
    world
}

/// The frames of a policy.
fn frames(name: &str, scene: &mut Scene, world: &World, count: usize) -> Vec<Counts> {
    let mut eye = Culler::new(policy(name));
    let mut queries = SoftwareQueries::new();
    scene.adapt([&mut eye]);
    scene.sync(world);
    let mut frame = |_| {
        if let Some(Recording::StopAndWait | Recording::ExactSet) = eye.policy().wants_recorded() {
            let all: Vec<_> = scene.objects().map(|object| object.object.id).collect();
            eye.policy_mut().give_recorded(&all);
        }
        let mut passes = 0;
        let stats = eye
            .frame(scene, &view(), &mut queries, |pass, objects| {
                passes += 1;
                draw(world, pass, objects);
            })
            .expect("a frame");
        scene.adapt([&mut eye]);
        scene.update();
        let FrameStats { drawn, queries: questions, query_boxes: boxes, waves, .. } = stats;
        Counts { passes, drawn, questions, boxes, waves }
    };
    (0..count).map(&mut frame).collect()
}

/// No pass, no question, no wait.
#[test]
fn a_frame_of_an_empty_scene_does_nothing() {
    for &name in policy::NAMES {
        let (mut scene, world) = (scene(), World::new());
        for counts in frames(name, &mut scene, &world, 5) {
            let nothing = Counts { passes: 0, drawn: 0, questions: 0, boxes: 0, waves: 0 };
            assert_eq!(counts, nothing, "{name}");
        }
        assert_eq!(scene.tree().stats().nodes, 1);
    }
}

/// A world behind the camera, however large, is one box outside of the frustum.
#[test]
fn what_is_out_of_view_is_not_asked_about() {
    let mut world = World::new();
    for i in 0..500 {
        let at = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, 40.0 + (i / 100) as f32);
        spawn(&mut world, Place::new(at, Vec3::splat(0.2)));
    }
    for &name in policy::NAMES.iter().filter(|name| !matches!(**name, "none" | "opt" | "exact")) {
        for counts in frames(name, &mut scene(), &world, 5) {
            assert_eq!((counts.passes, counts.drawn, counts.questions), (0, 0, 0), "{name}");
        }
    }
}

/// Policies that ask nothing encode one pass, and none waits for what it did not ask.
#[test]
fn who_asks_nothing_draws_once() {
    for &name in policy::NAMES {
        let all = frames(name, &mut scene(), &crowd(), 6);
        for counts in &all {
            assert!(counts.questions > 0 || (counts.passes, counts.waves) == (1, 0), "{name}: {counts:?}");
            // A pass is there for what it draws, a wait for what was asked.
            assert!(counts.passes <= counts.drawn && counts.waves <= counts.questions, "{name}: {counts:?}");
        }
        let asks = !matches!(name, "none" | "frustum" | "opt" | "exact");
        assert_eq!(all.iter().any(|counts| counts.questions > 0), asks, "{name}");
    }
}

/// Components that say nothing new change no count; one object that is drawn last needs one pass more.
#[test]
fn optional_components_change_what_they_are_about_and_nothing_else() {
    for &name in policy::NAMES {
        let bare = frames(name, &mut scene(), &crowd(), 8);
        let with = |dress: &dyn Fn(&mut World, hecs::Entity)| {
            let mut world = crowd();
            let all: Vec<hecs::Entity> = world.query::<hecs::Entity>().iter().collect();
            all.into_iter().for_each(|entity| dress(&mut world, entity));
            frames(name, &mut scene(), &world, 8)
        };
        let batch = with(&|world, entity| world.insert_one(entity, Batch(3)).expect("alive"));
        assert_eq!(batch, bare, "{name}, Batch");
        let slack = with(&|world, entity| world.insert_one(entity, Slack(0.0)).expect("alive"));
        assert_eq!(slack, bare, "{name}, a slack of nothing");
        let fixed = with(&|world, entity| world.insert_one(entity, Mobility::Static).expect("alive"));
        assert_eq!(fixed, bare, "{name}, Mobility");
    }
}

/// What nearly every object lacks takes no memory before some object has it.
#[test]
fn optional_components_take_memory_where_they_are() {
    let bytes = |dress: &dyn Fn(&mut World, usize, hecs::Entity)| {
        let mut world = World::new();
        for i in 0..2000 {
            let at = Vec3::new((i % 50) as f32, (i / 50) as f32, 0.0);
            let entity = spawn(&mut world, Place::new(at, Vec3::splat(0.2)));
            dress(&mut world, i, entity);
        }
        let mut scene = scene();
        scene.sync(&world);
        scene.bytes()
    };
    let bare = bytes(&|_, _, _| {});
    let marks = bytes(&|world, i, entity| match i % 2 {
        0 => world.insert_one(entity, NotOccluder).expect("alive"),
        _ => world.insert_one(entity, Mobility::Dynamic).expect("alive"),
    });
    assert_eq!(marks, bare, "marks are a bit each");
    let all =
        bytes(&|world, _, entity| world.insert(entity, (Slack(f32::MIN_POSITIVE), Batch(1))).expect("alive"));
    assert!(all >= bare + 2000 * 8, "a slack and a batch take four bytes each: {all} instead of {bare}");
    let few = bytes(&|world, i, entity| {
        if i == 0 {
            world.insert_one(entity, NeverCull).expect("alive");
        }
    });
    // Its slot is the last one, and where it stands in the list of its kind is an array up to there.
    assert!(few > bare && few < bare + 2000 * 4 + 1024, "{few} instead of {bare}");
}
