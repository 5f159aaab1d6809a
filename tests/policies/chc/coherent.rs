//! What CHC remembers of the last frame, and what it does not trust.

use glam::Vec3;
use tercet::Tradeoff;
use tercet::geom::Aabb;
use tercet::policy::{Chc, ChcPlusPlus, Policy};
use tercet::tree::{Straddlers, TreeConfig};

use super::script::{Arrival, Script, cube, fine, looking};

/// Visible leaves are asked about in every frame.
fn chc() -> Chc {
    let mut policy = Chc::default();
    policy.n_av = 0;
    policy
}

/// Objects 0 and 2 are visible, and so are the nodes that hold them.
const ZERO_AND_TWO: &[&str] = &["0123", "01", "23", "0", "2"];
const ZERO: &[&str] = &["0123", "01", "0"];

#[test]
fn the_first_frame_goes_down_from_the_root_and_awaits_each_answer() {
    let first = Script::row(4).frame(&mut chc(), ZERO);
    assert_eq!(first, "ask 0123, wait, ask 01, ask 23, wait, ask 0, ask 1, wait, draw 0");
}

#[test]
fn what_was_visible_is_drawn_without_an_answer_and_what_was_hidden_awaits_one() {
    let (mut script, mut chc) = (Script::row(4), chc());
    script.frame(&mut chc, ZERO);
    // 0123 and 01 were visible: opened without a question. 0 was visible: drawn before its answer is
    // there. 1 and 23 were hidden: asked again, and awaited.
    assert_eq!(script.frame(&mut chc, ZERO), "ask 0, draw 0, ask 1, ask 23, wait");
    // 23 has become visible: drawn in this very frame.
    let now = script.frame(&mut chc, ZERO_AND_TWO);
    assert_eq!(now, "ask 0, draw 0, ask 1, ask 23, wait, ask 2, ask 3, wait, draw 2");
}

#[test]
fn the_answer_about_a_visible_leaf_is_for_the_next_frame() {
    let (mut script, mut chc) = (Script::row(4), chc());
    script.frame(&mut chc, ZERO_AND_TWO);
    let before = "ask 0, draw 0, ask 1, ask 2, draw 2, ask 3, wait";
    assert_eq!(script.frame(&mut chc, ZERO_AND_TWO), before);
    // 0 has become hidden: drawn once more, and then no longer.
    assert_eq!(script.frame(&mut chc, &["0123", "23", "2"]), before);
    let after = script.frame(&mut chc, &["0123", "23", "2"]);
    assert_eq!(after, "ask 01, ask 2, draw 2, ask 3, wait");
}

#[test]
fn hidden_children_are_pulled_up_one_level_a_frame() {
    let (mut script, mut chc) = (Script::row(4), chc());
    script.frame(&mut chc, ZERO);
    assert_eq!(script.frame(&mut chc, &[]), "ask 0, draw 0, ask 1, ask 23, wait");
    // Nothing below 01 was visible, and nothing below the root: it is asked about as a whole.
    assert_eq!(script.frame(&mut chc, &[]), "ask 0123, wait");
    let counted = chc.counters().into_iter().find(|counter| counter.key == "pull_ups");
    assert_eq!(counted.expect("it counts them").count, 0, "no node was opened");
}

#[test]
fn answers_come_while_the_walk_goes_on() {
    let (mut script, mut chc) = (Script::row(4), chc());
    chc.in_flight = 1;
    script.arrival = Arrival::AtOnce;
    // 0 is drawn before anything farther is asked about.
    let first = script.frame(&mut chc, ZERO);
    assert_eq!(first, "ask 0123, wait, ask 01, look, ask 0, look, draw 0, ask 1, look, ask 23, wait");
    let second = script.frame(&mut chc, ZERO_AND_TWO);
    assert_eq!(second, "ask 0, draw 0, look, ask 1, look, ask 23, wait, ask 2, look, draw 2, ask 3, wait");
}

#[test]
fn the_order_of_answers_changes_nothing() {
    let (mut forth, mut back) = (Script::row(8), Script::row(8));
    back.arrival = Arrival::Backwards;
    let all = ["01234567", "0123", "4567", "01", "23", "45", "67", "0", "3", "4", "6"];
    let (mut a, mut b) = (chc(), chc());
    for visible in [&all[..], &all[..7], &all[..9], &all] {
        let sorted = |told: String| {
            let mut told: Vec<String> = told.split(", ").map(str::to_owned).collect();
            told.sort();
            told
        };
        assert_eq!(sorted(forth.frame(&mut a, visible)), sorted(back.frame(&mut b, visible)));
    }
}

#[test]
fn what_an_answer_is_lost_for_is_drawn_and_asked_about_again() {
    let (mut script, mut chc) = (Script::row(4), Chc::default());
    script.frame(&mut chc, ZERO);
    script.lost = &["1"];
    assert_eq!(script.frame(&mut chc, ZERO), "draw 0, ask 1, ask 23, wait, draw 1");
    // An answer would have been trusted for ten frames.
    assert_eq!(script.frame(&mut chc, ZERO), "draw 0, ask 1, draw 1, ask 23, wait");
    script.lost = &[];
    assert_eq!(script.frame(&mut chc, ZERO), "draw 0, ask 1, draw 1, ask 23, wait");
    assert_eq!(script.frame(&mut chc, ZERO), "draw 0, ask 1, ask 23, wait");
}

