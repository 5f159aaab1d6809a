//! Speed against accuracy, in one value.

/// How much may be given up for speed. The default gives up nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Tradeoff {
    /// Samples that may be visible of a box that is culled all the same; 0 is exact. It holds for
    /// questions that count; an [`Any`](crate::query::Want::Any) question is always exact.
    pub visible_pixels: u32,
}

impl Tradeoff {
    /// No object that owns a sample is ever culled, whatever the policy.
    pub const EXACT: Self = Self { visible_pixels: 0 };
}
