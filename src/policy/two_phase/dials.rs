//! The dials by name: those of all policies of two phases, and those of the plan.

use super::super::plan::Plan;
use super::TwoPhase;
use crate::Error;
use crate::dial::{self, Dial};

/// With their values.
pub(super) fn of<P: Plan>(policy: &TwoPhase<P>) -> Vec<Dial> {
    let mut dials = vec![
        Dial::new(
            "occluder_filtering",
            policy.occluder_filtering,
            "draw first only what owned a sample in the last frame",
        ),
        Dial::new(
            "by_geometry",
            policy.by_geometry,
            "draw only what shows by its geometry, where that can be told",
        ),
        Dial::new("near_first", policy.near_first, "draw what was visible from near to far, not by slot"),
        Dial::new("parts", policy.parts, "parts in which many new objects are drawn, at most"),
    ];
    dials.extend(policy.plan.dials());
    dials
}

/// See [`Policy::set`](super::Policy::set).
pub(super) fn set<P: Plan>(policy: &mut TwoPhase<P>, key: &str, value: &str) -> Result<(), Error> {
    match key {
        "occluder_filtering" => policy.occluder_filtering = dial::switch(key, value)?,
        "by_geometry" => policy.by_geometry = dial::switch(key, value)?,
        "near_first" => policy.near_first = dial::switch(key, value)?,
        "parts" => policy.parts = dial::number(key, value, 1..=64)?,
        _ if policy.plan.set(key, value)? => {}
        _ => return Err(dial::unknown(key, value, &of(policy))),
    }
    Ok(())
}
