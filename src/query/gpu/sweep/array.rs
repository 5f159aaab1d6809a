//! Arrays that the device fills: their buffers grow with what they hold.

use std::marker::PhantomData;

use wgpu::{Buffer, BufferBinding, BufferDescriptor, BufferUsages, Device};

use crate::Error;
use crate::query::gpu::guard::failed;

/// A buffer of so many elements. One that is too small is made anew, with room for half as many again.
#[derive(Debug)]
pub(in crate::query::gpu) struct DeviceArray<T> {
    buffer: Buffer,
    label: &'static str,
    count: u32,
    element: PhantomData<fn() -> T>,
}

/// Elements that there is room for at first.
const FEW: usize = 64;

impl<T> DeviceArray<T> {
    /// An array of nothing.
    pub(in crate::query::gpu) fn new(device: &Device, label: &'static str, usage: BufferUsages) -> Self {
        Self { buffer: buffer::<T>(device, label, usage, FEW), label, count: 0, element: PhantomData }
    }

    /// The same of one that the host writes to, or clears.
    pub(in crate::query::gpu) fn written(device: &Device, label: &'static str) -> Self {
        Self::new(device, label, BufferUsages::STORAGE | BufferUsages::COPY_DST)
    }

    /// Makes room for a number of elements, and says whether what was there is lost.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(in crate::query::gpu) fn resize(&mut self, device: &Device, count: usize) -> Result<bool, Error> {
        let limit = device.limits().max_storage_buffer_binding_size;
        let most = limit as usize / size_of::<T>();
        if count > most {
            return Err(failed(format!(
                "{}: {count} elements, and with max_storage_buffer_binding_size = {limit} it binds {most} at most",
                self.label
            )));
        }
        let grows = (count * size_of::<T>()) as u64 > self.buffer.size();
        if grows {
            let room = (count + count / 2).min(most);
            self.buffer = buffer::<T>(device, self.label, self.buffer.usage(), room);
        }
        self.count = count as u32;
        Ok(grows)
    }

    pub(in crate::query::gpu) fn count(&self) -> u32 {
        self.count
    }

    pub(in crate::query::gpu) fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// How many elements are bound: one at least, since nothing can be bound of no length.
    pub(in crate::query::gpu) fn bound(&self) -> usize {
        self.count.max(1) as usize
    }

    /// Their bytes.
    pub(in crate::query::gpu) fn bytes(&self) -> u64 {
        (self.bound() * size_of::<T>()) as u64
    }

    /// All elements, and no more.
    pub(in crate::query::gpu) fn all(&self) -> BufferBinding<'_> {
        exactly(&self.buffer, self.count, size_of::<T>())
    }
}

/// The first elements of a buffer, but at least one: nothing can be bound of no length.
pub(in crate::query::gpu) fn exactly(buffer: &Buffer, count: u32, size: usize) -> BufferBinding<'_> {
    let bytes = u64::from(count.max(1)) * size as u64;
    BufferBinding { buffer, offset: 0, size: bytes.try_into().ok() }
}

fn buffer<T>(device: &Device, label: &str, usage: BufferUsages, count: usize) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size: (count * size_of::<T>()) as u64,
        usage,
        mapped_at_creation: false,
    })
}
