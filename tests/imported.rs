//! The suite of `conservative.rs` over scenes that were read from glTF files: every policy on
//! objects whose transforms and parts come from elsewhere, each frame against the exact oracle.

#![cfg(feature = "gltf")]

#[path = "support/scenes.rs"]
mod scenes;
mod support;
#[path = "support/writer.rs"]
mod writer;

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use scenes::Interior;
use support::lying::Lying;
use support::stage::Stage;
use support::suite::{FRAMES, SCREEN, assert_culls_most, culls_hidden, dialled, is_default, outcome};
use support::{Outcome, run};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::import;
use tercet::tree::TreeConfig;
use tercet::worlds::Model;

/// Writes a file in a folder of its own and reads it.
fn import(write: impl FnOnce(&Path) -> PathBuf) -> Model {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let imported = import::load(write(folder.path())).expect("the file is well formed");
    assert_eq!(imported.report.skipped.first(), None);
    imported.model
}

/// Runs every policy over some models, with each seed.
fn suite(models: &[Model], seeds: impl IntoIterator<Item = u64>) {
    let runs = seeds.into_iter().flat_map(|seed| models.iter().map(move |model| (seed, model)));
    let runs: Vec<(u64, &Model)> = runs.collect();
    for &name in policy::NAMES {
        let outcomes = runs.par_iter().map(|&(seed, model)| {
            let outcome = outcome(name, model.clone(), seed);
            assert_eq!(outcome.lost, 0, "{name} lost an object of {}, seed {seed}", model.name);
            (seed, outcome)
        });
        let outcomes: Vec<(u64, Outcome)> = outcomes.collect();
        let (mut all, mut by_default) = (Outcome::default(), Outcome::default());
        for (seed, outcome) in outcomes {
            all.add(outcome);
            if is_default(seed) {
                by_default.add(outcome);
            }
        }
        assert!(all.hidden > 10_000 && all.visible > 2_000, "the scenes have things to hide: {all:?}");
        if culls_hidden(name) {
            assert_culls_most(name, by_default);
        }
    }
}

#[test]
fn nested_transforms() {
    let chain = import(|folder| scenes::nested().write_glb(folder));
    let grove = import(|folder| scenes::grove(100).write_embedded(folder));
    suite(&[chain, grove], 0..12);
}

#[test]
fn thousands_of_parts() {
    // One seed for each tree, and each variant of the dials.
    suite(&[import(|folder| scenes::parts(20, 10, 15).write_glb(folder))], [0, 1, 2, 7]);
}

#[test]
fn an_interior_with_doorways_and_glass() {
    let interior = Interior::new(8);
    let model = import(|folder| interior.file.write_beside(folder));
    assert_eq!(model.objects.iter().filter(|o| o.not_occluder).count(), interior.rooms());
    assert!(model.objects.len() > interior.rooms() * Interior::FURNITURE);
    suite(&[model], [0, 1, 2, 7]);
}

#[test]
fn a_lying_backend_is_found_out() {
    let models =
        [scenes::grove(100), Interior::new(8).file].map(|file| import(|folder| file.write_glb(folder)));
    for model in models {
        let name = model.name.clone();
        let mut stage = Stage::new(model, 0, SCREEN, true);
        let mut lying = Lying(SoftwareQueries::new());
        let policy = dialled("dual-query", 0);
        let outcome = run(&mut stage, TreeConfig::default(), policy, &mut lying, FRAMES);
        assert!(outcome.lost > 0 && outcome.wrong_pixels > 0, "{name}: {outcome:?}");
    }
}
