//! A cloud of teapots: nothing but moving objects of many triangles, hidden only by each other.
//!
//! After the 2 500 teapots of Kovalčík and Tobola (2005), whose text gives neither the size of
//! their cloud nor the flight. Ours were chosen by the oracle alone, before any policy had been
//! measured on them: nearly all is in the frustum, and about two thirds is really visible, as the
//! paper's own counts suggest.

use glam::Vec3;

use super::CameraPath;
use crate::geom::Aabb;

/// As many as the paper's.
const OBJECTS: f64 = 2500.0;
/// The side of the room of that many, in metres.
const SIDE: f64 = 38.0;

/// Where the eye is, in halves of the room's side; it always looks at the middle.
const FLIGHT: [Vec3; 9] = [
    Vec3::new(0.0, 0.6, 3.2),
    Vec3::new(1.8, 0.8, 2.2),
    Vec3::new(2.3, 0.5, 0.6),
    Vec3::new(1.6, 0.3, -0.9),
    Vec3::new(0.9, 0.2, -0.9),
    Vec3::new(-0.8, 0.5, -1.6),
    Vec3::new(-2.2, 1.0, -1.4),
    Vec3::new(-2.5, 1.0, 0.6),
    Vec3::new(-1.3, 0.6, 1.7),
];

/// The cube in which the middles of `objects` teapots fly about, for a [`Swarm`](super::Swarm).
/// Its side grows with their cube root, so that they are always equally dense; that of none is
/// as large as that of one.
pub fn room(objects: usize) -> Aabb {
    Aabb::from_center(Vec3::ZERO, Vec3::splat(half_side(objects)))
}

/// The flight around the room of so many teapots, and once in at its edge and out again.
pub fn path(objects: usize) -> CameraPath {
    let half = half_side(objects);
    CameraPath::new(60.0, FLIGHT.map(|eye| (eye * half, Vec3::ZERO)))
}

fn half_side(objects: usize) -> f32 {
    (0.5 * SIDE * libm::cbrt(objects.max(1) as f64 / OBJECTS)) as f32
}
