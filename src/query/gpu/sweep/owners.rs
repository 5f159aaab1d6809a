//! Occluder filtering (HROC, *OF*): who owns a sample of what has been drawn?
//!
//! The app keeps an item buffer beside its colours: each draw writes who is drawn, where it passes the
//! depth test. So nothing is drawn twice, and each sample has one owner: of several objects at the same
//! depth, the one that was drawn last.

use wgpu::{Buffer, Device, TextureFormat, TextureUsages, TextureView};

use super::asked::Verdicts;
use super::stage::Stage;
use crate::Error;
use crate::geom::Viewport;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::counter::compiled;
use crate::query::gpu::guard::guarded;
use crate::query::gpu::shaders::Shaders;

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Owners(Stage);

impl Owners {
    /// # Errors
    /// [`Error::Device`] if the device refuses it.
    pub(in crate::query::gpu) fn new(
        device: &Device,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<Self, Error> {
        guarded(device, || {
            let module = compiled(device, shaders.sweep_owners.source(multisampled));
            let ids = DepthAs::Ids { multisampled };
            Self(Stage::on_texture(device, &module, ("tercet owners", "look"), &[(2, true)], ids))
        })
    }

    /// Records the looking through an item buffer: verdicts are by slot, and are none at first.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        (frame, ids): (&Buffer, &TextureView),
        verdicts: &Verdicts,
        viewport: Viewport,
    ) {
        tape.encoder.clear_buffer(verdicts.buffer(), 0, Some(verdicts.bytes()));
        let frame = self.0.bind(tape.device, frame, Some(ids));
        self.0.record_pixels(tape, &frame, &[(2, verdicts.all())], viewport);
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
