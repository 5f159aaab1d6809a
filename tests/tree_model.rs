//! Random edits, votes and moves against a brute-force model of the scene; every invariant of the
//! tree is checked after each step.

use std::collections::BTreeMap;

use glam::Vec3;
use proptest::prelude::*;
use tercet::geom::{Aabb, Frustum, View, Viewport, projection};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{LANES, SplitAxis, SplitPlane, Straddlers, TightBoxes, TreeConfig, Votes, Walk};
use tercet::{Costs, Voter};

/// One step of a test. Indices are taken modulo what there is.
#[derive(Clone, Debug)]
enum Op {
    Insert(Aabb),
    /// Many at once: what the bulk build is for.
    Flood(Vec<Aabb>),
    Move(usize, Aabb),
    /// A small step: mostly stays in its cell.
    Nudge(usize, Vec3),
    Remove(usize),
    /// Objects move, and every third time another one goes, all between two updates.
    Rush(Vec<(usize, Vec3)>),
    /// All but a few objects go: nodes thin out, the root may shrink.
    Purge(usize),
    /// Dual answers for every leaf, from a seed; then the tree adapts.
    Vote(u32),
    /// Frames in which nothing happens.
    Rest(u8),
}

struct Ballot(Votes);

impl Voter for Ballot {
    fn votes(&self) -> &Votes {
        &self.0
    }

    fn votes_mut(&mut self) -> &mut Votes {
        &mut self.0
    }
}

/// Coordinates that lie close together, far out, on round numbers (planes) and at random.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -50.0f32..50.0,
        3 => (-8i32..=8).prop_map(|i| i as f32),
        1 => prop_oneof![Just(0.0f32), Just(1e7), Just(-1e7), Just(1e-6), Just(3e30), Just(f32::MAX)],
    ]
}

fn extent() -> impl Strategy<Value = f32> {
    prop_oneof![
        5 => 0.0f32..4.0,
        2 => Just(0.0f32),
        1 => 10.0f32..200.0,
        1 => Just(1e-6f32),
    ]
}

fn aabb() -> impl Strategy<Value = Aabb> {
    let v3 = || [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from);
    (v3(), [extent(), extent(), extent()].prop_map(Vec3::from))
        .prop_map(|(min, size)| Aabb::new(min, (min + size).min(Vec3::MAX)))
}

fn step() -> impl Strategy<Value = Vec3> {
    [-0.5f32..0.5, -0.5f32..0.5, -0.5f32..0.5].prop_map(Vec3::from)
}

fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        4 => aabb().prop_map(Op::Insert),
        1 => prop::collection::vec(aabb(), 1..120).prop_map(Op::Flood),
        1 => (aabb(), 2usize..80).prop_map(|(b, n)| Op::Flood(vec![b; n])),
        4 => (any::<usize>(), aabb()).prop_map(|(i, b)| Op::Move(i, b)),
        4 => (any::<usize>(), step()).prop_map(|(i, d)| Op::Nudge(i, d)),
        2 => any::<usize>().prop_map(Op::Remove),
        2 => prop::collection::vec((any::<usize>(), step()), 1..60).prop_map(Op::Rush),
        1 => (0usize..6).prop_map(Op::Purge),
        3 => any::<u32>().prop_map(Op::Vote),
        1 => (1u8..20).prop_map(Op::Rest),
    ]
}

fn config() -> impl Strategy<Value = TreeConfig> {
    let dials = (
        prop_oneof![Just(SplitAxis::Longest), Just(SplitAxis::ViewAligned)],
        prop_oneof![Just(SplitPlane::Middle), Just(SplitPlane::SurfaceArea)],
        prop_oneof![Just(Straddlers::Leaf), Just(Straddlers::Split), Just(Straddlers::StayInParent)],
        prop_oneof![Just(TightBoxes::Never), Just(TightBoxes::Settled), Just(TightBoxes::Always)],
        1u32..12,
        prop_oneof![Just(1u32), 1u32..64],
        any::<bool>(),
    );
    dials.prop_map(|(axis, plane, straddlers, tight_boxes, bulk_leaf, unasked_leaf, published)| TreeConfig {
        axis,
        plane,
        straddlers,
        tight_boxes,
        bulk_leaf,
        unasked_leaf,
        idle_frames: 10,
        ..if published { TreeConfig::paper() } else { TreeConfig::stable() }
    })
}

