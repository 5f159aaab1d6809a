//! The suite over scenes that were read from glTF files: every policy on objects whose transforms
//! and parts come from elsewhere, each frame against the exact oracle.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::import;
use tercet::tree::TreeConfig;
use tercet::worlds::Model;

use crate::lying::Lying;
use crate::run::run;
use crate::scenes::{self, Interior};
use crate::stage::Stage;
use crate::suite::{
    FRAMES, Row, SCREEN, assert_culls_most, culls_hidden, dialled, is_default, queries, rows, total,
};

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
    let rows =
        runs.into_par_iter().flat_map_iter(|(seed, model)| rows(policy::NAMES, model.clone(), seed, queries));
    let rows: Vec<Row> = rows.collect();
    for &name in policy::NAMES {
        let all = total(&rows, name, |_| true);
        assert!(all.hidden > 10_000 && all.visible > 2_000, "the scenes have things to hide: {all:?}");
        if culls_hidden(name) {
            assert_culls_most(name, total(&rows, name, |row| is_default(row.seed)));
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
        let lying = Lying(SoftwareQueries::new());
        let policy = dialled("dual-query", 0);
        let outcome = run(&mut stage, TreeConfig::default(), policy, lying, FRAMES);
        assert!(outcome.lost > 0 && outcome.wrong_pixels > 0, "{name}: {outcome:?}");
    }
}
