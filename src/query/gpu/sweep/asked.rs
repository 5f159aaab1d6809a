//! What a sweep asks about, on the device: a proxy and a verdict each.

use wgpu::{Buffer, BufferBinding, BufferDescriptor, BufferUsages, Device};

use crate::Error;
use crate::query::gpu::guard::failed;
use crate::query::gpu::pack::PackedProxy;

/// The verdict on what is in sight, or cannot be asked about; see `shaders/shared/verdict.wgsl`.
pub(in crate::query::gpu) const SEEN: u32 = 2;
/// The verdict on what can own no sample.
pub(in crate::query::gpu) const OUTSIDE: u32 = 0;

/// Buffers that proxies are made in, and looked at.
#[derive(Debug)]
pub(in crate::query::gpu) struct Asked {
    proxies: Buffer,
    verdicts: Buffer,
    count: u32,
}

impl Asked {
    pub(in crate::query::gpu) fn new(device: &Device) -> Self {
        Self { proxies: proxies(device, 64), verdicts: verdicts(device, 64), count: 0 }
    }

    /// Makes room for a number of boxes. What was there is lost.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many proxies.
    pub(in crate::query::gpu) fn resize(&mut self, device: &Device, count: usize) -> Result<(), Error> {
        let most = device.limits().max_storage_buffer_binding_size / size_of::<PackedProxy>() as u64;
        if count as u64 > most {
            return Err(failed(format!("it binds {most} proxies at most, and {count} are asked about")));
        }
        if (count * size_of::<PackedProxy>()) as u64 > self.proxies.size() {
            let room = (count + count / 2).min(most as usize);
            (self.proxies, self.verdicts) = (proxies(device, room), verdicts(device, room));
        }
        self.count = count as u32;
        Ok(())
    }

    /// How many boxes are asked about.
    pub(in crate::query::gpu) fn count(&self) -> u32 {
        self.count
    }

    /// How many verdicts are bound, and come back: one at least.
    pub(in crate::query::gpu) fn words(&self) -> usize {
        self.count.max(1) as usize
    }

    /// The proxies as instances.
    pub(in crate::query::gpu) fn instances(&self) -> &Buffer {
        &self.proxies
    }

    /// All proxies, and no more.
    pub(in crate::query::gpu) fn proxies(&self) -> BufferBinding<'_> {
        exactly(&self.proxies, self.count, size_of::<PackedProxy>())
    }

    /// All verdicts, and no more.
    pub(in crate::query::gpu) fn verdicts(&self) -> BufferBinding<'_> {
        exactly(&self.verdicts, self.count, size_of::<u32>())
    }
}

/// The first elements of a buffer, but at least one: nothing can be bound of no length.
pub(in crate::query::gpu) fn exactly(buffer: &Buffer, count: u32, size: usize) -> BufferBinding<'_> {
    let bytes = u64::from(count.max(1)) * size as u64;
    BufferBinding { buffer, offset: 0, size: bytes.try_into().ok() }
}

fn proxies(device: &Device, count: usize) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet swept proxies"),
        size: (count * size_of::<PackedProxy>()) as u64,
        usage: BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

fn verdicts(device: &Device, count: usize) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet verdicts"),
        size: (count * size_of::<u32>()) as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