/// The scene and what it should hold.
struct Tested {
    scene: Scene,
    model: BTreeMap<ObjectId, Aabb>,
}

impl Tested {
    fn insert(&mut self, aabb: Aabb) {
        let id = self.scene.insert(aabb, Traits::default());
        assert!(self.model.insert(id, aabb).is_none(), "a handle was given out twice");
    }

    fn nth(&self, i: usize) -> Option<(ObjectId, Aabb)> {
        let n = self.model.len();
        (n > 0).then(|| self.model.iter().nth(i % n).map(|(&id, &b)| (id, b))).flatten()
    }

    fn set(&mut self, id: ObjectId, aabb: Aabb) {
        assert!(self.scene.set_bounds(id, aabb));
        self.model.insert(id, aabb);
    }

    fn remove(&mut self, id: ObjectId) {
        assert!(self.scene.remove(id));
        assert!(!self.scene.remove(id), "a removed handle is not valid");
        self.model.remove(&id);
    }

    fn nudge(&mut self, i: usize, d: Vec3) {
        if let Some((id, b)) = self.nth(i) {
            let moved = Aabb::new(b.min + d, b.max + d);
            self.set(id, if moved.is_valid() { moved } else { b });
        }
    }

    fn remove_nth(&mut self, i: usize) {
        if let Some((id, _)) = self.nth(i) {
            self.remove(id);
        }
    }

    fn apply(&mut self, op: &Op) {
        match op {
            Op::Insert(b) => self.insert(*b),
            Op::Flood(boxes) => boxes.iter().for_each(|b| self.insert(*b)),
            Op::Move(i, b) => {
                if let Some((id, _)) = self.nth(*i) {
                    self.set(id, *b);
                }
            }
            Op::Nudge(i, d) => self.nudge(*i, *d),
            Op::Remove(i) => self.remove_nth(*i),
            Op::Rush(steps) => {
                for (n, &(i, d)) in steps.iter().enumerate() {
                    self.nudge(i, d);
                    if n % 3 == 0 {
                        self.remove_nth(i / 2);
                    }
                }
            }
            Op::Purge(keep) => {
                while self.model.len() > *keep {
                    let id = *self.model.keys().next().expect("not empty");
                    self.remove(id);
                }
            }
            Op::Vote(seed) => {
                self.scene.update();
                self.vote(*seed);
            }
            Op::Rest(frames) => {
                for _ in 0..*frames {
                    self.scene.update();
                    self.vote(0);
                }
            }
        }
        self.scene.update();
    }

    /// Answers about each leaf: all visible, all hidden, or a share, by the bits of the seed.
    fn vote(&mut self, seed: u32) {
        let costs = Costs::of((seed % 11) as f32);
        let mut ballot = Ballot(Votes { forward: Vec3::new(0.3, -0.2, -0.9), costs, ..Votes::default() });
        for (i, node) in self.scene.tree().nodes().enumerate() {
            if node.is_leaf && seed != 0 {
                let share = seed.rotate_left(3 * i as u32) % 5;
                match share {
                    4 => ballot.0.near(node.id),
                    _ => ballot.0.count(node.id, 25 * share, 100),
                }
            }
        }
        self.scene.adapt([&mut ballot]);
        assert!(ballot.0.votes.is_empty(), "votes are used up");
        self.scene.tree().validate().expect("valid after adapting");
    }

    fn check(&self) {
        let tree = self.scene.tree();
        tree.validate().expect("a valid tree");
        assert_eq!(tree.len(), self.model.len());
        assert_eq!(self.scene.len(), self.model.len());
        for (&id, aabb) in &self.model {
            let object = self.scene.object(id).expect("a live object");
            assert_eq!(object.bounds, Some(*aabb));
        }
        self.check_boxes(tree.root());
    }

