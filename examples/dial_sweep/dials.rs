//! Which dials are turned, through which values. The base's own value need not be among them.

/// A dial's name, and its values in the order of the plot.
pub const DIALS: &[(&str, &[&str])] = &[
    ("preset", &["paper", "stable"]),
    ("r_split", &["0.001", "0.01", "0.05", "0.25", "0.5", "0.9"]),
    ("o_split", &["2", "3", "5", "8", "12", "24"]),
    ("leaf_size", &["fixed", "costs"]),
    ("r_merge", &["0", "0.01", "0.1", "0.25", "0.5", "0.75"]),
    ("o_merge", &["0", "1", "2", "3", "5", "8"]),
    ("axis", &["longest", "view"]),
    ("plane", &["middle", "sah"]),
    ("straddlers", &["leaf", "split", "parent"]),
    ("tight_boxes", &["never", "settled", "always"]),
    ("settle_frames", &["0", "1", "4", "16", "64"]),
    ("bulk_leaf", &["1", "2", "4", "8", "12", "32"]),
    ("cooldown", &["0", "5", "30", "120"]),
];

/// The names.
pub fn names() -> impl Iterator<Item = &'static str> {
    DIALS.iter().map(|(name, _)| *name)
}
