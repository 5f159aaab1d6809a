//! Each rule and each trap of the paper, step by step.

use glam::Vec3;
use tercet::policy::{Coherence, Hierarchy, Policy};
use tercet::tree::{Straddlers, TightBoxes, TreeConfig};

use super::script::Row;

/// Two, one across the middle, and two more.
const STRADDLING: [f32; 5] = [0.0, 0.5, 15.25, 30.0, 30.5];

const ALL: &str = "root L LL all:LL LH all:LH H HL all:HL HH all:HH";

/// Propagation always tried, what was visible never asked about again.
fn policy(coherence: Coherence) -> Hierarchy {
    let mut policy = Hierarchy::new(coherence);
    (policy.p_vp, policy.p_skip) = (1.0, 1.0);
    policy
}

fn drawing_wholes(coherence: Coherence) -> Hierarchy {
    let mut policy = policy(coherence);
    policy.whole = true;
    policy
}

fn without_propagation(coherence: Coherence) -> Hierarchy {
    let mut policy = policy(coherence);
    policy.p_vp = 0.0;
    policy
}

#[test]
fn a_asks_about_every_node_on_the_way_in_every_frame() {
    let mut row = Row::new(policy(Coherence::Classical), TreeConfig::binary());
    for _ in 0..3 {
        assert_eq!(row.frame(""), ALL);
        assert_eq!(row.frame("H=h"), "root L LL all:LL LH all:LH H");
        assert_eq!(row.frame("root=h"), "root");
    }
}

