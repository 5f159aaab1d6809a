//! Occluder filtering (HROC, *OF*): who owns a sample of what has been drawn?
//!
//! The app keeps an item buffer beside its colours: each draw writes who is drawn, where it passes the
//! depth test. So nothing is drawn twice, and each sample has one owner: of several objects at the same
//! depth, the one that was drawn last.

use wgpu::{
    Buffer, BufferBinding, ComputePipeline, Device, ShaderModule, TextureFormat, TextureUsages, TextureView,
};

use super::{STAGES, compute};
use crate::Error;
use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;

/// The pass.
#[derive(Debug)]
pub(super) struct Owners {
    layouts: Layouts,
    pipeline: ComputePipeline,
}

impl Owners {
    pub(super) fn new(device: &Device, module: &ShaderModule, multisampled: bool) -> Self {
        let layouts = Layouts::new(device, STAGES, &[(2, true)], DepthAs::Ids { multisampled });
        let pipeline = compute(device, &layouts, module, "look");
        Self { layouts, pipeline }
    }

    /// Records the looking through an item buffer: verdicts are by slot, and are none at first.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        (frame, ids): (&Buffer, &TextureView),
        verdicts: BufferBinding<'_>,
        viewport: Viewport,
    ) {
        /// Invocations along each side of a workgroup, as the shader has them.
        const SIDE: u32 = 8;
        tape.encoder.clear_buffer(verdicts.buffer, 0, verdicts.size.map(Into::into));
        let frame = bind::frame(tape.device, &self.layouts.frame, frame, Some(ids));
        let bindings = bind::storage(tape.device, &self.layouts.batch, &[(2, verdicts)]);
        let mut pass = tape.compute_pass("tercet owners");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame, &[]);
        pass.set_bind_group(1, &bindings, &[]);
        pass.dispatch_workgroups(viewport.width.div_ceil(SIDE), viewport.height.div_ceil(SIDE), 1);
    }
}

/// Whether an item buffer can be read of a view with so many samples.
pub(in crate::query::gpu) fn check(ids: &TextureView, viewport: Viewport, samples: u32) -> Result<(), Error> {
    let texture = ids.texture();
    let unusable = |why: String| Err(Error::Target { why });
    if !matches!(texture.format(), TextureFormat::R32Uint | TextureFormat::Rg16Uint) {
        return unusable(format!("{:?} holds no ids: use Rg16Uint or R32Uint", texture.format()));
    }
    if !texture.usage().contains(TextureUsages::TEXTURE_BINDING) {
        return unusable("a texture of ids needs the usage TEXTURE_BINDING".into());
    }
    if texture.sample_count() != samples {
        let count = texture.sample_count();
        return unusable(format!("the ids have {count} samples a pixel, and the depth has {samples}"));
    }
    let (right, lower) = (viewport.x + viewport.width, viewport.y + viewport.height);
    if right > texture.width() || lower > texture.height() {
        return unusable("the ids are smaller than the viewport".into());
    }
    Ok(())
}
