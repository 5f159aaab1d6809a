//! From snapped triangles to samples: exact coverage, and one arithmetic of depth.
//!
//! Coverage is decided by edge functions in integers: a sample (a pixel's centre) is covered where
//! all three are positive, or zero on a top or left edge. A triangle of at most
//! [`SMALL_EXTENT`] subpixels a side is rasterised in i32: an edge function inside the bounding
//! box is at most its area, 2³⁰, and a block of lanes reaches less than 2²⁷ beyond. Others take
//! f64, where every value is an integer below 2⁴⁸ and therefore exact. How depth is interpolated
//! is told in `setup`.
#![expect(clippy::needless_range_loop, reason = "lanes of several arrays advance together, by index")]

use super::bin::Chunk;
use super::setup::{SMALL_EXTENT, Shading, Small, bias, centre, first_sample, last_sample};
use super::simd::Isa;
use super::vertex::{SUBPIXELS, Vertex};

/// Samples that are worked on together.
pub(crate) const LANES: usize = 16;
/// Samples of a row when two rows are worked on together.
pub(crate) const HALF: usize = LANES / 2;
/// The most sample columns or rows of a triangle that is rasterised among others, a lane each.
pub(crate) const TINY_SIDE: i32 = 4;

/// A bit for each lane.
pub(crate) const ALL_LANES: u32 = (1 << LANES) - 1;

/// Where samples go. The rows of a sink are those of one band.
pub(crate) trait Sink {
    /// Whether the sink wants to know which triangle a sample belongs to.
    const WANTS_IDS: bool;

    /// The rows of the viewport that the sink holds.
    fn rows(&self) -> Rows;

    /// Samples of a row, from `column` on; lanes with `outside < 0` are not covered. The row and
    /// the covered columns lie in the viewport.
    fn block<I: Isa>(
        &mut self,
        row: i32,
        column: i32,
        outside: &[i32; LANES],
        nearness: &[f32; LANES],
        id: Id,
    );

    /// The same for [`HALF`] samples of a row, and as many below them. The lower row may lie beyond
    /// the band where none of its lanes is covered.
    fn pair<I: Isa>(
        &mut self,
        row: i32,
        column: i32,
        outside: &[i32; LANES],
        nearness: &[f32; LANES],
        id: Id,
    );

    /// One sample.
    fn sample(&mut self, row: i32, column: i32, nearness: f32, id: Id);
}

/// Which triangle of which draw call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Id {
    /// Index of the draw call.
    pub(crate) call: u32,
    /// Index of the triangle in the call's level.
    pub(crate) triangle: u32,
}

/// A range of rows of the viewport, `last` included; and its columns, from 0 to `last_column`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    /// First row.
    pub(crate) first: i32,
    /// Last row.
    pub(crate) last: i32,
    /// The viewport's last column.
    pub(crate) last_column: i32,
}

/// A triangle on the screen, by snapped corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Triangle {
    pub(crate) x: [i32; 3],
    pub(crate) y: [i32; 3],
    pub(crate) nearness: [f32; 3],
    pub(crate) id: Id,
}

impl Triangle {
    pub(crate) fn new(v: [Vertex; 3]) -> Self {
        Self { x: v.map(|v| v.x), y: v.map(|v| v.y), nearness: v.map(|v| v.nearness), id: Id::default() }
    }
}

/// Tiny triangles, a lane each.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct TinyBatch {
    pub(crate) x: [[i32; LANES]; 3],
    pub(crate) y: [[i32; LANES]; 3],
    pub(crate) nearness: [[f32; LANES]; 3],
    pub(crate) call: [u32; LANES],
    pub(crate) triangle: [u32; LANES],
}

impl TinyBatch {
    pub(crate) const EMPTY: Self = Self {
        x: [[0; LANES]; 3],
        y: [[0; LANES]; 3],
        nearness: [[0.0; LANES]; 3],
        call: [0; LANES],
        triangle: [0; LANES],
    };
}

/// Rasterises what chunks of triangles left for one band.
#[inline(always)]
pub(crate) fn band<I: Isa, S: Sink>(chunks: &[Chunk], band: usize, sink: &mut S) {
    for chunk in chunks {
        let bin = chunk.bin(band);
        for (batch, lanes) in bin.tiny() {
            tiny::<I, S>(batch, lanes, sink);
        }
        for triangle in &bin.singles {
            single::<I, S>(triangle, sink);
        }
    }
}

