//! Counting in a fragment shader: the rectangles of all proxies in one instanced draw.
//!
//! It needs nothing but storage buffers in fragment shaders; see `rectangles` for how.
//!
//! # No forced early depth test
//!
//! `@early_depth_test(force)` would spare hidden fragments their invocations where a device has it.
//! It is not used. Forced, the test sees the depth of the triangles, not one that the shader writes;
//! the entry depth is not planar, and the corners of its faces are snapped, which moves a tilted
//! plane by more than the bound in `pack.rs`. So it could decide no answer exactly: only sort out
//! what lies behind a proxy's nearest point. And hidden fragments must run all the same, to be
//! counted in the total: it would take a second draw of everything. On a software adapter, to
//! rasterise the pixels of large boxes twice without any fragment shader already takes about as long
//! as to count them in blocks (docs/measurements/queries.md).

use wgpu::{Device, ShaderModule, ShaderStages};

use super::batch::Batch;
use super::bind::{Bound, Layouts};
use super::clock::Tape;
use super::rectangles::{Instances, Of, Rectangles};
use crate::geom::Viewport;

/// The pass.
#[derive(Debug)]
pub(super) struct CountFragments(Rectangles);

impl CountFragments {
    /// The stages that read the frame and the depth.
    pub(super) const STAGES: ShaderStages = ShaderStages::VERTEX_FRAGMENT;

    /// Storage buffers of a batch, and whether they are written to.
    pub(super) const BUFFERS: &[(u32, bool)] = &[(0, false), (1, true)];

    pub(super) fn new(device: &Device, layouts: &Layouts, module: &ShaderModule) -> Self {
        Self(Rectangles::new(device, layouts, module, Of::Proxies, ("tercet count fragments", "count")))
    }

    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        bound: &Bound<'_>,
        batch: &Batch,
        viewport: Viewport,
    ) {
        let count = batch.questions.proxies.len() as u32;
        let proxies = Instances::Proxies(&batch.proxies, count);
        self.0.record(tape, [bound.frame, bound.batch], proxies, viewport);
    }
}