#[test]
fn b_opens_again_what_was_opened_and_asks_only_where_the_traversal_ended() {
    let mut row = Row::new(policy(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame("LH=h"), "root L LL all:LL LH H HL all:HL HH all:HH");
    // Opened nodes with mixed children are stamped on every visit: none is ever asked about again.
    for _ in 0..4 {
        assert_eq!(row.frame("LH=h"), "LL all:LL LH HL all:HL HH all:HH");
        assert_eq!(row.counter("opened_unasked"), 3);
    }
}

#[test]
fn what_all_children_came_to_is_pulled_up() {
    let mut row = Row::new(policy(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame("HL=h HH=h"), "root L LL all:LL LH all:LH H HL HH");
    assert_eq!(row.counter("pull_ups"), 1);
    assert_eq!(row.frame("H=h"), "LL all:LL LH all:LH H", "one question for the two");
    assert_eq!(row.frame("HL=h"), "LL all:LL LH all:LH H HL HH all:HH", "it shows again, and is opened");
    assert_eq!(row.frame("LL=h LH=h HL=h HH=h"), "LL LH HL HH");
    assert_eq!(row.counter("pull_ups"), 3);
    assert_eq!(row.frame("root=h"), "root");
}

#[test]
fn an_inner_node_that_is_all_visible_is_opened_unless_it_may_be_drawn_as_a_whole() {
    let all = "root=v L=v H=v LL=v LH=v HL=v HH=v";
    let mut row = Row::new(policy(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame(all), ALL);
    assert_eq!(row.frame(all), "LL all:LL LH all:LH HL all:HL HH all:HH");
    let mut row = Row::new(drawing_wholes(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame("LL=v LH=v"), ALL);
    assert_eq!(row.frame("L=v"), "L all:L HL all:HL HH all:HH", "pulled up, and one question for the two");
    assert_eq!(row.frame("L=p"), "L LL all:LL LH all:LH HL all:HL HH all:HH");
    let mut row = Row::new(drawing_wholes(Coherence::Classical), TreeConfig::binary());
    assert_eq!(row.frame("root=v"), "root all:root");
}

/// The root keeps the box at 15. In part visible by an answer of the same frame, it is no hidden
/// node, whatever its children are; opened unasked, it may be.
#[test]
fn straddlers_in_an_inner_node_count_as_one_more_child() {
    let mut row = Row::of(policy(Coherence::Updating), TreeConfig::binary(), &STRADDLING.map(Row::at));
    assert_eq!(row.frame("L=h H=h"), "root own:root L H");
    assert_eq!(row.frame("L=h H=h"), "own:root L H");
    assert_eq!(row.frame("root=h"), "root");
}

#[test]
fn lost_answers_are_visible_and_prove_nothing() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    assert_eq!(row.frame("root=u L=u LL=u LH=u H=u HL=u HH=u"), ALL);
}

#[test]
fn what_was_out_of_view_is_asked_about_anew() {
    let mut row = Row::new(policy(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame(""), ALL);
    row.target = Vec3::X * -100.0;
    assert_eq!(row.frame(""), "");
    row.target = Vec3::ZERO;
    assert_eq!(row.frame(""), ALL);
}

#[test]
fn a_hidden_cell_hides_what_is_behind_its_faces() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    // LL hides LH, and LH hides H.
    assert_eq!(row.frame("LL=h"), "root L LL");
    assert_eq!(row.counter("propagated_nodes"), 2);
    // All came to nothing: the root was pulled up, is asked about and opened, and so on.
    assert_eq!(row.frame("LL=h"), "root L LL");
    assert_eq!(row.frame("root=h"), "root");
}

/// The link of H leads to LH, below L at which the traversal ended.
#[test]
fn links_lead_up_to_where_the_traversal_ended() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    assert_eq!(row.frame("L=h"), "root L", "L, which is larger, proves H hidden");
    assert_eq!(row.counter("propagated_nodes"), 1);
}

/// Seen from above, HL has two faces to the viewer, and nothing is known beyond the root's.
#[test]
fn nothing_is_known_beyond_the_root() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    row.eye.y = 15.0;
    assert_eq!(row.frame("LL=h LH=h HL=h HH=h"), "root L LL LH H HL HH");
    assert_eq!(row.counter("propagated_nodes"), 0);
}

#[test]
fn a_tight_box_says_nothing_of_its_cell() {
    let tight = TreeConfig { tight_boxes: TightBoxes::Always, ..TreeConfig::binary() };
    let mut row = Row::new(policy(Coherence::Propagating), tight);
    assert_eq!(row.frame("LL=h LH=h H=h"), "root L LL LH H");
    assert_eq!(row.counter("propagated_nodes"), 0);
}

/// The ternary tree's third child holds the box at 15: it neither bears witness nor is it judged.
#[test]
fn a_straddle_child_is_no_neighbour() {
    let ternary = TreeConfig { straddlers: Straddlers::Leaf, ..TreeConfig::binary() };
    let mut row = Row::of(policy(Coherence::Propagating), ternary.clone(), &STRADDLING.map(Row::at));
    assert_eq!(row.frame("L=h S=h"), "root L S", "H is behind L, whatever stands between");
    assert_eq!(row.frame("root=p L=p S=h H=h"), "root L all:L S H", "S, hidden, says nothing of H");
    // HS holds the box across the middle of H; its cell, which is H's, lies behind L as HL's does.
    let boxes = [0.0, 0.5, 18.0, 18.5, 23.375, 30.0, 30.5].map(Row::at);
    let mut row = Row::of(without_propagation(Coherence::Propagating), ternary, &boxes);
    assert_eq!(row.frame("HL=h HS=h"), "root L all:L H HL HS HH all:HH");
    row.policy.p_vp = 1.0;
    assert_eq!(row.frame("L=h HS=h"), "L HS HH all:HH");
    assert_eq!(row.counter("propagated_nodes"), 1);
}

#[test]
fn samples_that_were_given_up_prove_nothing() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    row.tradeoff.visible_pixels = 5;
    assert_eq!(
        row.frame("root=v L=v LL=p LH=h H=h"),
        "root L LL LH",
        "LL, in part visible, does not; LH does"
    );
}

#[test]
fn an_answer_of_an_earlier_frame_proves_nothing() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    assert_eq!(row.frame("LL=h"), "root L LL");
    // The viewer has gone to the other end: HH is now the first, and LL's old answer is no one's.
    row.eye.x = 50.0;
    row.target = Vec3::X * 30.0;
    assert_eq!(row.frame("LL=h LH=p HL=p HH=p"), "root H HH all:HH HL all:HL L LH all:LH LL");
}

