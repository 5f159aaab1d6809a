//! Direct edits: insert, move, remove.

use glam::Vec4;
use hecs::Entity;
use pulp::NullaryFnOnce;

use super::Scene;
use super::components::Traits;
use super::object::ObjectId;
use super::objects::{Place, Plain};
use super::tape::SceneEdit;
use crate::geom::Aabb;
use crate::tree::Newest;

impl Scene {
    /// Adds an object, without an entity. Its box may be bad: then it is drawn always.
    /// O(1). Call [`Scene::update`] before the next frame.
    pub fn insert(&mut self, bounds: Aabb, traits: Traits) -> ObjectId {
        self.insert_for(Entity::DANGLING, bounds, traits)
    }

    /// Moves an object; returns false if the handle is no longer valid. A bad box (not finite or
    /// inverted) makes the object drawn always until it is given a good one. O(1); the object is
    /// placed by the next update.
    pub fn set_bounds(&mut self, id: ObjectId, bounds: Aabb) -> bool {
        let Some(slot) = self.objects.slot(id) else { return false };
        self.note(|| SceneEdit::SetBounds { id, bounds });
        self.set_slot_bounds(slot, bounds);
        true
    }

    /// Moves many objects, in time proportional to their number: for apps that know what moved.
    /// Returns how many handles were no longer valid. The update is included.
    pub fn sync_moved(&mut self, moved: impl IntoIterator<Item = (ObjectId, Aabb)>) -> usize {
        let mut moved = moved.into_iter();
        let mut stale = 0;
        while let Some((id, bounds)) = self.take_plain(&mut moved) {
            if !self.set_bounds(id, bounds) {
                stale += 1;
            }
        }
        self.update();
        stale
    }

    /// Moves objects that need no closer look, up to the first that does: that one is returned.
    #[inline]
    fn take_plain(&mut self, moved: &mut impl Iterator<Item = (ObjectId, Aabb)>) -> Option<(ObjectId, Aabb)> {
        if self.tape.is_some() {
            return moved.next();
        }
        if moved.size_hint().1 == Some(0) {
            return None;
        }
        let take = TakePlain { moved, objects: self.objects.plain(), newest: self.tree.newest() };
        #[cfg(target_arch = "x86_64")]
        if let Some(wide) = pulp::x86::V3::try_new() {
            return wide.vectorize(take);
        }
        take.call()
    }

    /// Changes an object's optional components; false if the handle is no longer valid. O(depth).
    pub fn set_traits(&mut self, id: ObjectId, bounds: Aabb, traits: Traits) -> bool {
        let Some(slot) = self.objects.slot(id) else { return false };
        self.change_traits(slot, bounds, traits);
        true
    }

    /// Removes an object; false if the handle is no longer valid. O(depth).
    pub fn remove(&mut self, id: ObjectId) -> bool {
        let Some(slot) = self.objects.slot(id) else { return false };
        self.remove_slot(slot);
        true
    }

    pub(super) fn insert_for(&mut self, entity: Entity, bounds: Aabb, traits: Traits) -> ObjectId {
        self.note(|| SceneEdit::Insert { bounds, traits });
        let id = self.objects.insert(entity, traits);
        self.put(id.slot() as u32, grown(bounds, traits.slack));
        id
    }

    /// Gives an object other components and a box.
    pub(super) fn change_traits(&mut self, slot: u32, bounds: Aabb, traits: Traits) {
        let id = self.objects.id(slot);
        self.note(|| SceneEdit::SetTraits { id, bounds, traits });
        self.objects.set_traits(slot, traits);
        self.set_slot_bounds(slot, bounds);
        self.tree.set_tag(slot, self.objects.tag(slot));
    }

    /// Gives an object a box. It is not taken down here.
    pub(super) fn set_slot_bounds(&mut self, slot: u32, bounds: Aabb) {
        let traits = self.objects.traits(slot);
        let bounds = grown(bounds, traits.slack);
        let in_tree = self.objects.place(slot) == Place::Tree;
        if in_tree && !traits.never_cull && bounds.is_valid() {
            self.tree.set_bounds(slot, &bounds);
            self.pending += 1;
        } else {
            if in_tree {
                self.tree.remove(slot);
            }
            self.put(slot, bounds);
        }
    }

    pub(super) fn remove_slot(&mut self, slot: u32) {
        let id = self.objects.id(slot);
        self.note(|| SceneEdit::Remove(id));
        if self.objects.place(slot) == Place::Tree {
            self.tree.remove(slot);
        }
        self.mirror.unbind(self.objects.entity(slot), slot);
        self.objects.remove(slot);
        self.pending += 1;
    }

    /// Keeps an object that the tree does not hold where it belongs.
    pub(super) fn put(&mut self, slot: u32, bounds: Aabb) {
        self.pending += 1;
        let place = if !bounds.is_valid() {
            Place::Bad
        } else if self.objects.traits(slot).never_cull {
            Place::Always
        } else {
            self.tree.insert(slot, &bounds);
            Place::Tree
        };
        self.objects.set_place(slot, place);
        self.tree.set_tag(slot, self.objects.tag(slot));
    }
}

/// The taking of plain objects, to be compiled for each kind of registers.
struct TakePlain<'a, I> {
    moved: &'a mut I,
    objects: Plain<'a>,
    newest: Newest<'a>,
}

impl<I: Iterator<Item = (ObjectId, Aabb)>> NullaryFnOnce for TakePlain<'_, I> {
    type Output = Option<(ObjectId, Aabb)>;

    #[inline(always)]
    fn call(self) -> Option<(ObjectId, Aabb)> {
        let Self { moved, objects, newest } = self;
        // One length for both: a slot is compared with it once.
        let slots = objects.len().min(newest.len());
        let (objects, mut newest) = (objects.up_to(slots), newest.up_to(slots));
        moved.find(|(id, bounds)| {
            let plain = objects.has(*id) && is_surely_valid(bounds);
            !(plain && newest.set(id.slot() as u32, bounds))
        })
    }
}

/// Whether a box is certainly valid, without a branch: its size is neither NaN, negative nor
/// infinite, so that its corners are finite and in order. A box larger than f32 can say is not
/// certain.
#[inline(always)]
fn is_surely_valid(Aabb { min, max }: &Aabb) -> bool {
    // x is there twice, so that all lanes are of use.
    let size = Vec4::new(max.x, max.x, max.y, max.z) - Vec4::new(min.x, min.x, min.y, min.z);
    size.abs().min(Vec4::MAX).cmpeq(size).all()
}

/// The box with its slack. A slack that is not a length makes the box bad, not smaller.
pub(super) fn grown(bounds: Aabb, slack: f32) -> Aabb {
    if slack == 0.0 {
        bounds
    } else if slack > 0.0 && bounds.is_valid() {
        bounds.inflated(slack)
    } else {
        Aabb::EMPTY
    }
}
