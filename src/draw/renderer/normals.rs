//! Normals for meshes that have none: smooth over gentle edges, sharp over steep ones.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::scene::mesh::Level;

/// The cosine of the angle between two triangles up to which the edge between them is smooth:
/// 40 degrees.
const SMOOTH: f64 = 0.766;

/// A vertex as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Vertex {
    pub(super) position: [f32; 3],
    /// Of unit length, as fractions of 32767; zero where no triangle has an area.
    pub(super) normal: [i16; 4],
}

/// The same triangles in the same order with the same positions, to the bit. Vertices are split
/// where a steep edge ends, and then have the normal of their side: the mean of its triangles'
/// normals, weighted by area. Neighbours that wind differently share no smooth edge.
///
/// O(triangles · log triangles).
pub(super) fn with_normals(level: &Level) -> (Vec<Vertex>, Vec<u32>) {
    let points = welded(&level.positions);
    let triangles: Vec<[u32; 3]> = level.indices.as_chunks::<3>().0.to_vec();
    let areas: Vec<DVec3> = triangles
        .iter()
        .map(|triangle| {
            // In f64, where no product of f32 differences overflows or vanishes.
            let [a, b, c] = triangle.map(|i| level.positions[i as usize].as_dvec3());
            (b - a).cross(c - a)
        })
        .collect();
    let sides = sides(&triangles, &points, &areas);
    let mut sums = vec![DVec3::ZERO; sides.len()];
    for (corner, &side) in sides.iter().enumerate() {
        sums[side as usize] += areas[corner / 3];
    }
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut place = vec![u32::MAX; sides.len()];
    let indices = sides.iter().enumerate().map(|(corner, &side)| {
        let index = &mut place[side as usize];
        if *index == u32::MAX {
            *index = vertices.len() as u32;
            let position = level.positions[level.indices[corner] as usize];
            vertices.push(Vertex::new(position, sums[side as usize]));
        }
        *index
    });
    let indices = indices.collect();
    (vertices, indices)
}

impl Vertex {
    fn new(position: Vec3, normal: DVec3) -> Self {
        let [x, y, z] = (normal.normalize_or_zero() * 32767.0).round().to_array().map(|c| c as i16);
        Self { position: position.to_array(), normal: [x, y, z, 0] }
    }
}

/// A number for each position: the same for the same coordinates.
fn welded(positions: &[Vec3]) -> Vec<u32> {
    let mut known = HashMap::with_capacity(positions.len());
    let number = |p: &Vec3| {
        let next = known.len() as u32;
        *known.entry(p.to_array().map(f32::to_bits)).or_insert(next)
    };
    positions.iter().map(number).collect()
}

/// For each corner of each triangle, the first of the corners that share its point and are reached
/// from it over smooth edges.
fn sides(triangles: &[[u32; 3]], points: &[u32], areas: &[DVec3]) -> Vec<u32> {
    let mut sides: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    // Each edge with its points in ascending order, the corners at them, and whether the triangle
    // runs through it that way.
    let mut edges: Vec<([u32; 2], [u32; 2], bool)> = Vec::with_capacity(sides.len());
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            let ends = [k, (k + 1) % 3];
            let [from, to] = ends.map(|end| points[triangle[end] as usize]);
            let [at_from, at_to] = ends.map(|end| (3 * t + end) as u32);
            let ascends = from < to;
            edges.push(match ascends {
                true => ([from, to], [at_from, at_to], true),
                false => ([to, from], [at_to, at_from], false),
            });
        }
    }
    edges.sort_unstable();
    for pair in edges.windows(2) {
        let [(ends, one, ascends), (same_ends, other, same_ascends)] = [pair[0], pair[1]];
        let [a, b] = [one, other].map(|corners| areas[corners[0] as usize / 3]);
        let is_smooth = a.dot(b) > SMOOTH * a.length() * b.length();
        if ends == same_ends && ascends != same_ascends && is_smooth {
            unite(&mut sides, one[0], other[0]);
            unite(&mut sides, one[1], other[1]);
        }
    }
    (0..sides.len() as u32).map(|corner| first(&mut sides, corner)).collect()
}

