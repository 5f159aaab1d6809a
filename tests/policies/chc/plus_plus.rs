//! The queues of CHC++, its tight volumes, and how its switches take it back to CHC.

use glam::Vec3;
use tercet::Tradeoff;
use tercet::geom::Aabb;
use tercet::policy::{Chc, ChcPlusPlus, Policy};
use tercet::tree::TreeConfig;

use super::script::{Arrival, Script, cube, fine};

/// Batches, and nothing else; visible leaves are asked about in every frame.
fn batching() -> ChcPlusPlus {
    let mut policy = ChcPlusPlus::default();
    (policy.n_av, policy.randomised, policy.tight, policy.multiqueries) = (1, false, false, false);
    (policy.regroup, policy.guess) = (false, false);
    policy
}

const ZERO: &[&str] = &["0123", "01", "0"];

#[test]
fn hidden_nodes_are_asked_about_in_batches_and_visible_leaves_while_they_are_awaited() {
    let (mut script, mut policy) = (Script::row(4), batching());
    script.frame(&mut policy, ZERO);
    // CHC: ask 0, draw 0, ask 1, ask 23, wait. Here everything is drawn before anything is asked, and
    // the leaf's question fills the wait of the others.
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 1, ask 23, ask 0, wait");
}

#[test]
fn a_full_batch_goes_out_before_the_walk_goes_on() {
    let (mut script, mut policy) = (Script::row(4), batching());
    policy.b = 1;
    script.frame(&mut policy, ZERO);
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 1, look, ask 23, ask 0, wait");
    // What arrives meanwhile is walked at once: 1 is drawn before 23 is asked about.
    script.arrival = Arrival::AtOnce;
    let told = script.frame(&mut policy, &["0123", "01", "0", "1"]);
    assert_eq!(told, "draw 0, ask 1, look, draw 1, ask 23, ask 0, wait");
    assert_eq!(policy.counters().iter().find(|c| c.key == "batches").map(|c| c.count), Some(2));
}

#[test]
fn visible_leaves_are_asked_about_at_the_end_if_there_is_nothing_to_wait_for() {
    let (mut script, mut policy) = (Script::row(4), batching());
    script.frame(&mut policy, &["0123", "01", "23", "0", "1", "2", "3"]);
    let told = script.frame(&mut policy, ZERO);
    assert_eq!(told, "draw 0, draw 1, draw 2, draw 3, ask 0, ask 1, ask 2, ask 3, wait");
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 1, ask 23, ask 0, wait");
}

/// With every optimisation off, it does what CHC does, step by step.
#[test]
fn without_its_optimisations_it_is_chc() {
    let mut chc = Chc::default();
    let mut policy = batching();
    policy.batching = false;
    // As published: CHC asks in the frame after n_av, CHC++ every n_av.
    (chc.n_av, policy.n_av) = (2, 3);
    let (mut one, mut other) = (Script::row(8), Script::row(8));
    let sights: [&[&str]; 4] = [
        &["01234567", "0123", "01", "0", "4567", "67", "6"],
        &["01234567", "0123", "01", "0", "1", "23", "3"],
        &["01234567", "4567", "67", "7"],
        &[],
    ];
    for arrival in [Arrival::WhenAwaited, Arrival::AtOnce, Arrival::Backwards] {
        (one.arrival, other.arrival) = (arrival, arrival);
        for frame in 0..40 {
            let visible = sights[frame / 5 % 4];
            assert_eq!(one.frame(&mut chc, visible), other.frame(&mut policy, visible), "frame {frame}");
        }
    }
}

#[test]
fn tight_volumes_are_the_boxes_of_descendants() {
    let mut policy = batching();
    (policy.tight, policy.virtual_leaf, policy.d_max) = (true, 0, 1);
    let mut script = Script::row(4);
    // The boxes of children are smaller than the one around them; a lone object has none below it.
    let told = script.frame(&mut policy, ZERO);
    assert_eq!(told, "ask 01+23, wait, ask 0+1, ask 2+3, wait, ask 0, ask 1, wait, draw 0");
    policy.reset();
    policy.d_max = 3;
    let told = script.frame(&mut policy, ZERO);
    assert_eq!(told, "ask 0+1+2+3, wait, ask 0+1, ask 2+3, wait, ask 0, ask 1, wait, draw 0");
    policy.reset();
    policy.s_max = 0.1;
    let told = script.frame(&mut policy, ZERO);
    assert_eq!(told, "ask 0123, wait, ask 01, ask 23, wait, ask 0, ask 1, wait, draw 0");
}

#[test]
fn a_leaf_is_asked_about_by_the_boxes_of_its_objects() {
    let mut policy = batching();
    policy.tight = true;
    let coarse = TreeConfig { bulk_leaf: 8, unasked_leaf: 8, ..fine() };
    let mut script = Script::new(coarse, &[cube(10.0), cube(20.0)]);
    assert_eq!(script.frame(&mut policy, &["#1"]), "ask #0+#1, wait, draw 01");
    assert_eq!(script.frame(&mut policy, &[]), "draw 01, ask #0+#1, wait");
    assert_eq!(script.frame(&mut policy, &[]), "ask #0+#1, wait");
    // A count is about one box.
    script.tradeoff = Tradeoff { visible_pixels: 1, ..Tradeoff::EXACT };
    assert_eq!(script.frame(&mut policy, &[]), "count 01, wait");
}

#[test]
fn virtual_leaves_are_asked_about_and_drawn_whole() {
    let mut policy = batching();
    (policy.tight, policy.virtual_leaf) = (true, 2);
    let mut script = Script::row(4);
    let told = script.frame(&mut policy, &["0"]);
    assert_eq!(told, "ask 0+1+2+3, wait, ask 0+1, ask 2+3, wait, draw 01 whole");
    assert_eq!(script.frame(&mut policy, &["0"]), "draw 01 whole, ask 2+3, ask 0+1, wait");
    // It grows to three objects, and is a leaf no longer: it was visible, and is opened.
    script.add(cube(12.5));
    script.scene.update();
    let told = script.frame(&mut policy, &["#0"]);
    assert_eq!(told, "ask #0+#4, ask 1, ask 2+3, wait, draw 04");
}

/// A node may surround the eye while the objects in it do not.
#[test]
fn tight_volumes_can_be_asked_about_around_the_eye() {
    let beside = |side: f32| Aabb::from_center(Vec3::new(6.0, 0.0, side), Vec3::splat(0.5));
    let behind = Aabb::from_center(Vec3::NEG_X * 6.0, Vec3::splat(0.5));
    let coarse = TreeConfig { bulk_leaf: 8, unasked_leaf: 8, ..fine() };
    let mut script = Script::new(coarse, &[beside(-2.0), beside(2.0), behind]);
    let mut policy = batching();
    assert_eq!(script.frame(&mut policy, &[]), "draw 012", "its box holds the eye");
    policy.tight = true;
    policy.reset();
    assert_eq!(script.frame(&mut policy, &[]), "ask #0+#1, wait", "number 2 is out of view");
    assert_eq!(script.frame(&mut policy, &["#1"]), "ask #0+#1, wait, draw 012");
}
