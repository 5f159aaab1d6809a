//! Ordered compaction: the flags of a sweep become a list (HROC, *packed multidraw*).
//!
//! A prefix sum over the flags gives each flagged object its place, so the list keeps the objects'
//! order, by slot, whoever set the flags and when: what lies at the same depth does not flicker from
//! frame to frame. The twin of the device's stages: count, scan, scatter, a word of flags a thread.

use crate::scene::{ObjectId, ObjectSet, Scene};

/// Room to work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compaction {
    /// By word: how many objects come before it.
    before: Vec<u32>,
}

impl Compaction {
    /// Lists the objects of a set in the order of their slots. O(slots / 64 + objects).
    pub(crate) fn list(&mut self, scene: &Scene, set: &ObjectSet, list: &mut Vec<ObjectId>) {
        self.before.clear();
        let mut sum = 0;
        for word in set.words() {
            self.before.push(sum);
            sum += word.count_ones();
        }
        list.clear();
        list.resize(sum as usize, ObjectId::new(0, 0));
        for (word, (&flags, &before)) in set.words().iter().zip(&self.before).enumerate() {
            let (mut rest, mut at) = (flags, before as usize);
            while rest != 0 {
                let slot = 64 * word as u32 + rest.trailing_zeros();
                rest &= rest - 1;
                list[at] = scene.objects_store().id(slot);
                at += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::scene::{SceneConfig, Traits};
    use glam::Vec3;

    #[test]
    fn the_list_is_in_the_order_of_slots_and_whole() {
        let mut scene = Scene::new(SceneConfig::default());
        let unit = Aabb::from_center(Vec3::ZERO, Vec3::ONE);
        let mut ids: Vec<ObjectId> = (0..300).map(|_| scene.insert(unit, Traits::default())).collect();
        // Slots that are given out again keep their place in the order.
        for i in (0..300).step_by(7) {
            scene.remove(ids[i]);
            ids[i] = scene.insert(unit, Traits::default());
        }
        let (mut compaction, mut list) = (Compaction::default(), Vec::new());
        for step in [1, 2, 63, 64, 65, 299, 1000] {
            let mut set = ObjectSet::default();
            let chosen: Vec<ObjectId> = ids.iter().copied().skip(step % 5).step_by(step).collect();
            assert!(chosen.iter().rev().all(|&id| set.insert(id)));
            compaction.list(&scene, &set, &mut list);
            assert_eq!(list, chosen);
            assert!(set.slots().eq(chosen.iter().map(|id| id.slot())));
        }
        compaction.list(&scene, &ObjectSet::default(), &mut list);
        assert!(list.is_empty());
    }
}
