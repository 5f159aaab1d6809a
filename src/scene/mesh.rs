//! Triangle meshes and their levels of detail.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use glam::{Affine3A, Vec3};

use super::meshlets::Meshlets;
use crate::Error;
use crate::geom::{Aabb, Support};

/// One level of detail: an indexed triangle list in object space, metres.
#[derive(Clone, Debug)]
pub struct Level {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Three indices a triangle; either winding, both sides are drawn.
    pub indices: Vec<u32>,
    /// How far the surface may lie from that of level 0, in metres of object space.
    pub error: f32,
}

/// A mesh with its levels of detail, finest first. A handle: cloning it copies a pointer.
#[derive(Clone, Debug)]
pub struct Mesh(Arc<MeshData>);

/// Which mesh a handle points to. Clones share it; no other mesh of the process ever has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshId(u64);

#[derive(Debug)]
struct MeshData {
    id: MeshId,
    name: String,
    levels: Vec<Level>,
    bounds: Aabb,
    /// Made when it is first asked for.
    support: OnceLock<Support>,
    /// One a level, made when it is first asked for.
    meshlets: Box<[OnceLock<Meshlets>]>,
}

impl Mesh {
    /// A mesh with a single level.
    ///
    /// # Errors
    /// As [`Mesh::with_levels`].
    pub fn new(name: impl Into<String>, positions: Vec<Vec3>, indices: Vec<u32>) -> Result<Self, Error> {
        Self::with_levels(name, vec![Level { positions, indices, error: 0.0 }])
    }

    /// A mesh with levels of detail, finest first. The bounds hold every vertex of every level,
    /// so whichever level is drawn stays inside them.
    ///
    /// # Errors
    /// [`Error::Mesh`] when there is no level, an index has no vertex, the indices are not whole
    /// triangles, or a position is not finite; the message names the level and the element.
    pub fn with_levels(name: impl Into<String>, levels: Vec<Level>) -> Result<Self, Error> {
        let name = name.into();
        let fail = |why: String| Err(Error::Mesh { name: name.clone(), why });
        if levels.is_empty() {
            return fail("has no level of detail".into());
        }
        let mut bounds = Aabb::EMPTY;
        for (l, level) in levels.iter().enumerate() {
            if !level.indices.len().is_multiple_of(3) {
                return fail(format!("level {l} has {} indices, not whole triangles", level.indices.len()));
            }
            if let Some(i) = level.positions.iter().position(|p| !p.is_finite()) {
                return fail(format!("level {l}, position {i} is not finite: {}", level.positions[i]));
            }
            let count = level.positions.len();
            if let Some(i) = level.indices.iter().position(|&v| v as usize >= count) {
                return fail(format!("level {l}, index {i} is {}, of {count} vertices", level.indices[i]));
            }
            bounds = bounds.union(&Aabb::from_points(level.positions.iter().copied()));
        }
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let id = MeshId(NEXT.fetch_add(1, Ordering::Relaxed));
        let meshlets = levels.iter().map(|_| OnceLock::new()).collect();
        Ok(Self(Arc::new(MeshData { id, name, levels, bounds, support: OnceLock::new(), meshlets })))
    }

    /// Which mesh this is: what a renderer keeps its buffers by.
    pub fn id(&self) -> MeshId {
        self.0.id
    }

    /// The name it was made with.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// The box around every vertex of every level, in object space.
    pub fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    /// A box around the mesh as `target_from_object` places it: it holds every vertex of every
    /// level after it was transformed in f32 by any order of the sums, like
    /// `bounds().transformed(target_from_object)`, in which it lies. For a turned mesh that is
    /// rounder than its box it is much smaller.
    ///
    /// The first call for a mesh or one of its clones looks at every vertex, at some
    /// hundreds of nanoseconds each; all others are O(1).
    pub fn bounds_under(&self, target_from_object: &Affine3A) -> Aabb {
        let around = self.bounds().transformed(target_from_object);
        // A mesh without vertices, or one that is placed nowhere.
        if !around.is_valid() {
            return around;
        }
        // On one thread: while it waits for its helpers, a parallel one could take up work that
        // asks for the same mesh, and so wait for itself.
        let support = self.0.support.get_or_init(|| {
            let levels = self.levels().iter();
            Support::new(levels.flat_map(|level| level.positions.iter().copied()))
        });
        support.tightened(around, target_from_object)
    }

