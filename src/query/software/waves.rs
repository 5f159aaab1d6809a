//! The raster pipeline: draw calls in, samples out.
//!
//! Draw calls are gathered into *waves* that fit the cache. Of each wave, vertices are transformed
//! once, in parallel; chunks of triangles are set up and binned by bands of rows, in parallel; then
//! every band is rasterised, in parallel, each by one thread that owns its rows (all by one where
//! there is little to do). Nothing is locked,
//! and no result depends on who did what. With one thread there is one band, and each chunk is
//! rasterised while it is in the cache. All buffers are kept between frames.

use rayon::prelude::*;

use super::bin::{CHUNK, Chunk, Instance, Wave};
use super::hi_z::TILE_HEIGHT;
use super::instance::Footprint;
use super::pass::DrawCall;
use super::raster::Sink;
use super::simd::{self, SimdLevel};
use super::vertex::{Screen, Vertex};

/// The most bands of rows.
pub(crate) const MOST_BANDS: usize = 64;
/// A wave ends after this many vertices or triangles a thread: 16 bytes a vertex, half of an
/// ordinary second-level cache.
const WAVE: usize = 32_768;
/// Triangles or vertices from which a wave is shared among threads. Below, waking another thread
/// takes longer than the work.
const SHARED_FROM: usize = 8192;
/// Vertices a task.
const VERTICES: usize = 4096;

/// Buffers that are reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Waves {
    footprints: Vec<Footprint>,
    instances: Vec<Instance>,
    vertices: Vec<Vertex>,
    chunks: Vec<Chunk>,
}

/// What a run of the pipeline did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Work {
    /// Draw calls that were not skipped.
    pub(crate) calls: u64,
    /// Triangles of those.
    pub(crate) triangles: u64,
    /// Triangles that could cover a sample.
    pub(crate) kept: u64,
}

/// Rows a band, for the threads at hand.
pub(crate) fn band_rows(height: u32) -> usize {
    let threads = rayon::current_num_threads();
    // More bands than threads, so that a busy one does not hold up the rest.
    let bands = if threads == 1 { 1 } else { (4 * threads).min(MOST_BANDS) };
    (height as usize).div_ceil(bands).next_multiple_of(TILE_HEIGHT as usize)
}

impl Waves {
    /// Bounds what each draw call touches; see [`Waves::footprints`].
    pub(crate) fn survey(
        &mut self,
        calls: &[DrawCall],
        footprint: impl Fn(&DrawCall) -> Footprint + Send + Sync,
    ) {
        self.footprints.clear();
        self.footprints.par_extend(calls.par_iter().with_min_len(64).map(footprint));
    }

    /// The footprints of the draw calls last surveyed.
    pub(crate) fn footprints(&self) -> &[Footprint] {
        &self.footprints
    }

    /// Rasterises the draw calls last surveyed, but for those that cover nothing, into one sink a
    /// band.
    pub(crate) fn rasterise<S: Sink + Send>(
        &mut self,
        simd: SimdLevel,
        screen: Screen,
        calls: &[DrawCall],
        band_rows: usize,
        sinks: &mut [S],
    ) -> Work {
        let limit = WAVE * rayon::current_num_threads().min(8);
        let mut work = Work::default();
        let (mut vertices, mut triangles) = (0, 0);
        self.instances.clear();
        for index in 0..calls.len() {
            if self.footprints[index].rect.is_none() {
                continue;
            }
            let geometry = calls[index].geometry();
            if geometry.indices.is_empty() {
                continue;
            }
            work.calls += 1;
            work.triangles += calls[index].triangle_count() as u64;
            self.instances.push(Instance {
                call: index as u32,
                first_vertex: vertices as u32,
                first_triangle: triangles as u32,
                clip_from_object: self.footprints[index].clip_from_object,
            });
            vertices += geometry.positions.len();
            triangles += calls[index].triangle_count();
            if vertices >= limit || triangles >= limit {
                work.kept += self.flush(simd, screen, calls, (vertices, triangles), band_rows, sinks);
                (vertices, triangles) = (0, 0);
                self.instances.clear();
            }
        }
        if triangles > 0 {
            work.kept += self.flush(simd, screen, calls, (vertices, triangles), band_rows, sinks);
        }
        work
    }

    /// Rasterises one wave; returns how many triangles could cover a sample.
    fn flush<S: Sink + Send>(
        &mut self,
        simd: SimdLevel,
        screen: Screen,
        calls: &[DrawCall],
        (vertices, triangles): (usize, usize),
        band_rows: usize,
        sinks: &mut [S],
    ) -> u64 {
        if self.vertices.len() < vertices {
            self.vertices.resize(vertices, Vertex::default());
        }
        let instances = &self.instances;
        let parallel = rayon::current_num_threads() > 1 && vertices.max(triangles) >= SHARED_FROM;
        let transform = |(task, out): (usize, &mut [Vertex])| {
            transform_task(simd, &screen, calls, instances, task * VERTICES, out);
        };
        if parallel {
            self.vertices[..vertices].par_chunks_mut(VERTICES).enumerate().for_each(transform);
        } else {
            self.vertices[..vertices].chunks_mut(VERTICES).enumerate().for_each(transform);
        }
        let wave = Wave {
            screen,
            calls,
            instances,
            vertices: &self.vertices[..vertices],
            band_rows: band_rows as i32,
            triangles,
        };
        let bin = |index: usize, chunk: &mut Chunk, bands: usize| {
            chunk.reset(bands);
            if S::WANTS_IDS {
                simd::bin::<true>(simd, &wave, index, chunk);
            } else {
                simd::bin::<false>(simd, &wave, index, chunk);
            }
        };
        let count = triangles.div_ceil(CHUNK);
        let bands = sinks.len();
        let wanted = if parallel { count } else { 1 };
        if self.chunks.len() < wanted {
            self.chunks.resize_with(wanted, Chunk::default);
        }
        if parallel {
            let chunks = &mut self.chunks[..count];
            chunks.par_iter_mut().enumerate().for_each(|(index, chunk)| bin(index, chunk, bands));
            let chunks = &self.chunks[..count];
            sinks.par_iter_mut().enumerate().for_each(|(band, sink)| simd::band(simd, chunks, band, sink));
            return chunks.iter().map(|c| c.kept).sum();
        }
        let mut kept = 0;
        for index in 0..count {
            let chunk = &mut self.chunks[0];
            bin(index, chunk, bands);
            kept += chunk.kept;
            for (band, sink) in sinks.iter_mut().enumerate() {
                simd::band(simd, &self.chunks[..1], band, sink);
            }
        }
        kept
    }
}

/// Transforms a run of a wave's vertices, which may belong to several draw calls.
fn transform_task(
    simd: SimdLevel,
    screen: &Screen,
    calls: &[DrawCall],
    instances: &[Instance],
    first: usize,
    out: &mut [Vertex],
) {
    let mut done = 0;
    let mut at = instances.partition_point(|i| i.first_vertex as usize <= first) - 1;
    while done < out.len() {
        let instance = &instances[at];
        let positions = &calls[instance.call as usize].geometry().positions;
        let start = first + done - instance.first_vertex as usize;
        let count = (positions.len() - start).min(out.len() - done);
        let positions = &positions[start..start + count];
        simd::transform(simd, screen, &instance.clip_from_object, positions, &mut out[done..done + count]);
        done += count;
        at += 1;
    }
}
