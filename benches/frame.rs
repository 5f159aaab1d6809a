//! Whole frames: each policy in a part of each world, the camera halfway along its flight, on the software
//! backend, which draws the picture. In the same run, `none` and `frustum` are what culling has to beat, and
//! `exact`, which is handed what can be seen, is what nobody beats.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use hecs::World;
use support::painter::Painter;
use support::reference::Reference;
use support::run::Eye;
use tercet::Culler;
use tercet::draw::Detail;
use tercet::geom::{View, Viewport};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds::{self, CameraPath, Model, city, factory, fantasy, power_plant, satellites};

const SCALE: f32 = 0.1;
const SEED: u64 = 1;

fn places() -> [(&'static str, Model, CameraPath); 5] {
    [
        ("plant", worlds::power_plant(SEED, SCALE), power_plant::path(SCALE)),
        ("fantasy", worlds::fantasy(SEED, SCALE), fantasy::path(SCALE)),
        ("factory", worlds::factory(SEED, SCALE), factory::path(SCALE)),
        ("city", worlds::city(SEED, SCALE), city::path(SCALE)),
        ("satellites", worlds::satellites(SEED, SCALE), satellites::path(SCALE)),
    ]
}

fn policies(c: &mut Criterion) {
    let painter = Painter { detail: Detail::default() };
    for (place, model, path) in places() {
        let mut world = World::new();
        model.spawn(&mut world);
        let pose = path.pose(0.5);
        let screen = Viewport::new(1280, 720);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, screen)
            .expect("the path looks somewhere");
        let mut group = c.benchmark_group(place);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(1));
        // What stop-and-wait found stands for itself.
        for name in policy::NAMES.iter().filter(|name| **name != "opt") {
            let mut scene = Scene::new(SceneConfig::default());
            let mut eye: Eye = Culler::new(policy::by_name(name).expect("it is in the list"));
            let mut queries = SoftwareQueries::new();
            queries.set_true_shapes(true);
            scene.sync(&world);
            Reference::new(painter, false).look(&scene, &world, &view, &mut eye).expect("the exact set");
            group.bench_function(*name, |b| {
                b.iter(|| {
                    scene.sync(&world);
                    let stats = eye
                        .frame(&scene, &view, &mut queries, |pass, objects| {
                            painter.draw(&world, &view, pass, objects);
                        })
                        .expect("a frame");
                    scene.adapt([&mut eye]);
                    stats.drawn
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, policies);
criterion_main!(benches);