    /// The box that a question about a node asks holds all that is below, whatever the dials.
    fn check_boxes(&self, root: tercet::tree::NodeId) {
        let tree = self.scene.tree();
        let mut stack = vec![(root, Vec::new())];
        while let Some((node, above)) = stack.pop() {
            let mut boxes: Vec<Aabb> = above;
            boxes.push(tree.query_box(node));
            for (_, aabb) in tree.own_objects(node) {
                assert!(boxes.iter().all(|b| b.contains(&aabb)), "an object sticks out of a question's box");
            }
            stack.extend(tree.children(node).into_iter().flatten().map(|c| (c, boxes.clone())));
        }
    }
}

proptest! {
    #[test]
    fn the_tree_agrees_with_a_list(config in config(), ops in prop::collection::vec(op(), 1..40)) {
        let scene = Scene::new(SceneConfig { tree: config, ..SceneConfig::default() });
        let mut tested = Tested { scene, model: BTreeMap::new() };
        for op in &ops {
            tested.apply(op);
            tested.check();
        }
    }
}

/// A thousand objects at one point cannot be separated: one leaf holds them, and nothing loops.
#[test]
fn coincident_objects_share_a_leaf() {
    for straddlers in [Straddlers::Leaf, Straddlers::Split, Straddlers::StayInParent] {
        let tree = TreeConfig { straddlers, ..TreeConfig::default() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        for _ in 0..1000 {
            scene.insert(Aabb::new(Vec3::ONE, Vec3::ONE), Traits::default());
        }
        scene.update();
        scene.tree().validate().expect("a valid tree");
        assert_eq!(scene.tree().stats().nodes, 1);
    }
}

/// Objects that could not be told apart can be once they have moved.
#[test]
fn coincident_objects_that_spread_are_separated() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let ids: Vec<_> =
        (0..1000).map(|_| scene.insert(Aabb::new(Vec3::ONE, Vec3::ONE), Traits::default())).collect();
    scene.update();
    assert_eq!(scene.tree().stats().nodes, 1);
    for step in 1..=4 {
        for (i, &id) in ids.iter().enumerate() {
            let at = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * step as f32;
            scene.set_bounds(id, Aabb::from_center(at, Vec3::splat(0.1)));
        }
        scene.update();
        scene.tree().validate().expect("a valid tree");
    }
    assert!(scene.tree().stats().nodes > 500, "{:?}", scene.tree().stats());
}

/// The content epoch of every node above an object changes when it moves, and of no other.
#[test]
fn epochs_follow_what_moves() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let at = |i: usize, z: f32| Aabb::from_center(Vec3::new(i as f32 * 4.0, 0.0, z), Vec3::ONE);
    let ids: Vec<_> = (0..64).map(|i| scene.insert(at(i, 0.0), Traits::default())).collect();
    scene.update();
    let epochs = |scene: &Scene| -> Vec<_> {
        let tree = scene.tree();
        tree.nodes().map(|n| (n.bounds, tree.epoch(n.id), tree.is_settled(n.id))).collect()
    };
    let before = epochs(&scene);
    scene.set_bounds(ids[20], at(20, 0.0));
    scene.update();
    for (old, new) in before.iter().zip(epochs(&scene)) {
        let above = old.0.contains(&at(20, 0.0));
        assert_eq!(new.1 != old.1, above, "{:?}", old.0);
        assert!(!(above && new.2), "what has just moved is not settled");
    }
    for _ in 0..scene.tree().config().settle_frames {
        scene.update();
    }
    assert!(epochs(&scene).iter().all(|e| e.2), "at rest, everything settles");
}

