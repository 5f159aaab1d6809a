//! What a mesh's surface is: closed, turned outward, and how far from another's.

use std::collections::BTreeMap;

use glam::Vec3;
use tercet::scene::mesh::Level;

pub(super) fn corners(level: &Level) -> impl Iterator<Item = [Vec3; 3]> {
    level.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| level.positions[i as usize]))
}

/// How many edges are not used as often in one direction as in the other, and the volume.
pub(super) fn hull(triangles: impl Iterator<Item = [Vec3; 3]>) -> (usize, f32) {
    let mut edges: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
    let mut volume = 0.0;
    for triangle in triangles {
        volume += triangle[0].dot(triangle[1].cross(triangle[2])) / 6.0;
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]].map(|p| (p + 0.0).to_array().map(f32::to_bits));
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let open = edges.iter().filter(|(edge, count)| edge[0] != edge[1] && **count != 0).count();
    (open, volume)
}

/// The greatest distance of a surface from another, sampled at some thousand points inside the
/// triangles and on their edges.
pub(super) fn farthest(from: &Level, to: &Level) -> f32 {
    const SPREAD: [[f32; 3]; 6] = [
        [1.0, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [0.6, 0.2, 0.2],
        [0.2, 0.4, 0.4],
    ];
    let to: Vec<_> = corners(to).collect();
    let step = (from.indices.len() / 3 / 500).max(1);
    let points =
        corners(from).step_by(step).flat_map(|t| SPREAD.map(|w| t[0] * w[0] + t[1] * w[1] + t[2] * w[2]));
    points.map(|p| to.iter().map(|&t| point_to_triangle(p, t)).fold(f32::MAX, f32::min)).fold(0.0, f32::max)
}

/// Ericson, *Real-Time Collision Detection*, §5.1.5, by the edges and the plane.
pub(super) fn point_to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let above = |a: Vec3, b: Vec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if normal != Vec3::ZERO && above(a, b) && above(b, c) && above(c, a) {
        return (p - a).dot(normal).abs();
    }
    let edge = |a: Vec3, b: Vec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.distance(a + (b - a) * t)
    };
    edge(a, b).min(edge(b, c)).min(edge(c, a))
}
