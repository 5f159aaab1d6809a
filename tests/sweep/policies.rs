//! The four policies on worlds in which everything changes.

use rayon::prelude::*;
use tercet::worlds;

use crate::support::Outcome;
use crate::support::suite::outcome;

pub const NAMES: [&str; 4] = ["roc", "hroc", "hi-z", "hybrid"];

#[test]
fn quick() {
    for name in NAMES {
        for variant in 0..3 {
        let outcomes = (0..8u64).into_par_iter().map(|i| {
            let seed = 12 * i + variant;
            outcome(name, worlds::random(seed, 120), seed)
        });
        let mut all = Outcome::default();
        outcomes.collect::<Vec<_>>().into_iter().for_each(|o| all.add(o));
        println!("{name} {variant} {:.3} {all:?}", all.culled as f64 / all.hidden as f64);
        assert_eq!(all.lost, 0);
        }
    }
}
