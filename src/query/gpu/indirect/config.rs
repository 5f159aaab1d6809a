//! The dials of indirect frames.

use super::super::config::PRUNE_FROM;
use super::super::shaders::Shaders;
use crate::query::SweepTest;

/// The dials of an [`IndirectCuller`](super::IndirectCuller).
#[derive(Clone, Debug)]
pub struct IndirectConfig {
    /// How objects are tested. [`SweepTest::HiZ`] is the fastest, and calls some of the hidden ones
    /// visible; [`SweepTest::Raster`] draws the proxies, which is exact; [`SweepTest::Rays`] those of
    /// groups, which finds the same. Groups are nodes of the tree: it should be a fine one from the
    /// beginning ([`TreeConfig::unasked_leaf`](crate::tree::TreeConfig::unasked_leaf)).
    /// [`SweepTest::Owners`] is no test of objects that are not drawn yet: it is taken for `Raster`.
    pub test: SweepTest,
    /// By rays, a group that covers more of the screen is opened; 1 opens only what may hold the eye.
    pub share: f32,
    /// Whether the counters of [`IndirectStats`](super::IndirectStats) come back, some frames late. Nothing
    /// waits for them.
    pub counters: bool,
    /// See [`GpuConfig::prune_from`](super::super::GpuConfig::prune_from).
    pub prune_from: usize,
    /// See [`GpuConfig::depth_slack`](super::super::GpuConfig::depth_slack).
    pub depth_slack: Option<f32>,
    /// The sources of the passes.
    pub shaders: Shaders,
}

impl Default for IndirectConfig {
    fn default() -> Self {
        Self {
            test: SweepTest::HiZ,
            share: 0.25,
            counters: false,
            prune_from: PRUNE_FROM,
            depth_slack: None,
            shaders: Shaders::default(),
        }
    }
}
