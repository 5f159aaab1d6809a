//! With `Tradeoff::EXACT` a culled object never owned a sample: every policy on worlds in which
//! everything changes every frame, each frame against the exact oracle. Each suite also asserts
//! that hidden things were culled, so that a policy that draws everything cannot pass.

#[path = "support/dropping.rs"]
mod dropping;
#[path = "support/faulty.rs"]
mod faulty;
#[path = "support/fickle.rs"]
mod fickle;
mod support;
#[path = "support/tally.rs"]
mod tally;
#[path = "support/trusting.rs"]
mod trusting;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use dropping::Dropping;
use faulty::faulty;
use fickle::Fickle;
use rayon::prelude::*;
use support::lying::Lying;
use support::stage::Stage;
use support::suite::{
    FRAMES, SCREEN, assert_culls_most, culls_hidden, dialled, is_default, outcome, queries, trees,
};
use support::{Outcome, run, run_with};
use tally::Tally;
use tercet::draw::Detail;
use tercet::geom::Viewport;
use tercet::policy::{self, Gated};
use tercet::query::software::SoftwareQueries;
use tercet::tree::{SplitPlane, Straddlers, TightBoxes, TreeConfig};
use tercet::worlds::{self, Model, Pathology};
use tercet::{Budget, Tradeoff};
use trusting::Trusting;

#[test]
fn random_worlds() {
    for &name in policy::NAMES {
        let seeds: Vec<u64> = (0..48).collect();
        let outcomes = seeds.par_iter().map(|&seed| {
            let outcome = outcome(name, worlds::random(seed, 120), seed);
            assert_eq!(outcome.lost, 0, "{name} lost an object in random world {seed}");
            outcome
        });
        let outcomes: Vec<Outcome> = outcomes.collect();
        let sum = |seeds: &mut dyn Iterator<Item = &u64>| {
            let mut all = Outcome::default();
            seeds.for_each(|&seed| all.add(outcomes[seed as usize]));
            all
        };
        let all = sum(&mut seeds.iter());
        assert!(all.hidden > 7_500 && all.visible > 3_750, "the worlds have things to hide: {all:?}");
        if culls_hidden(name) {
            assert!(all.culled > 0, "{name} culled nothing that was hidden: {all:?}");
            assert_culls_most(name, sum(&mut seeds.iter().filter(|&&seed| is_default(seed))));
        }
    }
}

#[test]
fn pathological_worlds() {
    let kinds = |(n, &name)| Pathology::ALL.map(|kind| (n as u64, name, kind));
    let runs: Vec<(u64, &str, Pathology)> = policy::NAMES.iter().enumerate().flat_map(kinds).collect();
    let outcomes = runs.par_iter().map(|&(n, name, kind)| {
        let mut all = Outcome::default();
        // A thousand cubes that each fill the picture take long to draw: one variant a policy.
        let variants = if kind == Pathology::Coincident { n % 4..n % 4 + 1 } else { 0..4 };
        for variant in variants {
            let outcome = outcome(name, worlds::pathological(kind), 4 * kind as u64 + variant);
            assert_eq!(outcome.lost, 0, "{name} lost an object in {kind:?}, variant {variant}");
            all.add(outcome);
        }
        (name, all)
    });
    let outcomes: Vec<(&str, Outcome)> = outcomes.collect();
    for &name in policy::NAMES.iter().filter(|name| culls_hidden(name)) {
        let culled: usize = outcomes.iter().filter(|run| run.0 == name).map(|run| run.1.culled).sum();
        assert!(culled > 0, "{name} culled nothing that was hidden");
    }
}

#[test]
fn the_plant_with_bunnies() {
    let bunny = worlds::random(0, 1).meshes[0].clone();
    let outcomes: Vec<_> = policy::NAMES
        .par_iter()
        .map(|&name| {
            let mut model = worlds::power_plant(3, 0.1);
            scatter(&mut model, &bunny);
            let outcome = outcome(name, model, 12);
            assert_eq!(outcome.lost, 0, "{name} lost an object in the plant");
            (name, outcome)
        })
        .collect();
    for (name, outcome) in outcomes {
        if culls_hidden(name) {
            assert_culls_most(name, outcome);
        }
    }
}

