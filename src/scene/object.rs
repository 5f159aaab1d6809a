//! Names of objects, and sets of them.

use hecs::Entity;

/// A handle of an object in one scene: a slot and the slot's generation, so that the handle of a
/// removed object never names the one that took its slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ObjectId {
    slot: u32,
    generation: u32,
}

impl ObjectId {
    pub(crate) const fn new(slot: u32, generation: u32) -> Self {
        Self { slot, generation }
    }

    /// The slot: dense, reused after removal, an index for side tables and [`ObjectSet`].
    pub const fn slot(self) -> usize {
        self.slot as usize
    }

    /// How often the slot has been given out before.
    pub const fn generation(self) -> u32 {
        self.generation
    }
}

/// What a draw closure is handed: an object and the app's entity behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObjectRef {
    /// The scene's handle.
    pub id: ObjectId,
    entity: Entity,
}

impl ObjectRef {
    pub(crate) const fn new(id: ObjectId, entity: Entity) -> Self {
        Self { id, entity }
    }

    /// The app's entity; [`Entity::DANGLING`] for an object inserted without one.
    pub const fn entity(self) -> Entity {
        self.entity
    }
}

/// A set of objects by slot: one bit each. It does not know generations; it is meant for one
/// frame, between two edits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ObjectSet {
    words: Vec<u64>,
}

impl ObjectSet {
    /// Adds an object; true if it was not in the set.
    pub fn insert(&mut self, id: ObjectId) -> bool {
        let (word, bit) = (id.slot() / 64, 1 << (id.slot() % 64));
        if word >= self.words.len() {
            self.words.resize(word + 1, 0);
        }
        let new = self.words[word] & bit == 0;
        self.words[word] |= bit;
        new
    }

    /// Whether an object is in the set.
    pub fn contains(&self, id: ObjectId) -> bool {
        self.words.get(id.slot() / 64).is_some_and(|w| w & (1 << (id.slot() % 64)) != 0)
    }

    /// The slots of its objects, in order.
    pub fn slots(&self) -> impl Iterator<Item = usize> {
        self.words.iter().enumerate().flat_map(|(at, &word)| {
            std::iter::successors(Some(word), |&rest| (rest != 0).then(|| rest & (rest - 1)))
                .take_while(|&rest| rest != 0)
                .map(move |rest| 64 * at + rest.trailing_zeros() as usize)
        })
    }

    /// Takes the place of what it held: a bit a slot.
    pub(crate) fn assign(&mut self, words: impl Iterator<Item = u64>) {
        self.words.clear();
        self.words.extend(words);
    }

    /// A bit a slot.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// Empties the set and keeps its memory.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }

    /// How many objects are in the set. O(capacity / 64).
    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&w| w == 0)
    }
}
