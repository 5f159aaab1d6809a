//! Triangles of any size, one at a time: rows of tiles between exact spans, in f64, where every
//! value is an integer below 2⁴⁸.

use super::isa::{ALL, Isa, LANES, splat_each};
use super::layout::{LANE_X, LANE_Y, TILE, TILE_BITS, within};
use super::setup::{Shading, first_sample, last_sample};
use super::sink::{Id, Sink};
use super::vertex::{SUBPIXEL_BITS, SUBPIXELS};
use super::winding::Winding;

/// A triangle on the screen, by snapped corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Triangle {
    pub(crate) x: [i32; 3],
    pub(crate) y: [i32; 3],
    pub(crate) nearness: [f32; 3],
}

impl Triangle {
    /// The first and the last row with samples, of the viewport and beyond.
    pub(crate) fn rows(&self) -> (i32, i32) {
        samples(self.y)
    }
}

/// The samples of an axis between three coordinates; the last may lie before the first.
fn samples(v: [i32; 3]) -> (i32, i32) {
    let (low, high) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
    (first_sample(low), last_sample(high))
}

/// An edge function: its value at the first sample, and how it changes.
#[derive(Clone, Copy, Default)]
struct Edge {
    start: f64,
    step_x: f64,
    step_y: f64,
    /// Covered from here on: 0 for a top or left edge, 1 for the others.
    threshold: f64,
}

/// Rasterises a triangle.
#[inline(always)]
pub(crate) fn walk<I: Isa, S: Sink>(t: &Triangle, winding: Winding, id: Id, sink: &mut S) {
    let rows = sink.rows();
    let ((left, right), (top, bottom)) = (samples(t.x), samples(t.y));
    let (x0, x1) = (left.max(0), right.min(rows.last_column));
    let (y0, y1) = (top.max(rows.first), bottom.min(rows.last));
    let Some((edges, nearness, area)) = edges(t, winding, x0, y0) else { return };
    if x0 > x1 || y0 > y1 {
        return;
    }
    let shading = Shading::<I>::new(splat_each::<I, 3>(nearness), I::splat_f(area as f32));
    let columns = x1 - x0;
    for tile_y in y0 >> TILE_BITS..=y1 >> TILE_BITS {
        // Of each of the four rows: the columns that are covered, and two edges in column x0.
        let (mut from, mut to) = ([i32::MAX; TILE as usize], [-1; TILE as usize]);
        let mut start = [[0.0_f64; TILE as usize]; 2];
        for (i, row) in (tile_y << TILE_BITS..(tile_y + 1) << TILE_BITS).enumerate() {
            let at = edges.map(|e| e.start + f64::from(row - y0) * e.step_y);
            (start[0][i], start[1][i]) = (at[1], at[2]);
            if row < y0 || row > y1 {
                continue;
            }
            let (mut first, mut last) = (0, columns);
            for (at, edge) in at.iter().zip(&edges) {
                let (from, to) = covered(at - edge.threshold, edge.step_x, columns);
                (first, last) = (first.max(from), last.min(to));
            }
            if first <= last {
                (from[i], to[i]) = (x0 + first, x0 + last);
            }
        }
        let first = from.into_iter().min().unwrap_or(i32::MAX);
        let last = to.into_iter().max().unwrap_or(-1);
        if first > last {
            continue;
        }
        let (mut lanes_from, mut lanes_to) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            lanes_from[lane] = from[LANE_Y[lane] as usize];
            lanes_to[lane] = to[LANE_Y[lane] as usize];
        }
        let (from, to) = (I::load(&lanes_from), I::load(&lanes_to));
        let mut open = (usize::MAX, 0);
        for tile_x in first >> TILE_BITS..=last >> TILE_BITS {
            let (x, y) = (tile_x << TILE_BITS, tile_y << TILE_BITS);
            let block = rows.block(x, y);
            if open.0 != block {
                open = (block, sink.open_tiles::<I>(block, shading.greatest));
            }
            let (tile, _) = within(x as u32, y as u32);
            if open.1 >> tile & 1 == 0 {
                continue;
            }
            let column = I::add(I::splat(x), I::load(&LANE_X));
            let outside = I::gt(from, column) | I::gt(column, to);
            let mut e = [[0.0_f32; LANES]; 2];
            for k in 0..2 {
                for lane in 0..LANES {
                    let along = f64::from(x - x0 + LANE_X[lane]);
                    let at = start[k][LANE_Y[lane] as usize] + along * edges[k + 1].step_x;
                    e[k][lane] = at as f32;
                }
            }
            let nearness = shading.nearness(I::load_f(&e[0]), I::load_f(&e[1]));
            sink.tile::<I>(block, tile, ALL & !outside, nearness, id);
        }
    }
}

/// The edges of a triangle from the sample at a column and row on, wound clockwise, the nearness at
/// the corners in that order, and twice the area; none without an area, or where it is not drawn.
fn edges(t: &Triangle, winding: Winding, column: i32, row: i32) -> Option<([Edge; 3], [f32; 3], f64)> {
    let cross =
        |ax: i32, ay: i32, bx: i32, by: i32| i64::from(ax) * i64::from(by) - i64::from(ay) * i64::from(bx);
    let Triangle { mut x, mut y, nearness: mut n } = *t;
    let mut area = cross(x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
    if area == 0 || !winding.draws(area < 0) {
        return None;
    }
    if area < 0 {
        x.swap(1, 2);
        y.swap(1, 2);
        n.swap(1, 2);
        area = -area;
    }
    let centre = |sample: i32| (sample << SUBPIXEL_BITS) + SUBPIXELS / 2;
    let edges = std::array::from_fn(|k| {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        let (dx, dy) = (x[b] - x[a], y[b] - y[a]);
        let covers = dy < 0 || (dy == 0 && dx > 0);
        Edge {
            start: cross(dx, dy, centre(column) - x[a], centre(row) - y[a]) as f64,
            step_x: -f64::from(dy) * f64::from(SUBPIXELS),
            step_y: f64::from(dx) * f64::from(SUBPIXELS),
            threshold: f64::from(u8::from(!covers)),
        }
    });
    Some((edges, n, area as f64))
}

/// The columns in `0..=columns` where `height + column · step ≥ 0`, as first and last.
///
/// Numerator and divisor are integers, the divisor below 2³². A quotient that is no integer is at
/// least 2⁻³² away from one, while f64 division errs by less than 2⁻³⁸ for quotients below 2¹⁵;
/// beyond that, the viewport's side, only its size matters. So truncation is exact.
fn covered(height: f64, step: f64, columns: i32) -> (i32, i32) {
    let limit = f64::from(columns + 1);
    if step < 0.0 {
        let to = if height < 0.0 { -1 } else { (height / -step).min(limit) as i32 };
        (0, to)
    } else if height >= 0.0 {
        (0, columns)
    } else if step == 0.0 {
        (0, -1)
    } else {
        let from = ((step - 1.0 - height) / step).min(limit) as i32;
        (from, columns)
    }
}
