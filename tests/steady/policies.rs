//! Every policy: objects move to and fro, the scene follows its world, the tree adapts, and the software
//! backend draws and answers, all in memory that earlier frames have made.

use glam::{Affine3A, Vec3};
use stats_alloc::Region;
use tercet::audit::Auditor;
use tercet::draw::Drawable;
use tercet::geom::{View, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Bounds, ObjectId, Scene, SceneConfig};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Culler, worlds};

use super::ALLOCATOR;

const OBJECTS: usize = 150;
/// One in so many of them moves.
const MOVERS: usize = 10;
/// Frames until all is where it was.
const PERIOD: u32 = 50;
const WARM_UP: u32 = 6 * PERIOD;

/// On one thread: how the pool hands work to others is not ours.
pub(crate) fn check() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| {
        for &name in policy::NAMES {
            each(name, &[]);
        }
        for name in ["roc", "hroc", "hi-z", "hybrid"] {
            each(name, &[("by_geometry", "false")]);
            each(name, &[("by_geometry", "false"), ("occluder_filtering", "true")]);
        }
        each("chc++", &[("multiqueries", "false"), ("tight", "false")]);
        each("dual-query", &[("order", "visible-first")]);
    });
}

fn each(name: &str, dials: &[(&str, &str)]) {
    let mut world = hecs::World::new();
    worlds::random(5, OBJECTS).spawn(&mut world);
    let mut policy = policy::by_name(name).expect("a policy of that name");
    // Which way is the best, and how many objects a leaf should have, is a matter of times.
    let own: &[_] = if name == "auto" { &[("race", "false")] } else { &[] };
    for (key, value) in own.iter().chain(dials) {
        policy.set(key, value).expect("its dial");
    }
    let tree = TreeConfig { leaf_size: LeafSize::Fixed, ..TreeConfig::default() };
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let mut eye = Culler::new(policy);
    let mut queries = SoftwareQueries::new();
    queries.set_true_shapes(true);
    scene.adapt([&mut eye]);
    scene.sync(&world);
    // What a reference is given.
    let all: Vec<ObjectId> = scene.objects().map(|object| object.object.id).collect();
    let mut culled = 0;
    // Frames that are not due cost it nothing.
    let mut auditor = Auditor::new(u32::MAX);
    let mut frame = |number: u32| {
        // To and fro: each place is come by again.
        let away = (number % PERIOD).abs_diff(PERIOD / 2) as f32;
        let step = Vec3::Y * if number % PERIOD < PERIOD / 2 { 0.05 } else { -0.05 };
        let movers = world.query_mut::<(&mut Drawable, &mut Bounds)>();
        for (drawable, bounds) in movers.into_iter().step_by(MOVERS) {
            drawable.world_from_object = Affine3A::from_translation(step) * drawable.world_from_object;
            bounds.0 = drawable.mesh.bounds().transformed(&drawable.world_from_object);
        }
        scene.sync(&world);
        let angle = 0.04 * away;
        let at = 22.0 * Vec3::new(angle.cos(), 0.3, angle.sin());
        let view = View::look_at(at, Vec3::ZERO, 60.0, 0.1, Viewport::new(64, 36)).expect("a view");
        eye.policy_mut().give_recorded(&all);
        let stats = eye
            .frame(&scene, &view, &mut queries, |pass, objects| {
                for object in objects {
                    let drawable = world.get::<&Drawable>(object.entity()).expect("a drawable");
                    pass.draw_level(&drawable.mesh, usize::MAX, &drawable.world_from_object);
                }
            })
            .expect("a frame");
        let audit = auditor.check(&scene, &view, &eye, |_, _| unreachable!("it is not due"));
        assert!(audit.is_ok_and(|audit| audit.is_none()));
        culled += OBJECTS - stats.drawn as usize;
        scene.adapt([&mut eye]);
    };
    // A list that is as full as never before doubles, which is no steady frame: then the next hundred count.
    let mut frames = 0..;
    let mut run = |count: u32| frames.by_ref().take(count as usize).for_each(&mut frame);
    run(WARM_UP);
    let mut growing = 0;
    loop {
        let region = Region::new(ALLOCATOR);
        run(2 * PERIOD);
        let change = region.change();
        if (change.allocations, change.reallocations) == (0, 0) {
            break;
        }
        growing += 1;
        assert!(growing < 12, "{name}, {dials:?}: {change:?}");
    }
    let culls = !matches!(name, "none" | "opt" | "exact");
    assert!(!culls || culled > 300, "{name} culled {culled}");
}
