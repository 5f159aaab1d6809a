//! What the software backend counts.

use super::bands::Work;

/// Counters since [`QueryBackend::begin`](crate::query::QueryBackend::begin).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SoftwareStats {
    /// Draw calls recorded.
    pub calls: u64,
    /// Draw calls that were skipped whole: out of view, or behind what was already drawn.
    pub skipped_calls: u64,
    /// Triangles of the draw calls that were not skipped.
    pub triangles: u64,
    /// Triangles of those that had a sample in their bounding box, whichever side they show, but for
    /// those of parts that were hidden where they begin. What clipping leaves of a triangle counts by pieces.
    pub rasterised: u64,
    /// Boxes asked about.
    pub boxes: u64,
    /// Sweeps, but for those about owners.
    pub sweeps: u64,
    /// Boxes of nodes that sweeps have tested.
    pub sweep_nodes: u64,
    /// Rays that went down the subtrees of groups.
    pub rays: u64,
    /// Objects whose own boxes sweeps have tested.
    pub swept: u64,
    /// Objects that sweeps have found.
    pub flagged: u64,
}

impl SoftwareStats {
    /// Adds what a run of the pipeline did with so many draw calls.
    pub(super) fn add(&mut self, calls: usize, work: Work) {
        self.calls += calls as u64;
        self.skipped_calls += calls as u64 - work.calls;
        self.triangles += work.triangles;
        self.rasterised += work.kept;
    }
}
