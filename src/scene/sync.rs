//! Mirroring a hecs world: what is new, what has moved, what is gone.

use std::time::{Duration, Instant};

use hecs::{Entity, Or, With, Without, World};

use super::Scene;
use super::components::{Batch, Bounds, BoundsF64, Mobility, NeverCull, NotOccluder, Slack, Traits};
use super::edit::grown;
use super::objects::{Place, tag_of};
use crate::geom::Aabb;

/// What a [`Scene::sync`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SyncReport {
    /// Objects that are new.
    pub spawned: usize,
    /// Objects whose box or components changed.
    pub moved: usize,
    /// Objects whose entity is gone, or has no bounds any more.
    pub removed: usize,
    /// Objects whose bounds are bad now: they are drawn always.
    pub bad: usize,
    /// The first few of them.
    pub first_bad: Vec<BadEdit>,
    /// Time for reading the world.
    pub sync_time: Duration,
    /// Time for bringing the tree up to date.
    pub tree_time: Duration,
}

/// An edit that could not be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadEdit {
    /// Whose bounds are bad.
    pub entity: Entity,
    /// The box as it was given, without slack.
    pub bounds: Aabb,
    /// Its slack, metres.
    pub slack: f32,
}

impl SyncReport {
    /// How many bad edits are reported by name.
    pub const NAMED: usize = 8;
}

const NONE: u32 = u32::MAX;

/// Which object stands for which entity.
#[derive(Clone, Debug, Default)]
pub(super) struct Mirror {
    /// Slot by `Entity::id`: its object is of that id.
    slot_of: Vec<u32>,
    /// By slot: the last search for removed entities that found its own.
    seen: Vec<u32>,
    /// Slots that stand for an entity.
    count: usize,
    tick: u32,
}

impl Mirror {
    pub(super) fn bytes(&self) -> usize {
        (self.slot_of.capacity() + self.seen.capacity()) * size_of::<u32>()
    }

    fn slot_of(&self, entity: Entity) -> Option<u32> {
        self.slot_of.get(entity.id() as usize).copied().filter(|&s| s != NONE)
    }

    fn bind(&mut self, entity: Entity, slot: u32) {
        let index = entity.id() as usize;
        if index >= self.slot_of.len() {
            self.slot_of.resize(index + 1, NONE);
        }
        self.slot_of[index] = slot;
        self.count += 1;
    }

    /// Forgets an entity whose object is removed, if this slot stands for it.
    pub(super) fn unbind(&mut self, entity: Entity, slot: u32) {
        if self.slot_of(entity) == Some(slot) {
            self.slot_of[entity.id() as usize] = NONE;
            self.count -= 1;
        }
    }

    /// Records that the entity of its slot is there.
    fn see(&mut self, entity: Entity) {
        let Some(slot) = self.slot_of(entity) else { return };
        let index = slot as usize;
        if index >= self.seen.len() {
            self.seen.resize(index + 1, 0);
        }
        self.seen[index] = self.tick;
    }
}

type Optional<'a> = (
    Option<&'a Mobility>,
    Option<&'a NeverCull>,
    Option<&'a NotOccluder>,
    Option<&'a Slack>,
    Option<&'a Batch>,
);

/// Entities with any of them.
type AnyOptional<'a> = Or<&'a Mobility, Or<&'a NeverCull, Or<&'a NotOccluder, Or<&'a Slack, &'a Batch>>>>;