#[test]
fn what_was_out_of_view_was_not_visible() {
    let (mut script, mut chc) = (Script::row(4), Chc::default());
    script.frame(&mut chc, ZERO);
    assert_eq!(script.frame(&mut chc, ZERO), "draw 0, ask 1, ask 23, wait");
    script.view = looking(Vec3::NEG_X);
    assert_eq!(script.frame(&mut chc, &[]), "");
    script.view = looking(Vec3::X);
    // Not even within the frames for which 0 was to be assumed visible.
    let told = script.frame(&mut chc, &["0123", "01", "1"]);
    assert_eq!(told, "ask 0123, wait, ask 01, ask 23, wait, ask 0, ask 1, wait, draw 1");
}

#[test]
fn a_box_at_the_near_plane_is_visible_without_a_question() {
    let mut plus_plus = ChcPlusPlus::default();
    plus_plus.virtual_leaf = 0;
    for policy in [&mut Chc::default() as &mut dyn Policy, &mut plus_plus] {
        let mut script = Script::new(fine(), &[0.0, 10.0, 20.0, 30.0, 40.0].map(cube));
        let told = script.frame(policy, &[]);
        assert!(told.contains("draw 0") && !told.contains("ask 0"), "{told}");
        // The camera turns away within it.
        script.view = looking(Vec3::NEG_X);
        assert_eq!(script.frame(policy, &[]), "draw 0");
    }
}

#[test]
fn a_moved_object_is_asked_about_where_it_is() {
    for policy in [&mut chc() as &mut dyn Policy, &mut ChcPlusPlus::default()] {
        let mut script = Script::row(4);
        for _ in 0..3 {
            script.frame(policy, ZERO);
        }
        // From a node that is hidden to one that is visible, from there to a hidden one, and to where
        // nothing was.
        for x in [12.5, 28.0, 14.0, 100.0] {
            script.put(3, cube(x));
            let told = script.frame(policy, &["3", "13", "23", "03", "013", "123", "0123", "#3"]);
            let leaf = told.split(", ").find(|step| step.starts_with("draw") && step.contains('3'));
            assert!(leaf.is_some(), "{} at {x}: {told}", policy.name());
        }
    }
}

#[test]
fn what_a_visible_leaf_splits_into_was_visible() {
    let crowd = TreeConfig { bulk_leaf: 8, unasked_leaf: 1, ..fine() };
    let mut script = Script::new(TreeConfig { unasked_leaf: 8, ..crowd }, &[cube(10.0), cube(20.0)]);
    let mut chc = Chc::default();
    assert_eq!(script.frame(&mut chc, &["01"]), "ask 01, wait, draw 01");
    assert_eq!(script.frame(&mut chc, &["01"]), "draw 01");
    for i in 0..40 {
        script.add(cube(30.0 + 10.0 * i as f32));
    }
    script.scene.update();
    // The leaf has been built anew: nobody has asked about its heirs, which are drawn meanwhile.
    let told = script.frame(&mut chc, &[]);
    let (asked, drawn) = (told.matches("ask").count(), told.matches("draw").count());
    assert!(drawn > 5 && asked == drawn && !told.contains("whole"), "{told}");
    let steps: Vec<&str> = told.split(", ").collect();
    assert!(steps.chunks(2).take(drawn).all(|pair| pair[1] == pair[0].replace("ask", "draw")), "{told}");
}

#[test]
fn straddlers_that_stay_in_an_inner_node_are_drawn_when_it_opens() {
    let binary = TreeConfig { straddlers: Straddlers::StayInParent, ..fine() };
    let long = Aabb::new(Vec3::new(9.0, -1.0, -1.0), Vec3::new(41.0, 1.0, 1.0));
    let boxes = [cube(10.0), cube(20.0), cube(30.0), cube(40.0), long];
    let (mut script, mut chc) = (Script::new(binary, &boxes), chc());
    let first = script.frame(&mut chc, &["01234", "01", "0"]);
    assert_eq!(first, "ask 01234, wait, draw 01234, ask 01, ask 23, wait, ask 0, ask 1, wait, draw 0");
    // Only the straddler is left to see: nothing below the root is, so it is asked about. Its own
    // answer keeps it open for one frame more. It is never without its straddler.
    let visible = &["01234"];
    assert_eq!(script.frame(&mut chc, visible), "draw 01234, ask 0, draw 0, ask 1, ask 23, wait");
    for _ in 0..3 {
        let told = script.frame(&mut chc, visible);
        assert_eq!(told, "ask 01234, wait, draw 01234, ask 01, ask 23, wait");
        assert_eq!(script.frame(&mut chc, visible), "draw 01234, ask 01, ask 23, wait");
    }
}

#[test]
fn a_threshold_makes_questions_count() {
    let (mut script, mut chc) = (Script::row(4), chc());
    // Three samples are seen of what is visible.
    script.tradeoff = Tradeoff { visible_pixels: 2, ..Tradeoff::EXACT };
    let first = "count 0123, wait, count 01, count 23, wait, count 0, count 1, wait, draw 0";
    assert_eq!(script.frame(&mut chc, ZERO), first);
    script.tradeoff = Tradeoff { visible_pixels: 3, ..Tradeoff::EXACT };
    assert_eq!(script.frame(&mut chc, ZERO), "count 0, draw 0, count 1, count 23, wait");
    assert_eq!(script.frame(&mut chc, ZERO), "count 0123, wait");
}
