//! A probe: how much of what is in view is hidden, found by asking about a few objects of it.
//!
//! Objects are picked with equal chances from all that are in view, and asked about by their own
//! boxes when the frame is complete. So the share of hidden answers is an estimate of the share of
//! objects that asking could cull at best, whatever the shape of the tree. It costs
//! [`QUESTIONS`] questions and the nodes that the frustum's planes cross.

use crate::geom::{PlaneMask, Proxy, Question};
use crate::policy::Context;
use crate::tree::{NodeId, Tree};

/// Objects that a probe picks: the share is certain to a tenth or so.
const QUESTIONS: u32 = 32;

/// What is in view, and the questions about some of it. The memory is kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    stack: Vec<(NodeId, PlaneMask)>,
    /// Nodes whose objects are in view, with the sum of all weights up to and with theirs.
    parts: Vec<(NodeId, Weight, f64)>,
    pub(super) proxies: Vec<Proxy>,
    /// Answers that found something hidden, and objects that own a sample, or might.
    hidden: u32,
    all: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Weight {
    /// Everything below the node is in view.
    Whole,
    /// A plane crosses the box around the node's own objects: half of them are taken to be in view.
    Half,
}

impl Probe {
    /// Objects in view, about. O(nodes that a plane crosses).
    pub(super) fn count(&mut self, cx: &Context<'_>) -> f32 {
        self.parts.clear();
        self.stack.clear();
        self.stack.push((cx.tree.root(), PlaneMask::ALL));
        let mut sum = 0.0;
        while let Some((node, mask)) = self.stack.pop() {
            if cx.tree.count(node) == 0 {
                continue;
            }
            let Some(mask) = cx.frustum.classify(&cx.tree.bounds(node), mask) else { continue };
            let (objects, weight) = match mask.is_empty() {
                true => (cx.tree.count(node) as f64, Weight::Whole),
                false => (0.5 * cx.tree.own_count(node) as f64, Weight::Half),
            };
            if objects > 0.0 {
                sum += objects;
                self.parts.push((node, weight, sum));
            }
            if weight == Weight::Half {
                let children = cx.tree.children(node).into_iter().flatten();
                self.stack.extend(children.map(|child| (child, mask)));
            }
        }
        sum as f32
    }

    /// Picks objects in view and makes their questions; returns how many objects are in view.
    pub(super) fn pick(&mut self, cx: &Context<'_>) -> f32 {
        let in_view = self.count(cx);
        self.proxies.clear();
        (self.hidden, self.all) = (0, 0);
        for question in 0..QUESTIONS {
            // One out of each of as many equal shares, which spreads them.
            let at = (f64::from(question) + dice(cx.frame, question)) / f64::from(QUESTIONS);
            let at = at * f64::from(in_view);
            let part = self.parts.partition_point(|&(.., sum)| sum <= at);
            let Some(&(node, weight, sum)) = self.parts.get(part) else { continue };
            let left = ((sum - at) * if weight == Weight::Half { 2.0 } else { 1.0 }) as usize;
            let Some(aabb) = object(cx.tree, node, left) else { continue };
            match cx.question_about(node, &aabb) {
                Question::Outside => {}
                Question::Visible => self.all += 1,
                Question::Ask(proxy) => {
                    self.all += 1;
                    self.proxies.push(proxy);
                }
            }
        }
        in_view
    }

    /// One of the questions found nothing visible.
    pub(super) fn found_hidden(&mut self) {
        self.hidden += 1;
    }

    /// The share of objects that are hidden, 0 to 1.
    pub(super) fn share(&self) -> f32 {
        self.hidden as f32 / self.all.max(1) as f32
    }
}

/// The box of the object of this number, of those in and below a node. O(depth + objects of a leaf).
fn object(tree: &Tree, mut node: NodeId, mut number: usize) -> Option<crate::geom::Aabb> {
    loop {
        if number < tree.own_count(node) {
            return tree.own_objects(node).nth(number).map(|(_, bounds)| bounds);
        }
        number -= tree.own_count(node);
        let mut children = tree.children(node)?.into_iter();
        node = children.find(|&child| {
            let is_below = number < tree.count(child);
            number -= if is_below { 0 } else { tree.count(child) };
            is_below
        })?;
    }
}

/// As good as random, 0 to 1, and the same in every run (SplitMix64).
fn dice(frame: u32, question: u32) -> f64 {
    let mut x = (u64::from(frame) << 32 | u64::from(question)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ x >> 31) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geom::Aabb;
    use crate::tree::TreeConfig;

    #[test]
    fn every_object_below_a_node_has_a_number() {
        let mut tree = Tree::new(TreeConfig { unasked_leaf: 4, bulk_leaf: 4, ..TreeConfig::stable() });
        let boxes: Vec<Aabb> = (0..200)
            .map(|i| Aabb::from_center(Vec3::new(i as f32, (i % 7) as f32, 0.0), Vec3::ONE))
            .collect();
        boxes.iter().zip(0..).for_each(|(aabb, slot)| tree.insert(slot, aabb));
        tree.update();
        let mut found: Vec<f32> =
            (0..200).map(|i| object(&tree, tree.root(), i).expect("there are 200").center().x).collect();
        found.sort_by(f32::total_cmp);
        assert!(found.iter().enumerate().all(|(i, &x)| x == i as f32), "{found:?}");
        assert!(object(&tree, tree.root(), 200).is_none());
    }

    #[test]
    fn dice_are_fair() {
        let mean = (0..1000).map(|i| dice(i / 32, i % 32)).sum::<f64>() / 1000.0;
        assert!((0.45..0.55).contains(&mean), "{mean}");
        assert!((0..1000).all(|i| (0.0..1.0).contains(&dice(7, i))));
    }
}
