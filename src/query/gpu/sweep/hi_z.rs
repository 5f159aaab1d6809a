//! The test against the pyramid: one invocation a box.

use wgpu::{BindGroup, ComputePipeline, Device, ShaderModule};

use super::asked::Asked;
use super::pyramid::{self, Pyramid};
use super::{STAGES, compute, dispatch};
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct HiZ {
    layouts: Layouts,
    pipeline: ComputePipeline,
}

impl HiZ {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let buffers = &[(0, false), (2, true), (pyramid::BINDING, false)];
        let layouts = Layouts::new(device, STAGES, buffers, depth);
        let pipeline = compute(device, &layouts, module, "look");
        Self { layouts, pipeline }
    }

    /// Records the test of all proxies against a pyramid that has been built.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        asked: &Asked,
        pyramid: &Pyramid,
    ) {
        let Some(levels) = pyramid.binding() else { return };
        let buffers = [(0, asked.proxies()), (2, asked.verdicts()), (pyramid::BINDING, levels)];
        let bindings = bind::storage(tape.device, &self.layouts.batch, &buffers);
        dispatch(tape, "tercet hi-z", &self.pipeline, [frame, &bindings], asked.count());
    }
}
