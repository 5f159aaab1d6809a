//! The objects of a scene, in struct-of-arrays by slot. Their boxes live in the tree.
//!
//! What nearly every object lacks (slack, a batch, being drawn always) has arrays that are no
//! longer than the last slot that needs them.

use hecs::Entity;

use super::components::{Batch, Mobility, Traits};
use super::object::{ObjectId, ObjectRef};
use crate::tree::grow;

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

/// What is known of an object, in a byte: its place, then its traits.
type State = u8;
const PLACE: State = 0b11;
const NOT_OCCLUDER: State = 1 << 2;
const NEVER_CULL: State = 1 << 3;
/// It has a slack, in the array of slacks.
const SLACK: State = 1 << 4;
/// It has a batch, in the array of batches.
const BATCH: State = 1 << 5;
const STATIC: State = 1 << 6;
const DYNAMIC: State = 1 << 7;

/// Marks the generation of a slot that is not plain: not in the tree, drawn always, or with slack.
/// So one compare with a handle's generation tells that it is valid, and nothing is special.
const SPECIAL: u32 = 1 << 31;

/// Slots, their generations and what is known of each object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Objects {
    /// The generation, and [`SPECIAL`] where it applies.
    generation: Vec<u32>,
    entity: Vec<Entity>,
    state: Vec<State>,
    slack: Vec<f32>,
    batch: Vec<Batch>,
    free: Vec<u32>,
    live: usize,
    /// Objects that are drawn always, in no particular order.
    always: Vec<u32>,
    /// Where each slot stands in `always`, while it does.
    always_at: Vec<u32>,
}

/// The objects in the tree whose boxes need no slack.
#[derive(Clone, Copy)]
pub(crate) struct Plain<'a>(&'a [u32]);

impl Plain<'_> {
    /// Slots that there are.
    #[inline(always)]
    pub(crate) fn len(self) -> usize {
        self.0.len()
    }

    /// Those below a slot.
    #[inline(always)]
    pub(crate) fn up_to(self, slot: usize) -> Self {
        Self(&self.0[..slot])
    }

    /// Whether a handle is that of one of them.
    #[inline]
    pub(crate) fn has(self, id: ObjectId) -> bool {
        self.0.get(id.slot()) == Some(&id.generation())
    }
}

impl Objects {
    pub(crate) fn insert(&mut self, entity: Entity, traits: Traits) -> ObjectId {
        let slot = self.free.pop().unwrap_or_else(|| {
            let slot = self.generation.len();
            grow(&mut self.generation, slot + 1, SPECIAL);
            grow(&mut self.entity, slot + 1, Entity::DANGLING);
            grow(&mut self.state, slot + 1, Place::Free as State);
            slot as u32
        });
        self.entity[slot as usize] = entity;
        self.state[slot as usize] = Place::Tree as State;
        self.set_traits(slot, traits);
        self.live += 1;
        self.id(slot)
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        self.set_place(slot, Place::Free);
        let s = slot as usize;
        // A slot whose generations are used up is retired: no handle is ever valid twice.
        let next = (self.generation[s] & !SPECIAL) + 1;
        self.generation[s] = next | SPECIAL;
        if next < SPECIAL - 1 {
            self.free.push(slot);
        }
        self.entity[s] = Entity::DANGLING;
        self.live -= 1;
    }

