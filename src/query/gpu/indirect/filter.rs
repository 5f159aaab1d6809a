//! Occluder filtering without the host (Lee et al. 2021, *OF*): who was drawn and owns no sample of the item buffer is
//! forgotten, so that the next frame draws it first no more.

use wgpu::{BindGroup, Buffer, BufferBinding, Device, TextureView};

use super::super::clock::Tape;
use super::super::counter::compiled;
use super::super::shaders::Shaders;
use super::super::sweep::array::exactly;
use super::super::sweep::asked::{self, Verdicts};
use super::super::sweep::owners::{self, Owners};
use super::super::sweep::stage::Stage;
use super::IndirectCuller;
use crate::Error;
use crate::geom::View;

/// The passes, made when first needed.
#[derive(Debug)]
pub(super) struct Filter {
    /// For targets with one sample a pixel and with several.
    owners: [Option<Owners>; 2],
    keep: Stage,
    nothing: BindGroup,
    /// By slot.
    owned: Verdicts,
}

impl Filter {
    pub(super) fn new(device: &Device, shaders: &Shaders) -> Self {
        let keep = Stage::new(
            device,
            &compiled(device, &shaders.filter),
            ("tercet filter", "keep"),
            &[(0, false), (1, true)],
        );
        let nothing = keep.bind_nothing(device);
        Self { owners: [None, None], keep, nothing, owned: asked::verdicts(device) }
    }

    /// Records the looking through an item buffer, and the forgetting of `remembered` objects, by slot, that own
    /// nothing. To be called when everything that hides something is drawn.
    ///
    /// # Errors
    /// [`Error::Device`] if the device refuses the pass, or cannot bind so many verdicts.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        shaders: &Shaders,
        (frame, ids): (&Buffer, &TextureView),
        view: &View,
        (remembered, slots): (BufferBinding<'_>, u32),
    ) -> Result<(), Error> {
        let several = view.samples() > 1;
        let owners = match &mut self.owners[usize::from(several)] {
            Some(owners) => owners,
            none => none.insert(Owners::new(tape.device, shaders, several)?),
        };
        self.owned.resize(tape.device, slots as usize)?;
        owners.record(tape, (frame, ids), &self.owned, view.viewport());
        let buffers = [(0, self.owned.all()), (1, remembered)];
        self.keep.record(tape, &self.nothing, &buffers, slots);
        Ok(())
    }
}

impl IndirectCuller {
    /// Says where the next frames' *item buffer* is, if there is one: as
    /// [`GpuQueries::target_ids`](super::super::GpuQueries::target_ids) has it. The app writes it while it draws. What is drawn
    /// first in the next frame are then those that own a sample of it (*occluder filtering*), and not all of which
    /// the box has one in sight. It is checked when a frame is recorded.
    pub fn target_ids(&mut self, ids: Option<&TextureView>) {
        self.ids = ids.cloned();
    }

    /// Whether the item buffer, if there is one, fits a view.
    pub(super) fn check_ids(&self, view: &View) -> Result<(), Error> {
        self.ids.as_ref().map_or(Ok(()), |ids| owners::check(ids, view.viewport(), view.samples()))
    }

    /// Records the forgetting of who owns nothing, if there is an item buffer.
    pub(super) fn record_filter(&mut self, tape: &mut Tape<'_>, view: &View) -> Result<(), Error> {
        let Self { device, config, uniforms, boxes, remembered, ids: Some(ids), filter, .. } = self else {
            return Ok(());
        };
        if boxes.len() == 0 {
            return Ok(());
        }
        let filter = filter.get_or_insert_with(|| Filter::new(device, &config.shaders));
        let slots = boxes.len() as u32;
        let remembered = exactly(remembered, slots, size_of::<u32>());
        filter.record(tape, &config.shaders, (uniforms, ids), view, (remembered, slots))
    }
}
