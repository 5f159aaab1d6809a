//! A buffer whose bytes come back from the device some time after a submission.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device, MapMode};

/// The buffer, and how far it has got.
#[derive(Debug)]
pub(super) struct ReadBack {
    buffer: Buffer,
    /// How many bytes come back.
    bytes: u64,
    state: Arc<AtomicU8>,
}

/// How far a read-back has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum State {
    /// Nobody's.
    Free,
    /// The commands that fill it are recorded.
    Recorded,
    /// The device has them.
    Submitted,
    /// It can be read.
    Arrived,
    /// It will never come.
    Lost,
}

impl ReadBack {
    pub(super) fn new(device: &Device, bytes: u64) -> Self {
        Self { buffer: buffer(device, bytes), bytes, state: Arc::default() }
    }

    pub(super) fn state(&self) -> State {
        match self.state.load(Ordering::Acquire) {
            0 => State::Free,
            1 => State::Recorded,
            2 => State::Submitted,
            3 => State::Arrived,
            _ => State::Lost,
        }
    }

    fn set(&self, state: State) {
        self.state.store(state as u8, Ordering::Release);
    }

    /// Makes room, for twice as much as there was at least, and says that commands will fill it.
    pub(super) fn claim(&mut self, device: &Device, bytes: u64) {
        if bytes > self.buffer.size() {
            self.buffer = buffer(device, bytes.max(2 * self.buffer.size()));
        }
        self.bytes = bytes;
        self.set(State::Recorded);
    }

    /// What the commands fill.
    pub(super) fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Asks for the bytes; to be called when the commands have been submitted.
    pub(super) fn await_bytes(&self) {
        self.set(State::Submitted);
        let state = Arc::clone(&self.state);
        self.buffer.map_async(MapMode::Read, 0..self.bytes, move |result| {
            let arrived = if result.is_ok() { State::Arrived } else { State::Lost };
            state.store(arrived as u8, Ordering::Release);
        });
    }

    /// Hands the bytes out, if they have arrived and can be read.
    pub(super) fn read<R>(&self, read: impl FnOnce(&[u8]) -> R) -> Option<R> {
        if self.state() != State::Arrived {
            return None;
        }
        let view = self.buffer.get_mapped_range(0..self.bytes).ok()?;
        Some(read(&view))
    }

    /// To be called when nobody waits for it: frees it if it is not on its way, and says whether it
    /// is free.
    pub(super) fn reclaim(&self) -> bool {
        match self.state() {
            State::Arrived => {
                self.buffer.unmap();
                self.set(State::Free);
            }
            State::Recorded => self.set(State::Free),
            _ => {}
        }
        self.state() == State::Free
    }
}

fn buffer(device: &Device, size: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("tercet read-back"),
        size,
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
