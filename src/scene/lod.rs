//! Making levels of detail for a mesh that has none (feature `lod`).

use glam::Vec3;
use meshopt::{SimplifyOptions, VertexDataAdapter};
use rayon::prelude::*;

use super::compact::compact;
use super::mesh::Level;
use super::nearest::Triangles;
use crate::Error;

/// A coarser version of a mesh, made of some of its vertices.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// Three indices a triangle, into the vertices of the finest level.
    pub indices: Vec<u32>,
    /// How far the surfaces lie apart, in metres of object space: the simplifier's estimate, or
    /// the distance of the finest level's farthest vertex where that is greater.
    pub error: f32,
}

impl Simplified {
    /// The level with just the vertices that it uses.
    pub fn level(&self, positions: &[Vec3]) -> Level {
        compact(positions, &self.indices, self.error)
    }
}

/// Levels of about half the triangles each, finest first, until one would have fewer than
/// `least`; level 0, the mesh itself, is not among them. Their triangles are in an order that
/// suits a vertex cache. Every level is made from the finest, so errors do not add up.
///
/// Edges collapse as long as they keep the surface's shape. Where that stalls, a simplifier that
/// merges vertices by grid cells takes over, which always arrives but roughens the surface.
///
/// Takes time: about O(triangles · log triangles) a level, for the error is measured.
///
/// # Errors
/// [`Error::Mesh`] when there are no vertices, the indices are not whole triangles, or an index
/// has no vertex.
pub fn generate(positions: &[Vec3], indices: &[u32], least: usize) -> Result<Vec<Simplified>, Error> {
    let fail = |why: String| Error::Mesh { name: "to simplify".into(), why };
    if !indices.len().is_multiple_of(3) {
        return Err(fail(format!("{} indices are not whole triangles", indices.len())));
    }
    if let Some(i) = indices.iter().position(|&v| v as usize >= positions.len()) {
        return Err(fail(format!("index {i} is {}, of {} vertices", indices[i], positions.len())));
    }
    let bytes: Vec<u8> = positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_ne_bytes).collect();
    let vertices = VertexDataAdapter::new(&bytes, 12, 0).map_err(|e| fail(e.to_string()))?;
    let mut levels = Vec::new();
    let mut triangles = indices.len() / 3;
    while triangles / 2 >= least.max(1) {
        let (mut coarse, estimate) = simplify(indices, &vertices, triangles / 2);
        if coarse.is_empty() || coarse.len() / 3 >= triangles {
            break;
        }
        triangles = coarse.len() / 3;
        meshopt::optimize_vertex_cache_in_place(&mut coarse, positions.len());
        let error = estimate.max(farthest(positions, &coarse));
        levels.push(Simplified { indices: coarse, error });
    }
    Ok(levels)
}

/// A simpler mesh of about `target` triangles, and the simplifier's estimate of its error.
fn simplify(indices: &[u32], vertices: &VertexDataAdapter<'_>, target: usize) -> (Vec<u32>, f32) {
    let scale = meshopt::simplify_scale(vertices);
    let mut error = 0.0;
    let options = SimplifyOptions::None;
    let exact = meshopt::simplify(indices, vertices, 3 * target, f32::MAX, options, Some(&mut error));
    if exact.len() / 3 <= target + target / 4 {
        return (exact, error * scale);
    }
    let sloppy = meshopt::simplify_sloppy(indices, vertices, 3 * target, f32::MAX, Some(&mut error));
    (sloppy, error * scale)
}

/// The distance of the point that lies farthest from a mesh, in metres. Vertices that the finest
/// level has and no triangle uses are taken along: they can only make the error larger.
fn farthest(points: &[Vec3], indices: &[u32]) -> f32 {
    let triangles = Triangles::new(points, indices);
    points.par_iter().map(|&p| triangles.distance(p)).reduce(|| 0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::super::nearest::Triangle;
    use super::*;

    /// A wavy sheet of n × n cells.
    fn sheet(n: u32) -> (Vec<Vec3>, Vec<u32>) {
        let point = |i: u32| {
            let (x, z) = ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
            Vec3::new(x, (0.3 * x).sin() + (0.2 * z).cos(), z)
        };
        let cell = |c: u32| {
            let a = c / n * (n + 1) + c % n;
            [a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2]
        };
        ((0..(n + 1) * (n + 1)).map(point).collect(), (0..n * n).flat_map(cell).collect())
    }

    #[test]
    fn levels_halve_and_stay_as_near_as_they_say() {
        let (positions, indices) = sheet(24);
        let levels = generate(&positions, &indices, 30).unwrap();
        assert!(levels.len() >= 4, "only {} levels", levels.len());
        let mut triangles = indices.len() / 3;
        for level in &levels {
            let fewer = level.indices.len() / 3;
            assert!(fewer <= triangles * 5 / 8, "{triangles} to {fewer}");
            triangles = fewer;
            // Measured here by looking at each triangle.
            let all: Vec<Triangle> = level
                .indices
                .chunks_exact(3)
                .map(|t| Triangle([0, 1, 2].map(|k| positions[t[k] as usize])))
                .collect();
            let nearest = |p: &Vec3| all.iter().map(|t| t.distance(*p)).fold(f32::MAX, f32::min);
            assert!(positions.iter().all(|p| nearest(p) <= level.error * 1.0001));
            let compacted = level.level(&positions);
            assert!(compacted.positions.len() < positions.len());
            assert!(compacted.positions.iter().all(|p| positions.contains(p)));
        }
        assert!(levels.windows(2).all(|w| w[1].error > w[0].error));
    }

    #[test]
    fn refuses_what_is_no_mesh() {
        let (positions, mut indices) = sheet(2);
        assert!(generate(&positions, &indices[..4], 1).unwrap_err().to_string().contains("4 indices"));
        indices[5] = 99;
        assert!(generate(&positions, &indices, 1).unwrap_err().to_string().contains("index 5 is 99"));
    }
}
