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
            depth_slack: None,
            shaders: Shaders::default(),
        }
    }
}
