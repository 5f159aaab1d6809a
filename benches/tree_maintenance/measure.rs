//! The tree and its yardsticks, frame by frame in turns: whatever slows the machine slows both.

use std::hint::black_box;

use tercet::geom::{Aabb, Frustum, View};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{TreeConfig, Votes, Walk};

use crate::clock::{median, seconds};
use crate::workload::{Manner, Workload};
use crate::yardstick::{self, Reads, Scan};

/// Frames before the measurement: the first ones build, and make room.
const WARM_UP: usize = 20;

/// Who asks the tree about its nodes.
#[derive(Clone, Copy, PartialEq)]
pub enum Asking {
    /// Nobody: leaves stay coarse.
    Nobody,
    /// One view did, once: leaves are fine, and stay as they are.
    Once,
    /// One view, each frame, about each leaf that its frustum meets: the tree adapts.
    EachFrame,
}

/// What is measured.
pub struct Case {
    pub name: String,
    pub count: usize,
    pub moving: f64,
    pub manner: Manner,
    pub asking: Asking,
    pub frames: usize,
    /// The same frames again so many times: what counts of each frame is its least time, for what
    /// others on the machine add is not the tree's.
    pub runs: usize,
}

/// What it came to: medians over the frames, in seconds; queries by view: wide, mid, near.
pub struct Row {
    pub case: Case,
    pub write: f64,
    pub copy: f64,
    /// Of half a line of memory for each mover, in no order.
    pub reads: f64,
    pub update: f64,
    pub worst_update: f64,
    /// Of the last tenth of the frames, over that of the first tenth.
    pub ageing: f64,
    pub scan: [f64; 3],
    pub query: [f64; 3],
    /// Shares of the objects: cut by a plane, and changing their node, of the movers, each frame.
    pub straddling: f64,
    pub leaving: f64,
    pub tree_bytes: f64,
    pub scene_bytes: f64,
}

/// The times of one run, and the scene at its end.
struct Run {
    /// Write, copy, update.
    times: [Vec<f64>; 3],
    /// Now and then.
    reads: Vec<f64>,
    queries: [Query; 3],
    scene: Scene,
}

/// Measures a case.
pub fn run(case: Case) -> Row {
    let mut all = once(&case);
    for _ in 1..case.runs {
        let again = once(&case);
        for (least, times) in all.times.iter_mut().zip(&again.times) {
            least.iter_mut().zip(times).for_each(|(least, &time)| *least = least.min(time));
        }
        all.reads.extend(again.reads);
        for (all, again) in all.queries.iter_mut().zip(again.queries) {
            all.scans.extend(again.scans);
            all.walks.extend(again.walks);
        }
    }
    let Run { times: [write, copy, update], reads, queries, scene } = all;
    let tenth = (case.frames / 10).max(1);
    let tree = scene.tree();
    let across: usize =
        tree.nodes().filter(|node| node.is_leaf && node.is_straddle).map(|node| node.own).sum();
    let moved = (case.frames + WARM_UP) as f64 * case.count as f64 * case.moving;
    Row {
        write: median(&write),
        copy: median(&copy),
        reads: median(&reads),
        update: median(&update),
        worst_update: update.iter().copied().fold(0.0, f64::max),
        ageing: median(&update[case.frames - tenth..]) / median(&update[..tenth]),
        scan: queries.each_ref().map(|q| median(&q.scans)),
        query: queries.each_ref().map(|q| median(&q.walks)),
        straddling: across as f64 / case.count as f64,
        leaving: if moved > 0.0 { tree.stats().moves as f64 / moved } else { 0.0 },
        tree_bytes: tree.bytes() as f64 / case.count as f64,
        scene_bytes: scene.bytes() as f64 / case.count as f64,
        case,
    }
}

fn once(case: &Case) -> Run {
    let mut load = Workload::new(case.count, case.moving, case.manner);
    let mut scene = Scene::new(SceneConfig { tree: TreeConfig::default(), ..SceneConfig::default() });
    let ids: Vec<ObjectId> = load.boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
    scene.update();
    let mut ballot = Ballot(Votes { asks: case.asking != Asking::Nobody, ..Votes::default() });
    scene.adapt([&mut ballot]);
    let mut copied = load.boxes.clone();
    let (reader, mut reads) = (Reads::new(load.moved().len()), Vec::new());
    let mut queries = load.views().map(|(_, view)| Query::new(view));
    // A frame in which nothing moves takes less than the clock can tell.
    let repeat = if case.moving == 0.0 { 64 } else { 1 };
    let mut times = [const { Vec::new() }; 3];
    for frame in 0..WARM_UP + case.frames {
        let write = seconds(1, || {
            load.step();
            black_box(&load.boxes);
        });
        let copy = seconds(1, || yardstick::copy(black_box(&load.boxes), black_box(&mut copied)));
        if case.asking == Asking::EachFrame {
            ballot.vote(&scene, &queries[1].view);
        }
        let update = seconds(repeat, || {
            scene.sync_moved(ids.iter().copied().zip(load.moved().iter().copied()));
            scene.adapt([&mut ballot]);
        });
        if frame >= WARM_UP {
            times.iter_mut().zip([write, copy, update]).for_each(|(times, time)| times.push(time));
            if frame % 8 == 0 {
                reads.push(seconds(1, || reader.run()));
                queries.iter_mut().for_each(|query| query.run(&scene, &load.boxes));
            }
        }
    }
    Run { times, reads, queries, scene }
}

/// A view's answers: each leaf that its frustum meets is seen in full.
struct Ballot(Votes);

impl Ballot {
    fn vote(&mut self, scene: &Scene, view: &View) {
        let frustum = Frustum::new(view);
        self.0.asks = true;
        let leaves = scene.tree().nodes().filter(|node| node.is_leaf && node.own > 0);
        let met = leaves.filter(|leaf| frustum.intersects(&leaf.bounds));
        met.for_each(|leaf| self.0.near(leaf.id));
    }
}

impl tercet::Voter for Ballot {
    fn votes(&self) -> &Votes {
        &self.0
    }

    fn votes_mut(&mut self) -> &mut Votes {
        &mut self.0
    }
}

/// One view, by the scan and by the tree.
struct Query {
    view: View,
    scans: Vec<f64>,
    walks: Vec<f64>,
}

impl Query {
    fn new(view: View) -> Self {
        Self { view, scans: Vec::new(), walks: Vec::new() }
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
        let seen: usize = found.iter().map(|bits: &u16| bits.count_ones() as usize).sum();
        assert!(seen >= scan.count(), "the tree finds all that the scan finds: {seen}");
    }
}
