//! One question for several nodes.

use tercet::Tradeoff;
use tercet::policy::{ChcPlusPlus, KeepRule, Policy};

use super::script::Script;

/// Batches and multiqueries, by the published formula.
fn multiqueries() -> ChcPlusPlus {
    let mut policy = ChcPlusPlus::default();
    (policy.n_av, policy.randomised, policy.tight) = (1, false, false);
    (policy.p_keep, policy.guess) = (KeepRule::Analytic, false);
    policy
}

fn counter(policy: &ChcPlusPlus, key: &str) -> u32 {
    policy.counters().iter().find(|counter| counter.key == key).expect("it counts that").count
}

/// Of eight objects in a row, number 0.
const ZERO: &[&str] = &["01234567", "0123", "01", "0"];

/// The row, and the policy after so many frames.
fn after(frames: usize, visible: &[&str]) -> (Script, ChcPlusPlus) {
    let (mut script, mut policy) = (Script::row(8), multiqueries());
    (0..frames).for_each(|_| drop(script.frame(&mut policy, visible)));
    (script, policy)
}

/// The trap: the formula as printed, which charges 1 + p_fail to a single node, would put all of these
/// into one question that is bound to fail: each has p_keep = 0.29.
#[test]
fn nodes_that_nobody_knows_are_asked_about_alone() {
    let first = Script::row(8).frame(&mut multiqueries(), ZERO);
    let expected = "ask 01234567, wait, ask 0123, ask 4567, wait, ask 01, ask 23, wait, \
                    ask 0, ask 1, wait, draw 0";
    assert_eq!(first, expected);
}

#[test]
fn nodes_that_stay_hidden_are_asked_about_together() {
    let (mut script, mut policy) = after(1, ZERO);
    // i = 1, p_keep = 0.732: V = 1, 2 / (1 + 0.463 · 2) = 1.04, 3 / (1 + 0.607 · 3) = 1.06.
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 1+23+4567, ask 0, wait");
    assert_eq!((counter(&policy, "multiqueries"), counter(&policy, "failed_multiqueries")), (1, 0));
    // All three are hidden by its one answer.
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 1+23+4567, ask 0, wait");
}

#[test]
fn a_failed_multiquery_hides_and_draws_nothing_and_is_repeated_node_by_node() {
    let (mut script, mut policy) = after(4, ZERO);
    let told = script.frame(&mut policy, &["01234567", "0123", "01", "0", "23", "3"]);
    let expected = "draw 0, ask 1+23+4567, ask 0, wait, ask 1, ask 23, ask 4567, wait, \
                    ask 2, ask 3, wait, draw 3";
    assert_eq!(told, expected);
    assert_eq!((counter(&policy, "multiqueries"), counter(&policy, "failed_multiqueries")), (1, 1));
}

/// Sorted by descending p_keep: who has been hidden for long comes first, the fickle are left out.
#[test]
fn the_likeliest_to_stay_hidden_come_first() {
    let (mut script, mut policy) = after(10, ZERO);
    let all = &["01234567", "0123", "01", "0", "1"];
    script.frame(&mut policy, all);
    script.frame(&mut policy, all);
    // 1 was visible, and is drawn once more.
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, draw 1, ask 23+4567, ask 0, ask 1, wait");
    // Hidden for one frame, it comes after those hidden for thirteen: 0.99, 0.99, 0.73.
    // V = 1, 2 / (1 + 0.02 · 2) = 1.92, 3 / (1 + 0.28 · 3) = 1.63: it is left out.
    assert_eq!(script.frame(&mut policy, ZERO), "draw 0, ask 23+4567, ask 1, ask 0, wait");
}

/// A lost answer draws whatever was asked about, at once.
#[test]
fn a_lost_multiquery_draws_them_all() {
    let (mut script, mut policy) = after(4, ZERO);
    script.lost = &["23"];
    let told = script.frame(&mut policy, ZERO);
    assert!(told.starts_with("draw 0, ask 1+23+4567, ask 0, wait, draw 1, ask 2, ask 3, ask 45, ask 67"));
    assert_eq!(counter(&policy, "failed_multiqueries"), 0, "nobody knows that it failed");
}

/// What was seen counts, and not the formula, once there is something.
#[test]
fn p_keep_is_measured() {
    // In turns: 23 never stays hidden for longer than two frames.
    let sight = |frame: usize| match frame % 3 {
        0 => &["01234567", "0123", "01", "0", "23", "2"][..],
        _ => ZERO,
    };
    let (mut script, mut policy) = (Script::row(8), multiqueries());
    policy.p_keep = KeepRule::Measured;
    let mut failed = Vec::new();
    for frame in 0..60 {
        let told = script.frame(&mut policy, sight(frame));
        failed.push(counter(&policy, "failed_multiqueries"));
        // That is learnt: what has been hidden for as long as 23 is asked about alone.
        if frame >= 12 && frame % 3 == 0 {
            assert!(told.starts_with("draw 0, ask 1+4567, ask 23, ask 0, wait, "), "{told}");
        }
    }
    assert!(failed[..12].iter().any(|&failed| failed > 0), "at first in vain: {failed:?}");
    assert!(failed[12..].iter().all(|&failed| failed == 0), "{failed:?}");
}

/// Something is seen of a node's box, and nothing of the boxes below it: left closed, it would fail
/// the others' question again and again.
#[test]
fn a_node_that_was_opened_in_vain_stays_open() {
    let (mut script, mut policy) = after(4, ZERO);
    policy.n_av = 3;
    let corner = &["01234567", "0123", "01", "0", "23"];
    let told = script.frame(&mut policy, corner);
    let expected = "draw 0, ask 1+23+4567, ask 0, wait, ask 1, ask 23, ask 4567, wait, ask 2, ask 3, wait";
    assert_eq!(told, expected);
    for i in 0..3 {
        let told = script.frame(&mut policy, corner);
        assert!(told.starts_with("draw 0, ask 1+4567") && !told.contains("23,"), "{i}: {told}");
    }
    let told = script.frame(&mut policy, corner);
    assert!(told.contains("23"), "then it is asked about as one again: {told}");
}

/// A multiquery under a threshold asks for a single sample; alone, the nodes are counted.
#[test]
fn a_threshold_decides_about_single_nodes() {
    let (mut script, mut policy) = after(4, ZERO);
    script.tradeoff = Tradeoff { visible_pixels: 3, ..Tradeoff::EXACT };
    let told = script.frame(&mut policy, &["01234567", "0123", "01", "0", "23"]);
    // Three samples of 23 are seen: not enough. Nor of 0, which was visible.
    assert_eq!(told, "draw 0, ask 1+23+4567, count 0, wait, count 1, count 23, count 4567, wait");
}
