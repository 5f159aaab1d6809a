//! What the fuzz targets do, on stable: every seed and regression once, and random bytes, so that
//! neither the targets nor what they found is forgotten.
//!
//! `TERCET_FUZZ_RUNS` sets the number of random inputs a target.

#[path = "../fuzz/src/lib.rs"]
mod bodies;

use std::fs;
use std::path::{Path, PathBuf};

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// The files of a folder in `fuzz/`; none if it does not exist.
fn files(folder: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz").join(folder).join(target);
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a folder that can be read").path()).collect();
    files.sort();
    files
}

/// Runs a target over its files, and over random bytes and mutated files.
fn drive(target: &str) {
    let files: Vec<_> = ["seeds", "regressions"].iter().flat_map(|folder| files(folder, target)).collect();
    let inputs: Vec<Vec<u8>> =
        files.iter().map(|file| fs::read(file).expect("a file that can be read")).collect();
    for (file, bytes) in files.iter().zip(&inputs) {
        println!("{}", file.display());
        assert!(bodies::run(target, bytes), "a target of that name");
    }
    let runs: u64 = std::env::var("TERCET_FUZZ_RUNS").map_or(300, |n| n.parse().expect("a whole number"));
    (0..runs).into_par_iter().for_each(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut bytes = inputs.choose(&mut rng).filter(|_| seed % 2 == 0).cloned().unwrap_or_default();
        mutate(&mut bytes, &mut rng);
        bodies::run(target, &bytes);
    });
}

/// Changes, removes and adds some bytes; an empty input becomes a random one.
fn mutate(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    if bytes.is_empty() {
        bytes.resize(rng.random_range(1..2000), 0);
        rng.fill(&mut bytes[..]);
    }
    for _ in 0..rng.random_range(1..8) {
        let at = rng.random_range(0..bytes.len());
        match rng.random_range(0..4) {
            0 => bytes[at] = rng.random(),
            1 => bytes[at] ^= 1 << rng.random_range(0..8),
            2 => bytes.insert(at, rng.random()),
            _ if bytes.len() > 1 => drop(bytes.remove(at)),
            _ => {}
        }
    }
}

#[cfg(feature = "gltf")]
#[test]
fn gltf() {
    assert!(!files("seeds", "gltf").is_empty(), "random bytes alone are no glTF");
    drive("gltf");
}

#[cfg(feature = "record")]
#[test]
fn replay() {
    drive("replay");
}

#[test]
fn tree() {
    drive("tree");
}

#[test]
fn geometry() {
    drive("geometry");
}

#[test]
fn frame() {
    drive("frame");
}
