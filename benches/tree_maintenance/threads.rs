//! The same updates by one thread and by two, frame by frame in turns, by the clock on the wall.

use std::hint::black_box;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use tercet::geom::Aabb;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};

use crate::clock::median;
use crate::workload::{Manner, Workload};

/// The columns.
pub const NAMES: [&str; 5] = ["objects", "moving", "one thread, µs", "two threads, µs", "one / two"];

const WARM_UP: usize = 20;
const FRAMES: usize = 60;

/// Measures so many boxes, of which a share moves.
pub fn cells(count: usize, moving: f64) -> anyhow::Result<Vec<String>> {
    let mut load = Workload::new(count, moving, Manner::USUAL);
    let mut sides = [Side::new(1, &load.boxes)?, Side::new(2, &load.boxes)?];
    for frame in 0..WARM_UP + FRAMES {
        load.step();
        for side in &mut sides {
            let time = side.update(load.moved());
            side.times.extend((frame >= WARM_UP).then_some(time));
        }
    }
    let [one, two] = sides.map(|side| median(&side.times));
    Ok(vec![
        count.to_string(),
        moving.to_string(),
        format!("{:.0}", one * 1e6),
        format!("{:.0}", two * 1e6),
        format!("{:.2}", one / two),
    ])
}

/// A scene and the threads that keep it up to date.
struct Side {
    pool: ThreadPool,
    scene: Scene,
    ids: Vec<ObjectId>,
    times: Vec<f64>,
}

impl Side {
    fn new(threads: usize, boxes: &[Aabb]) -> anyhow::Result<Self> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
        let mut scene = Scene::new(SceneConfig::default());
        let ids = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
        pool.install(|| scene.update());
        Ok(Self { pool, scene, ids, times: Vec::new() })
    }

    fn update(&mut self, moved: &[Aabb]) -> f64 {
        let Self { pool, scene, ids, .. } = self;
        pool.install(|| {
            let start = Instant::now();
            scene.sync_moved(ids.iter().copied().zip(moved.iter().copied()));
            black_box(&scene);
            start.elapsed().as_secs_f64()
        })
    }
}