/// Rasterises the triangles in some lanes of a batch, each of at most [`TINY_SIDE`] sample columns
/// and rows and [`SMALL_EXTENT`] a side: one step looks at one sample of every triangle. The other
/// lanes may hold anything.
#[inline(always)]
pub(crate) fn tiny<I: Isa, S: Sink>(batch: &TinyBatch, lanes: u32, sink: &mut S) {
    let rows = sink.rows();
    let mut edge = [[0_i32; LANES]; 3];
    let mut step_x = [[0_i32; LANES]; 3];
    let mut step_y = [[0_i32; LANES]; 3];
    let mut inverse_area = [0.0_f32; LANES];
    let mut base = [0.0_f32; LANES];
    let mut along_1 = [0.0_f32; LANES];
    let mut along_2 = [0.0_f32; LANES];
    let mut low = [0.0_f32; LANES];
    let mut high = [0.0_f32; LANES];
    let mut biases = [[0_i32; LANES]; 3];
    let (mut column, mut row) = ([0_i32; LANES], [0_i32; LANES]);
    let (mut columns, mut lines) = ([0_i32; LANES], [0_i32; LANES]);
    for i in 0..LANES {
        let x = [batch.x[0][i], batch.x[1][i], batch.x[2][i]];
        let y = [batch.y[0][i], batch.y[1][i], batch.y[2][i]];
        let n = [batch.nearness[0][i], batch.nearness[1][i], batch.nearness[2][i]];
        column[i] = first_sample(x[0].min(x[1]).min(x[2])).max(0);
        row[i] = first_sample(y[0].min(y[1]).min(y[2])).max(rows.first);
        // All ones in a lane without a triangle, for -1 columns and rows.
        let absent = ((lanes >> i & 1) as i32).wrapping_sub(1);
        columns[i] =
            last_sample(x[0].max(x[1]).max(x[2])).min(rows.last_column).wrapping_sub(column[i]) | absent;
        lines[i] = last_sample(y[0].max(y[1]).max(y[2])).min(rows.last).wrapping_sub(row[i]) | absent;
        let t = Small::new(x, y, n, column[i], row[i]);
        for k in 0..3 {
            edge[k][i] = t.edge[k];
            step_x[k][i] = t.step_x[k];
            step_y[k][i] = t.step_y[k];
            biases[k][i] = t.bias[k];
        }
        let s = Shading::new(t.nearness, t.area as f32);
        inverse_area[i] = s.inverse_area;
        base[i] = s.base;
        along_1[i] = s.along_1;
        along_2[i] = s.along_2;
        low[i] = s.least;
        high[i] = s.greatest;
    }
    let most_columns = columns.iter().fold(-1, |most, &c| c.max(most));
    let most_lines = lines.iter().fold(-1, |most, &c| c.max(most));
    for dy in 0..=most_lines {
        for dx in 0..=most_columns {
            let mut e = [[0_i32; LANES]; 3];
            let mut outside = [0_i32; LANES];
            for i in 0..LANES {
                for k in 0..3 {
                    e[k][i] = edge[k][i]
                        .wrapping_add(dx.wrapping_mul(step_x[k][i]))
                        .wrapping_add(dy.wrapping_mul(step_y[k][i]));
                }
                outside[i] = e[0][i].wrapping_add(biases[0][i])
                    | e[1][i].wrapping_add(biases[1][i])
                    | e[2][i].wrapping_add(biases[2][i])
                    | (columns[i] - dx)
                    | (lines[i] - dy);
            }
            let mut covered = I::negative(&outside) ^ ALL_LANES;
            if covered == 0 {
                continue;
            }
            let mut nearness = [0.0_f32; LANES];
            for i in 0..LANES {
                let shading = Shading {
                    inverse_area: inverse_area[i],
                    base: base[i],
                    along_1: along_1[i],
                    along_2: along_2[i],
                    least: low[i],
                    greatest: high[i],
                };
                nearness[i] = shading.nearness(e[1][i] as f32, e[2][i] as f32);
            }
            while covered != 0 {
                let i = covered.trailing_zeros() as usize;
                covered &= covered - 1;
                let id = Id { call: batch.call[i], triangle: batch.triangle[i] };
                sink.sample(row[i] + dy, column[i] + dx, nearness[i], id);
            }
        }
    }
}