/// A world that has moved far away and gathered there does not keep the depth of its journey.
#[test]
fn the_root_grows_and_shrinks_again() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let at = |p: Vec3, i: usize| {
        Aabb::from_center(p + Vec3::new((i % 10) as f32, (i / 10) as f32, 0.0) * 3.0, Vec3::splat(0.5))
    };
    let ids: Vec<_> = (0..200).map(|i| scene.insert(at(Vec3::ZERO, i), Traits::default())).collect();
    scene.update();
    let depth = scene.tree().stats().depth;
    let journey = [Vec3::X * 1e6, Vec3::new(-1e7, 1e7, 3.0), Vec3::splat(-5e6), Vec3::ZERO];
    for to in journey {
        for (i, &id) in ids.iter().enumerate() {
            scene.set_bounds(id, at(to, i));
            if i % 50 == 0 {
                scene.update();
                scene.tree().validate().expect("valid on the way");
            }
        }
        scene.update();
        scene.tree().validate().expect("valid on arrival");
    }
    let after = scene.tree().stats();
    assert!(after.depth <= depth + 60, "depth {depth} became {}", after.depth);
}

/// The default tree, with leaves as fine before the first question as after it.
fn fine() -> TreeConfig {
    TreeConfig { unasked_leaf: 2, ..TreeConfig::default() }
}

/// Objects in a row, 10 m apart.
fn row(count: usize, tree: TreeConfig) -> Scene {
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    for i in 0..count {
        let center = Vec3::new(i as f32 * 10.0, 0.0, 0.0);
        scene.insert(Aabb::from_center(center, Vec3::ONE), Traits::default());
    }
    scene.update();
    scene
}

/// A view along x that saw `visible` per cent of every leaf.
fn ballot(scene: &Scene, visible: u32) -> Ballot {
    let mut ballot = Ballot(Votes { forward: Vec3::X, ..Votes::default() });
    let leaves = scene.tree().nodes().filter(|n| n.is_leaf);
    leaves.for_each(|leaf| ballot.0.count(leaf.id, visible, 100));
    ballot
}

/// The published constants split a visible leaf of twelve and merge three siblings of five.
#[test]
fn the_published_rule_splits_and_merges() {
    let mut scene = row(12, TreeConfig::paper());
    assert_eq!(scene.tree().stats().nodes, 1, "twelve fit the bulk build's leaf");
    let vote = |scene: &mut Scene, visible: u32| {
        scene.adapt([&mut ballot(scene, visible)]);
        scene.update();
        scene.tree().validate().expect("a valid tree");
        scene.tree().stats()
    };
    assert_eq!(vote(&mut scene, 24).splits, 0, "24 % is below R_split");
    assert_eq!(vote(&mut scene, 25).splits, 1, "25 % of a leaf of twelve splits it");
    assert_eq!(vote(&mut scene, 10).merges, 0, "six objects in a child are above O_merge");
}

/// A merge needs every view that sees the leaves to agree.
#[test]
fn one_dissenting_view_prevents_a_merge() {
    let tree = TreeConfig { o_merge: 50, cooldown: 0, merge_below_split: false, ..TreeConfig::paper() };
    let mut scene = row(12, tree);
    let mut split = ballot(&scene, 100);
    scene.adapt([&mut split]);
    assert_eq!(scene.tree().stats().splits, 1);
    // Below twelve objects a leaf, nothing splits further: only the merge is at stake.
    scene.update();
    let (mut hidden, mut visible) = (ballot(&scene, 0), ballot(&scene, 100));
    scene.adapt([&mut hidden, &mut visible]);
    assert_eq!(scene.tree().stats().merges, 0, "one view sees the leaves fully");
    scene.update();
    let (mut hidden, mut also_hidden) = (ballot(&scene, 0), ballot(&scene, 0));
    scene.adapt([&mut hidden, &mut also_hidden]);
    assert_eq!(scene.tree().stats().merges, 1, "both views agree");
    assert_eq!(scene.tree().stats().flips, 1, "merged right after the split");
}

