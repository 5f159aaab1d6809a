//! Sweeps that a policy asks for: the device looks, and the host reads the verdicts back.

use bytemuck::try_cast_slice;

use super::asked;
use super::looks::Looks;
use super::owners::Owners;
use super::swept::{Swept, copy_verdicts};
use crate::Error;
use crate::query::gpu::read_back::State;
use crate::query::gpu::{GpuQueries, frame, guard};
use crate::query::{Answer, Sweep, SweepTest, Ticket};
use crate::scene::ObjectSet;

/// The sweeps of a view, and what each kind of them needs, made by the first of its kind.
#[derive(Debug, Default)]
pub(in crate::query::gpu) struct Sweeps {
    pub(super) looks: Option<Looks>,
    /// For targets with one sample a pixel and with several.
    owners: [Option<Owners>; 2],
    pub(super) sweeps: Vec<Swept>,
    /// What could not be asked.
    refused: Vec<Ticket>,
    /// Why, of the last one.
    refusal: Option<Error>,
}

impl Sweeps {
    /// Forgets all sweeps, and the frame.
    pub(in crate::query::gpu) fn forget(&mut self) {
        self.refused.clear();
        self.looks.iter_mut().for_each(Looks::forget);
        for swept in &mut self.sweeps {
            swept.ticket = None;
            swept.read_back.reclaim();
        }
        self.sweeps.retain(|swept| swept.read_back.state() != State::Lost);
    }

    /// Another frame begins.
    pub(in crate::query::gpu) fn restart(&mut self) {
        self.refusal = None;
    }

    /// Whether the read-back of some sweep is in a state, and somebody waits for it.
    pub(in crate::query::gpu) fn any(&self, state: State) -> bool {
        self.sweeps.iter().any(|swept| swept.ticket.is_some() && swept.read_back.state() == state)
    }

    /// Asks for the verdicts of what was recorded; to be called when it has been submitted.
    pub(in crate::query::gpu) fn submitted(&self) {
        let recorded = self.sweeps.iter().filter(|swept| swept.read_back.state() == State::Recorded);
        recorded.for_each(|swept| swept.read_back.await_bytes());
    }

    /// Hands out what has arrived; with `all`, everything else as unknown.
    pub(in crate::query::gpu) fn deliver(&mut self, all: bool, deliver: &mut impl FnMut(Ticket, Answer<'_>)) {
        for ticket in self.refused.drain(..) {
            deliver(ticket, Answer::Unknown);
        }
        let mut found = ObjectSet::default();
        for swept in &mut self.sweeps {
            let Some(ticket) = swept.ticket else { continue };
            found.clear();
            let arrived = swept.read_back.read(|bytes| {
                let verdicts: &[u32] = try_cast_slice(bytes).unwrap_or(&[]);
                swept.read(verdicts, self.looks.as_ref(), &mut found);
            });
            match arrived {
                Some(()) => deliver(ticket, Answer::Swept(&found)),
                None if all => deliver(ticket, Answer::Unknown),
                None => continue,
            }
            swept.ticket = None;
            swept.read_back.reclaim();
        }
    }
}

impl GpuQueries {
    /// Why a sweep of the frame that was begun last is answered with [`Answer::Unknown`], if one is that the
    /// device cannot hold: [`Error::Device`] with the limit that is in its way. Of several, the last one.
    pub fn refusal(&self) -> Option<&Error> {
        self.sweeps.as_ref().and_then(|sweeps| sweeps.refusal.as_ref())
    }

    /// Records a sweep against what has been drawn so far. What the device cannot hold is unknown.
    pub(in crate::query::gpu) fn record_sweep(
        &mut self,
        ticket: Ticket,
        sweep: &Sweep<'_>,
    ) -> Result<(), Error> {
        match sweep.test {
            SweepTest::Owners => self.open_sweeps()?,
            _ => self.bind_looks()?,
        }
        let recorded = match sweep.test {
            SweepTest::Owners => self.record_owners(sweep),
            SweepTest::Rays if self.has_few(sweep) => {
                self.record_looks(sweep, Some(SweepTest::Raster)).map(Some)
            }
            SweepTest::Rays => match self.record_looks(sweep, Some(sweep.test)) {
                // The tree is more than the device can bind: its objects may not be.
                Err(Error::Device { .. }) => self.record_looks(sweep, Some(SweepTest::Raster)).map(Some),
                recorded => recorded.map(Some),
            },
            test => self.record_looks(sweep, Some(test)).map(Some),
        };
        let sweeps = self.sweeps.as_mut().expect("they are open");
        match recorded {
            Ok(Some(index)) => sweeps.sweeps[index].ticket = Some(ticket),
            Ok(None) => sweeps.refused.push(ticket),
            // What the device cannot do for a sweep is not the frame's failure.
            Err(error @ Error::Device { .. }) => {
                sweeps.refused.push(ticket);
                sweeps.refusal = Some(error);
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Whether all groups of a sweep have too few objects for the device to take the way of the tree. O(groups).
    fn has_few(&self, sweep: &Sweep<'_>) -> bool {
        let tree = sweep.scene.tree();
        let objects: usize = sweep.groups.iter().map(|&group| tree.count(group)).sum();
        objects < self.config.rays_from
    }

    /// Records the looking through the item buffer, if there is one; returns which sweep it is.
    fn record_owners(&mut self, sweep: &Sweep<'_>) -> Result<Option<usize>, Error> {
        let (device, several) = (&self.device, sweep.view.samples() > 1);
        let frame = self.frame.as_mut().ok_or_else(frame::not_begun)?;
        let Some(ids) = frame.ids.as_ref() else { return Ok(None) };
        let Sweeps { owners, sweeps, .. } = self.sweeps.as_mut().expect("they are open");
        let owners = match &mut owners[usize::from(several)] {
            Some(owners) => owners,
            none => none.insert(Owners::new(device, &self.config.shaders, several)?),
        };
        guard::guarded(device, || {
            let index = Swept::free(sweeps, device);
            let swept = &mut sweeps[index];
            swept.is_for_owners = true;
            swept.targets.ids.clear();
            swept.targets.ids.extend_from_slice(sweep.loose);
            let verdicts = swept.owned.get_or_insert_with(|| asked::verdicts(device));
            verdicts.resize(device, sweep.scene.slot_bound())?;
            swept.read_back.claim(device, verdicts.bytes());
            let mut tape = frame::tape(&mut frame.encoder, device, &mut self.clock);
            owners.record(&mut tape, (&self.uniforms, ids), verdicts, frame.view.viewport());
            copy_verdicts(tape.encoder, verdicts, &swept.read_back);
            self.stats.sweeps += 1;
            self.stats.swept += sweep.loose.len() as u64;
            Ok(Some(index))
        })?
    }

    /// Gets ready to sweep. What was asked before is recorded first: it is about the same depth.
    pub(super) fn open_sweeps(&mut self) -> Result<(), Error> {
        self.record_questions()?;
        self.open_first()?;
        self.sweeps.get_or_insert_default();
        Ok(())
    }
}
