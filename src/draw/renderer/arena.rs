//! Room on the device for what one frame draws.

use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device, Queue};

/// Hands out pieces of vertex buffers, one after the other, until the frame is over.
///
/// What `Queue::write_buffer` writes is there for all commands that are submitted after it, and the
/// passes of a frame may be submitted together: so no two pieces of a frame overlap. A buffer that
/// is full is followed by another and stays as it is, since passes refer to it. A frame that needs
/// no more than the frames before makes no buffer.
#[derive(Debug, Default)]
pub(super) struct Arena {
    buffers: Vec<Buffer>,
    /// The buffer that is being filled, and how much of it is.
    current: usize,
    used: u64,
}

/// Bytes of the first buffer; each later one has at least twice as many as the one before.
const FIRST: u64 = 1 << 16;

impl Arena {
    /// Starts anew: everything that was handed out may be overwritten.
    pub(super) fn clear(&mut self) {
        (self.current, self.used) = (0, 0);
    }

    /// Writes something of a length that is a multiple of 4, and returns where it is.
    pub(super) fn write(&mut self, device: &Device, queue: &Queue, bytes: &[u8]) -> (Buffer, u64) {
        let length = bytes.len() as u64;
        while self.buffers.get(self.current).is_some_and(|buffer| self.used + length > buffer.size()) {
            (self.current, self.used) = (self.current + 1, 0);
        }
        if self.current == self.buffers.len() {
            let size = self.buffers.last().map_or(FIRST, |last| 2 * last.size());
            // Beyond the device's limit only if this one piece is.
            let size = size.min(device.limits().max_buffer_size).max(length);
            self.buffers.push(device.create_buffer(&BufferDescriptor {
                label: Some("tercet frame's objects"),
                size: size.next_multiple_of(4),
                usage: BufferUsages::VERTEX | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        let (buffer, offset) = (&self.buffers[self.current], self.used);
        queue.write_buffer(buffer, offset, bytes);
        self.used += length;
        (buffer.clone(), offset)
    }

    /// How many buffers there are.
    pub(super) fn buffers(&self) -> usize {
        self.buffers.len()
    }
}