/// Where questions are dear, leaves hold more objects; the cheapest view decides.
#[test]
fn leaves_are_as_large_as_the_costs_ask_for() {
    let mut scene = row(64, TreeConfig::default());
    let at_cost = |scene: &Scene, objects: f32| {
        let mut ballot = ballot(scene, 100);
        ballot.0.costs = Costs::of(objects);
        ballot
    };
    let mut settle = |costs: &[f32]| {
        for _ in 0..200 {
            let mut ballots: Vec<_> = costs.iter().map(|&c| at_cost(&scene, c)).collect();
            scene.adapt(&mut ballots);
            scene.update();
            scene.tree().validate().expect("a valid tree");
        }
        let leaves = scene.tree().nodes().filter(|n| n.is_leaf && n.own > 0);
        let leaves: Vec<_> = leaves.map(|n| n.own).collect();
        let stats = scene.tree().stats();
        (64.0 / leaves.len() as f32, leaves.into_iter().max(), stats.splits + stats.merges)
    };
    let (mean, most, _) = settle(&[0.1]);
    assert!(mean < 1.5 && most <= Some(2), "questions cost nearly nothing: {mean} a leaf");
    let (mean, most, changes) = settle(&[6.0]);
    assert!(mean >= 6.0 && most < Some(24), "O_split is 24: {mean} a leaf, {most:?} at most");
    assert_eq!(settle(&[6.0]).2, changes, "and there it stays");
    assert_eq!(settle(&[6.5]).2, changes, "a little more or less changes nothing");
    let (mean, ..) = settle(&[6.0, 0.1]);
    assert!(mean < 1.5, "one view asks at nearly no cost: {mean} a leaf");
}

/// A tree that nobody asks anything stays coarse; the first view that asks makes it fine at once.
#[test]
fn the_first_view_that_asks_refines_the_tree() {
    let mut scene = row(4000, TreeConfig::default());
    for _ in 0..3 {
        scene.adapt([&mut Ballot(Votes::default())]);
        scene.update();
    }
    let unasked = scene.tree().stats().nodes;
    assert!((2..200).contains(&unasked), "{unasked} nodes, none of which was asked about");
    scene.adapt([&mut Ballot(Votes { asks: true, ..Votes::default() })]);
    scene.tree().validate().expect("a valid tree");
    let leaves = scene.tree().nodes().filter(|n| n.is_leaf);
    assert_eq!(leaves.map(|n| n.own).max(), Some(2), "even a view that had nothing to ask counts");
}

/// What a view may see by the tree is what it may see by looking at each object.
#[test]
fn a_walk_finds_what_the_frustum_meets() {
    for tree in [
        TreeConfig::default(),
        fine(),
        TreeConfig::paper(),
        TreeConfig { straddlers: Straddlers::StayInParent, ..fine() },
    ] {
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let at = |i: usize| Vec3::new((i * 7 % 41) as f32, (i * 11 % 37) as f32, (i * 13 % 43) as f32) - 20.0;
        let boxes: Vec<_> =
            (0..3000).map(|i| Aabb::from_center(at(i), Vec3::splat(0.2 + (i % 9) as f32 * 0.2))).collect();
        let ids: Vec<_> = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
        scene.update();
        let viewport = Viewport::new(640, 360);
        let upright =
            View::look_at(Vec3::new(3.0, 1.0, 25.0), Vec3::ZERO, 40.0, 0.1, viewport).expect("a view");
        let flat = projection::orthographic(20.0, 9.0, 0.1, 30.0);
        let flat = View::new(upright.view_from_world(), flat, viewport).expect("a view");
        for view in [upright, flat] {
            let frustum = Frustum::new(&view);
            let mut found = Vec::new();
            Walk::new().run(scene.tree(), &frustum, view.eye(), |block, lanes| {
                let lanes = (0..LANES).filter(|lane| lanes & (1 << lane) != 0);
                found.extend(lanes.map(|lane| block.slots[lane] as usize));
            });
            found.sort_unstable();
            let met = ids.iter().zip(&boxes).filter(|(_, b)| frustum.intersects(b));
            let met: Vec<_> = met.map(|(id, _)| id.slot()).collect();
            assert!(met.len() > 50 && met.len() < 2500, "{} of 3000", met.len());
            assert_eq!(found, met);
        }
    }
}
