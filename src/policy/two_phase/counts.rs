//! What a frame of two phases counts.

use crate::Counter;

/// Objects, but for groups and sweeps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    /// V in the frustum.
    pub(super) first: u32,
    pub(super) groups: u32,
    pub(super) loose: u32,
    pub(super) sweeps: u32,
    /// Drawn in the second phase.
    pub(super) found: u32,
    /// Of either phase, those of which nothing showed.
    pub(super) left_out: u32,
}

impl Counts {
    pub(super) fn list(self) -> Vec<Counter> {
        vec![
            Counter { key: "drawn_first", count: self.first },
            Counter { key: "groups", count: self.groups },
            Counter { key: "loose", count: self.loose },
            Counter { key: "sweeps", count: self.sweeps },
            Counter { key: "found", count: self.found },
            Counter { key: "left_out", count: self.left_out },
        ]
    }
}
