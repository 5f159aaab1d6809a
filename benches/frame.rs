//! Whole frames: each policy on a part of the power plant, camera standing inside, on the software
//! backend. `none` and `frustum` in the same run are what culling has to beat.

use criterion::{Criterion, criterion_group, criterion_main};
use tercet::Culler;
use tercet::draw::{Detail, Drawable};
use tercet::geom::{View, Viewport};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds::{self, power_plant};

const SCALE: f32 = 0.1;

fn policies(c: &mut Criterion) {
    let mut group = c.benchmark_group("frame");
    group.sample_size(20);
    let mut world = hecs::World::new();
    worlds::power_plant(1, SCALE).spawn(&mut world);
    let pose = power_plant::path(SCALE).pose(0.5);
    let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, Viewport::new(1280, 720))
        .expect("the path looks somewhere");
    let detail = Detail::default();
    // References draw what they are given: without a recording, nothing.
    for name in policy::NAMES.iter().filter(|name| !matches!(**name, "exact" | "opt")) {
        let mut scene = Scene::new(SceneConfig::default());
        let mut eye = Culler::new(policy::by_name(name).expect("it is in the list"));
        let mut queries = SoftwareQueries::new();
        group.bench_function(*name, |b| {
            b.iter(|| {
                scene.sync(&world);
                let stats = eye
                    .frame(&scene, &view, &mut queries, |pass, objects| {
                        for object in objects {
                            let d = world.get::<&Drawable>(object.entity()).expect("it was spawned with one");
                            let level = detail.level(&d.mesh, &d.world_from_object, &view);
                            pass.draw_level(&d.mesh, level, &d.world_from_object);
                        }
                    })
                    .expect("a frame");
                scene.adapt([&mut eye]);
                stats.drawn
            });
        });
    }
    group.finish();
}

criterion_group!(benches, policies);
criterion_main!(benches);
