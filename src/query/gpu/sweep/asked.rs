//! What a sweep asks about, on the device: a proxy and a verdict each.

use wgpu::{Buffer, BufferBinding, BufferUsages, Device};

use super::array::DeviceArray;
use crate::Error;
use crate::query::gpu::pack::PackedProxy;

/// The verdict on what is in sight, or cannot be asked about; see `shaders/shared/verdict.wgsl`.
pub(in crate::query::gpu) const SEEN: u32 = 2;
/// The verdict on what can own no sample.
pub(in crate::query::gpu) const OUTSIDE: u32 = 0;

/// One of these each.
pub(in crate::query::gpu) type Verdicts = DeviceArray<u32>;

/// Verdicts on nothing.
pub(in crate::query::gpu) fn verdicts(device: &Device) -> Verdicts {
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    DeviceArray::new(device, "tercet verdicts", usage)
}

/// Arrays that proxies are made in, and looked at.
#[derive(Debug)]
pub(in crate::query::gpu) struct Asked {
    proxies: DeviceArray<PackedProxy>,
    verdicts: Verdicts,
}

impl Asked {
    pub(in crate::query::gpu) fn new(device: &Device) -> Self {
        let usage = BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC;
        let proxies = DeviceArray::new(device, "tercet swept proxies", usage);
        Self { proxies, verdicts: verdicts(device) }
    }

    /// Makes room for a number of boxes. What was there is lost.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many proxies.
    pub(in crate::query::gpu) fn resize(&mut self, device: &Device, count: usize) -> Result<(), Error> {
        self.proxies.resize(device, count)?;
        self.verdicts.resize(device, count)?;
        Ok(())
    }

    /// How many boxes are asked about.
    pub(in crate::query::gpu) fn count(&self) -> u32 {
        self.proxies.count()
    }

    /// The proxies as instances.
    pub(in crate::query::gpu) fn instances(&self) -> &Buffer {
        self.proxies.buffer()
    }

    /// All proxies, and no more.
    pub(in crate::query::gpu) fn proxies(&self) -> BufferBinding<'_> {
        self.proxies.all()
    }

    /// All verdicts, and no more.
    pub(in crate::query::gpu) fn verdicts(&self) -> BufferBinding<'_> {
        self.verdicts.all()
    }

    /// The same, to be copied.
    pub(super) fn found(&self) -> &Verdicts {
        &self.verdicts
    }
}
