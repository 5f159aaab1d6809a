//! The three tests of a sweep against each other and against the plain loop over samples.

use rayon::prelude::*;
use tercet::geom::Viewport;
use tercet::query::SweepTest;
use tercet::tree::{Straddlers, TreeConfig};
use tercet::worlds::{self, Model, Pathology};

use super::table::Table;

fn tree(seed: u64) -> TreeConfig {
    let stable = TreeConfig { unasked_leaf: 6, ..TreeConfig::stable() };
    match seed % 4 {
        0 => stable,
        1 => TreeConfig { bulk_leaf: 1, unasked_leaf: 1, ..TreeConfig::paper() },
        2 => TreeConfig { straddlers: Straddlers::StayInParent, ..stable },
        _ => TreeConfig { straddlers: Straddlers::Leaf, unasked_leaf: 16, ..stable },
    }
}

const SIZES: [Viewport; 6] = [
    Viewport::new(160, 90),
    Viewport::new(161, 91),
    Viewport::new(1, 1),
    Viewport::new(1, 77),
    Viewport::new(83, 1),
    Viewport::new(33, 65),
];

/// Objects swept, found, and found by the pyramid alone.
fn check(model: Model, seed: u64) -> [usize; 3] {
    let viewport = SIZES[seed as usize % SIZES.len()];
    let mut table = Table::new(model, tree(seed), seed, viewport);
    let mut counts = [0; 3];
    for frame in 0..8 {
        table.next(frame, [0.1, 0.5, 0.9][frame as usize % 3]);
        let (groups, loose) = table.targets();
        let expected = table.naive(&groups, &loose);
        let raster = table.sweep(&groups, &loose, SweepTest::Raster);
        assert_eq!(raster, expected, "seed {seed}, frame {frame}: not what the samples say");
        let rays = table.sweep(&groups, &loose, SweepTest::Rays);
        assert_eq!(rays, expected, "seed {seed}, frame {frame}: rays find the same");
        let hi_z = table.sweep(&groups, &loose, SweepTest::HiZ);
        assert!(hi_z.is_superset(&expected), "seed {seed}, frame {frame}: the pyramid hides too much");
        counts[0] += table.objects.len();
        counts[1] += expected.len();
        counts[2] += hi_z.len() - expected.len();
    }
    counts
}

fn sum(all: Vec<[usize; 3]>) -> [usize; 3] {
    all.into_iter().fold([0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

#[test]
fn rays_find_what_rasters_find_and_the_pyramid_no_less_in_random_worlds() {
    let counts = (0..96u64).into_par_iter().map(|seed| check(worlds::random(seed, 200), seed));
    let [swept, found, more] = sum(counts.collect());
    println!("{found} of {swept} objects, and {more} by the pyramid alone");
    assert!(found > 1000 && swept > 3 * found && more > 100, "{found} of {swept}, and {more}");
}

#[test]
fn they_do_in_crowded_worlds_too() {
    let counts = (0..12u64).into_par_iter().map(|seed| check(worlds::city(seed, 0.004), 6 * seed));
    let [swept, found, more] = sum(counts.collect());
    println!("{found} of {swept} objects, and {more} by the pyramid alone");
    assert!(found > 500 && swept > 3 * found && more > 50, "{found} of {swept}, and {more}");
}

#[test]
fn they_do_in_pathological_worlds_too() {
    let kinds: Vec<(usize, Pathology)> = Pathology::ALL.into_iter().enumerate().collect();
    kinds.into_par_iter().for_each(|(i, kind)| {
        for variant in 0..6 {
            check(worlds::pathological(kind), (6 * i + variant) as u64);
        }
    });
}
