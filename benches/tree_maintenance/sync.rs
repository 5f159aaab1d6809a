//! Mirroring a hecs world that stands still, beside the plain loop that compares it with an array.

use std::hint::black_box;

use glam::Vec3;
use hecs::{Entity, World};
use tercet::geom::Aabb;
use tercet::scene::{Bounds, ObjectId, Scene, SceneConfig};

use crate::clock::{median, seconds};
use crate::workload::{Manner, Workload};

/// Movers of the frames in which the app says what has moved: so many, and one in so many.
const FEW: usize = 100;

/// The columns.
pub const NAMES: [&str; 6] = [
    "entities",
    "plain loop, µs",
    "sync, µs",
    "/ plain loop",
    "sync_moved of 100, µs",
    "sync_moved of one in 100, µs",
];

/// Measures a world of so many entities.
pub fn cells(count: usize) -> Vec<String> {
    let load = Workload::new(count, 0.0, Manner::USUAL);
    let mut world = World::new();
    world.spawn_batch(load.boxes.iter().map(|&b| (Bounds(b),))).for_each(drop);
    let mut array = load.boxes.clone();
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(&world);
    let ids = [count.div_ceil(FEW), FEW].map(|apart| {
        scene.objects().map(|object| object.object.id).step_by(apart).collect::<Vec<ObjectId>>()
    });
    let (mut plain, mut sync, mut moved) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
    for frame in 0..40 {
        plain.push(seconds(1, || {
            black_box(compare(&world, &mut array));
        }));
        sync.push(seconds(1, || {
            black_box(scene.sync(&world));
        }));
        let step = Vec3::splat(if frame % 2 == 0 { 0.05 } else { -0.05 });
        for (ids, times) in ids.iter().zip(&mut moved) {
            let boxes = ids.iter().map(|&id| (id, scene.object(id).and_then(|object| object.bounds)));
            let movers: Vec<(ObjectId, Aabb)> =
                boxes.filter_map(|(id, b)| Some((id, Aabb::new(b?.min + step, b?.max + step)))).collect();
            times.push(seconds(1, || {
                scene.sync_moved(movers.iter().copied());
            }));
            // The world has not moved: it takes its objects back, and neither loop is measured by it.
            scene.sync(&world);
        }
    }
    let (plain, sync) = (median(&plain), median(&sync));
    let [few, share] = moved.map(|times| format!("{:.1}", median(&times) * 1e6));
    vec![
        count.to_string(),
        format!("{:.0}", plain * 1e6),
        format!("{:.0}", sync * 1e6),
        format!("{:.2}", sync / plain),
        few,
        share,
    ]
}

/// What an app would write itself: how many boxes differ from those of an array by entity.
fn compare(world: &World, array: &mut [Aabb]) -> usize {
    let mut changed = 0;
    for (entity, Bounds(bounds)) in world.query::<(Entity, &Bounds)>().iter() {
        let known = &mut array[entity.id() as usize];
        if known != bounds {
            *known = *bounds;
            changed += 1;
        }
    }
    changed
}
