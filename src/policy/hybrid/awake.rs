//! Who is awake: the objects in the frustum that have moved a short while ago.
//!
//! The tree knows it of nodes ([`Tree::is_settled`](crate::tree::Tree::is_settled)). In a node that is
//! not settled, a trace of each object's box is compared with that of the frame before; nothing is looked
//! at in nodes that are. What was never seen, or not since its node was last settled, may be awake for
//! longer than it need be: that costs a test, and changes no answer.

use super::super::Context;
use super::super::plan::each_own;
use crate::geom::Aabb;
use crate::scene::{ObjectId, ObjectSet};
use crate::tree::NodeId;

/// The objects that are awake in a view.
#[derive(Clone, Debug, Default)]
pub(super) struct Awake {
    /// By slot.
    traces: Vec<Trace>,
    objects: Vec<ObjectId>,
    set: ObjectSet,
    stack: Vec<NodeId>,
}

/// What is remembered of an object.
#[derive(Clone, Copy, Debug, Default)]
struct Trace {
    /// Of its box and generation.
    hash: u32,
    /// The tree's update in which another one was seen.
    changed_at: u32,
}

impl Awake {
    /// Finds them anew. O(objects of the nodes in the frustum that are not settled).
    pub(super) fn look(&mut self, cx: &Context<'_>) {
        let Self { traces, objects, set, stack } = self;
        objects.clear();
        set.clear();
        traces.resize(cx.scene.slot_bound(), Trace::default());
        let (tick, store) = (cx.tree.tick(), cx.scene.objects_store());
        stack.push(cx.tree.root());
        while let Some(node) = stack.pop() {
            if !may_hold_awake(cx, node) {
                continue;
            }
            each_own(cx, node, |slot| {
                let Some(bounds) = cx.tree.aabb_of(slot) else { return };
                let (id, trace) = (store.id(slot), &mut traces[slot as usize]);
                let hash = hash(&bounds, id.generation());
                if trace.hash != hash {
                    *trace = Trace { hash, changed_at: tick };
                }
                if tick.wrapping_sub(trace.changed_at) < cx.tree.config().settle_frames {
                    objects.push(id);
                    set.insert(id);
                }
            });
            stack.extend(cx.tree.children(node).into_iter().flatten());
        }
        objects.sort_unstable();
    }

    /// By slot.
    pub(super) fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    pub(super) fn contains(&self, id: ObjectId) -> bool {
        self.set.contains(id)
    }

    /// Whether an object in the frustum, at or below a node, is settled.
    pub(super) fn any_settled(&self, cx: &Context<'_>, node: NodeId) -> bool {
        if cx.tree.count(node) == 0 || !cx.frustum.intersects(&cx.tree.bounds(node)) {
            return false;
        }
        let mut any = cx.tree.is_settled(node);
        if !any {
            each_own(cx, node, |slot| any |= !self.contains(cx.scene.objects_store().id(slot)));
        }
        any || cx.tree.children(node).into_iter().flatten().any(|child| self.any_settled(cx, child))
    }
}

fn may_hold_awake(cx: &Context<'_>, node: NodeId) -> bool {
    cx.tree.count(node) > 0 && !cx.tree.is_settled(node) && cx.frustum.intersects(&cx.tree.bounds(node))
}

/// Of a box and whose it is; never 0, which stands for nothing seen yet.
fn hash(bounds: &Aabb, generation: u32) -> u32 {
    let words = bounds.min.to_array().into_iter().chain(bounds.max.to_array()).map(f32::to_bits);
    // FNV-1a, a word a step; the high bits are folded in at the end.
    let hash = words
        .fold(0x811c_9dc5 ^ generation, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193).rotate_left(5));
    (hash ^ hash >> 15).max(1)
}
