//! Tight bounding volumes: a question about a node asks about the boxes of its descendants instead,
//! down to depth `d_max`, while the sum of their surface areas stays within `s_max` times the area of
//! the node's own box. Fewer samples of empty space are found visible.
//!
//! A leaf has no nodes below it, but objects, each with its box: they are one level deeper. So the
//! tree need not be built deeper for it, and an inner node of few objects may be a *virtual leaf*.
//!
//! Conservative: each step replaces a box by boxes that together hold every object that it held.

use crate::geom::Aabb;
use crate::tree::{NodeId, Tree};

/// How far boxes are replaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    /// Levels below the node.
    pub(super) d_max: u32,
    /// The sum of the surface areas, to the area of the node's box.
    pub(super) s_max: f32,
}

/// Boxes of one question at most: coincident objects would have any number of them.
const MOST_BOXES: usize = 32;

/// The boxes of one node, made anew for each; the memory stays.
#[derive(Clone, Debug, Default)]
pub(super) struct TightVolume {
    parts: Vec<Part>,
    /// Reused: the parts one level deeper.
    deeper: Vec<Part>,
}

/// A box, and what it is made of.
#[derive(Clone, Copy, Debug)]
struct Part {
    aabb: Aabb,
    /// None for an object, and for what cannot be replaced any more.
    node: Option<NodeId>,
}

impl TightVolume {
    /// Boxes that together hold every object in and below a node. O(3^d_max) at most.
    pub(super) fn of(&mut self, tree: &Tree, node: NodeId, limits: Limits) -> impl Iterator<Item = Aabb> {
        let whole = tree.query_box(node);
        let most = limits.s_max * whole.surface_area();
        let mut sum = whole.surface_area();
        self.parts.clear();
        self.parts.push(Part { aabb: whole, node: Some(node) });
        // A point and a line have no area that could be saved.
        let depth = if sum > 0.0 { limits.d_max } else { 0 };
        for _ in 0..depth {
            let mut left = self.parts.len();
            for part in self.parts.drain(..) {
                left -= 1;
                let first = self.deeper.len();
                let room = MOST_BOXES.saturating_sub(first + left);
                let area = part.node.map_or(f32::NAN, |node| replace(tree, node, room, &mut self.deeper));
                let replaced = sum - part.aabb.surface_area() + area;
                // False for NaN and for infinite areas.
                if replaced <= most {
                    sum = replaced;
                } else {
                    self.deeper.truncate(first);
                    self.deeper.push(Part { node: None, ..part });
                }
            }
            std::mem::swap(&mut self.parts, &mut self.deeper);
        }
        self.parts.iter().map(|part| part.aabb)
    }
}

/// Adds the boxes one level below a node and returns the sum of their areas; NaN if they are more
/// than there is room for.
fn replace(tree: &Tree, node: NodeId, room: usize, parts: &mut Vec<Part>) -> f32 {
    let children = || tree.children(node).into_iter().flatten().filter(|&child| tree.count(child) > 0);
    if tree.own_count(node) + children().count() > room {
        return f32::NAN;
    }
    let first = parts.len();
    parts.extend(tree.own_objects(node).map(|(_, aabb)| Part { aabb, node: None }));
    parts.extend(children().map(|child| Part { aabb: tree.query_box(child), node: Some(child) }));
    parts[first..].iter().map(|part| part.aabb.surface_area()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Straddlers, TreeConfig};
    use glam::Vec3;

    const LIMITS: Limits = Limits { d_max: 3, s_max: 1.4 };

    fn tree(boxes: &[Aabb], config: TreeConfig) -> Tree {
        let mut tree = Tree::new(config);
        boxes.iter().zip(0..).for_each(|(aabb, slot)| tree.insert(slot, aabb));
        tree.update();
        tree
    }

    fn leaf(boxes: &[Aabb]) -> Tree {
        tree(boxes, TreeConfig { unasked_leaf: 1000, ..TreeConfig::stable() })
    }

    fn of(tree: &Tree, node: NodeId, limits: Limits) -> Vec<Aabb> {
        TightVolume::default().of(tree, node, limits).collect()
    }

    fn cube(x: f32, half: f32) -> Aabb {
        Aabb::from_center(Vec3::new(x, 0.0, 0.0), Vec3::splat(half))
    }

    #[test]
    fn a_leaf_is_asked_about_by_its_objects() {
        // Two cubes of area 24 in a box of area 88.
        let boxes = [cube(0.0, 1.0), cube(8.0, 1.0)];
        let tree = leaf(&boxes);
        assert_eq!(of(&tree, tree.root(), LIMITS), boxes);
        assert_eq!(of(&tree, tree.root(), Limits { d_max: 0, ..LIMITS }), [tree.bounds(tree.root())]);
    }

    #[test]
    fn boxes_that_are_no_smaller_are_not_worth_it() {
        // Four cubes on one another's heels: 4 · 24 in a box of 2 · (4 + 2 · 2 · 2.6) = 28.8.
        let boxes: Vec<Aabb> = (0..4).map(|i| cube(0.2 * i as f32, 1.0)).collect();
        let tree = leaf(&boxes);
        assert_eq!(of(&tree, tree.root(), LIMITS), [tree.bounds(tree.root())]);
        assert_eq!(of(&tree, tree.root(), Limits { s_max: 10.0, ..LIMITS }).len(), 4);
    }

    #[test]
    fn depth_is_limited() {
        let boxes: Vec<Aabb> = (0..16).map(|i| cube(10.0 * i as f32, 1.0)).collect();
        let tree = tree(&boxes, TreeConfig { unasked_leaf: 1, bulk_leaf: 1, ..TreeConfig::stable() });
        let count = |d_max| of(&tree, tree.root(), Limits { d_max, s_max: 1.4 }).len();
        assert_eq!([count(0), count(1), count(2), count(3)], [1, 2, 4, 8]);
    }

    #[test]
    fn every_object_is_held_whatever_the_tree() {
        let mut dice = crate::worlds::random(5, 150).objects;
        dice.truncate(150);
        let boxes: Vec<Aabb> = dice.iter().map(|placed| placed.bounds).collect();
        for straddlers in [Straddlers::Leaf, Straddlers::Split, Straddlers::StayInParent] {
            let config = TreeConfig { straddlers, unasked_leaf: 4, bulk_leaf: 4, ..TreeConfig::stable() };
            let tree = tree(&boxes, config);
            for node in tree.nodes().filter(|node| node.below > 0) {
                for s_max in [0.5, 1.4, 1e9] {
                    let volume = of(&tree, node.id, Limits { d_max: 3, s_max });
                    assert!((1..=MOST_BOXES).contains(&volume.len()));
                    let mut below = vec![node.id];
                    while let Some(id) = below.pop() {
                        below.extend(tree.children(id).into_iter().flatten());
                        for (_, aabb) in tree.own_objects(id) {
                            assert!(volume.iter().any(|part| part.contains(&aabb)));
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn coincident_points_and_endless_boxes_keep_their_one_box() {
        let points = vec![cube(1.0, 0.0); 40];
        let endless = [cube(0.0, 1e30), cube(1e30, 1e30)];
        for boxes in [&points[..], &endless] {
            let tree = leaf(boxes);
            assert_eq!(of(&tree, tree.root(), LIMITS).len(), 1);
        }
    }
}
