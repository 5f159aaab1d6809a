//! The software backend with faults.

use tercet::query::fault::{Faults, Faulty};
use tercet::query::software::SoftwareQueries;

use crate::support::Shown;

/// Answers go astray in every way.
pub fn faulty(seed: u64) -> Faulty<SoftwareQueries> {
    Faulty::new(SoftwareQueries::new(), Faults::MANY, seed)
}

impl Shown for Faulty<SoftwareQueries> {
    fn shown(&self) -> &SoftwareQueries {
        &self.inner
    }
}
