//! NOHC: a question is asked where it is expected to save more than it costs.

use tercet::policy::{Nohc, Policy};

use super::script::Script;

const ZERO: &[&str] = &["0123", "01", "0"];

fn not_worth(policy: &Nohc) -> u32 {
    policy.counters().iter().find(|c| c.key == "not_worth_asking").expect("it counts that").count
}

/// A policy for which questions cost so much.
fn nohc(caution: f32) -> Nohc {
    let mut policy = Nohc::default();
    policy.caution = caution;
    policy
}

/// Of new nodes an even share is taken to be hidden.
#[test]
fn what_nobody_knows_is_asked_about_if_an_even_chance_pays() {
    let mut script = Script::row(4);
    // What an inner node can save are the questions about its two children: no more than its own.
    let told = script.frame(&mut nohc(0.5), ZERO);
    assert_eq!(told, "ask 0, ask 1, ask 23, wait, draw 0");
}

/// A question that costs more than all the objects it may hide is not asked.
#[test]
fn where_questions_are_dear_everything_is_drawn() {
    let (mut script, mut policy) = (Script::row(4), nohc(1000.0));
    for _ in 0..20 {
        assert_eq!(script.frame(&mut policy, ZERO), "draw 0, draw 1, draw 2, draw 3");
        assert!(not_worth(&policy) >= 4);
    }
}

/// Hidden nodes stay hidden with a probability of nine in ten to begin with: they are asked about.
#[test]
fn what_was_hidden_is_asked_about_and_awaited() {
    let (mut script, mut policy) = (Script::row(4), nohc(0.5));
    script.frame(&mut policy, ZERO);
    let told = script.frame(&mut policy, ZERO);
    assert!(told.contains("ask 1") && told.contains("ask 23") && told.ends_with("wait"), "{told}");
    assert!(told.contains("draw 0") && !told.contains("draw 1"), "{told}");
}

/// The longer nobody looked, the likelier it is that a leaf has become hidden.
#[test]
fn a_visible_leaf_is_asked_about_again_when_it_may_well_be_hidden() {
    let (mut script, mut policy) = (Script::row(4), nohc(0.5));
    let frames: Vec<String> = (0..60).map(|_| script.frame(&mut policy, ZERO)).collect();
    assert!(frames.iter().all(|told| told.contains("draw 0")), "{frames:?}");
    let asked: Vec<usize> = (1..60).filter(|&n| frames[n].split(", ").any(|step| step == "ask 0")).collect();
    assert!((2..40).contains(&asked.len()), "{asked:?}");
    // It hardly ever becomes hidden, so the questions get rarer.
    let gaps: Vec<usize> = asked.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.last() > gaps.first(), "{gaps:?}");
}

/// What a visible leaf's answer says decides how the next frame begins.
#[test]
fn a_leaf_that_was_found_hidden_is_drawn_in_this_frame_and_not_in_the_next() {
    let (mut script, mut policy) = (Script::row(4), nohc(0.01));
    script.frame(&mut policy, ZERO);
    let hidden = script.frame(&mut policy, &[]);
    assert!(hidden.contains("ask 0, draw 0"), "{hidden}");
    assert!(!script.frame(&mut policy, &[]).contains("draw"), "it was asked about and is hidden");
}

/// A lost answer draws, and teaches nothing.
#[test]
fn what_an_answer_is_lost_for_is_drawn() {
    let (mut script, mut policy) = (Script::row(4), nohc(0.5));
    script.frame(&mut policy, ZERO);
    script.lost = &["1"];
    let told = script.frame(&mut policy, ZERO);
    assert!(told.ends_with("draw 1"), "{told}");
}