    pub(crate) fn set_place(&mut self, slot: u32, place: Place) {
        let kept_apart = |p| matches!(p, Place::Always | Place::Bad);
        let old = self.place(slot);
        self.set_state(slot, self.state[slot as usize] & !PLACE | place as State);
        match (kept_apart(old), kept_apart(place)) {
            (false, true) => {
                *entry(&mut self.always_at, slot) = self.always.len() as u32;
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
        let state = self.state[slot as usize] & PLACE | state_of(&traits);
        self.set_state(slot, state);
        if state & SLACK != 0 {
            *entry(&mut self.slack, slot) = traits.slack;
        }
        if let Some(batch) = traits.batch {
            *entry(&mut self.batch, slot) = batch;
        }
    }

    pub(crate) fn traits(&self, slot: u32) -> Traits {
        let (s, state) = (slot as usize, self.state[slot as usize]);
        let mobility = match state & (STATIC | DYNAMIC) {
            STATIC => Mobility::Static,
            DYNAMIC => Mobility::Dynamic,
            _ => Mobility::Unknown,
        };
        Traits {
            mobility,
            never_cull: state & NEVER_CULL != 0,
            not_occluder: state & NOT_OCCLUDER != 0,
            slack: if state & SLACK != 0 { self.slack[s] } else { 0.0 },
            batch: (state & BATCH != 0).then(|| self.batch[s]),
        }
    }

    /// Whether an object has these very traits. Slacks are compared bit for bit: one that is NaN
    /// is the same bad slack as before.
    #[inline]
    pub(crate) fn has_traits(&self, slot: u32, traits: &Traits) -> bool {
        let (s, state) = (slot as usize, self.state[slot as usize] & !PLACE);
        state == state_of(traits)
            && (state & SLACK == 0 || self.slack[s].to_bits() == traits.slack.to_bits())
            && (state & BATCH == 0 || Some(self.batch[s]) == traits.batch)
    }

    /// What the tree is to know an object by: its entity's generation, if it is there and has no traits,
    /// and else 0. Where the slot is the entity's by its id, that tells all that an entity without traits
    /// is compared by.
    pub(crate) fn tag(&self, slot: u32) -> u32 {
        let is_bare = self.state[slot as usize] == Place::Tree as State;
        if is_bare { tag_of(self.entity[slot as usize]) } else { 0 }
    }

    /// The objects in the tree whose boxes need no slack: the common case.
    #[inline]
    pub(crate) fn plain(&self) -> Plain<'_> {
        Plain(&self.generation)
    }

    pub(crate) fn place(&self, slot: u32) -> Place {
        [Place::Free, Place::Tree, Place::Always, Place::Bad][(self.state[slot as usize] & PLACE) as usize]
    }

    pub(crate) fn entity(&self, slot: u32) -> Entity {
        self.entity[slot as usize]
    }

    pub(crate) fn is_occluder(&self, slot: u32) -> bool {
        self.state[slot as usize] & NOT_OCCLUDER == 0
    }

    /// The slot of a handle that is still valid.
    pub(crate) fn slot(&self, id: ObjectId) -> Option<u32> {
        let s = id.slot();
        let valid = self.generation.get(s).is_some_and(|g| g & !SPECIAL == id.generation());
        (valid && self.state[s] & PLACE != Place::Free as State).then_some(s as u32)
    }

    pub(crate) fn id(&self, slot: u32) -> ObjectId {
        ObjectId::new(slot, self.generation[slot as usize] & !SPECIAL)
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
        (0..self.state.len() as u32).filter(|&s| self.place(s) != Place::Free)
    }

    pub(crate) fn slot_bound(&self) -> usize {
        self.state.len()
    }

    fn set_state(&mut self, slot: u32, state: State) {
        self.state[slot as usize] = state;
        let is_plain = state & (PLACE | NEVER_CULL | SLACK) == Place::Tree as State;
        let generation = &mut self.generation[slot as usize];
        *generation = *generation & !SPECIAL | if is_plain { 0 } else { SPECIAL };
    }

    pub(crate) fn bytes(&self) -> usize {
        self.generation.capacity() * size_of::<u32>()
            + self.entity.capacity() * size_of::<Entity>()
            + self.state.capacity()
            + self.slack.capacity() * size_of::<f32>()
            + self.batch.capacity() * size_of::<Batch>()
            + (self.free.capacity() + self.always.capacity() + self.always_at.capacity()) * size_of::<u32>()
    }
}

/// An entity's generation; it is never 0.
#[inline(always)]
pub(crate) fn tag_of(entity: Entity) -> u32 {
    (entity.to_bits().get() >> 32) as u32
}

/// The traits' share of a state.
fn state_of(traits: &Traits) -> State {
    let flag = |bit, is_set| if is_set { bit } else { 0 };
    flag(NOT_OCCLUDER, traits.not_occluder)
        | flag(NEVER_CULL, traits.never_cull)
        | flag(SLACK, traits.slack.to_bits() != 0)
        | flag(BATCH, traits.batch.is_some())
        | flag(STATIC, traits.mobility == Mobility::Static)
        | flag(DYNAMIC, traits.mobility == Mobility::Dynamic)
}

/// A slot's place in an array that is only as long as it must be.
fn entry<T: Clone + Default>(array: &mut Vec<T>, slot: u32) -> &mut T {
    let s = slot as usize;
    if s >= array.len() {
        array.resize(s + 1, T::default());
    }
    &mut array[s]
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// A slot is given out as long as it has generations; then it is retired, and the next object gets
    /// another. No handle is valid again.
    #[test]
    fn generations_that_are_used_up_name_nobody_twice() {
        let mut objects = Objects::default();
        let first = objects.insert(Entity::DANGLING, Traits::default());
        // As if the slot had been given out nearly as often as it can be.
        objects.generation[0] += SPECIAL - 6 - first.generation();
        let mut given = HashSet::new();
        let mut id = objects.id(0);
        for _ in 0..10 {
            assert!(given.insert(id), "{id:?} was given out before");
            assert!(id.generation() < SPECIAL - 1 && objects.plain().has(id));
            objects.remove(objects.slot(id).expect("it is there"));
            assert!(given.iter().all(|&old| objects.slot(old).is_none() && !objects.plain().has(old)));
            id = objects.insert(Entity::DANGLING, Traits::default());
        }
        assert_eq!((objects.slot_bound(), objects.len()), (2, 1), "one slot was retired");
        assert_eq!(id.slot(), 1);
    }
}
