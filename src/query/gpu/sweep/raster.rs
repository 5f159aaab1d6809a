//! The test of ROC (Lee et al. 2021, and those before): proxies are drawn, and a fragment in sight
//! stores a flag. See `count_fragments.rs` for why no early depth test is forced.

use wgpu::{BindGroup, Buffer, Device, ShaderModule};

use super::STAGES;
use super::asked::Asked;
use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::{Draws, Of, Rectangles};

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Raster {
    layouts: Layouts,
    rectangles: Rectangles,
}

impl Raster {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs, of: Of) -> Self {
        let layouts = Layouts::new(device, STAGES, &[(0, false), (2, true)], depth);
        let rectangles = Rectangles::new(device, &layouts, module, of, ("tercet raster", "look"));
        Self { layouts, rectangles }
    }

    /// Records the looking for samples in sight, of all instances that have a rectangle.
    pub(in crate::query::gpu) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        asked: &Asked,
        instances: (&Buffer, Draws<'_>),
        viewport: Viewport,
    ) {
        let buffers = [(0, asked.proxies()), (2, asked.verdicts())];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        self.rectangles.record(tape, [frame, &bindings], instances, viewport);
    }
}
