//! The dials of the backend.

use std::time::Duration;

use super::{Counting, Shaders};

/// Who answers [`Want::Any`](crate::query::Want::Any).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum AnyBy {
    /// The shaders that count, which stop at the first visible sample where they can.
    #[default]
    Counts,
    /// Native occlusion queries, one a question. They find visible whatever counting does, and
    /// hardly more: with a depth of 24 bits, what lies two units behind what is stored.
    Native,
}

/// Few objects are looked at more quickly than a pyramid is built.
pub(super) const PRUNE_FROM: usize = 16;

/// The dials of [`GpuQueries`](super::GpuQueries).
#[derive(Clone, Debug)]
pub struct GpuConfig {
    /// Who answers [`Want::Any`](crate::query::Want::Any); [`Want::Dual`](crate::query::Want::Dual) is always
    /// counted.
    pub any: AnyBy,
    /// How samples are counted; None for the best that the device supports: questions about many
    /// pixels by [`Counting::Blocks`], about few by the first of [`Counting::Subgroups`],
    /// [`Counting::Workgroups`] and [`Counting::Fragments`] that it can do.
    pub counting: Option<Counting>,
    /// The longest that [`Wait::Block`](crate::query::Wait::Block) waits.
    pub timeout: Duration,
    /// Sweeps of so many objects ask the pyramid of farthest depths first, and look closely at what it leaves
    /// open. What is found is the same, but where rounding alone decides; nothing that can be seen is lost.
    pub prune_from: usize,
    /// Sweeps by rays go by way of the tree on the device where the groups have so many objects, all together.
    /// Fewer are looked at one by one, as [`SweepTest::Raster`](crate::query::SweepTest::Raster) does, which
    /// finds the same: of up to 400 000 objects that took half the time, since the whole tree need not be kept
    /// on the device. What lies outside of the frustum is left out by subtrees either way. 0 for rays always.
    pub rays_from: usize,
    /// How much nearer than exact geometry may be stored beyond what `geom/proxy.rs` allows for;
    /// None for what the device's API is known to need: nothing but on OpenGL, which emulates the
    /// depth range.
    pub depth_slack: Option<f32>,
    /// The sources of the passes.
    pub shaders: Shaders,
}

impl Default for GpuConfig {
    fn default() -> Self {
        Self {
            any: AnyBy::default(),
            counting: None,
            timeout: Duration::from_secs(10),
            prune_from: PRUNE_FROM,
            rays_from: 1 << 20,
            depth_slack: None,
            shaders: Shaders::default(),
        }
    }
}
