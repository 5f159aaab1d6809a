//! What loses objects is found out: policies that trust old answers, backends that lie or drop.

use rayon::prelude::*;
use tercet::query::software::SoftwareQueries;
use tercet::tree::TreeConfig;
use tercet::{policy, worlds};

use crate::dropping::Dropping;
use crate::lying::Lying;
use crate::run::{Outcome, run};
use crate::stage::Stage;
use crate::suite::{FRAMES, SCREEN, dialled, trees};
use crate::trusting::Trusting;

/// A policy that culls what was hidden in the last frame must be found out.
#[test]
fn trust_in_old_answers_is_found_out() {
    for (name, dials) in [("chc", &[][..]), ("chc++", &["tight", "multiqueries"])] {
        let mut all = Outcome::default();
        for seed in 0..4 {
            let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
            let mut policy = policy::by_name(name).expect("a policy of that name");
            dials.iter().for_each(|key| policy.set(key, "false").expect("a switch of that name"));
            let (tree, queries) = (TreeConfig::default(), SoftwareQueries::new());
            all.add(run(&mut stage, tree, Trusting::new(policy), queries, FRAMES));
        }
        assert!(all.lost > 0 && all.wrong_pixels > 0, "{name}: {all:?}");
    }
}

#[test]
fn a_lying_backend_is_found_out() {
    for name in ["dual-query", "hierarchy-a", "hierarchy-b", "hierarchy-c", "hierarchy-d"] {
        let mut all = Outcome::default();
        for seed in 0..4 {
            let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
            let lying = Lying(SoftwareQueries::new());
            all.add(run(&mut stage, TreeConfig::default(), dialled(name, 0), lying, FRAMES));
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
                let dropping = Dropping { inner: SoftwareQueries::new(), groups, loose, tried: 0 };
                all.add(run(&mut stage, TreeConfig::default(), policy, dropping, FRAMES));
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
                    return run(&mut stage, tree, policy, inner, FRAMES);
                }
                let dropping = Dropping { inner, groups: 0, loose: 0, tried };
                run(&mut stage, tree, policy, dropping, FRAMES)
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
