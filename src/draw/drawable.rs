//! The component that the worlds of this crate are drawn from.

use glam::Affine3A;

use crate::scene::mesh::Mesh;

/// A mesh at a place, in one colour. Many entities share one mesh: cloning it copies a pointer.
#[derive(Clone, Debug)]
pub struct Drawable {
    /// What to draw, in object space.
    pub mesh: Mesh,
    /// Where to draw it.
    pub world_from_object: Affine3A,
    /// Red, green and blue, as sRGB shows them.
    pub color: [u8; 3],
}