    /// The levels of detail, finest first; never empty.
    pub fn levels(&self) -> &[Level] {
        &self.0.levels
    }

    /// A level in parts. The first call for a level looks at every triangle, at about a hundred
    /// nanoseconds each; all others are O(1).
    pub(crate) fn meshlets(&self, level: usize) -> &Meshlets {
        self.0.meshlets[level].get_or_init(|| Meshlets::new(&self.0.levels[level]))
    }

    /// Triangles of the finest level.
    pub fn triangle_count(&self) -> usize {
        self.0.levels[0].indices.len() / 3
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat3A, Mat4, Quat};
    use rand::{Rng, RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn vector(rng: &mut impl Rng) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..=1.0)))
    }

    /// One to three levels of some points, stretched, and perhaps far from the origin.
    fn random_mesh(rng: &mut impl Rng) -> Mesh {
        let stretch = vector(rng).map(|x| 10f32.powf(4.0 * x));
        let away = if rng.random_bool(0.3) { vector(rng) * 1e4 } else { Vec3::ZERO };
        let level = |error: usize| {
            let positions = (0..rng.random_range(1..30)).map(|_| vector(rng) * stretch + away).collect();
            Level { positions, indices: vec![0; 3], error: error as f32 }
        };
        Mesh::with_levels("points", (0..3).map(level).collect()).unwrap()
    }

    /// Turned, sheared, mirrored, flat, tiny or huge.
    fn random_place(rng: &mut impl Rng) -> Affine3A {
        let turn = Quat::from_axis_angle(vector(rng).normalize_or(Vec3::Y), rng.random_range(0.0..6.3));
        let mut size = vector(rng);
        match rng.random_range(0..4) {
            0 => size = Vec3::splat(size.x),
            1 => size[rng.random_range(0..3)] = 0.0,
            _ => {}
        }
        size *= 10f32.powi(rng.random_range(-30..=15));
        let mut place = Affine3A::from_scale_rotation_translation(size, turn, Vec3::ZERO);
        if rng.random_bool(0.3) {
            let [x, y, z] = [0; 3].map(|_| vector(rng).into());
            place.matrix3 *= Mat3A::from_cols(x, y, z);
        }
        if rng.random_bool(0.8) {
            place.translation = (vector(rng) * size.abs().max_element() * 100.0).into();
        }
        place
    }

    /// A vertex as shaders may transform it: sums in several orders, fused or not.
    fn transformed(place: &Affine3A, p: Vec3) -> [Vec3; 4] {
        let row = |i: usize| (Vec3::from(place.matrix3.row(i)), place.translation[i]);
        let by_row =
            |f: &dyn Fn(Vec3, f32) -> f32| Vec3::from_array([0, 1, 2].map(|i| f(row(i).0, row(i).1)));
        [
            place.transform_point3(p),
            (Mat4::from(*place) * p.extend(1.0)).truncate(),
            by_row(&|r, t| r.x.mul_add(p.x, r.y.mul_add(p.y, r.z.mul_add(p.z, t)))),
            by_row(&|r, t| t + r.z * p.z + (r.y * p.y + r.x * p.x)),
        ]
    }

    #[test]
    fn the_box_of_a_placed_mesh_holds_every_vertex_of_every_level() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..300 {
            let mesh = random_mesh(&mut rng);
            for _ in 0..30 {
                let place = random_place(&mut rng);
                let (bounds, around) = (mesh.bounds_under(&place), mesh.bounds().transformed(&place));
                assert!(bounds.is_valid() && around.contains(&bounds));
                for &p in mesh.levels().iter().flat_map(|level| &level.positions) {
                    for drawn in transformed(&place, p) {
                        assert!(bounds.contains_point(drawn), "{drawn} is not in {bounds:?}: {place:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_mesh_that_is_nowhere_has_no_valid_box() {
        let mesh = Mesh::new("point", vec![Vec3::ONE], vec![]).unwrap();
        for nowhere in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(f32::MAX)] {
            let scale = Affine3A::from_scale(Vec3::splat(2.0));
            let place = Affine3A::from_translation(nowhere) * scale;
            assert!(!mesh.bounds_under(&place).is_valid(), "{nowhere}");
        }
        assert!(!mesh.bounds_under(&Affine3A::from_scale(Vec3::NAN)).is_valid());
        let nothing = Mesh::new("nothing", vec![], vec![]).unwrap();
        assert!(!nothing.bounds_under(&Affine3A::IDENTITY).is_valid());
    }
}
