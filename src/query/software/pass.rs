//! What the app's closure records into: draw calls, kept until the pass is rasterised.

use glam::Affine3A;

use crate::scene::mesh::{Level, Mesh};

/// Which triangles are drawn, by the side that they show to the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Faces {
    /// Those that show either side.
    #[default]
    Both,
    /// Those that show their front: their corners run counter-clockwise in the world, as glTF has
    /// it. Where the transform to the world mirrors the mesh, fronts stay outside: corners that run
    /// clockwise after it are a front (glTF 2.0, 3.7.4). What clipping leaves of a triangle is judged
    /// piece by piece, by its corners on the screen; so is every triangle.
    ///
    /// For those who draw with back faces culled: their depth holds exactly these.
    Front,
}

/// One draw call: a level of a mesh and where it stands.
#[derive(Clone, Debug)]
pub struct DrawCall {
    /// The mesh; a handle.
    pub mesh: Mesh,
    /// Which of [`Mesh::levels`] is drawn, 0 for the finest.
    pub level: usize,
    /// Object space to the scene's world space.
    pub world_from_object: Affine3A,
    /// Which of its triangles are drawn.
    pub faces: Faces,
}

impl DrawCall {
    /// The level's triangles.
    pub fn geometry(&self) -> &Level {
        &self.mesh.levels()[self.level]
    }

    /// How many triangles the call draws.
    pub fn triangle_count(&self) -> usize {
        self.geometry().indices.len() / 3
    }
}

/// The software backend's pass: the draw calls of one flush, in order.
#[derive(Debug, Default)]
pub struct SoftwarePass {
    calls: Vec<DrawCall>,
}

impl SoftwarePass {
    /// Draws a mesh in its finest level, both sides of each triangle. O(1): a pointer is copied.
    pub fn draw_mesh(&mut self, mesh: &Mesh, world_from_object: &Affine3A) {
        self.draw_level(mesh, 0, world_from_object);
    }

    /// Draws one level of a mesh, both sides of each triangle; a level beyond the last draws the
    /// last.
    pub fn draw_level(&mut self, mesh: &Mesh, level: usize, world_from_object: &Affine3A) {
        self.draw_faces(mesh, level, Faces::Both, world_from_object);
    }

    /// The same of some of its triangles.
    pub fn draw_faces(&mut self, mesh: &Mesh, level: usize, faces: Faces, world_from_object: &Affine3A) {
        let level = level.min(mesh.levels().len() - 1);
        let world_from_object = *world_from_object;
        self.calls.push(DrawCall { mesh: mesh.clone(), level, world_from_object, faces });
    }

    /// What was drawn so far.
    pub fn calls(&self) -> &[DrawCall] {
        &self.calls
    }

    /// Hands its draw calls over, behind others.
    pub(crate) fn drain_into(&mut self, calls: &mut Vec<DrawCall>) {
        calls.append(&mut self.calls);
    }

    pub(crate) fn clear(&mut self) {
        self.calls.clear();
    }
}
