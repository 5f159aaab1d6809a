//! A world that never rests, for as long as you like: what the engine holds is bounded by what is there,
//! not by what has been.
//!
//! Every frame objects are spawned, moved, thrown, despawned, respawned at once, spoiled and mended; three
//! views of one scene cull it, and cut now and then. `TERCET_FRAMES` sets the number of frames.

#[path = "../support/boxes.rs"]
mod boxes;
mod churn;

use std::alloc::System;

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use tercet::Culler;
use tercet::policy::{self, Policy};
use tercet::query::oracle::Oracle;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::tree::{LeafSize, TreeConfig};

use boxes::draw;
use churn::Churn;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Nodes of a tree over `n` objects, at most: a split separates something, but for those by which the root
/// grows, up to the farthest object.
fn most_nodes(n: usize) -> usize {
    3 * (n + most_depth())
}

/// Depth, at most: on each axis, how often the farthest reach is halved to the size of the smallest object.
fn most_depth() -> usize {
    3 * (churn::FARTHEST / churn::SMALLEST).log2().ceil() as usize
}

/// What all that is alive takes, bytes.
fn live_bytes() -> usize {
    let stats = ALLOCATOR.stats();
    stats.bytes_allocated - stats.bytes_deallocated
}

struct View {
    eye: Culler<Box<dyn Policy>>,
    queries: SoftwareQueries,
    /// Objects drawn, over all frames.
    drawn: usize,
}

/// Frames before memory is looked at: lists grow to what they need.
const WARM_UP: u32 = 2000;

/// The greatest of what was seen since it was last reset.
#[derive(Clone, Copy, Debug, Default)]
struct Most {
    bytes: usize,
    nodes: usize,
    depth: usize,
    slots: usize,
}

/// One test: memory is counted for the whole process.
#[test]
fn what_is_held_is_bounded_by_what_is_there() {
    let frames: u32 = std::env::var("TERCET_FRAMES").map_or(2000, |n| n.parse().expect("a whole number"));
    // Threads that hand work to each other take memory now and then, which is not ours.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| soak(frames));
}

fn soak(frames: u32) {
    let frames = WARM_UP + frames;
    let mut churn = Churn::new(1);
    // Fine leaves, whatever asking costs on this machine.
    let tree = TreeConfig { leaf_size: LeafSize::Fixed, ..TreeConfig::default() };
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let mut views = ["dual-query", "chc++", "hybrid"].map(|name| View {
        eye: Culler::new(policy::by_name(name).expect("a policy of that name")),
        queries: SoftwareQueries::new(),
        drawn: 0,
    });
    let mut oracle = Oracle::new();
    // The most of each quarter.
    let mut quarters = [Most::default(); 4];
    let (mut visible, mut culled) = (0, 0);
    for frame in 0..frames {
        churn.change();
        scene.sync(&churn.world);
        let view = churn.look(frame);
        let is_checked = frame % 50 == 0;
        if is_checked {
            scene.tree().validate().expect("a valid tree");
        }
        // What the oracle knows is gone by the time that memory is counted.
        let truth = is_checked.then(|| {
            oracle.look(&scene, &view, |pass, objects| draw(&churn.world, pass, objects)).expect("a look")
        });
        for View { eye, queries, drawn } in &mut views {
            if churn.is_cut(frame) {
                eye.cut();
            }
            let stats = eye
                .frame(&scene, &view, queries, |pass, objects| draw(&churn.world, pass, objects))
                .expect("a frame");
            *drawn += stats.drawn as usize;
            let Some(truth) = &truth else { continue };
            let shown: Vec<_> = eye.visible().iter().map(|object| object.id).collect();
            for object in scene.objects() {
                let id = object.object.id;
                let is_lost = truth.exact.contains(id) && !shown.contains(&id);
                assert!(!is_lost, "{} lost {id:?} in frame {frame}", eye.policy().name());
            }
            let is_shown = |slot: &usize| shown.iter().any(|id| id.slot() == *slot);
            visible += truth.exact.len();
            culled += truth.in_frustum.slots().filter(|slot| !is_shown(slot)).count();
        }
        drop(truth);
        scene.adapt(views.iter_mut().map(|view| &mut view.eye));
        let Some(after) = frame.checked_sub(WARM_UP) else { continue };
        let most = &mut quarters[(4 * u64::from(after) / u64::from(frames - WARM_UP)) as usize];
        most.bytes = most.bytes.max(live_bytes());
        most.nodes = most.nodes.max(scene.tree().stats().nodes);
        most.depth = most.depth.max(scene.tree().stats().depth);
        most.slots = most.slots.max(scene.slot_bound());
    }
    scene.tree().validate().expect("a valid tree");
    for (i, most) in quarters.iter().enumerate() {
        println!("quarter {}: at most {most:?}", i + 1);
    }
    println!("{churn:?}, {} objects now, {:?}", scene.len(), scene.tree().stats());
    println!("{visible} visible objects looked for, {culled} culled in those frames");
    let n = churn::MOST;
    for most in quarters {
        assert!(most.nodes <= most_nodes(n) && most.depth <= most_depth(), "{most:?}");
        // Slots are given out again.
        assert!(most.slots <= n + churn::SPAWNED_AT_ONCE, "{most:?}");
    }
    // Lists that are as full as never before double, the tree's log of edits among them. In 100 000 frames,
    // 16 bytes a frame that are never given back are more than this allows.
    let (early, late) = (quarters[0].bytes, quarters[3].bytes);
    assert!(late <= early + early / 8 + (512 << 10), "from {early} bytes to {late}");
    assert!(culled > 0 && visible > 0 && views.iter().all(|view| view.drawn > 0));
}
