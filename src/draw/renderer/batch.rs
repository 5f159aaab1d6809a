//! The objects of one call, put together by what is drawn for them.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Affine3A;

/// An object as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Instance {
    /// The rows of `world_from_object`.
    pub(super) rows: [[f32; 4]; 3],
    /// Linear red, green and blue, in 16 bits so that every sRGB byte keeps a number of its own.
    pub(super) color: [u16; 4],
}

impl Instance {
    pub(super) fn new(world_from_object: &Affine3A, color: [u16; 3]) -> Self {
        let Affine3A { matrix3, translation } = world_from_object;
        let row = |i: usize| matrix3.row(i).extend(translation[i]).to_array();
        let [r, g, b] = color;
        Self { rows: [row(0), row(1), row(2)], color: [r, g, b, u16::MAX] }
    }
}

/// A counting sort of instances by group, that is, by mesh and level. Its memory is kept from call
/// to call.
#[derive(Debug, Default)]
pub(super) struct Batch {
    staged: Vec<(u32, Instance, u32)>,
    /// By group: how many are staged, and while sorting, where the next one goes.
    counts: Vec<u32>,
    /// The groups with staged instances, in the order in which they came.
    groups: Vec<u32>,
    sorted: Vec<Instance>,
    ids: Vec<u32>,
    runs: Vec<Run>,
}

/// What a call draws, in the order of the draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sorted<'a> {
    /// Each group's instances together and in their order, and the groups in the order of their first
    /// instance.
    pub(super) instances: &'a [Instance],
    /// Whose they are.
    pub(super) ids: &'a [u32],
    pub(super) runs: &'a [Run],
}

/// Instances of one group.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) group: u32,
    /// Indices into the sorted instances.
    pub(super) instances: Range<u32>,
}

impl Batch {
    pub(super) fn len(&self) -> usize {
        self.staged.len()
    }

    pub(super) fn push(&mut self, group: u32, instance: Instance, id: u32) {
        let index = group as usize;
        if self.counts.len() <= index {
            self.counts.resize(index + 1, 0);
        }
        if self.counts[index] == 0 {
            self.groups.push(group);
        }
        self.counts[index] += 1;
        self.staged.push((group, instance, id));
    }

    /// All that was pushed, sorted. Starts anew. O(instances).
    pub(super) fn sort(&mut self) -> Sorted<'_> {
        self.runs.clear();
        let mut first = 0;
        for group in self.groups.drain(..) {
            let next = &mut self.counts[group as usize];
            self.runs.push(Run { group, instances: first..first + *next });
            first += std::mem::replace(next, first);
        }
        self.sorted.resize(self.staged.len(), Instance::zeroed());
        self.ids.resize(self.staged.len(), 0);
        for (group, instance, id) in self.staged.drain(..) {
            let next = &mut self.counts[group as usize];
            (self.sorted[*next as usize], self.ids[*next as usize]) = (instance, id);
            *next += 1;
        }
        self.runs.iter().for_each(|run| self.counts[run.group as usize] = 0);
        Sorted { instances: &self.sorted, ids: &self.ids, runs: &self.runs }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn at(x: f32) -> Instance {
        Instance::new(&Affine3A::from_translation(Vec3::X * x), [1, 2, 3])
    }

    #[test]
    fn instances_are_grouped_in_the_order_in_which_they_came() {
        let mut batch = Batch::default();
        for _ in 0..2 {
            for (group, x) in [(7, 0u8), (2, 1), (7, 2), (0, 3), (2, 4), (7, 5)] {
                batch.push(group, at(x.into()), u32::from(x) + 10);
            }
            assert_eq!(batch.len(), 6);
            let Sorted { instances, ids, runs } = batch.sort();
            assert_eq!(ids, [10, 12, 15, 11, 14, 13]);
            assert_eq!(instances, [0.0, 2.0, 5.0, 1.0, 4.0, 3.0].map(at));
            let runs: Vec<_> = runs.iter().map(|run| (run.group, run.instances.clone())).collect();
            assert_eq!(runs, [(7, 0..3), (2, 3..5), (0, 5..6)]);
        }
        assert_eq!(batch.sort(), Sorted { instances: &[], ids: &[], runs: &[] });
    }

    #[test]
    fn rows_are_those_of_the_transform() {
        let place =
            Affine3A::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
        let instance = Instance::new(&place, [0; 3]);
        let rows = [[1.0, 4.0, 7.0, 10.0], [2.0, 5.0, 8.0, 11.0], [3.0, 6.0, 9.0, 12.0]];
        assert_eq!(instance.rows, rows);
    }
}