/// Rasterises one triangle of any size, row by row.
#[inline(always)]
pub(crate) fn single<I: Isa, S: Sink>(t: &Triangle, sink: &mut S) {
    let rows = sink.rows();
    let (left, right) = (t.x[0].min(t.x[1]).min(t.x[2]), t.x[0].max(t.x[1]).max(t.x[2]));
    let (top, bottom) = (t.y[0].min(t.y[1]).min(t.y[2]), t.y[0].max(t.y[1]).max(t.y[2]));
    let area = Area {
        first_column: first_sample(left).max(0),
        last_column: last_sample(right).min(rows.last_column),
        first_row: first_sample(top).max(rows.first),
        last_row: last_sample(bottom).min(rows.last),
    };
    if area.first_column > area.last_column || area.first_row > area.last_row {
        return;
    }
    if right - left <= SMALL_EXTENT && bottom - top <= SMALL_EXTENT {
        if area.last_column - area.first_column < HALF as i32 {
            narrow::<I, S>(t, &area, sink);
        } else {
            small::<I, S>(t, &area, sink);
        }
    } else {
        large::<I, S>(t, &area, sink);
    }
}

/// The samples to look at, both ends included.
struct Area {
    first_column: i32,
    last_column: i32,
    first_row: i32,
    last_row: i32,
}

/// A triangle of few columns, two rows at a time.
#[inline(always)]
fn narrow<I: Isa, S: Sink>(t: &Triangle, area: &Area, sink: &mut S) {
    let setup = Small::new(t.x, t.y, t.nearness, area.first_column, area.first_row);
    let shading = Shading::new(setup.nearness, setup.area as f32);
    let columns = area.last_column - area.first_column;
    let mut edge = [[0_i32; LANES]; 3];
    let mut beside = [0_i32; LANES];
    for i in 0..LANES {
        let (dx, dy) = ((i % HALF) as i32, (i / HALF) as i32);
        for k in 0..3 {
            edge[k][i] = setup.edge[k]
                .wrapping_add(setup.step_x[k].wrapping_mul(dx))
                .wrapping_add(setup.step_y[k].wrapping_mul(dy));
        }
        beside[i] = columns - dx;
    }
    let mut row = area.first_row;
    while row <= area.last_row {
        let mut outside = [0_i32; LANES];
        let mut nearness = [0.0_f32; LANES];
        let below = area.last_row - row;
        for i in 0..LANES {
            outside[i] = edge[0][i].wrapping_add(setup.bias[0])
                | edge[1][i].wrapping_add(setup.bias[1])
                | edge[2][i].wrapping_add(setup.bias[2])
                | beside[i]
                | (below - (i / HALF) as i32);
            nearness[i] = shading.nearness(edge[1][i] as f32, edge[2][i] as f32);
        }
        sink.pair::<I>(row, area.first_column, &outside, &nearness, t.id);
        for k in 0..3 {
            for i in 0..LANES {
                edge[k][i] = edge[k][i].wrapping_add(setup.step_y[k].wrapping_mul(2));
            }
        }
        row += 2;
    }
}

