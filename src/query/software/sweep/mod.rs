//! Sweeps on the CPU.

use super::{SoftwareQueries, count, simd};
use crate::geom::Question;
use crate::query::{Sweep, SweepTest, Ticket};
use crate::scene::{ObjectId, ObjectSet};
use crate::tree::NodeId;

/// The sweeps of a frame that have no answer yet.
#[derive(Debug, Default)]
pub(super) struct Sweeps {
    /// None for an answer that nobody knows.
    pub(super) asked: Vec<(Ticket, Option<ObjectSet>)>,
}

impl SoftwareQueries {
    /// Answers a sweep at once, against the depth as it is now.
    pub(super) fn sweep_now(&mut self, ticket: Ticket, sweep: &Sweep<'_>) {
        if self.view.is_none() || sweep.test == SweepTest::Owners {
            self.sweeps.asked.push((ticket, None));
            return;
        }
        self.depth.settle();
        self.hi_z.refresh(self.simd, &self.depth);
        let scene = count::Scene { depth: &self.depth, hi_z: &self.hi_z };
        let mut found = ObjectSet::default();
        for id in objects(sweep) {
            let bounds = sweep.scene.object(id).and_then(|object| object.bounds);
            let Some(bounds) = bounds.filter(|bounds| sweep.frustum.intersects(bounds)) else { continue };
            let visible = match Question::new(&bounds, sweep.view) {
                Question::Outside => false,
                Question::Visible => true,
                Question::Ask(proxy) => !count::is_usable(&proxy) || simd::any(self.simd, scene, &proxy),
            };
            if visible {
                found.insert(id);
            }
        }
        self.sweeps.asked.push((ticket, Some(found)));
    }
}

/// All that a sweep is about.
fn objects(sweep: &Sweep<'_>) -> Vec<ObjectId> {
    let (tree, mut all) = (sweep.scene.tree(), sweep.loose.to_vec());
    let mut stack: Vec<NodeId> = sweep.groups.to_vec();
    while let Some(node) = stack.pop() {
        let slots = tree.own(node).iter().flat_map(|block| block.slots).filter(|&slot| slot != u32::MAX);
        all.extend(slots.map(|slot| sweep.scene.objects_store().id(slot)));
        stack.extend(tree.children(node).into_iter().flatten());
    }
    all
}
