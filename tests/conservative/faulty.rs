//! The software backend with faults.

use tercet::query::fault::{Faults, Faulty};
use tercet::query::software::SoftwareQueries;

use crate::run::Shown;

/// Answers go astray in every way, every other time those of who shows, too.
pub fn faulty(seed: u64) -> Faulty<SoftwareQueries> {
    let mut queries = SoftwareQueries::new();
    queries.set_true_shapes(seed % 2 == 1);
    Faulty::new(queries, Faults::MANY, seed)
}

impl Shown for Faulty<SoftwareQueries> {
    fn shown(&self) -> &SoftwareQueries {
        &self.inner
    }
}
