//! The raster pipeline: draw calls in, samples out.
//!
//! The screen is cut into bands of rows, which fit an ordinary second-level cache up to a width of
//! 4096 pixels. Each draw call is bounded once and listed in the bands that it may touch; then every
//! band takes its calls in order, each by one thread: what is hidden by what the band holds already
//! is left out, of large meshes part by part and from near to far; the rest is transformed, set up
//! and sampled while it is in the first-level cache. Nothing is locked or passed on, and no result
//! depends on who did what. All buffers are kept between frames.

use rayon::prelude::*;

use super::clip::{Fan, clip};
use super::compact;
use super::footprint::{Extents, Footprint, extents};
use super::isa::{ALL, Isa, LANES, Mask, store_each};
use super::large::{self, Triangle};
use super::layout::BLOCK;
use super::level::SimdLevel;
use super::pass::DrawCall;
use super::raster::{self, Ids};
use super::setup::Corners;
use super::simd;
use super::sink::{Id, Rows, Sink};
use super::tiles::Room;
use super::vertex::{Projected, Screen, clip_position};
use super::winding::Winding;
use crate::geom::{PixelRect, View};
use crate::scene::meshlets::Part;

/// Rows of pixels a band.
pub(crate) const BAND_ROWS: u32 = 4 * BLOCK as u32;
/// Triangles from which bands are shared among threads. Below, waking another thread takes
/// longer than the work.
const SHARED_FROM: u64 = 4096;
/// Draw calls from which they are bounded by several threads.
const BOUNDED_TOGETHER: usize = 256;

/// Draw calls between a hint that one will be read and its turn.
const AHEAD: usize = 4;

/// What every band reads.
pub(crate) struct Frame<'a> {
    screen: Screen,
    calls: &'a [DrawCall],
    footprints: &'a [Footprint],
}

/// What a run of the pipeline did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Work {
    /// Draw calls that were not skipped.
    pub(crate) calls: u64,
    /// Triangles of those.
    pub(crate) triangles: u64,
    /// See [`SoftwareStats::rasterised`](super::SoftwareStats::rasterised).
    pub(crate) kept: u64,
}

/// The draw calls of a band, and room to work.
#[derive(Debug, Default)]
pub(crate) struct List {
    calls: Vec<CallInBand>,
    /// Those that were not hidden and reach into other bands, which may have drawn them too.
    shared: Vec<u32>,
    parts: Vec<PartInBand>,
    /// What was done, but for calls and triangles of `shared`.
    work: Work,
    vertices: Projected,
    room: Room,
}

/// A draw call that may touch a band.
#[derive(Clone, Copy, Debug)]
struct CallInBand {
    call: u32,
    nearest: f32,
    rect: PixelRect,
}

/// A part of a mesh that may touch a band.
#[derive(Clone, Copy, Debug)]
struct PartInBand {
    part: u32,
    nearest: f32,
    rect: PixelRect,
}

/// Buffers that are reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Bands {
    footprints: Vec<Footprint>,
    lists: Vec<List>,
    drawn: Vec<bool>,
}

impl Bands {
    /// Rasterises draw calls in their order, into one sink a band.
    pub(crate) fn rasterise<S: Sink + Send>(
        &mut self,
        level: SimdLevel,
        view: &View,
        calls: &[DrawCall],
        sinks: impl IndexedParallelIterator<Item = S>,
    ) -> Work {
        let screen = Screen::new(view);
        self.footprints.clear();
        let bound = |call: &DrawCall| simd::footprint(level, view, &screen, call);
        if calls.len() < BOUNDED_TOGETHER {
            self.footprints.extend(calls.iter().map(bound));
        } else {
            self.footprints.par_extend(calls.par_iter().with_min_len(64).map(bound));
        }
        let triangles = self.list(view, calls);
        let frame = Frame { screen, calls, footprints: &self.footprints };
        let bands = self.lists.par_iter_mut().zip(sinks);
        let run = |(list, mut sink): (&mut List, S)| simd::band(level, &frame, list, &mut sink);
        if triangles < SHARED_FROM {
            bands.with_min_len(usize::MAX).for_each(run);
        } else {
            bands.with_max_len(1).for_each(run);
        }
        self.sum(calls)
    }

