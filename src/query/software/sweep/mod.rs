//! Sweeps on the CPU: each stage is the twin of the device's, under the paper's name.
//!
//! | file | stage |
//! |---|---|
//! | `group_raster` | the samples of a group's proxy that are in sight (HROC) |
//! | `cast_rays` | those, sixteen side by side, down the group's subtree (HROC) |
//! | `groups` | one group after the other; groups of which too much is in sight are opened |
//! | `hi_z_build`, `hi_z_test` | the pyramid of farthest depths, and a rectangle against it (Rákos) |
//! | `owners` | who owns a sample: an item buffer of the frame as drawn |
//! | `field` | what the threads share |
//!
//! Group extraction is the policy's (`policy/hroc/`), ordered compaction that of whoever wants a list
//! (`query/compact.rs`).
//!
//! Threads take groups, or objects, as they come; what they find are bits that are set, so the answer
//! is the same for any number of them.

mod cast_rays;
mod field;
mod group_raster;
mod groups;
mod hi_z_build;
mod hi_z_test;
mod owners;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

pub(super) use cast_rays::{meets, those_that_meet};
pub(super) use group_raster::{Packet, Rays, group_raster};
pub use hi_z_build::{Pyramid, PyramidLevel};
pub(super) use owners::Owned;

use super::count::{Scene, is_usable};
use super::{SoftwareQueries, SoftwareStats, simd};
use crate::geom::{Aabb, PlaneMask};
use crate::query::{Sweep, SweepTest, Ticket};
use crate::scene::ObjectSet;
use crate::tree::NodeId;
use field::{Field, Tally};

/// A group of more objects is tested and opened before threads share what is left.
const GROUP_OF_A_THREAD: usize = 256;

/// The sweeps of a frame that have no answer yet, and room to work.
#[derive(Debug, Default)]
pub(super) struct Sweeps {
    /// None for an answer that nobody knows; else which set.
    asked: Vec<(Ticket, Option<usize>)>,
    sets: Vec<ObjectSet>,
    used: usize,
    loose: ObjectSet,
    flags: Vec<AtomicU64>,
    todo: Todo,
    pyramid: Pyramid,
}

/// What threads share out.
#[derive(Debug, Default)]
struct Todo {
    objects: Vec<(u32, Aabb)>,
    groups: Vec<(NodeId, PlaneMask)>,
    stack: Vec<(NodeId, PlaneMask)>,
}

impl Sweeps {
    pub(super) fn forget(&mut self) {
        self.asked.clear();
        self.used = 0;
    }

    /// An empty set, to be filled for an answer.
    pub(super) fn new_set(&mut self) -> ObjectSet {
        if self.used == self.sets.len() {
            self.sets.push(ObjectSet::default());
        }
        let mut set = std::mem::take(&mut self.sets[self.used]);
        set.clear();
        set
    }

    pub(super) fn answer(&mut self, ticket: Ticket, found: ObjectSet) {
        self.asked.push((ticket, Some(self.used)));
        self.sets[self.used] = found;
        self.used += 1;
    }

    /// The answers, as far as there are any.
    pub(super) fn answers(&self) -> impl Iterator<Item = (Ticket, Option<&ObjectSet>)> {
        self.asked.iter().map(|&(ticket, set)| (ticket, set.map(|set| &self.sets[set])))
    }
}

impl SoftwareQueries {
    /// The pyramid of the last [`SweepTest::HiZ`], to look at.
    pub fn pyramid(&self) -> &Pyramid {
        &self.sweeps.pyramid
    }

    /// The pyramid of what has been drawn so far, built anew to look at.
    pub fn inspect_pyramid(&mut self) -> &Pyramid {
        self.depth.settle();
        self.sweeps.pyramid.build(&self.depth);
        &self.sweeps.pyramid
    }