impl Scene {
    /// Brings the scene in step with a world: entities with [`Bounds`] (or [`BoundsF64`]) are its
    /// objects. Spawned, moved and despawned entities, components added and removed, and entity
    /// ids reused are all found by looking; nothing need be announced. The update is included.
    /// O(entities), and O(depth) for each that changed.
    pub fn sync(&mut self, world: &World) -> SyncReport {
        let start = Instant::now();
        let mut report = SyncReport::default();
        // Most entities have bounds alone, and most of those stay where they are.
        let mut bare = world.query::<Without<(Entity, &Bounds), AnyOptional<'_>>>();
        let mut bare = bare.iter();
        let mut found = bare.len();
        while let Some((entity, Bounds(bounds))) = self.find_changed(&mut bare) {
            self.sync_one(entity, *bounds, Traits::default(), &mut report);
        }
        let mut others = world.query::<With<(Entity, &Bounds, Optional<'_>), AnyOptional<'_>>>();
        for (entity, Bounds(bounds), optional) in others.iter() {
            found += 1;
            self.sync_one(entity, *bounds, traits(optional), &mut report);
        }
        let mut absolute = world.query::<Without<(Entity, &BoundsF64, Optional<'_>), &Bounds>>();
        for (entity, b, optional) in absolute.iter() {
            found += 1;
            let bounds = Aabb::from_f64(b.min, b.max, self.origin);
            self.sync_one(entity, bounds, traits(optional), &mut report);
        }
        if found < self.mirror.count {
            self.mirror.tick = self.mirror.tick.wrapping_add(1);
            for entity in world.query::<With<Entity, Or<&Bounds, &BoundsF64>>>().iter() {
                self.mirror.see(entity);
            }
            self.remove_unseen(&mut report);
        }
        report.sync_time = start.elapsed();
        report.tree_time = self.update();
        report
    }

    /// The next of entities with nothing but their bounds that is not surely in the tree with this very
    /// box.
    #[inline]
    fn find_changed<'a>(
        &self,
        bare: &mut impl Iterator<Item = (Entity, &'a Bounds)>,
    ) -> Option<(Entity, &'a Bounds)> {
        let (slot_of, tagged) = (&self.mirror.slot_of[..], self.tree.tagged());
        bare.find(|(entity, Bounds(bounds))| {
            let slot = slot_of.get(entity.id() as usize);
            !slot.is_some_and(|&slot| tagged.has(slot, tag_of(*entity), bounds))
        })
    }

    fn sync_one(&mut self, entity: Entity, bounds: Aabb, traits: Traits, report: &mut SyncReport) {
        let known = self.mirror.slot_of(entity);
        let slot = known.filter(|&slot| {
            let same = self.objects.entity(slot) == entity;
            if !same {
                self.remove_gone(slot, report);
            }
            same
        });
        let slot = match slot {
            Some(slot) => {
                if self.change(slot, bounds, traits) {
                    report.moved += 1;
                }
                slot
            }
            None => {
                let slot = self.insert_for(entity, bounds, traits).slot() as u32;
                self.mirror.bind(entity, slot);
                report.spawned += 1;
                slot
            }
        };
        if self.objects.place(slot) == Place::Bad {
            report.bad += 1;
            if report.first_bad.len() < SyncReport::NAMED {
                report.first_bad.push(BadEdit { entity, bounds, slack: traits.slack });
            }
        }
    }

    /// Takes over an entity's new box and components; false if they are the old ones.
    fn change(&mut self, slot: u32, bounds: Aabb, traits: Traits) -> bool {
        let same_traits = self.objects.has_traits(slot, &traits);
        let same_box = match self.objects.place(slot) {
            Place::Tree => self.tree.aabb_of(slot) == Some(grown(bounds, traits.slack)),
            // Drawn always: only whether the box is good matters.
            Place::Always => bounds.is_valid(),
            Place::Bad => !grown(bounds, traits.slack).is_valid(),
            Place::Free => false,
        };
        if same_traits && same_box {
            return false;
        }
        self.change_traits(slot, bounds, traits);
        true
    }

    fn remove_unseen(&mut self, report: &mut SyncReport) {
        for index in 0..self.mirror.slot_of.len() {
            let slot = self.mirror.slot_of[index];
            if slot == NONE {
                continue;
            }
            if self.mirror.seen.get(slot as usize) != Some(&self.mirror.tick) {
                self.remove_gone(slot, report);
            }
        }
    }

    /// Removes the object of an entity that is gone.
    fn remove_gone(&mut self, slot: u32, report: &mut SyncReport) {
        self.remove_slot(slot);
        report.removed += 1;
    }
}

fn traits((mobility, never_cull, not_occluder, slack, batch): Optional<'_>) -> Traits {
    Traits {
        mobility: mobility.copied().unwrap_or_default(),
        never_cull: never_cull.is_some(),
        not_occluder: not_occluder.is_some(),
        slack: slack.map_or(0.0, |s| s.0),
        batch: batch.copied(),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::SceneConfig;

    /// Nothing of an entity but its components changes: the short way, by its tag, must not be taken.
    #[test]
    fn what_comes_and_goes_while_its_entity_stands_still_is_found() {
        let (mut world, mut scene) = (World::new(), Scene::new(SceneConfig::default()));
        let good = Bounds(Aabb::new(Vec3::ZERO, Vec3::ONE));
        let entity = world.spawn((good,));
        let slot = scene.sync(&world).spawned as u32 - 1;
        assert!(scene.find_changed(&mut [(entity, &good)].into_iter()).is_none(), "the short way");
        for _ in 0..2 {
            world.insert_one(entity, NotOccluder).expect("an entity");
            assert_eq!(scene.sync(&world).moved, 1);
            assert!(!scene.objects.is_occluder(slot));
            world.remove_one::<NotOccluder>(entity).expect("an entity");
            assert_eq!(scene.sync(&world).moved, 1);
            assert!(scene.objects.is_occluder(slot));
            world.insert_one(entity, Bounds(Aabb::EMPTY)).expect("an entity");
            assert_eq!(scene.sync(&world).bad, 1);
            world.insert_one(entity, good).expect("an entity");
            assert_eq!((scene.sync(&world).bad, scene.objects.place(slot)), (0, Place::Tree));
        }
    }
}
