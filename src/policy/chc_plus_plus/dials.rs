//! The dials by name.

use super::{ChcPlusPlus, KeepRule};
use crate::Error;
use crate::dial::{self, Dial};

const KEEP_RULES: &[(&str, KeepRule)] = &[("measured", KeepRule::Measured), ("analytic", KeepRule::Analytic)];

/// With their values.
pub(super) fn of(policy: &ChcPlusPlus) -> Vec<Dial> {
    vec![
        Dial::new("n_av", policy.n_av, "frames from one question about a visible leaf to the next"),
        Dial::new("b", policy.b, "hidden nodes a batch"),
        Dial::new("batching", policy.batching, "ask in batches"),
        Dial::new("randomised", policy.randomised, "spread the first questions of what turned visible"),
        Dial::new("tight", policy.tight, "ask about the boxes of descendants"),
        Dial::new("multiqueries", policy.multiqueries, "ask about several hidden nodes in one question"),
        Dial::new("regroup", policy.regroup, "repeat large multiqueries that fail in groups"),
        Dial::new(
            "guess",
            policy.guess,
            "take as visible what comes into view if such nodes are seldom hidden",
        ),
        Dial::choice("p_keep", policy.p_keep, KEEP_RULES, "how likely hidden nodes are to stay hidden"),
        Dial::new("d_max", policy.d_max, "levels to which tight volumes go down"),
        Dial::new("s_max", policy.s_max, "surface of a tight volume to that of the node's box, at most"),
        Dial::new("virtual_leaf", policy.virtual_leaf, "objects up to which a node is a leaf, if tight"),
    ]
}

/// See [`Policy::set`](super::Policy::set).
pub(super) fn set(policy: &mut ChcPlusPlus, key: &str, value: &str) -> Result<(), Error> {
    match key {
        "n_av" => policy.n_av = dial::number(key, value, 0..=1000)?,
        "b" => policy.b = dial::number(key, value, 1..=100_000)?,
        "batching" => policy.batching = dial::switch(key, value)?,
        "randomised" => policy.randomised = dial::switch(key, value)?,
        "tight" => policy.tight = dial::switch(key, value)?,
        "multiqueries" => policy.multiqueries = dial::switch(key, value)?,
        "regroup" => policy.regroup = dial::switch(key, value)?,
        "guess" => policy.guess = dial::switch(key, value)?,
        "p_keep" => policy.p_keep = dial::choice(key, value, KEEP_RULES)?,
        "d_max" => policy.d_max = dial::number(key, value, 0..=32)?,
        "s_max" => policy.s_max = dial::number(key, value, 0.0..=1000.0)?,
        "virtual_leaf" => policy.virtual_leaf = dial::number(key, value, 0..=100_000)?,
        _ => return Err(dial::unknown(key, value, &of(policy))),
    }
    Ok(())
}
