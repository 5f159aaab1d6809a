//! One sweep, from what is asked to the verdicts that come back.

use bytemuck::cast_slice;
use wgpu::{CommandEncoder, Device, Queue};

use super::array::DeviceArray;
use super::asked::{Asked, SEEN, Verdicts};
use super::grove::Groups;
use super::looks::Looks;
use super::targets::Targets;
use crate::Error;
use crate::query::Ticket;
use crate::query::gpu::read_back::ReadBack;
use crate::query::gpu::rectangles::List;
use crate::scene::{ObjectId, ObjectSet};

/// One sweep; its buffers are reused.
#[derive(Debug)]
pub(super) struct Swept {
    pub(super) ticket: Option<Ticket>,
    pub(super) targets: Targets,
    /// What looks at boxes, made by the first sweep that does.
    pub(super) looked: Option<Looked>,
    /// Verdicts by slot, made by the first sweep for owners.
    pub(super) owned: Option<Verdicts>,
    /// Whether this one is for owners.
    pub(super) is_for_owners: bool,
    /// Verdicts of the objects looked at one by one, after them those of the tree if rays were cast; or by slot.
    pub(super) read_back: ReadBack,
}

/// The objects whose boxes are looked at, on the device.
#[derive(Debug)]
pub(super) struct Looked {
    pub(super) slots: DeviceArray<u32>,
    pub(super) asked: Asked,
    /// Those of them that must be looked at closely.
    pub(super) open: List,
    /// Into which rays are cast.
    pub(super) groups: Groups,
}

impl Swept {
    fn new(device: &Device) -> Self {
        Self {
            ticket: None,
            targets: Targets::default(),
            looked: None,
            owned: None,
            is_for_owners: false,
            read_back: ReadBack::new(device, 256),
        }
    }

    /// One that nobody uses.
    pub(super) fn free(sweeps: &mut Vec<Self>, device: &Device) -> usize {
        let found = sweeps.iter().position(|swept| swept.ticket.is_none() && swept.read_back.reclaim());
        found.unwrap_or_else(|| {
            sweeps.push(Self::new(device));
            sweeps.len() - 1
        })
    }

    /// Adds the objects that these verdicts are in favour of.
    pub(super) fn read(&self, verdicts: &[u32], looks: Option<&Looks>, found: &mut ObjectSet) {
        for (index, &id) in self.targets.ids.iter().enumerate() {
            let index = if self.is_for_owners { id.slot() } else { index };
            if verdicts.get(index) == Some(&SEEN) {
                found.insert(id);
            }
        }
        if let (false, Some(looked), Some(looks)) = (self.is_for_owners, &self.looked, looks) {
            let below = verdicts.get(looked.asked.found().bound()..).unwrap_or(&[]);
            looks.found_below(&looked.groups, below, found);
        }
    }
}

impl Looked {
    pub(super) fn new(device: &Device) -> Self {
        let slots = DeviceArray::written(device, "tercet swept slots");
        Self { slots, asked: Asked::new(device), open: List::new(device), groups: Groups::new(device) }
    }

    /// Uploads which objects are asked about. The upload happens when the encoder is submitted.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(super) fn load(&mut self, device: &Device, queue: &Queue, ids: &[ObjectId]) -> Result<(), Error> {
        self.asked.resize(device, ids.len())?;
        self.open.resize(device, queue, ids.len())?;
        self.slots.resize(device, ids.len())?;
        let listed: Vec<u32> = ids.iter().map(|id| id.slot() as u32).collect();
        queue.write_buffer(self.slots.buffer(), 0, cast_slice(&listed));
        Ok(())
    }
}

/// Records the way of verdicts into memory that can be read.
pub(super) fn copy_verdicts(encoder: &mut CommandEncoder, verdicts: &Verdicts, to: &ReadBack) {
    encoder.copy_buffer_to_buffer(verdicts.buffer(), 0, to.buffer(), 0, verdicts.bytes());
}