    /// Lists the calls by bands. Returns the triangles of all.
    fn list(&mut self, view: &View, calls: &[DrawCall]) -> u64 {
        let bands = view.viewport().height.div_ceil(BAND_ROWS) as usize;
        self.lists.resize_with(bands, List::default);
        for list in &mut self.lists {
            list.calls.clear();
            list.shared.clear();
            list.work = Work::default();
        }
        let mut triangles = 0;
        for (index, (footprint, call)) in self.footprints.iter().zip(calls).enumerate() {
            let Some(rect) = footprint.rect else { continue };
            triangles += call.triangle_count() as u64;
            let (first, last) = (rect.y0 / BAND_ROWS, (rect.y1 - 1) / BAND_ROWS);
            for band in first..=last {
                let (y0, y1) = (rect.y0.max(band * BAND_ROWS), rect.y1.min((band + 1) * BAND_ROWS));
                let rect = PixelRect { y0, y1, ..rect };
                let entry = CallInBand { call: index as u32, nearest: footprint.nearest, rect };
                self.lists[band as usize].calls.push(entry);
            }
        }
        triangles
    }

    fn sum(&mut self, calls: &[DrawCall]) -> Work {
        self.drawn.clear();
        self.drawn.resize(calls.len(), false);
        let mut work = Work::default();
        for list in &self.lists {
            work.kept += list.work.kept;
            work.calls += list.work.calls;
            work.triangles += list.work.triangles;
            for &index in &list.shared {
                if !std::mem::replace(&mut self.drawn[index as usize], true) {
                    work.calls += 1;
                    work.triangles += calls[index as usize].triangle_count() as u64;
                }
            }
        }
        work
    }
}

/// Draws the calls of a band.
#[inline(always)]
pub(crate) fn band<I: Isa, S: Sink>(frame: &Frame<'_>, list: &mut List, sink: &mut S) {
    if list.calls.is_empty() {
        return;
    }
    sink.begin();
    let rows = sink.rows();
    let List { calls, shared, parts, work, vertices, room } = list;
    for (at, &CallInBand { call: index, nearest, rect }) in calls.iter().enumerate() {
        // The app's order is not the band's: calls lie far apart in memory.
        if let Some(soon) = calls.get(at + AHEAD) {
            let (call, footprint) = (&frame.calls[soon.call as usize], &frame.footprints[soon.call as usize]);
            simd::prefetch(&call.mesh);
            simd::prefetch(&footprint.clip_from_object);
            simd::prefetch(&footprint.nearest);
        }
        if !sink.wants(index) || sink.hides::<I>(&rect, nearest) {
            continue;
        }
        let (call, footprint) = (&frame.calls[index as usize], &frame.footprints[index as usize]);
        if footprint.rect == Some(rect) {
            work.calls += 1;
            work.triangles += call.triangle_count() as u64;
        } else {
            shared.push(index);
        }
        let meshlets = call.mesh.meshlets(call.level);
        let winding = Winding::new(&frame.screen, call);
        if footprint.compact
            && let Some(single) = meshlets.single()
        {
            let matrix = &footprint.clip_from_object;
            let whole = compact::Whole { matrix, single, rect, winding, call: index };
            work.kept += u64::from(whole.draw::<I, S>(&frame.screen, room, sink));
            continue;
        }
        parts.clear();
        let whole = meshlets.len() == 1;
        if whole {
            parts.push(PartInBand { part: 0, nearest, rect });
        } else {
            for (register, boxes) in meshlets.boxes().iter().enumerate() {
                let extents = extents::<I>(&footprint.clip_from_object, &frame.screen, boxes);
                list_parts(extents, register * LANES, meshlets.len(), &rows, parts);
            }
            parts.sort_unstable_by(|a, b| b.nearest.total_cmp(&a.nearest));
        }
        for part in parts.iter() {
            // A mesh of one part is as large as the call, and that is not hidden.
            if whole || (sink.wants(index) && !sink.hides::<I>(&part.rect, part.nearest)) {
                let part = meshlets.part(part.part as usize);
                work.kept += draw_part::<I, S>(frame, index, &part, winding, vertices, room, sink);
            }
        }
    }
}

/// Adds those of sixteen parts from `first` on, of `count` in all, that may touch a band.
#[inline(always)]
fn list_parts<I: Isa>(
    extents: Extents<I>,
    first: usize,
    count: usize,
    rows: &Rows,
    parts: &mut Vec<PartInBand>,
) {
    let x0 = I::max(extents.first[0], I::splat(0));
    let y0 = I::max(extents.first[1], I::splat(rows.first));
    let x1 = I::min(extents.last[0], I::splat(rows.last_column));
    let y1 = I::min(extents.last[1], I::splat(rows.last));
    let present = ALL >> (LANES - (count - first).min(LANES));
    let mut lanes: Mask = present & !(I::gt(x0, x1) | I::gt(y0, y1));
    if lanes == 0 {
        return;
    }
    let [x0, y0, x1, y1] = store_each::<I, 4>([x0, y0, x1, y1]);
    let nearest = I::store_f(extents.nearest);
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        parts.push(PartInBand {
            part: (first + lane) as u32,
            nearest: nearest[lane],
            rect: PixelRect {
                x0: x0[lane] as u32,
                y0: y0[lane] as u32,
                x1: x1[lane] as u32 + 1,
                y1: y1[lane] as u32 + 1,
            },
        });
    }
}

