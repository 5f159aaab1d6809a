//! The triangles that cannot be rasterised as they are: those that cross the near or the far
//! plane, or reach beyond the guard band. Rare, so in f64 and one at a time.

use glam::{DVec4, Vec4};

use super::large::Triangle;
use super::vertex::{SUBPIXELS, Screen, Vertex};

/// The guard band in subpixels from the viewport's centre: within ±2²² for the sake of `snap`,
/// outside [`GUARD_LIMIT`](super::vertex::GUARD_LIMIT).
const GUARD_PLANE: f64 = 0.99 * 4_194_304.0;
/// The last subpixel from the centre that a corner can have.
const GUARD_LAST: u32 = 1 << 22;
/// Three vertices, and one more for each of six planes.
const MOST_CORNERS: usize = 9;

/// A corner of the polygon that is being clipped.
#[derive(Clone, Copy)]
struct Corner {
    position: DVec4,
    /// The vertex that it came from, while nothing has cut it away.
    vertex: Option<Vertex>,
}

/// What is left of a triangle: triangles around its first corner.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fan {
    triangles: [Triangle; MOST_CORNERS - 2],
    count: usize,
}

impl Fan {
    pub(crate) fn triangles(&self) -> &[Triangle] {
        &self.triangles[..self.count]
    }
}

/// Clips a triangle. `clip` are its clip-space corners, `vertices` their projections. Of degenerate
/// and non-finite triangles nothing is left.
pub(crate) fn clip(screen: &Screen, clip: [Vec4; 3], vertices: [Vertex; 3]) -> Fan {
    let mut fan = Fan::default();
    if clip.iter().any(|c| !c.is_finite()) {
        return fan;
    }
    let mut polygon = Polygon::default();
    for (position, vertex) in clip.iter().zip(vertices) {
        polygon.push(Corner { position: position.as_dvec4(), vertex: Some(vertex) });
    }
    let guard_x = GUARD_PLANE / f64::from(screen.scale_x);
    let guard_y = GUARD_PLANE / f64::from(screen.scale_y.abs());
    let planes = [
        DVec4::new(0.0, 0.0, -1.0, 1.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(1.0, 0.0, 0.0, guard_x),
        DVec4::new(-1.0, 0.0, 0.0, guard_x),
        DVec4::new(0.0, 1.0, 0.0, guard_y),
        DVec4::new(0.0, -1.0, 0.0, guard_y),
    ];
    for plane in planes {
        polygon = polygon.cut(plane);
    }
    let mut projected = [Vertex::default(); MOST_CORNERS];
    for (vertex, corner) in projected.iter_mut().zip(polygon.corners()) {
        let Some(p) = project(screen, corner) else { return fan };
        *vertex = p;
    }
    for i in 2..polygon.len {
        let corners = [projected[0], projected[i - 1], projected[i]];
        fan.triangles[fan.count] = Triangle {
            x: corners.map(|c| c.x),
            y: corners.map(|c| c.y),
            nearness: corners.map(|c| c.nearness),
        };
        fan.count += 1;
    }
    fan
}

#[derive(Clone, Copy)]
struct Polygon {
    corners: [Corner; MOST_CORNERS],
    len: usize,
}

impl Default for Polygon {
    fn default() -> Self {
        Self { corners: [Corner { position: DVec4::ZERO, vertex: None }; MOST_CORNERS], len: 0 }
    }
}

impl Polygon {
    fn corners(&self) -> &[Corner] {
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: Corner) {
        // A convex polygon gains at most one corner a plane; rounding could make it look
        // concave, and then the surplus corner is left out.
        if self.len < MOST_CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// What lies on the positive side of a plane (Sutherland & Hodgman 1974).
    fn cut(&self, plane: DVec4) -> Self {
        let mut kept = Self::default();
        for (i, corner) in self.corners().iter().enumerate() {
            let next = self.corners[(i + 1) % self.len];
            let (a, b) = (plane.dot(corner.position), plane.dot(next.position));
            if a >= 0.0 {
                kept.push(*corner);
            }
            if (a >= 0.0) != (b >= 0.0) {
                // Always from the inner to the outer end, so that both triangles at a shared edge
                // find the same point.
                let (inner, outer) = if a >= 0.0 {
                    (corner.position, next.position)
                } else {
                    (next.position, corner.position)
                };
                let (d_inner, d_outer) = if a >= 0.0 { (a, b) } else { (b, a) };
                let t = d_inner / (d_inner - d_outer);
                kept.push(Corner { position: inner + (outer - inner) * t, vertex: None });
            }
        }
        kept
    }
}

/// A corner on the screen; none if that is not finite.
fn project(screen: &Screen, corner: &Corner) -> Option<Vertex> {
    let centre = SUBPIXELS / 2;
    if let Some(vertex) = corner.vertex {
        // A kept vertex lies inside both depth planes and the outer guard: its own f32 position
        // is valid, and the same that its other triangles use. Only a w near the least f32 spoils
        // it.
        let inside = |v: i32, side: i32| v.wrapping_sub(side * centre).unsigned_abs() <= GUARD_LAST;
        let valid = inside(vertex.x, screen.width) && inside(vertex.y, screen.height);
        return (valid && vertex.nearness.is_finite()).then_some(vertex);
    }
    let p = corner.position;
    let (x, y) = (p.x / p.w * f64::from(screen.scale_x), p.y / p.w * f64::from(screen.scale_y));
    if !(x.abs() <= f64::from(GUARD_LAST) && y.abs() <= f64::from(GUARD_LAST)) {
        return None;
    }
    Some(Vertex {
        x: x.round_ties_even() as i32 + screen.width * centre,
        y: y.round_ties_even() as i32 + screen.height * centre,
        nearness: screen.sign * (p.z / p.w).clamp(0.0, 1.0) as f32,
    })
}
