//! The examples' renderer: what an app would put in its own draw closure.

use hecs::World;
use tercet::draw::{Detail, Drawable};
use tercet::geom::View;
use tercet::query::software::SoftwarePass;
use tercet::scene::ObjectRef;

/// Draws objects that are entities with a [`Drawable`].
#[derive(Clone, Copy, Debug)]
pub struct Painter {
    /// How finely.
    pub detail: Detail,
}

impl Painter {
    /// Draws objects into a pass and returns the number of triangles.
    pub fn draw(&self, world: &World, view: &View, pass: &mut SoftwarePass, objects: &[ObjectRef]) -> u64 {
        let mut triangles = 0;
        for object in objects {
            // Whoever has bounds but nothing to show draws nothing.
            let Ok(drawable) = world.get::<&Drawable>(object.entity()) else { continue };
            let Drawable { mesh, world_from_object, .. } = &*drawable;
            let level = self.detail.level(mesh, world_from_object, view);
            pass.draw_level(mesh, level, world_from_object);
            triangles += mesh.levels()[level].indices.len() as u64 / 3;
        }
        triangles
    }
}
