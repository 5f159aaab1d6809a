//! The test against the pyramid: one invocation a box.

use wgpu::{BindGroup, Device, ShaderModule};

use super::asked::Asked;
use super::pyramid::{self, Pyramid};
use super::stage::Stage;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct HiZ(Stage);

impl HiZ {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let buffers = &[(0, false), (2, true), (pyramid::BINDING, false)];
        Self(Stage::on_texture(device, module, ("tercet hi-z", "look"), buffers, depth))
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
        self.0.record(tape, frame, &buffers, asked.count());
    }
}