/// A triangle that the i32 path takes, row by row.
#[inline(always)]
fn small<I: Isa, S: Sink>(t: &Triangle, area: &Area, sink: &mut S) {
    let setup = Small::new(t.x, t.y, t.nearness, area.first_column, area.first_row);
    let shading = Shading::new(setup.nearness, setup.area as f32);
    let mut ramp = [[0_i32; LANES]; 3];
    for k in 0..3 {
        for i in 0..LANES {
            ramp[k][i] = setup.step_x[k].wrapping_mul(i as i32);
        }
    }
    let mut row_edge = setup.edge;
    for row in area.first_row..=area.last_row {
        let mut edge = row_edge;
        let mut column = area.first_column;
        while column <= area.last_column {
            let mut outside = [0_i32; LANES];
            let mut nearness = [0.0_f32; LANES];
            let left = area.last_column - column;
            for i in 0..LANES {
                let e = [
                    edge[0].wrapping_add(ramp[0][i]),
                    edge[1].wrapping_add(ramp[1][i]),
                    edge[2].wrapping_add(ramp[2][i]),
                ];
                outside[i] = e[0].wrapping_add(setup.bias[0])
                    | e[1].wrapping_add(setup.bias[1])
                    | e[2].wrapping_add(setup.bias[2])
                    | (left - i as i32);
                nearness[i] = shading.nearness(e[1] as f32, e[2] as f32);
            }
            sink.block::<I>(row, column, &outside, &nearness, t.id);
            for k in 0..3 {
                edge[k] = edge[k].wrapping_add(setup.step_x[k].wrapping_mul(LANES as i32));
            }
            column += LANES as i32;
        }
        for k in 0..3 {
            row_edge[k] = row_edge[k].wrapping_add(setup.step_y[k]);
        }
    }
}

#[inline(always)]
fn large<I: Isa, S: Sink>(t: &Triangle, area: &Area, sink: &mut S) {
    let cross =
        |ax: i32, ay: i32, bx: i32, by: i32| i64::from(ax) * i64::from(by) - i64::from(ay) * i64::from(bx);
    let (mut x, mut y, mut n) = (t.x, t.y, t.nearness);
    let mut twice = cross(x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
    if twice < 0 {
        x.swap(1, 2);
        y.swap(1, 2);
        n.swap(1, 2);
        twice = -twice;
    }
    if twice == 0 {
        return;
    }
    let shading = Shading::new(n, twice as f32);
    let (sx, sy) = (centre(area.first_column), centre(area.first_row));
    let mut edge = [0.0_f64; 3];
    let mut step_x = [0.0_f64; 3];
    let mut step_y = [0.0_f64; 3];
    let mut threshold = [0.0_f64; 3];
    for k in 0..3 {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        let (dx, dy) = (x[b] - x[a], y[b] - y[a]);
        edge[k] = cross(dx, dy, sx - x[a], sy - y[a]) as f64;
        step_x[k] = -f64::from(dy) * f64::from(SUBPIXELS);
        step_y[k] = f64::from(dx) * f64::from(SUBPIXELS);
        threshold[k] = f64::from(-bias(dx, dy));
    }
    let columns = area.last_column - area.first_column;
    for row in area.first_row..=area.last_row {
        let (mut first, mut last) = (0, columns);
        for k in 0..3 {
            let (from, to) = covered(edge[k] - threshold[k], step_x[k], columns);
            first = first.max(from);
            last = last.min(to);
        }
        let mut column = first;
        while column <= last {
            let mut outside = [0_i32; LANES];
            let mut nearness = [0.0_f32; LANES];
            for i in 0..LANES {
                let along = f64::from(column + i as i32);
                outside[i] = last - column - i as i32;
                let e1 = edge[1] + along * step_x[1];
                let e2 = edge[2] + along * step_x[2];
                nearness[i] = shading.nearness(e1 as f32, e2 as f32);
            }
            sink.block::<I>(row, area.first_column + column, &outside, &nearness, t.id);
            column += LANES as i32;
        }
        for k in 0..3 {
            edge[k] += step_y[k];
        }
    }
}

/// The columns in `0..=columns` where `height + column · step ≥ 0`, as first and last.
///
/// Numerator and divisor are integers, the divisor below 2³². A quotient that is no integer is at
/// least 2⁻³² away from one, while f64 division errs by less than 2⁻³⁸ for quotients below 2¹⁵;
/// beyond that, the viewport's side, only its size matters. So truncation is exact.
#[inline(always)]
fn covered(height: f64, step: f64, columns: i32) -> (i32, i32) {
    let limit = f64::from(columns + 1);
    if step < 0.0 {
        let to = if height < 0.0 { -1 } else { least_f64(height / -step, limit) as i32 };
        (0, to)
    } else if height >= 0.0 {
        (0, columns)
    } else if step == 0.0 {
        (0, -1)
    } else {
        let from = least_f64((step - 1.0 - height) / step, limit) as i32;
        (from, columns)
    }
}

#[inline(always)]
fn least_f64(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
