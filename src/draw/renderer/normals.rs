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
