//! The questions of one pass with the buffers that they need, from upload to read-back.

use std::num::NonZeroU64;
use std::ops::Range;

use bytemuck::{Pod, cast_slice, try_cast_slice};
use wgpu::{
    Buffer, BufferBinding, BufferDescriptor, BufferUsages, CommandEncoder, Device, QUERY_SET_MAX_QUERIES,
    QuerySet, QuerySetDescriptor, QueryType, Queue,
};

use super::bind;
use super::pack::{PackedCount, PackedProxy, PackedTile};
use super::questions::Questions;
use super::read_back::ReadBack;
pub(super) use super::read_back::State;

/// Buffers are reused from wave to wave: a batch belongs to one wave until its answers have been
/// delivered, or are no longer awaited and have arrived.
#[derive(Debug)]
pub(super) struct Batch {
    pub(super) questions: Questions,
    pub(super) proxies: Buffer,
    tiles: Buffer,
    counts: Buffer,
    /// Proxies of native queries.
    pub(super) drawn: Buffer,
    /// As many as there ever were queries, all but the last with the most that a set holds.
    sets: Vec<QuerySet>,
    /// What the queries found, 64 bits each.
    resolved: Buffer,
    /// Counts, and what the queries found after them.
    read_back: ReadBack,
}

impl Batch {
    pub(super) fn new(device: &Device) -> Self {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        Self {
            questions: Questions::default(),
            proxies: buffer::<PackedProxy>(device, "tercet proxies", 64, storage | BufferUsages::VERTEX),
            tiles: buffer::<PackedTile>(device, "tercet tiles", 64, storage),
            counts: buffer::<PackedCount>(device, "tercet counts", 64, storage | BufferUsages::COPY_SRC),
            drawn: buffer::<PackedProxy>(device, "tercet drawn", 64, storage | BufferUsages::VERTEX),
            sets: Vec::new(),
            resolved: buffer::<PackedCount>(device, "tercet resolved", 64, RESOLVED),
            read_back: ReadBack::new(device, bytes::<PackedCount>(64)),
        }
    }

    /// How far it has got.
    pub(super) fn state(&self) -> State {
        self.read_back.state()
    }

    /// Takes questions over and uploads them. The upload happens when the encoder is submitted.
    pub(super) fn load(&mut self, device: &Device, queue: &Queue, questions: &mut Questions) {
        let proxies = questions.proxies.len();
        grow::<PackedProxy>(device, &mut self.proxies, proxies);
        grow::<PackedTile>(device, &mut self.tiles, questions.tiles.len());
        grow::<PackedCount>(device, &mut self.counts, proxies);
        grow::<PackedProxy>(device, &mut self.drawn, questions.drawn.len());
        grow::<PackedCount>(device, &mut self.resolved, questions.queries.len());
        self.grow_sets(device, questions.queries.len());
        queue.write_buffer(&self.proxies, 0, cast_slice(&questions.proxies));
        queue.write_buffer(&self.tiles, 0, cast_slice(&questions.tiles));
        queue.write_buffer(&self.drawn, 0, cast_slice(&questions.drawn));
        // What comes back in exchange is empty and has room.
        std::mem::swap(&mut self.questions, questions);
        self.read_back.claim(device, self.result_bytes());
    }

    /// Makes room for a number of queries.
    fn grow_sets(&mut self, device: &Device, queries: usize) {
        let sets = queries.div_ceil(MOST_QUERIES);
        for i in 0..sets {
            // The last one of those in use may have been smaller.
            let wanted = (queries - i * MOST_QUERIES).next_power_of_two().clamp(64, MOST_QUERIES) as u32;
            if self.sets.get(i).is_some_and(|set| set.count() >= wanted) {
                continue;
            }
            let label = Some("tercet queries");
            let set = QuerySetDescriptor { label, ty: QueryType::Occlusion, count: wanted };
            let set = device.create_query_set(&set);
            match self.sets.get_mut(i) {
                Some(old) => *old = set,
                None => self.sets.push(set),
            }
        }
    }

    /// Records that all counts start at 0.
    pub(super) fn clear_counts(&self, encoder: &mut CommandEncoder) {
        encoder.clear_buffer(&self.counts, 0, Some(self.count_bytes()));
    }

    /// Records the way of the counts into memory that can be read.
    pub(super) fn copy_counts(&self, encoder: &mut CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.counts, 0, self.read_back.buffer(), 0, self.count_bytes());
    }

    /// Each set of native queries in use, with what its queries draw.
    pub(super) fn query_sets(&self) -> impl Iterator<Item = (&QuerySet, &[Range<u32>])> {
        self.sets.iter().zip(self.questions.queries.chunks(MOST_QUERIES))
    }

    /// Records the way of what the queries found into memory that can be read.
    pub(super) fn resolve_queries(&self, encoder: &mut CommandEncoder) {
        let mut at = 0;
        for (set, queries) in self.query_sets() {
            encoder.resolve_query_set(set, 0..queries.len() as u32, &self.resolved, at);
            at += RESULT * queries.len() as u64;
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, self.read_back.buffer(), self.counted_bytes(), at);
    }

    /// Asks for the results; to be called when the commands have been submitted.
    pub(super) fn await_results(&self) {
        self.read_back.await_bytes();
    }

    /// Hands the results out, one a proxy and one a native query, if they have arrived and can be
    /// read.
    pub(super) fn read<R>(&self, read: impl FnOnce(&[PackedCount]) -> R) -> Option<R> {
        self.read_back.read(|bytes| try_cast_slice(bytes).ok().map(read))?
    }

    /// Nobody waits for it any more. One that is on its way is freed when it has arrived.
    pub(super) fn forget(&mut self) {
        self.questions.clear();
        self.read_back.reclaim();
    }

    /// Frees a batch that nobody waits for, if it is not on its way; says whether it is free.
    pub(super) fn reclaim(&self) -> bool {
        self.questions.asked.is_empty() && self.read_back.reclaim()
    }

    /// What is asked about, and no more: proxies, their counts and, on demand, their tiles.
    pub(super) fn bindings(&self, with_tiles: bool) -> Vec<(u32, BufferBinding<'_>)> {
        let Questions { proxies, tiles, .. } = &self.questions;
        let mut all = vec![
            (bind::PROXIES, binding::<PackedProxy>(&self.proxies, proxies.len())),
            (1, binding::<PackedCount>(&self.counts, proxies.len())),
        ];
        if with_tiles {
            all.push((2, binding::<PackedTile>(&self.tiles, tiles.len())));
        }
        all
    }

    /// What native queries draw.
    pub(super) fn native_bindings(&self) -> [(u32, BufferBinding<'_>); 1] {
        [(bind::PROXIES, binding::<PackedProxy>(&self.drawn, self.questions.drawn.len()))]
    }

    fn count_bytes(&self) -> u64 {
        bytes::<PackedCount>(self.questions.proxies.len())
    }

    /// Where the results of queries begin.
    fn counted_bytes(&self) -> u64 {
        RESULT * self.questions.proxies.len() as u64
    }

    fn result_bytes(&self) -> u64 {
        bytes::<PackedCount>(self.questions.proxies.len() + self.questions.queries.len())
    }
}

/// The most queries that a set holds.
const MOST_QUERIES: usize = QUERY_SET_MAX_QUERIES as usize;

/// The bytes of a result: a count, or what a query found.
const RESULT: u64 = size_of::<PackedCount>() as u64;

const RESOLVED: BufferUsages = BufferUsages::QUERY_RESOLVE.union(BufferUsages::COPY_SRC);

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
