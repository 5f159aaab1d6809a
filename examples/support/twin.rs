//! A world once more, for a lane that adds components of its own: the other lanes read theirs as it is.

use hecs::{Component, Entity, World};
use tercet::draw::Drawable;
use tercet::scene::{Bounds, Mobility, NeverCull, NotOccluder, Slack};

/// A copy of a world, under the same names of entities, that follows what moves in it.
#[derive(Default)]
pub struct Twin {
    /// The copy.
    pub world: World,
}

impl Twin {
    /// Everything that the engine reads, and what is drawn.
    pub fn new(world: &World) -> Self {
        let mut twin = Self::default();
        for (entity, bounds, drawable) in world.query::<(Entity, &Bounds, &Drawable)>().iter() {
            twin.world.spawn_at(entity, (*bounds, drawable.clone()));
        }
        twin.copy::<Mobility>(world);
        twin.copy::<NeverCull>(world);
        twin.copy::<NotOccluder>(world);
        twin.copy::<Slack>(world);
        twin
    }

    /// Moves what has moved. In the worlds that are compared nothing is spawned later. O(entities).
    pub fn follow(&mut self, world: &World) {
        let originals = world.view::<(&Bounds, &Drawable)>();
        for (entity, bounds, drawable) in self.world.query_mut::<(Entity, &mut Bounds, &mut Drawable)>() {
            if let Some((now, original)) = originals.get(entity)
                && (bounds.0 != now.0 || drawable.world_from_object != original.world_from_object)
            {
                *bounds = *now;
                *drawable = original.clone();
            }
        }
    }

    fn copy<C: Component + Clone>(&mut self, world: &World) {
        for (entity, component) in world.query::<(Entity, &C)>().iter() {
            // Whoever has no bounds has no twin.
            let _ = self.world.insert_one(entity, component.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use tercet::worlds;

    use super::*;

    #[test]
    fn a_twin_has_the_same_entities_in_the_same_places() {
        let mut world = World::new();
        worlds::random(3, 50).spawn(&mut world);
        let first = world.query::<(Entity, &Bounds)>().iter().map(|(entity, _)| entity).next();
        let moved = first.expect("there are some");
        world.insert_one(moved, Slack(0.5)).expect("it is there");
        let mut twin = Twin::new(&world);
        let up = Affine3A::from_translation(Vec3::Y);
        let (bounds, drawable) =
            world.query_one_mut::<(&mut Bounds, &mut Drawable)>(moved).expect("it is there");
        drawable.world_from_object = up * drawable.world_from_object;
        bounds.0 = drawable.mesh.bounds_under(&drawable.world_from_object);
        twin.follow(&world);
        assert_eq!(twin.world.len(), world.len());
        for (entity, bounds, drawable) in world.query::<(Entity, &Bounds, &Drawable)>().iter() {
            let copy = twin.world.get::<&Drawable>(entity).expect("it has a twin");
            assert_eq!(twin.world.get::<&Bounds>(entity).expect("it has bounds").0, bounds.0);
            assert_eq!(copy.world_from_object, drawable.world_from_object);
        }
        assert_eq!(twin.world.get::<&Slack>(moved).expect("it has slack").0, 0.5);
    }
}