/// Some small movers among the plant's rooms; the bunny itself is an asset of a feature.
fn scatter(model: &mut Model, fallback: &tercet::scene::mesh::Mesh) {
    #[cfg(feature = "gltf")]
    let mesh = worlds::bunny_mesh().unwrap_or_else(|_| fallback.clone());
    #[cfg(not(feature = "gltf"))]
    let mesh = fallback.clone();
    let size = 1.0 / mesh.bounds().size().max_element();
    model.meshes.push(mesh);
    let (room, last) = (model.bounds, model.meshes.len() - 1);
    for i in 0..100u32 {
        // A low-discrepancy sequence fills the box evenly.
        let part = |step: f32| (i as f32 * step).fract();
        let at = room.min + room.size() * glam::Vec3::new(part(0.819_173), part(0.671_044), part(0.549_7));
        let place = glam::Affine3A::from_scale_rotation_translation(
            glam::Vec3::splat(size),
            glam::Quat::from_rotation_y(i as f32),
            at,
        );
        model.place(last, place, [200, 180, 160]);
    }
}

/// Whole pictures: what is not drawn leaves no trace, down to the bits of the depth buffer.
#[test]
fn frames_equal_those_without_culling() {
    let asking =
        ["dual-query", "statistical", "chc", "chc++", "nohc", "stop-and-wait", "hierarchy-b", "hierarchy-d"];
    for name in asking.into_iter().chain(["roc", "hroc", "hi-z", "hybrid"]) {
        for seed in 0..4 {
            let mut stage = Stage::new(worlds::random(seed, 120), seed, Viewport::new(301, 203), false);
            stage.detail = Detail::FULL;
            let tree = TreeConfig::default();
            // Two of them by boxes, two by geometry where that can be told.
            let mut queries = queries(3 * seed);
            let outcome = run(&mut stage, tree, dialled(name, seed), &mut queries, FRAMES);
            assert_eq!(outcome.wrong_pixels, 0, "{name}, world {seed}");
            assert!(outcome.culled > 0);
        }
    }
}

/// Answers that are late, lost, doubled and out of order cost culling, and no object.
#[test]
fn answers_that_go_astray_lose_nothing() {
    for &name in policy::NAMES {
        let outcomes: Vec<Outcome> = (0..24u64)
            .into_par_iter()
            .map(|seed| {
                let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
                let tree = trees()[seed as usize % trees().len()].clone();
                let outcome = run(&mut stage, tree, dialled(name, seed), &mut faulty(seed), FRAMES);
                assert_eq!(outcome.lost, 0, "{name} lost an object in random world {seed}");
                outcome
            })
            .collect();
        let culled: usize = outcomes.iter().map(|outcome| outcome.culled).sum();
        assert!(culled > 0 || !culls_hidden(name), "{name} culled nothing that was hidden");
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
                0 => run(&mut stage, tree, policy, &mut SoftwareQueries::new(), 2 * FRAMES),
                _ => run(&mut stage, tree, policy, &mut faulty(seed), 2 * FRAMES),
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
            0 => run(&mut stage, tree, policy, &mut queries(3 * seed / 2), frames),
            _ => run(&mut stage, tree, policy, &mut faulty(seed), frames),
        };
        assert_eq!(outcome.lost, 0, "an object was lost in random world {seed}");
        outcome.culled
    });
    let culled: usize = outcomes.sum();
    let first = first.load(Ordering::Relaxed);
    println!("{first} of {} frames went the first way, {culled} objects culled", 12 * frames);
    assert!(first > 48 && first < 9 * frames && culled > 0, "{first}, {culled}");
}

/// A policy that culls what was hidden in the last frame must be found out.
#[test]
fn trust_in_old_answers_is_found_out() {
    for (name, dials) in [("chc", &[][..]), ("chc++", &["tight", "multiqueries"])] {
        let mut all = Outcome::default();
        for seed in 0..4 {
            let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
            let mut policy = policy::by_name(name).expect("a policy of that name");
            dials.iter().for_each(|key| policy.set(key, "false").expect("a switch of that name"));
            let (tree, mut queries) = (TreeConfig::default(), SoftwareQueries::new());
            all.add(run(&mut stage, tree, Trusting::new(policy), &mut queries, FRAMES));
        }
        assert!(all.lost > 0 && all.wrong_pixels > 0, "{name}: {all:?}");
    }
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
        let outcome = run(&mut stage, tree, policy, &mut SoftwareQueries::new(), FRAMES);
        assert_eq!(outcome.lost, 0, "world {seed}: {outcome:?}");
    });
    let propagated = propagated.load(Ordering::Relaxed);
    println!("{propagated} nodes were classified by their neighbours");
    assert!(propagated > 100, "{propagated} nodes were classified by their neighbours");
}

