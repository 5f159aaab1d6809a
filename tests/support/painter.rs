//! An app's own drawing.

use hecs::World;
use tercet::draw::{Detail, Drawable};
use tercet::geom::View;
use tercet::query::software::SoftwarePass;
use tercet::scene::ObjectRef;

/// Draws an app's objects, as finely as a view asks for; what has no mesh does not show.
pub fn draw(world: &World, view: &View, detail: Detail, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
    for object in objects {
        let Ok(d) = world.get::<&Drawable>(object.entity()) else { continue };
        pass.draw_level(&d.mesh, detail.level(&d.mesh, &d.world_from_object, view), &d.world_from_object);
    }
}
