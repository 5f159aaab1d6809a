//! How a suite runs every policy: on trees and with dials that change from seed to seed, and how
//! much of what is hidden it must cull.

use tercet::geom::Viewport;
use tercet::policy::{self, Policy};
use tercet::query::QueryBackend;
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::tree::{LeafSize, Straddlers, TightBoxes, TreeConfig};
use tercet::worlds::Model;

use crate::run::{Lane, Outcome, Shown, run_together};
use crate::stage::Stage;

/// Frames a run.
pub const FRAMES: u32 = 24;
/// Small: a frame is mostly culling.
pub const SCREEN: Viewport = Viewport::new(160, 90);

/// Policies that cull what is hidden, not only what is outside the frustum.
pub fn culls_hidden(name: &str) -> bool {
    !matches!(name, "none" | "frustum")
}

/// Whether a seed stands for the default tree and the default dials; see [`trees`], [`dialled`].
pub fn is_default(seed: u64) -> bool {
    seed.is_multiple_of(12)
}

/// By default a policy culls most of what is hidden inside the frustum, although a fifth of the
/// world changes every frame and the camera cuts every sixth. Skipped questions about visible leaves
/// cost the baseline and CHC much of that.
pub fn assert_culls_most(name: &str, outcome: Outcome) {
    let least = match name {
        // Three objects at a time, and after each cut it guesses: in worlds of a hundred objects that is much.
        "chc++" => 0.2,
        // On a screen this small, four texels say little about a rectangle.
        "hi-z" => 0.25,
        "statistical" | "chc" | "nohc" => 0.4,
        _ => 0.55,
    };
    let share = outcome.culled as f64 / outcome.hidden as f64;
    println!("{name}: {share:.3} of what was hidden was culled");
    assert!(share > least, "{name} culled only {share:.2} of what was hidden: {outcome:?}");
}

/// The trees that the suites run on, in turn: the presets and the corners of their dials.
pub fn trees() -> Vec<TreeConfig> {
    let stable = TreeConfig::stable();
    vec![
        // What is held to a threshold must not weigh times.
        TreeConfig { leaf_size: LeafSize::Fixed, ..stable.clone() },
        TreeConfig::paper(),
        TreeConfig { straddlers: Straddlers::StayInParent, tight_boxes: TightBoxes::Never, ..stable.clone() },
        TreeConfig { straddlers: Straddlers::Leaf, tight_boxes: TightBoxes::Settled, bulk_leaf: 8, ..stable },
    ]
}

/// A policy with some of its dials turned, by a number.
pub fn dialled(name: &str, variant: u64) -> Box<dyn Policy> {
    let mut policy = policy::by_name(name).expect("a policy of that name");
    let dials: &[(&str, &str)] = match (name, variant % 3) {
        // Repeatable, as the tree above.
        ("dual-query", 0) => &[("n_skip", "0")],
        ("dual-query", 1) if variant.is_multiple_of(2) => &[("order", "visible-first")],
        ("dual-query", 2) => &[("max_waves", "3"), ("n_skip", "8")],
        ("statistical", 1) => &[("in_flight", "1"), ("n_skip", "0")],
        ("chc", 1) => &[("n_av", "0"), ("in_flight", "1")],
        ("chc", 2) => &[("n_av", "3"), ("in_flight", "64")],
        // One optimisation off at a time.
        ("chc++", 1) => &OFF[(variant / 3) as usize % OFF.len()],
        ("chc++", 2) => {
            &[("d_max", "32"), ("s_max", "1000"), ("virtual_leaf", "16"), ("n_av", "3"), ("b", "7")]
        }
        ("nohc", 0) => &[("caution", "0")],
        ("nohc", 1) => &[("in_flight", "1"), ("caution", "10")],
        ("nohc", 2) => &[("in_flight", "64"), ("caution", "0")],
        // Times are whatever they are here, so it is not left to them whether it asks.
        ("auto", _) => &[("race", "false")],
        ("hierarchy-b", 2) => &[("whole", "true")],
        ("hierarchy-c", 1 | 2) => &[("p_vp", "1")],
        ("roc" | "hi-z", 1) => &[("occluder_filtering", "true"), ("near_first", "false")],
        ("roc" | "hi-z", 2) => &[("parts", "1")],
        ("hroc" | "hybrid", 1) => &[("occluder_filtering", "true"), ("share", "0.01")],
        ("hroc" | "hybrid", 2) => &[("share", "1"), ("parts", "1")],
        ("hierarchy-d", 1) => &[("p_vp", "1"), ("p_skip", "0.9")],
        ("hierarchy-d", 2) => &[("p_vp", "1"), ("p_skip", "0"), ("whole", "true")],
        _ => &[],
    };
    for (key, value) in dials {
        policy.set(key, value).expect("a dial of that name");
    }
    policy
}

/// The switches of CHC++.
const OFF: &[[(&str, &str); 1]] = &[
    [("batching", "false")],
    [("randomised", "false")],
    [("tight", "false")],
    [("multiqueries", "false")],
    [("regroup", "false")],
    [("guess", "false")],
    [("p_keep", "analytic")],
    [("n_av", "1")],
];

/// What a policy came to in one run.
#[derive(Clone, Copy)]
pub struct Row {
    pub seed: u64,
    pub name: &'static str,
    pub outcome: Outcome,
}

/// Runs policies side by side over a model with churn, each with a backend of its own. None of them may
/// lose an object.
pub fn rows<B>(names: &[&'static str], model: Model, seed: u64, backend: impl Fn(u64) -> B) -> Vec<Row>
where
    B: QueryBackend<Pass = SoftwarePass> + Shown + Send,
{
    let (trees, what) = (trees(), model.name.clone());
    let tree = &trees[seed as usize % trees.len()];
    let lane = |&name| Lane::new(tree.clone(), dialled(name, seed), backend(seed));
    let mut lanes: Vec<_> = names.iter().map(lane).collect();
    run_together(&mut Stage::new(model, seed, SCREEN, true), &mut lanes, FRAMES);
    let row = |(&name, lane): (_, &Lane<_, _>)| {
        assert_eq!(lane.outcome.lost, 0, "{name} lost an object of {what}, seed {seed}");
        Row { seed, name, outcome: lane.outcome }
    };
    names.iter().zip(&lanes).map(row).collect()
}

/// What a policy came to, over all rows that are meant.
pub fn total(rows: &[Row], name: &str, is_meant: impl Fn(&Row) -> bool) -> Outcome {
    let mut all = Outcome::default();
    rows.iter().filter(|row| row.name == name && is_meant(row)).for_each(|row| all.add(row.outcome));
    all
}

/// A backend that is told true shapes for half of the seeds, not for those that stand for the default.
pub fn queries(seed: u64) -> SoftwareQueries {
    let mut queries = SoftwareQueries::new();
    queries.set_true_shapes(seed / 3 % 2 == 1);
    queries
}