#[test]
fn a_lying_backend_is_found_out() {
    for name in ["dual-query", "hierarchy-a", "hierarchy-b", "hierarchy-c", "hierarchy-d"] {
        let mut all = Outcome::default();
        for seed in 0..4 {
            let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
            let mut lying = Lying(SoftwareQueries::new());
            all.add(run(&mut stage, TreeConfig::default(), dialled(name, 0), &mut lying, FRAMES));
        }
        assert!(all.lost > 0 && all.wrong_pixels > 0, "{name}: {all:?}");
    }
}

/// A backend that drops one group, or one loose object, must be found out.
#[test]
fn a_dropped_group_or_object_is_found_out() {
    for name in ["roc", "hroc", "hi-z", "hybrid"] {
        for (groups, loose) in [(0, 0), (1, 0), (0, 1)] {
            let mut all = Outcome::default();
            for seed in 0..4 {
                let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
                let mut policy = policy::by_name(name).expect("a policy of that name");
                // Groups are small and many, and what is dropped is not asked about again.
                policy.set("parts", "1").expect("a dial of that name");
                // Nor is what was drawn already, for which it would not matter.
                policy.set("occluder_filtering", "true").expect("a dial of that name");
                let mut dropping = Dropping { inner: SoftwareQueries::new(), groups, loose, tried: 0 };
                all.add(run(&mut stage, TreeConfig::default(), policy, &mut dropping, FRAMES));
            }
            // The two that sweep from the root have nothing loose, but the owners' sweep, which only
            // decides what comes first.
            let matters = groups == 1 || (loose == 1 && matches!(name, "hroc" | "hybrid"));
            assert_eq!(all.lost > 0, matters, "{name}, {groups} groups, {loose} loose: {all:?}");
        }
    }
}

/// By their geometry, more of what is hidden is left out than by boxes, and nothing else, in either phase and
/// whether owners are asked for or not. One that is lost on the way must be found out.
#[test]
fn what_does_not_show_is_left_out() {
    for name in ["roc", "hroc", "hi-z", "hybrid"] {
        let sum = |by_geometry: &str, tried: usize| {
            let outcomes = (0..16u64).into_par_iter().map(|seed| {
                let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
                let mut policy = dialled(name, seed);
                policy.set("by_geometry", by_geometry).expect("a dial of that name");
                let mut inner = SoftwareQueries::new();
                inner.set_true_shapes(true);
                let tree = trees()[seed as usize % trees().len()].clone();
                if tried == 0 {
                    return run(&mut stage, tree, policy, &mut inner, FRAMES);
                }
                let mut dropping = Dropping { inner, groups: 0, loose: 0, tried };
                run(&mut stage, tree, policy, &mut dropping, FRAMES)
            });
            let mut all = Outcome::default();
            outcomes.collect::<Vec<_>>().into_iter().for_each(|outcome| all.add(outcome));
            all
        };
        let (boxes, geometry, dropping) = (sum("false", 0), sum("true", 0), sum("true", 1));
        let share = |all: Outcome| all.culled as f64 / all.hidden as f64;
        println!(
            "{name}: of what was hidden, {:.3} by boxes, {:.3} by geometry",
            share(boxes),
            share(geometry)
        );
        assert_eq!((boxes.lost, boxes.wrong_pixels), (0, 0), "{name}");
        assert_eq!((geometry.lost, geometry.wrong_pixels), (0, 0), "{name}");
        assert!(geometry.culled > boxes.culled && share(geometry) > 0.9, "{name}: {geometry:?}, {boxes:?}");
        assert!(dropping.lost > 0 && dropping.wrong_pixels > 0, "{name}: {dropping:?}");
    }
}

/// Policies that find out by themselves what they draw.
fn names() -> impl Iterator<Item = &'static str> {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    policy::NAMES.iter().copied().filter(move |name| finds_out(name))
}

fn with_tradeoff(tradeoff: Tradeoff, name: &str, seed: u64) -> Outcome {
    let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
    let tree = tradeoff.tree(trees()[0].clone());
    let policy = policy::by_name(name).expect("a policy of that name");
    run_with(tradeoff, &mut stage, tree, policy, &mut SoftwareQueries::new(), FRAMES)
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
