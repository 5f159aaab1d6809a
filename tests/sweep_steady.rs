//! A steady frame of the sweeping policies allocates nothing: neither they nor the sweeps, in memory that
//! earlier frames have made.

use std::alloc::System;

use glam::Vec3;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use tercet::audit::Auditor;
use tercet::draw::Drawable;
use tercet::geom::{View, Viewport};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::{Culler, worlds};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One thread: how the pool hands work to others is not ours.
#[test]
fn a_steady_frame_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| {
        for name in ["roc", "hroc", "hi-z", "hybrid"] {
            for filtering in ["true", "false"] {
                check(name, filtering);
            }
        }
    });
}

fn check(name: &str, filtering: &str) {
    let mut world = hecs::World::new();
    worlds::random(5, 300).spawn(&mut world);
    let mut scene = Scene::new(SceneConfig::default());
    let mut policy = policy::by_name(name).expect("a policy of that name");
    policy.set("occluder_filtering", filtering).expect("its dial");
    let mut eye = Culler::new(policy);
    let mut queries = SoftwareQueries::new();
    scene.adapt([&mut eye]);
    scene.sync(&world);
    let mut culled = 0;
    // Frames that are not due cost it nothing.
    let mut auditor = Auditor::new(u32::MAX);
    let mut frame = |number: u32| {
        scene.update();
        // To and fro: each place is come by again.
        let angle = 0.02 * (number % 100).abs_diff(50) as f32;
        let at = 25.0 * Vec3::new(angle.cos(), 0.3, angle.sin());
        let view = View::look_at(at, Vec3::ZERO, 60.0, 0.1, Viewport::new(160, 90)).expect("a view");
        let stats = eye
            .frame(&scene, &view, &mut queries, |pass, objects| {
                for object in objects {
                    let drawable = world.get::<&Drawable>(object.entity()).expect("a drawable");
                    pass.draw_level(&drawable.mesh, usize::MAX, &drawable.world_from_object);
                }
            })
            .expect("a frame");
        culled += 300 - stats.drawn;
        let audit = auditor.check(&scene, &view, &eye, |_, _| unreachable!("it is not due"));
        assert!(audit.is_ok_and(|audit| audit.is_none()));
    };
    (0..300).for_each(&mut frame);
    let region = Region::new(ALLOCATOR);
    (300..500).for_each(&mut frame);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{name}, {filtering}: {change:?}");
    assert!(culled > 10_000, "{name} culled {culled}");
}
