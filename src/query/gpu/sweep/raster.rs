//! The test of ROC (Lee et al. 2021, and those before): proxies are drawn, and a fragment in sight
//! stores a flag. See `count_fragments.rs` for why no early depth test is forced.

use wgpu::{BindGroup, Device, ShaderModule};

use super::asked::Asked;
use super::stage::Drawn;
use crate::geom::Viewport;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Instances, Of};

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Raster(Drawn);

impl Raster {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs, of: Of) -> Self {
        let buffers = &[(0, false), (2, true)];
        Self(Drawn::new(device, module, ("tercet raster", "look"), buffers, (of, depth)))
    }

    /// Records the looking for samples in sight, of all instances that have a rectangle.
    pub(in crate::query::gpu) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        asked: &Asked,
        instances: Instances<'_>,
        viewport: Viewport,
    ) {
        let buffers = [(0, asked.proxies()), (2, asked.verdicts())];
        self.0.record(tape, frame, &buffers, instances, viewport);
    }
}
