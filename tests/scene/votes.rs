//! How a tree adapts to what views have seen.

use glam::Vec3;
use tercet::geom::Aabb;
use tercet::scene::{Scene, SceneConfig, Traits};
use tercet::tree::{TreeConfig, Votes};
use tercet::{Costs, Voter};

/// What a view has to say, made up.
pub(super) struct Ballot(pub(super) Votes);

impl Voter for Ballot {
    fn votes(&self) -> &Votes {
        &self.0
    }

    fn votes_mut(&mut self) -> &mut Votes {
        &mut self.0
    }
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
