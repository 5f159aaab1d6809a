//! Triangles of a chunk: gathered, rejected if they cover no sample, and binned by bands of rows.

use glam::Mat4;

use super::clip::clip;
use super::pass::DrawCall;
use super::raster::{ALL_LANES, Id, LANES, TINY_SIDE, TinyBatch, Triangle};
use super::setup::{SMALL_EXTENT, first_sample, last_sample};
use super::simd::Isa;
use super::vertex::{CODE_W_MINUS_Z, CODE_Z, Screen, Vertex, clip_position};

/// A draw call in a wave: where its vertices and triangles lie in the wave's buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instance {
    /// Index of the draw call.
    pub(crate) call: u32,
    /// Its first vertex in the wave.
    pub(crate) first_vertex: u32,
    /// Its first triangle in the wave.
    pub(crate) first_triangle: u32,
    pub(crate) clip_from_object: Mat4,
}

/// What every chunk of a wave reads.
#[derive(Clone, Copy)]
pub(crate) struct Wave<'a> {
    pub(crate) screen: Screen,
    pub(crate) calls: &'a [DrawCall],
    pub(crate) instances: &'a [Instance],
    pub(crate) vertices: &'a [Vertex],
    /// Rows a band.
    pub(crate) band_rows: i32,
    /// Triangles of all instances.
    pub(crate) triangles: usize,
}

/// The triangles of a chunk that meet one band.
#[derive(Debug, Default)]
pub(crate) struct Bin {
    /// Batches with triangles in some lanes.
    whole: Vec<(TinyBatch, u32)>,
    /// Triangles picked from batches, packed: full but for the last.
    tiny: Vec<TinyBatch>,
    tiny_count: usize,
    pub(crate) singles: Vec<Triangle>,
}

impl Bin {
    /// The batches of tiny triangles, each with a bit for each lane that holds one.
    pub(crate) fn tiny(&self) -> impl Iterator<Item = (&TinyBatch, u32)> {
        let count = self.tiny_count;
        let packed = self.tiny[..count.div_ceil(LANES)].iter().enumerate();
        let packed = packed.map(move |(i, batch)| (batch, (1 << (count - i * LANES).min(LANES)) - 1));
        self.whole.iter().map(|(batch, lanes)| (batch, *lanes)).chain(packed)
    }

    fn clear(&mut self) {
        // The batches stay: what lies beyond the count is stale and never read.
        self.tiny_count = 0;
        self.whole.clear();
        self.singles.clear();
    }

    #[inline(always)]
    fn push_tiny(&mut self, from: &TinyBatch, i: usize, with_id: bool) {
        let (index, lane) = (self.tiny_count / LANES, self.tiny_count % LANES);
        if index == self.tiny.len() {
            self.tiny.push(TinyBatch::EMPTY);
        }
        let to = &mut self.tiny[index];
        for k in 0..3 {
            to.x[k][lane] = from.x[k][i];
            to.y[k][lane] = from.y[k][i];
            to.nearness[k][lane] = from.nearness[k][i];
        }
        if with_id {
            to.call[lane] = from.call[i];
            to.triangle[lane] = from.triangle[i];
        }
        self.tiny_count += 1;
    }
}

/// A run of a wave's triangles, and what it left in each band.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    bins: Vec<Bin>,
    /// Triangles that may cover a sample.
    pub(crate) kept: u64,
}

/// Tiny triangles of a batch from which it is kept as it is, gaps and all: a gap costs less than
/// to move a triangle.
const WHOLE_FROM: u32 = 6;

/// Triangles a chunk.
pub(crate) const CHUNK: usize = 2048;

impl Chunk {
    /// The bin of a band.
    pub(crate) fn bin(&self, band: usize) -> &Bin {
        &self.bins[band]
    }

    /// Empties the chunk for a number of bands; keeps its memory.
    pub(crate) fn reset(&mut self, bands: usize) {
        if self.bins.len() < bands {
            self.bins.resize_with(bands, Bin::default);
        }
        self.bins.iter_mut().for_each(Bin::clear);
        self.kept = 0;
    }
}

/// Bins the triangles of chunk `index` of a wave.
#[inline(always)]
pub(crate) fn bin<I: Isa, const WITH_IDS: bool>(wave: &Wave<'_>, index: usize, chunk: &mut Chunk) {
    let mut next = index * CHUNK;
    let end = (next + CHUNK).min(wave.triangles);
    let mut batch = TinyBatch::EMPTY;
    let mut filled = 0;
    let mut at = wave.instances.partition_point(|i| i.first_triangle as usize <= next) - 1;
    while next < end {
        let instance = &wave.instances[at];
        let geometry = wave.calls[instance.call as usize].geometry();
        let vertices = &wave.vertices[instance.first_vertex as usize..][..geometry.positions.len()];
        let first = next - instance.first_triangle as usize;
        let count = (geometry.indices.len() / 3 - first).min(end - next);
        let mut triangle = first as u32;
        let (corners, _) = geometry.indices[3 * first..3 * (first + count)].as_chunks::<3>();
        for corners in corners {
            let (a, b) = (&vertices[corners[0] as usize], &vertices[corners[1] as usize]);
            let c = &vertices[corners[2] as usize];
            if a.code | b.code | c.code != 0 {
                if a.code & b.code & c.code & (CODE_W_MINUS_Z | CODE_Z) == 0 {
                    let id = Id { call: instance.call, triangle };
                    clip_and_bin(wave, instance, corners, [*a, *b, *c], id, chunk);
                }
                triangle += 1;
                continue;
            }
            batch.x[0][filled] = a.x;
            batch.x[1][filled] = b.x;
            batch.x[2][filled] = c.x;
            batch.y[0][filled] = a.y;
            batch.y[1][filled] = b.y;
            batch.y[2][filled] = c.y;
            batch.nearness[0][filled] = a.nearness;
            batch.nearness[1][filled] = b.nearness;
            batch.nearness[2][filled] = c.nearness;
            if WITH_IDS {
                batch.call[filled] = instance.call;
                batch.triangle[filled] = triangle;
            }
            filled += 1;
            if filled == LANES {
                keep::<I, WITH_IDS>(wave, &batch, LANES, chunk);
                filled = 0;
            }
            triangle += 1;
        }
        next += count;
        at += 1;
    }
    keep::<I, WITH_IDS>(wave, &batch, filled, chunk);
}

