//! The tree and its yardsticks, frame by frame in turns: whatever slows the machine slows both.

use std::hint::black_box;

use tercet::geom::{Aabb, Frustum, View};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{TreeConfig, Walk};

use crate::clock::{median, seconds};
use crate::workload::Workload;
use crate::yardstick::{self, Scan};

/// Frames before the measurement: the first ones build, and make room.
const WARM_UP: usize = 20;

/// Medians over the frames of one workload, in seconds; queries by view: wide, mid, near.
pub struct Row {
    pub count: usize,
    pub moving: f64,
    pub write: f64,
    pub copy: f64,
    pub update: f64,
    pub worst_update: f64,
    /// Of the last tenth of the frames, over that of the first tenth.
    pub ageing: f64,
    pub scan: [f64; 3],
    pub query: [f64; 3],
    /// Share of the boxes that each view sees, by the scan, and by the tree, whose planes are a
    /// little wider, so that no rounding hides anything.
    pub seen: [[f64; 2]; 3],
    pub tree_bytes: f64,
    pub scene_bytes: f64,
}

impl Row {
    /// The columns.
    pub const NAMES: [&str; 16] = [
        "objects",
        "moving",
        "update, µs",
        "/ write",
        "/ copy",
        "/ scan",
        "worst / median",
        "last / first",
        "wide / scan",
        "mid / scan",
        "near / scan",
        "seen wide",
        "seen mid",
        "seen near",
        "tree B/object",
        "scene B/object",
    ];

    /// What stands in them.
    pub fn cells(&self) -> Vec<String> {
        let over =
            |what: f64| if what > 0.0 { format!("{:.2}", self.update / what) } else { "–".to_owned() };
        let mut cells =
            vec![self.count.to_string(), self.moving.to_string(), format!("{:.1}", self.update * 1e6)];
        cells.push(if self.moving > 0.0 { over(self.write) } else { "–".to_owned() });
        cells.extend([over(self.copy), over(self.scan[0])]);
        cells.extend([format!("{:.1}", self.worst_update / self.update), format!("{:.2}", self.ageing)]);
        cells.extend((0..3).map(|i| format!("{:.2}", self.query[i] / self.scan[i])));
        cells.extend(self.seen.map(|[scan, _]| format!("{scan:.4}")));
        cells.extend([self.tree_bytes, self.scene_bytes].map(|bytes| format!("{bytes:.0}")));
        cells
    }
}

/// Moves `moving` of `count` boxes for so many frames.
pub fn run(count: usize, moving: f64, frames: usize, tree: TreeConfig) -> Row {
    let mut load = Workload::new(count, moving);
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let ids: Vec<ObjectId> = load.boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
    scene.update();
    let mut copied = load.boxes.clone();
    let views = load.views().map(|(_, view)| view);
    let mut queries = views.map(Query::new);
    // A frame in which nothing moves takes less than the clock can tell.
    let repeat = if moving == 0.0 { 64 } else { 1 };
    let (mut write, mut copy, mut update) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..WARM_UP + frames {
        if frame == WARM_UP {
            write.clear();
            copy.clear();
            update.clear();
        }
        write.push(seconds(1, || {
            load.step();
            black_box(&load.boxes);
        }));
        copy.push(seconds(1, || yardstick::copy(black_box(&load.boxes), black_box(&mut copied))));
        update.push(seconds(repeat, || {
            scene.sync_moved(ids.iter().copied().zip(load.moved().iter().copied()));
            scene.adapt::<tercet::Culler<tercet::policy::FrustumOnly>>([]);
        }));
        if frame >= WARM_UP && frame % 8 == 0 {
            queries.iter_mut().for_each(|query| query.run(&scene, &load.boxes));
        }
    }
    let tenth = (frames / 10).max(1);
    Row {
        count,
        moving,
        write: median(&write),
        copy: median(&copy),
        update: median(&update),
        worst_update: update.iter().copied().fold(0.0, f64::max),
        ageing: median(&update[frames - tenth..]) / median(&update[..tenth]),
        scan: queries.each_ref().map(|q| median(&q.scans)),
        query: queries.each_ref().map(|q| median(&q.walks)),
        seen: queries.each_ref().map(|q| q.seen.map(|n| n as f64 / count as f64)),
        tree_bytes: scene.tree().bytes() as f64 / count as f64,
        scene_bytes: scene.bytes() as f64 / count as f64,
    }
}

/// One view, by the scan and by the tree.
struct Query {
    view: View,
    scans: Vec<f64>,
    walks: Vec<f64>,
    seen: [usize; 2],
}

impl Query {
    fn new(view: View) -> Self {
        Self { view, scans: Vec::new(), walks: Vec::new(), seen: [0; 2] }
    }

    fn run(&mut self, scene: &Scene, boxes: &[Aabb]) {
        let mut scan = Scan::new(boxes);
        scan.run(&self.view);
        self.scans.push(seconds(4, || scan.run(black_box(&self.view))));
        let frustum = Frustum::new(&self.view);
        let eye = self.view.eye();
        let (mut walk, mut found) = (Walk::new(), Vec::new());
        self.walks.push(seconds(4, || {
            found.clear();
            walk.run(scene.tree(), black_box(&frustum), eye, |_, lanes| found.push(lanes));
            black_box(&found);
        }));
        self.seen = [scan.count(), found.iter().map(|bits: &u16| bits.count_ones() as usize).sum()];
        assert!(self.seen[1] >= self.seen[0], "the tree finds all that the scan finds: {:?}", self.seen);
    }
}