/// Draws a part of a mesh; returns how many of its triangles begin in the band.
#[inline(always)]
fn draw_part<I: Isa, S: Sink>(
    frame: &Frame<'_>,
    call: u32,
    part: &Part<'_>,
    winding: Winding,
    vertices: &mut Projected,
    room: &mut Room,
    sink: &mut S,
) -> u64 {
    let matrix = &frame.footprints[call as usize].clip_from_object;
    vertices.transform::<I>(&frame.screen, matrix, part.positions);
    let mut kept = 0;
    for (register, triangles) in part.triangles.iter().enumerate() {
        let mut lanes = ALL >> (LANES - (part.count - register * LANES).min(LANES));
        if vertices.clipped() != 0 {
            let (clipped, left) = to_clip(vertices, part, register);
            kept += list_clipped(frame, call, triangles, lanes & left, sink.rows(), &mut room.large);
            lanes &= !clipped;
        }
        if lanes == 0 {
            continue;
        }
        let (zero, nowhere) = (I::splat(0), I::splat_f(0.0));
        let mut corners = Corners { x: [zero; 3], y: [zero; 3], nearness: [nowhere; 3] };
        for k in 0..3 {
            let at = I::widen(&part.corners[k][register]);
            corners.x[k] = I::look_up(&vertices.x, at);
            corners.y[k] = I::look_up(&vertices.y, at);
            corners.nearness[k] = I::look_up_f(&vertices.nearness, at);
        }
        let ids = Ids { call, triangles: if S::WANTS_IDS { Some(triangles) } else { None } };
        kept += raster::triangles::<I, S>(&corners, lanes, winding, ids, room, sink);
    }
    for (triangle, id) in room.large.drain(..) {
        large::walk::<I, S>(&triangle, winding, id, sink);
    }
    u64::from(kept)
}

/// Of sixteen triangles: those with a corner that needs clipping, and those among them that
/// do not lie beyond one plane as a whole.
#[cold]
fn to_clip(vertices: &Projected, part: &Part<'_>, register: usize) -> (Mask, Mask) {
    let (mut clipped, mut left) = (0, 0);
    let all = vertices.clipped();
    for lane in 0..LANES {
        let at = part.corners.map(|corners| corners[register][lane]);
        let any = at.iter().any(|&v| all >> v & 1 != 0);
        let beyond = |plane: u64| at.iter().all(|&v| plane >> v & 1 != 0);
        clipped |= Mask::from(any) << lane;
        left |= Mask::from(any && !beyond(vertices.beyond[0]) && !beyond(vertices.beyond[1])) << lane;
    }
    (clipped, left)
}

/// Clips triangles and leaves what remains for later; returns how many pieces begin in the band.
#[cold]
fn list_clipped(
    frame: &Frame<'_>,
    call: u32,
    triangles: &[u32; LANES],
    mut lanes: Mask,
    rows: Rows,
    large: &mut Vec<(Triangle, Id)>,
) -> u32 {
    let mut kept = 0;
    while lanes != 0 {
        let triangle = triangles[lanes.trailing_zeros() as usize];
        lanes &= lanes - 1;
        for piece in clipped(frame, call, triangle).triangles() {
            let (first, last) = piece.rows();
            let first = first.max(0);
            kept += u32::from(first >= rows.first && first <= last.min(rows.last));
            large.push((*piece, Id { call, triangle }));
        }
    }
    kept
}

/// What is left of a triangle of a draw call.
fn clipped(frame: &Frame<'_>, call: u32, triangle: u32) -> Fan {
    let geometry = frame.calls[call as usize].geometry();
    let matrix = &frame.footprints[call as usize].clip_from_object;
    let positions = [0, 1, 2].map(|k| {
        let vertex = geometry.indices[3 * triangle as usize + k];
        clip_position(matrix, geometry.positions[vertex as usize])
    });
    let vertices = positions.map(|p| frame.screen.project(p.x, p.y, p.z, p.w));
    clip(&frame.screen, positions, vertices)
}
