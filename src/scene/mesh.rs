//! Triangle meshes and their levels of detail.

use std::sync::Arc;

use glam::Vec3;

use crate::Error;
use crate::geom::Aabb;

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

#[derive(Debug)]
struct MeshData {
    name: String,
    levels: Vec<Level>,
    bounds: Aabb,
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
        Ok(Self(Arc::new(MeshData { name, levels, bounds })))
    }

    /// The name it was made with.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// The box around every vertex of every level, in object space.
    pub fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    /// The levels of detail, finest first; never empty.
    pub fn levels(&self) -> &[Level] {
        &self.0.levels
    }

    /// Triangles of the finest level.
    pub fn triangle_count(&self) -> usize {
        self.0.levels[0].indices.len() / 3
    }
}
