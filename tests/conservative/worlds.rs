//! Every policy, in worlds of every kind.

use rayon::prelude::*;
use tercet::draw::Detail;
use tercet::geom::Viewport;
use tercet::policy;
use tercet::tree::TreeConfig;
use tercet::worlds::{self, Model, Pathology};

use crate::run::run;
use crate::stage::Stage;
use crate::suite::{FRAMES, Row, assert_culls_most, culls_hidden, dialled, is_default, queries, rows, total};

#[test]
fn random_worlds() {
    let seeds = (0..48u64).into_par_iter();
    let rows: Vec<Row> =
        seeds.flat_map_iter(|seed| rows(policy::NAMES, worlds::random(seed, 120), seed, queries)).collect();
    for &name in policy::NAMES {
        let all = total(&rows, name, |_| true);
        assert!(all.hidden > 7_500 && all.visible > 3_750, "the worlds have things to hide: {all:?}");
        if culls_hidden(name) {
            assert!(all.culled > 0, "{name} culled nothing that was hidden: {all:?}");
            assert_culls_most(name, total(&rows, name, |row| is_default(row.seed)));
        }
    }
}

#[test]
fn pathological_worlds() {
    let variants = |kind| (0..4).map(move |variant| (kind, variant));
    let runs: Vec<(Pathology, usize)> = Pathology::ALL.into_iter().flat_map(variants).collect();
    let rows = runs.into_par_iter().flat_map_iter(|(kind, variant)| {
        // A thousand cubes that each fill the picture take long to draw: one variant a policy.
        let (first, step) = if kind == Pathology::Coincident { (variant, 4) } else { (0, 1) };
        let names: Vec<&str> = policy::NAMES.iter().copied().skip(first).step_by(step).collect();
        rows(&names, worlds::pathological(kind), (4 * kind as usize + variant) as u64, queries)
    });
    let rows: Vec<Row> = rows.collect();
    for &name in policy::NAMES.iter().filter(|name| culls_hidden(name)) {
        let all = total(&rows, name, |_| true);
        assert!(all.culled > 0, "{name} culled nothing that was hidden");
    }
}

#[test]
fn the_plant_with_bunnies() {
    let bunny = worlds::random(0, 1).meshes[0].clone();
    let mut model = worlds::power_plant(3, 0.1);
    scatter(&mut model, &bunny);
    for row in rows(policy::NAMES, model, 12, queries) {
        if culls_hidden(row.name) {
            assert_culls_most(row.name, row.outcome);
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
            let queries = queries(3 * seed);
            let outcome = run(&mut stage, tree, dialled(name, seed), queries, FRAMES);
            assert_eq!(outcome.wrong_pixels, 0, "{name}, world {seed}");
            assert!(outcome.culled > 0);
        }
    }
}