/// The least corner of a side, by halving paths (Tarjan and van Leeuwen 1984).
fn first(sides: &mut [u32], mut corner: u32) -> u32 {
    while sides[corner as usize] != corner {
        let next = sides[sides[corner as usize] as usize];
        sides[corner as usize] = next;
        corner = next;
    }
    corner
}

fn unite(sides: &mut [u32], a: u32, b: u32) {
    let (a, b) = (first(sides, a), first(sides, b));
    sides[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::teapot_mesh;

    fn level(positions: Vec<Vec3>, indices: Vec<u32>) -> Level {
        Level { positions, indices, error: 0.0 }
    }

    fn normal(vertex: &Vertex) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|i| f32::from(vertex.normal[i]) / 32767.0))
    }

    /// Every corner stays where it was, to the bit.
    fn assert_same_corners(level: &Level, vertices: &[Vertex], indices: &[u32]) {
        assert_eq!(indices.len(), level.indices.len());
        for (&new, &old) in indices.iter().zip(&level.indices) {
            let (new, old) = (vertices[new as usize].position, level.positions[old as usize].to_array());
            assert_eq!(new.map(f32::to_bits), old.map(f32::to_bits));
        }
    }

    /// A roof over the x axis: two sides that share the ridge and meet at an angle.
    fn roof(degrees: f32) -> Level {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.5, -sin, -cos)];
        level(positions, vec![1, 0, 2, 0, 1, 3])
    }

    #[test]
    fn steep_edges_are_sharp_and_gentle_ones_smooth() {
        let smooth = roof(30.0);
        let (vertices, indices) = with_normals(&smooth);
        assert_same_corners(&smooth, &vertices, &indices);
        assert_eq!(vertices.len(), 4);
        let ridge = normal(&vertices[indices[0] as usize]);
        assert!((ridge.y.abs() - 15f32.to_radians().cos()).abs() < 1e-3, "{ridge}");
        let sharp = roof(50.0);
        let (vertices, indices) = with_normals(&sharp);
        assert_same_corners(&sharp, &vertices, &indices);
        assert_eq!(vertices.len(), 6);
        assert!((normal(&vertices[indices[0] as usize]).y.abs() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn points_that_coincide_are_one() {
        let whole = roof(30.0);
        let corners: Vec<Vec3> = whole.indices.iter().map(|&i| whole.positions[i as usize]).collect();
        let loose = level(corners, (0..6).collect());
        assert_eq!(with_normals(&loose), with_normals(&whole));
    }

    #[test]
    fn neighbours_that_wind_differently_keep_their_own_normals() {
        let mut mixed = roof(30.0);
        mixed.indices.swap(4, 5);
        let (vertices, indices) = with_normals(&mixed);
        assert_same_corners(&mixed, &vertices, &indices);
        assert_eq!(vertices.len(), 6);
    }

    #[test]
    fn triangles_without_area_have_no_normal_and_harm_nobody() {
        let mut level = roof(30.0);
        level.indices.extend([0, 0, 1, 2, 2, 2, 0, 1, 0]);
        let (vertices, indices) = with_normals(&level);
        assert_same_corners(&level, &vertices, &indices);
        assert_eq!(vertices[..4], with_normals(&roof(30.0)).0);
        assert!(vertices[4..].iter().all(|vertex| vertex.normal == [0; 4]));
        assert_eq!(with_normals(&self::level(vec![], vec![])), (vec![], vec![]));
    }

    #[test]
    fn a_round_thing_is_round() {
        let teapot = &teapot_mesh().levels()[0].clone();
        let (vertices, indices) = with_normals(teapot);
        assert_same_corners(teapot, &vertices, &indices);
        // A vertex a corner would be six times as many.
        assert!(vertices.len() < teapot.positions.len() * 3 / 2, "{}", vertices.len());
        for triangle in indices.as_chunks::<3>().0 {
            let corners = triangle.map(|i| &vertices[i as usize]);
            let [a, b, c] = corners.map(|vertex| vertex.position);
            let has_area = a != b && b != c && c != a;
            let is_unit = |vertex: &Vertex| (normal(vertex).length() - 1.0).abs() < 1e-3;
            assert!(!has_area || corners.into_iter().all(is_unit), "{triangle:?}");
        }
    }
}
