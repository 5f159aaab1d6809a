//! The objects of a scene, in struct-of-arrays by slot. Their boxes live in the tree's blocks.

use hecs::Entity;

use super::components::Traits;
use super::object::{ObjectId, ObjectRef};

/// Where an object is kept, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// The slot is free.
    Free,
    /// In the tree.
    Tree,
    /// Drawn always: it asked for it ([`NeverCull`](super::NeverCull)).
    Always,
    /// Drawn always until it is mended: its last edit was bad.
    Bad,
}

const NOT_OCCLUDER: u8 = 1;

/// Slots, their generations and what is known of each object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Objects {
    generation: Vec<u32>,
    entity: Vec<Entity>,
    place: Vec<Place>,
    flags: Vec<u8>,
    traits: Vec<Traits>,
    free: Vec<u32>,
    live: usize,
    /// Objects that are drawn always, in no particular order.
    always: Vec<u32>,
    /// Where each slot stands in `always`, while it does.
    always_at: Vec<u32>,
}

impl Objects {
    pub(crate) fn insert(&mut self, entity: Entity, traits: Traits) -> ObjectId {
        let slot = self.free.pop().unwrap_or_else(|| {
            let slot = self.generation.len() as u32;
            self.generation.push(0);
            self.entity.push(Entity::DANGLING);
            self.place.push(Place::Free);
            self.flags.push(0);
            self.traits.push(Traits::default());
            self.always_at.push(0);
            slot
        });
        self.entity[slot as usize] = entity;
        self.place[slot as usize] = Place::Tree;
        self.set_traits(slot, traits);
        self.live += 1;
        self.id(slot)
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        self.set_place(slot, Place::Free);
        let s = slot as usize;
        // A slot whose generations are used up is retired: no handle is ever valid twice.
        if let Some(next) = self.generation[s].checked_add(1) {
            self.generation[s] = next;
            self.free.push(slot);
        }
        self.entity[s] = Entity::DANGLING;
        self.live -= 1;
    }

    pub(crate) fn set_place(&mut self, slot: u32, place: Place) {
        let kept_apart = |p| matches!(p, Place::Always | Place::Bad);
        let old = std::mem::replace(&mut self.place[slot as usize], place);
        match (kept_apart(old), kept_apart(place)) {
            (false, true) => {
                self.always_at[slot as usize] = self.always.len() as u32;
                self.always.push(slot);
            }
            (true, false) => {
                let hole = self.always_at[slot as usize] as usize;
                self.always.swap_remove(hole);
                if let Some(&moved) = self.always.get(hole) {
                    self.always_at[moved as usize] = hole as u32;
                }
            }
            _ => {}
        }
    }

    pub(crate) fn set_traits(&mut self, slot: u32, traits: Traits) {
        self.flags[slot as usize] = if traits.not_occluder { NOT_OCCLUDER } else { 0 };
        self.traits[slot as usize] = traits;
    }

    pub(crate) fn traits(&self, slot: u32) -> Traits {
        self.traits[slot as usize]
    }

    pub(crate) fn place(&self, slot: u32) -> Place {
        self.place[slot as usize]
    }

    pub(crate) fn entity(&self, slot: u32) -> Entity {
        self.entity[slot as usize]
    }

    pub(crate) fn is_occluder(&self, slot: u32) -> bool {
        self.flags[slot as usize] & NOT_OCCLUDER == 0
    }

    /// The slot of a handle that is still valid.
    pub(crate) fn slot(&self, id: ObjectId) -> Option<u32> {
        let s = id.slot();
        let valid = self.generation.get(s) == Some(&id.generation()) && self.place[s] != Place::Free;
        valid.then_some(s as u32)
    }

    pub(crate) fn id(&self, slot: u32) -> ObjectId {
        ObjectId::new(slot, self.generation[slot as usize])
    }

    pub(crate) fn object(&self, slot: u32) -> ObjectRef {
        ObjectRef::new(self.id(slot), self.entity[slot as usize])
    }

    pub(crate) fn always(&self) -> &[u32] {
        &self.always
    }

    pub(crate) fn len(&self) -> usize {
        self.live
    }

    pub(crate) fn slots(&self) -> impl Iterator<Item = u32> {
        (0..self.place.len() as u32).filter(|&s| self.place[s as usize] != Place::Free)
    }

    pub(crate) fn slot_bound(&self) -> usize {
        self.place.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.generation.capacity()
            * (size_of::<u32>() + size_of::<Entity>() + size_of::<Place>() + 1 + size_of::<Traits>())
            + (self.free.capacity() + self.always.capacity()) * size_of::<u32>()
    }
}
