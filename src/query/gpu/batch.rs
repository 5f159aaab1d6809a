//! The questions of one pass with the buffers that they need, from upload to read-back.

use std::num::NonZeroU64;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bytemuck::{Pod, cast_slice, try_cast_slice};
use wgpu::{Buffer, BufferBinding, BufferDescriptor, BufferUsages, CommandEncoder, Device, MapMode, Queue};

use super::pack::{PackedCount, PackedProxy, PackedTile};
use super::questions::Questions;

/// Buffers are reused from wave to wave: a batch belongs to one wave until its answers have been
/// delivered, or are no longer awaited and have arrived.
#[derive(Debug)]
pub(super) struct Batch {
    pub(super) questions: Questions,
    pub(super) proxies: Buffer,
    tiles: Buffer,
    counts: Buffer,
    read_back: Buffer,
    state: Arc<AtomicU8>,
}

/// How far a batch has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum State {
    /// Nobody's.
    Free,
    /// Its commands are recorded.
    Recorded,
    /// The device has it.
    Submitted,
    /// The counts can be read.
    Arrived,
    /// The counts will never come.
    Lost,
}

impl Batch {
    pub(super) fn new(device: &Device) -> Self {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        Self {
            questions: Questions::default(),
            proxies: buffer::<PackedProxy>(device, "tercet proxies", 64, storage | BufferUsages::VERTEX),
            tiles: buffer::<PackedTile>(device, "tercet tiles", 64, storage),
            counts: buffer::<PackedCount>(device, "tercet counts", 64, storage | BufferUsages::COPY_SRC),
            read_back: buffer::<PackedCount>(device, "tercet read-back", 64, READ_BACK),
            state: Arc::default(),
        }
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

    /// Takes questions over and uploads them. The upload happens when the encoder is submitted.
    pub(super) fn load(&mut self, device: &Device, queue: &Queue, questions: &mut Questions) {
        let proxies = questions.proxies.len();
        grow::<PackedProxy>(device, &mut self.proxies, proxies);
        grow::<PackedTile>(device, &mut self.tiles, questions.tiles.len());
        grow::<PackedCount>(device, &mut self.counts, proxies);
        grow::<PackedCount>(device, &mut self.read_back, proxies);
        queue.write_buffer(&self.proxies, 0, cast_slice(&questions.proxies));
        queue.write_buffer(&self.tiles, 0, cast_slice(&questions.tiles));
        // What comes back in exchange is empty and has room.
        std::mem::swap(&mut self.questions, questions);
        self.set(State::Recorded);
    }

    /// Records that all counts start at 0.
    pub(super) fn clear_counts(&self, encoder: &mut CommandEncoder) {
        encoder.clear_buffer(&self.counts, 0, Some(self.count_bytes()));
    }

    /// Records the way of the counts into memory that can be read.
    pub(super) fn copy_counts(&self, encoder: &mut CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.counts, 0, &self.read_back, 0, self.count_bytes());
    }

    /// Asks for the counts; to be called when the commands have been submitted.
    pub(super) fn await_counts(&self) {
        self.set(State::Submitted);
        let state = Arc::clone(&self.state);
        self.read_back.map_async(MapMode::Read, 0..self.count_bytes(), move |result| {
            let arrived = if result.is_ok() { State::Arrived } else { State::Lost };
            state.store(arrived as u8, Ordering::Release);
        });
    }

    /// Hands the counts out, one a proxy, if they have arrived and can be read.
    pub(super) fn read<R>(&self, read: impl FnOnce(&[PackedCount]) -> R) -> Option<R> {
        if self.state() != State::Arrived {
            return None;
        }
        let view = self.read_back.get_mapped_range(0..self.count_bytes()).ok()?;
        Some(read(try_cast_slice(&view).ok()?))
    }

    /// Nobody waits for it any more. One that is on its way is freed when it has arrived.
    pub(super) fn forget(&mut self) {
        self.questions.clear();
        self.reclaim();
        if self.state() == State::Recorded {
            self.set(State::Free);
        }
    }

    /// Frees a batch that nobody waits for, if it has arrived; says whether it is free.
    pub(super) fn reclaim(&mut self) -> bool {
        if !self.questions.asked.is_empty() {
            return false;
        }
        if self.state() == State::Arrived {
            self.read_back.unmap();
            self.set(State::Free);
        }
        self.state() == State::Free
    }

    /// What is asked about, and no more: proxies, their counts and, on demand, their tiles.
    pub(super) fn bindings(&self, with_tiles: bool) -> Vec<(u32, BufferBinding<'_>)> {
        let Questions { proxies, tiles, .. } = &self.questions;
        let mut all = vec![
            (0, binding::<PackedProxy>(&self.proxies, proxies.len())),
            (1, binding::<PackedCount>(&self.counts, proxies.len())),
        ];
        if with_tiles {
            all.push((2, binding::<PackedTile>(&self.tiles, tiles.len())));
        }
        all
    }

    fn count_bytes(&self) -> u64 {
        bytes::<PackedCount>(self.questions.proxies.len())
    }
}

const READ_BACK: BufferUsages = BufferUsages::MAP_READ.union(BufferUsages::COPY_DST);

/// The size of a number of elements; no buffer is bound, copied or mapped with none.
fn bytes<T: Pod>(count: usize) -> u64 {
    (count.max(1) * size_of::<T>()) as u64
}

fn binding<T: Pod>(buffer: &Buffer, count: usize) -> BufferBinding<'_> {
    BufferBinding { buffer, offset: 0, size: NonZeroU64::new(bytes::<T>(count)) }
}

fn buffer<T: Pod>(device: &Device, label: &str, count: usize, usage: BufferUsages) -> Buffer {
    let size = bytes::<T>(count);
    device.create_buffer(&BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

/// Makes room for a number of elements, twice as much as there was at least.
fn grow<T: Pod>(device: &Device, old: &mut Buffer, count: usize) {
    if bytes::<T>(count) > old.size() {
        let most = device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64;
        let room = (2 * old.size() / size_of::<T>() as u64).min(most).max(count as u64);
        *old = buffer::<T>(device, "tercet questions", room as usize, old.usage());
    }
}