    /// Answers a sweep at once, against the depth as it is now.
    pub(super) fn sweep_now(&mut self, ticket: Ticket, sweep: &Sweep<'_>) {
        if self.view.is_none() || (sweep.test == SweepTest::Owners && self.owned.owners.is_empty()) {
            self.sweeps.asked.push((ticket, None));
            return;
        }
        self.depth.settle();
        self.hi_z.refresh(self.simd, &self.depth);
        let mut sweeps = std::mem::take(&mut self.sweeps);
        let mut found = sweeps.new_set();
        sweeps.loose.clear();
        for &id in sweep.loose {
            sweeps.loose.insert(id);
        }
        if sweep.test == SweepTest::Owners {
            self.owners(sweep.view, &sweeps.loose, &mut found);
        } else {
            sweeps.test(self, sweep, &mut found);
        }
        sweeps.answer(ticket, found);
        self.sweeps = sweeps;
    }
}

impl Sweeps {
    fn test(&mut self, queries: &mut SoftwareQueries, sweep: &Sweep<'_>, found: &mut ObjectSet) {
        let words = sweep.scene.slot_bound().div_ceil(64);
        self.flags.clear();
        self.flags.resize_with(words, AtomicU64::default);
        let scene = Scene { depth: &queries.depth, hi_z: &queries.hi_z };
        let (simd, tree) = (queries.simd, sweep.scene.tree());
        let field = Field { sweep, tree, simd, scene, loose: &self.loose, flags: &self.flags };
        let mut tally = Tally::default();
        if sweep.test == SweepTest::HiZ {
            self.pyramid.build(scene.depth);
        }
        self.todo.fill(&field, &self.pyramid, &mut tally);
        let Todo { objects, groups, .. } = &self.todo;
        let image = scene.depth.image();
        objects.par_iter().with_min_len(64).for_each(|(slot, bounds)| match sweep.test {
            SweepTest::HiZ if !field.passes(bounds, |proxy| self.pyramid.passes(image, proxy)) => {}
            SweepTest::HiZ => field.flag(*slot),
            _ => field.raster(*slot, bounds),
        });
        tally.tested += objects.len() as u64;
        let one = |&(node, mask): &(NodeId, PlaneMask)| {
            let mut tally = Tally::default();
            field.sweep_group(node, mask, &mut tally);
            tally
        };
        let groups = groups.par_iter().with_min_len(4).map(one).reduce(Tally::default, Tally::add_up);
        let tally = tally.add_up(groups);
        found.assign(self.flags.iter().map(|word| word.load(Ordering::Relaxed)));
        let stats = &mut queries.stats;
        *stats = SoftwareStats {
            sweeps: stats.sweeps + 1,
            sweep_nodes: stats.sweep_nodes + tally.nodes,
            rays: stats.rays + tally.rays,
            swept: stats.swept + tally.tested,
            flagged: stats.flagged + found.len() as u64,
            ..*stats
        };
    }
}

impl Todo {
    /// Lists what is to be tested: objects one by one, and groups where rays are cast.
    fn fill(&mut self, field: &Field<'_>, pyramid: &Pyramid, tally: &mut Tally) {
        let Self { objects, groups, stack } = self;
        objects.clear();
        groups.clear();
        let store = field.sweep.scene.objects_store();
        for &id in field.sweep.loose {
            let bounds = store.slot(id).and_then(|slot| field.tree.aabb_of(slot));
            if let Some(bounds) = bounds.filter(|bounds| field.sweep.frustum.intersects(bounds)) {
                objects.push((id.slot() as u32, bounds));
            }
        }
        let image = field.scene.depth.image();
        stack.extend(field.sweep.groups.iter().filter_map(|&node| field.enter(node, PlaneMask::ALL)));
        while let Some((node, mask)) = stack.pop() {
            let open = match field.sweep.test {
                SweepTest::Raster | SweepTest::Owners => true,
                SweepTest::Rays if field.tree.count(node) <= GROUP_OF_A_THREAD => {
                    groups.push((node, mask));
                    false
                }
                SweepTest::Rays => {
                    tally.nodes += 1;
                    field.group_passes(node, |proxy| simd::any(field.simd, field.scene, proxy))
                }
                SweepTest::HiZ => {
                    tally.nodes += 1;
                    field.group_passes(node, |proxy| pyramid.passes(image, proxy))
                }
            };
            if open {
                field.each_own(node, mask, |slot, bounds| objects.push((slot, *bounds)));
                stack.extend(field.children(node, mask));
            }
        }
    }
}