/// Bins those of the first `count` triangles of a batch that may cover a sample. The other lanes
/// may hold anything, hence the wrapping arithmetic.
#[inline(always)]
fn keep<I: Isa, const WITH_IDS: bool>(wave: &Wave<'_>, batch: &TinyBatch, count: usize, chunk: &mut Chunk) {
    let mut empty = [0_i32; LANES];
    let mut not_tiny = [0_i32; LANES];
    let (mut first_row, mut last_row) = ([0_i32; LANES], [0_i32; LANES]);
    for i in 0..LANES {
        let x = [batch.x[0][i], batch.x[1][i], batch.x[2][i]];
        let y = [batch.y[0][i], batch.y[1][i], batch.y[2][i]];
        let (left, right) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
        let (top, bottom) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
        let columns = last_sample(right).min(wave.screen.width - 1) - first_sample(left).max(0);
        first_row[i] = first_sample(top).max(0);
        last_row[i] = last_sample(bottom).min(wave.screen.height - 1);
        let rows = last_row[i] - first_row[i];
        // Signs stand for truth: negative is true.
        empty[i] = columns | rows;
        not_tiny[i] = (TINY_SIDE - 1 - columns)
            | (TINY_SIDE - 1 - rows)
            | SMALL_EXTENT.wrapping_sub(right.wrapping_sub(left))
            | SMALL_EXTENT.wrapping_sub(bottom.wrapping_sub(top));
    }
    let mut kept = (I::negative(&empty) ^ ALL_LANES) & ((1 << count) - 1);
    let singles = I::negative(&not_tiny);
    chunk.kept += u64::from(kept.count_ones());
    let tiny = kept & !singles;
    if tiny.count_ones() >= WHOLE_FROM
        && let Some(band) = common_band(wave, tiny, &first_row, &last_row)
    {
        chunk.bins[band].whole.push((*batch, tiny));
        kept &= singles;
    }
    while kept != 0 {
        let i = kept.trailing_zeros() as usize;
        kept &= kept - 1;
        let (first, last) = bands(wave, first_row[i], last_row[i]);
        for bin in &mut chunk.bins[first..=last] {
            if singles & (1 << i) == 0 {
                bin.push_tiny(batch, i, WITH_IDS);
            } else {
                bin.singles.push(Triangle {
                    x: batch.x.map(|x| x[i]),
                    y: batch.y.map(|y| y[i]),
                    nearness: batch.nearness.map(|n| n[i]),
                    id: Id { call: batch.call[i], triangle: batch.triangle[i] },
                });
            }
        }
    }
}

/// The band that all triangles in some lanes lie in, if it is one.
#[inline(always)]
fn common_band(
    wave: &Wave<'_>,
    lanes: u32,
    first_row: &[i32; LANES],
    last_row: &[i32; LANES],
) -> Option<usize> {
    let (mut top, mut bottom) = (i32::MAX, i32::MIN);
    for i in 0..LANES {
        let present = lanes >> i & 1 != 0;
        top = if present { first_row[i].min(top) } else { top };
        bottom = if present { last_row[i].max(bottom) } else { bottom };
    }
    let (first, last) = bands(wave, top, bottom);
    (first == last).then_some(first)
}

#[inline(always)]
fn bands(wave: &Wave<'_>, first_row: i32, last_row: i32) -> (usize, usize) {
    if wave.band_rows >= wave.screen.height {
        return (0, 0);
    }
    ((first_row / wave.band_rows) as usize, (last_row / wave.band_rows) as usize)
}

#[inline(never)]
#[cold]
fn clip_and_bin(
    wave: &Wave<'_>,
    instance: &Instance,
    corners: &[u32; 3],
    v: [Vertex; 3],
    id: Id,
    chunk: &mut Chunk,
) {
    let positions = &wave.calls[instance.call as usize].geometry().positions;
    let at = |k: usize| clip_position(&instance.clip_from_object, positions[corners[k] as usize]);
    clip(&wave.screen, [at(0), at(1), at(2)], v, |triangle| {
        let first_row = first_sample(triangle.y.into_iter().min().unwrap_or(0)).max(0);
        let last_row = last_sample(triangle.y.into_iter().max().unwrap_or(0)).min(wave.screen.height - 1);
        if first_row > last_row {
            return;
        }
        chunk.kept += 1;
        let (first, last) = bands(wave, first_row, last_row);
        for bin in &mut chunk.bins[first..=last] {
            bin.singles.push(Triangle { id, ..triangle });
        }
    });
}
