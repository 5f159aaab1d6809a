//! Whatever happens to the answers, and whatever dials are turned that are not lossy: nothing is lost.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;
use tercet::policy::{self, Gated};
use tercet::query::software::SoftwareQueries;
use tercet::tree::{SplitPlane, Straddlers, TightBoxes, TreeConfig};
use tercet::{Budget, Tradeoff, worlds};

use crate::faulty::faulty;
use crate::fickle::Fickle;
use crate::run::{Outcome, run, run_with};
use crate::stage::Stage;
use crate::suite::{FRAMES, Row, SCREEN, culls_hidden, dialled, queries, rows, total, trees};
use crate::tally::Tally;

/// Answers that are late, lost, doubled and out of order cost culling, and no object.
#[test]
fn answers_that_go_astray_lose_nothing() {
    let seeds = (0..24u64).into_par_iter();
    let rows: Vec<Row> =
        seeds.flat_map_iter(|seed| rows(policy::NAMES, worlds::random(seed, 120), seed, faulty)).collect();
    for &name in policy::NAMES {
        let all = total(&rows, name, |_| true);
        assert!(all.culled > 0 || !culls_hidden(name), "{name} culled nothing that was hidden");
    }
}

/// Behind a gate that opens and shuts, with answers that come and some that do not.
#[test]
fn behind_a_gate_nothing_is_lost() {
    for name in ["dual-query", "chc", "chc++", "nohc", "hierarchy-c"] {
        let gated = Arc::new(AtomicU32::new(0));
        let outcomes = (0..12u64).into_par_iter().map(|seed| {
            let mut stage = Stage::new(worlds::random(seed, 240), seed, SCREEN, true);
            let tree = trees()[seed as usize % trees().len()].clone();
            let policy = Fickle(Gated::new(dialled(name, seed)));
            let policy = Tally { inner: policy, key: "gated_frames", sum: gated.clone() };
            let outcome = match seed % 2 {
                0 => run(&mut stage, tree, policy, SoftwareQueries::new(), 2 * FRAMES),
                _ => run(&mut stage, tree, policy, faulty(seed), 2 * FRAMES),
            };
            assert_eq!(outcome.lost, 0, "{name} lost an object in random world {seed}");
            outcome.culled
        });
        let culled: usize = outcomes.sum();
        let (gated, frames) = (gated.load(Ordering::Relaxed), 12 * 2 * FRAMES);
        println!("{name}: {gated} of {frames} frames were drawn whole, {culled} objects culled");
        assert!(gated > 24 && gated < frames - 24 && culled > 0, "{name}: {gated}, {culled}");
    }
}

/// While ways of culling race, by times that mean nothing, each takes over from any other.
#[test]
fn while_ways_race_nothing_is_lost() {
    let first = Arc::new(AtomicU32::new(0));
    let frames = 8 * FRAMES;
    let outcomes = (0..12u64).into_par_iter().map(|seed| {
        let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
        let tree = trees()[seed as usize % trees().len()].clone();
        let policy = Tally { inner: Fickle(policy::Auto::default()), key: "auto_hroc", sum: first.clone() };
        let outcome = match seed % 2 {
            0 => run(&mut stage, tree, policy, queries(3 * seed / 2), frames),
            _ => run(&mut stage, tree, policy, faulty(seed), frames),
        };
        assert_eq!(outcome.lost, 0, "an object was lost in random world {seed}");
        outcome.culled
    });
    let culled: usize = outcomes.sum();
    let first = first.load(Ordering::Relaxed);
    println!("{first} of {} frames went the first way, {culled} objects culled", 12 * frames);
    assert!(first > 48 && first < 9 * frames && culled > 0, "{first}, {culled}");
}

/// Where propagation applies: questions about cells, on the published trees. It must happen, and lose
/// nothing while everything moves.
#[test]
fn propagation_loses_nothing() {
    let propagated = Arc::new(AtomicU32::new(0));
    (0..24u64).into_par_iter().for_each(|seed| {
        let straddlers = if seed % 2 == 0 { Straddlers::StayInParent } else { Straddlers::Leaf };
        let plane = if seed % 3 == 0 { SplitPlane::SurfaceArea } else { SplitPlane::Middle };
        let tight_boxes = if seed % 4 == 3 { TightBoxes::Settled } else { TightBoxes::Never };
        let tree = TreeConfig { straddlers, tight_boxes, plane, ..TreeConfig::stable() };
        let mut policy = policy::Hierarchy::new(policy::Coherence::Propagating);
        policy.p_vp = 1.0;
        let policy = Tally { inner: policy, key: "propagated_nodes", sum: propagated.clone() };
        // Crowded: what is hidden lies in cells that are hidden as a whole.
        let model = if seed % 6 < 4 { worlds::city(seed, 0.005) } else { worlds::random(seed, 1500) };
        let mut stage = Stage::new(model, seed, SCREEN, true);
        let outcome = run(&mut stage, tree, policy, SoftwareQueries::new(), FRAMES);
        assert_eq!(outcome.lost, 0, "world {seed}: {outcome:?}");
    });
    let propagated = propagated.load(Ordering::Relaxed);
    println!("{propagated} nodes were classified by their neighbours");
    assert!(propagated > 100, "{propagated} nodes were classified by their neighbours");
}

#[test]
fn dials_that_are_not_lossy_lose_nothing() {
    let exact = Tradeoff::EXACT;
    let budget = |budget: Budget| Tradeoff { budget, ..exact };
    let tradeoffs = [
        budget(Budget { queries: Some(5), ..Budget::default() }),
        budget(Budget { box_pixels: Some(4000), ..Budget::default() }),
        Tradeoff { n_av: Some(40), p_skip: Some(1.0), ..exact },
        Tradeoff { tight_boxes: Some(TightBoxes::Never), ..exact },
    ];
    let runs: Vec<_> = names().flat_map(|name| tradeoffs.map(|tradeoff| (name, tradeoff))).collect();
    let outcomes: Vec<Outcome> = runs
        .par_iter()
        .enumerate()
        .map(|(seed, &(name, tradeoff))| {
            assert!(tradeoff.is_exact());
            let outcome = with_tradeoff(tradeoff, name, seed as u64);
            assert_eq!(outcome.lost, 0, "{name} with {tradeoff:?}");
            outcome
        })
        .collect();
    for (n, tradeoff) in tradeoffs.iter().enumerate() {
        let culled: usize = outcomes.iter().skip(n).step_by(tradeoffs.len()).map(|o| o.culled).sum();
        assert!(culled > 500, "{culled} hidden objects culled with {tradeoff:?}");
    }
}

fn with_tradeoff(tradeoff: Tradeoff, name: &str, seed: u64) -> Outcome {
    let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
    let tree = tradeoff.tree(trees()[0].clone());
    let policy = policy::by_name(name).expect("a policy of that name");
    run_with(tradeoff, &mut stage, tree, policy, SoftwareQueries::new(), FRAMES)
}

/// Policies that find out by themselves what they draw.
fn names() -> impl Iterator<Item = &'static str> {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    policy::NAMES.iter().copied().filter(move |name| finds_out(name))
}
