//! What the tree costs to maintain: boxes at constant density, a share of which moves each frame.
//!
//! Beside each update, in the same run, stands the cost of merely *writing* the movers' new boxes
//! into an array: the physical limit. Each moves 0.05 m a frame and turns back after a while, so
//! that the workload does not drift.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::Aabb;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};

/// Movers of a scene, with the velocities that they were given.
struct Workload {
    boxes: Vec<Aabb>,
    velocities: Vec<Vec3>,
    frame: u32,
}

impl Workload {
    /// `count` boxes of half extents 0.1 to 1 m, one in 64 cubic metres, `moving` of which move.
    fn new(count: usize, moving: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let side = (64.0 * count as f32).cbrt();
        let mut vec3 =
            |low: f32, high: f32| Vec3::from_array(std::array::from_fn(|_| rng.random_range(low..high)));
        let boxes = (0..count).map(|_| Aabb::from_center(vec3(0.0, side), vec3(0.1, 1.0))).collect();
        let movers = (count as f64 * moving) as usize;
        let velocities = (0..movers).map(|_| vec3(-1.0, 1.0).normalize_or_zero() * 0.05).collect();
        Self { boxes, velocities, frame: 0 }
    }

    /// Moves the movers one step.
    fn step(&mut self) {
        let sign = if (self.frame / 100).is_multiple_of(2) { 1.0 } else { -1.0 };
        self.frame += 1;
        for (aabb, velocity) in self.boxes.iter_mut().zip(&self.velocities) {
            let by = *velocity * sign;
            *aabb = Aabb::new(aabb.min + by, aabb.max + by);
        }
    }
}

fn update(c: &mut Criterion) {
    let mut group = c.benchmark_group("tree_maintenance");
    group.sample_size(20);
    for count in [2_500, 13_550, 100_000] {
        for share in [0.0, 0.2, 0.5, 1.0] {
            let label = format!("{count} boxes, {share} moving");
            let mut load = Workload::new(count, share);
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::new("write", &label), |b| {
                b.iter(|| {
                    load.step();
                    black_box(&load.boxes);
                });
            });
            let mut scene = Scene::new(SceneConfig::default());
            let ids: Vec<ObjectId> = load.boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
            scene.update();
            group.bench_function(BenchmarkId::new("update", &label), |b| {
                b.iter(|| {
                    load.step();
                    let movers = load.velocities.len();
                    scene.sync_moved(ids[..movers].iter().copied().zip(load.boxes.iter().copied()));
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, update);
criterion_main!(benches);