#[test]
fn what_is_behind_visible_leaves_is_taken_as_visible() {
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    // LL was asked about and speaks for LH; LH was not, and does not speak for others.
    assert_eq!(row.frame("LL=v"), "root L LL all:LL all:LH H HL all:HL HH all:HH");
    assert_eq!(row.counter("propagated_nodes"), 1);
    // In part visible, as HL was: not tried. LL is no more visible as a whole: LH is asked about.
    assert_eq!(row.frame("LL=p HL=v"), "LL all:LL LH all:LH HL all:HL HH all:HH");
}

#[test]
fn propagation_is_tried_again_where_it_worked_and_else_by_chance() {
    let mut row = Row::new(without_propagation(Coherence::Propagating), TreeConfig::binary());
    assert_eq!(row.frame("LL=v LH=v"), ALL, "never by chance");
    let mut row = Row::new(policy(Coherence::Propagating), TreeConfig::binary());
    assert_eq!(row.frame("LL=v"), "root L LL all:LL all:LH H HL all:HL HH all:HH");
    row.policy.set("p_vp", "0").expect("a dial");
    assert_eq!(row.frame("LL=v"), "LL all:LL all:LH HL all:HL HH all:HH", "it worked the last time");
}

#[test]
fn d_does_not_ask_about_what_was_visible_and_always_about_what_was_hidden() {
    let mut row = Row::new(without_propagation(Coherence::Conservative), TreeConfig::binary());
    assert_eq!(row.frame("LL=v HL=h"), "root L LL all:LL LH all:LH H HL HH all:HH");
    assert_eq!(row.frame("HL=h"), "all:LL all:LH all:HH HL");
    assert_eq!(row.counter("skipped_tests"), 3);
    assert_eq!(row.frame("HL=p"), "all:LL all:LH all:HH HL all:HL");
    row.policy.set("p_skip", "0").expect("a dial");
    assert_eq!(row.frame(""), "LL all:LL LH all:LH HL all:HL HH all:HH");
}

#[test]
fn chance_is_the_same_for_the_same_seed_and_frame() {
    let run = |seed| {
        let mut policy = without_propagation(Coherence::Conservative);
        (policy.seed, policy.p_skip) = (seed, 0.5);
        let mut row = Row::new(policy, TreeConfig::binary());
        (0..20).map(|_| row.frame("")).collect::<Vec<_>>()
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
    let once = run(7);
    assert!(once[1..].iter().any(|told| *told != once[1]), "frames differ in what they skip");
}

/// What was hidden in the last frame may have moved: no older answer keeps it from being drawn.
#[test]
fn a_moved_object_is_not_hidden_by_an_old_answer() {
    for coherence in [Coherence::Updating, Coherence::Propagating, Coherence::Conservative] {
        let mut row = Row::new(policy(coherence), TreeConfig::binary());
        row.frame("HH=h");
        row.frame("HH=h");
        // The hidden box comes forward, beside the first one.
        row.scene.set_bounds(row.objects[3], Row::at(4.0));
        row.scene.update();
        let told = row.frame("");
        assert!(told.contains("all:LL"), "{coherence:?}: {told}");
    }
}

/// The root grows, and what it was goes elsewhere: whoever is new is asked about.
#[test]
fn a_tree_that_grows_is_followed() {
    let mut row = Row::new(policy(Coherence::Updating), TreeConfig::binary());
    assert_eq!(row.frame("HH=h"), "root L LL all:LL LH all:LH H HL all:HL HH");
    row.objects.push(row.scene.insert(Row::at(55.0), tercet::scene::Traits::default()));
    row.scene.update();
    let told = row.frame("H=h LHH=h");
    assert_eq!(told, "root L LLL all:LLL LLH all:LLH LHL all:LHL LHH H");
}
