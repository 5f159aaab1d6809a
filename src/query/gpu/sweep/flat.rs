//! The tree as rays walk it on the device: without a stack.
//!
//! Nodes keep the tree's own indices, so what changes in one place is uploaded for one place. Their
//! order is in their links: where a ray goes on that meets a node (into it), and where one that does
//! not (past it). A walk that follows them visits a subtree depth first, and has left it when it comes
//! to where the subtree's root says to go past it. Nodes without objects are not linked to.
//!
//! Objects lie in *places*, in the order of that walk: those of a node, and all of those at and below
//! it, are a range each.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferBinding, Device, Queue};

use super::boxes::PackedBox;
use super::mirror::Mirrored;
use crate::Error;
use crate::scene::Scene;
use crate::tree::{NodeId, Tree};

/// The twin of `Link` in `shaders/sweep/enclose.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(in crate::query::gpu) struct PackedLink {
    /// The node to go on with, for a ray that meets this one, and for one that does not.
    enter: u32,
    skip: u32,
    /// Places of its own objects.
    first: u32,
    end: u32,
    parent: u32,
}

/// No node: the twin of the constant in `shaders/shared/nodes.wgsl`.
const NONE: u32 = u32::MAX;

impl PackedLink {
    /// That of an index which is no node's, or that of a node without objects.
    const NOTHING: Self = Self { enter: NONE, skip: NONE, first: 0, end: 0, parent: NONE };
}

/// A tree on the device.
#[derive(Debug)]
pub(in crate::query::gpu) struct FlatTree {
    boxes: Mirrored<PackedBox>,
    links: Mirrored<PackedLink>,
    places: Mirrored<u32>,
    /// Reused by uploads.
    scratch: (Vec<PackedBox>, Vec<PackedLink>, Vec<u32>),
    stack: Vec<(NodeId, u32)>,
}

impl FlatTree {
    pub(in crate::query::gpu) fn new(device: &Device) -> Self {
        Self {
            boxes: Mirrored::new(device, "tercet node boxes"),
            links: Mirrored::new(device, "tercet node links"),
            places: Mirrored::new(device, "tercet places"),
            scratch: Default::default(),
            stack: Vec::new(),
        }
    }

    /// Takes a scene's tree over; returns the bytes uploaded. `others` are slots of objects beside
    /// those of the tree: they get the last places. O(nodes + objects).
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(in crate::query::gpu) fn follow(
        &mut self,
        device: &Device,
        queue: &Queue,
        scene: &Scene,
        others: &[u32],
    ) -> Result<u64, Error> {
        let (boxes, links, places) = &mut self.scratch;
        flatten(scene.tree(), &mut self.stack, boxes, links, places);
        places.extend_from_slice(others);
        let uploaded = self.boxes.follow(device, queue, boxes)?
            + self.links.follow(device, queue, links)?
            + self.places.follow(device, queue, places)?;
        Ok(uploaded)
    }

    /// The nodes' boxes and links, by index.
    pub(in crate::query::gpu) fn nodes(&self) -> [BufferBinding<'_>; 2] {
        [self.boxes.binding(), self.links.binding()]
    }

    /// How many indices of nodes there are.
    pub(in crate::query::gpu) fn node_count(&self) -> u32 {
        self.links.len() as u32
    }

    /// Slots by place, on the device.
    pub(in crate::query::gpu) fn places(&self) -> BufferBinding<'_> {
        self.places.binding()
    }

    /// The same here.
    pub(in crate::query::gpu) fn slots(&self) -> &[u32] {
        self.places.known()
    }

    /// The places of all objects at and below a node.
    pub(super) fn below(&self, tree: &Tree, node: NodeId) -> Range<usize> {
        let first = self.links.known()[node.index()].first as usize;
        first..first + tree.count(node)
    }
}

/// Lists nodes by index, and objects in the order of a walk.
fn flatten(
    tree: &Tree,
    stack: &mut Vec<(NodeId, u32)>,
    boxes: &mut Vec<PackedBox>,
    links: &mut Vec<PackedLink>,
    places: &mut Vec<u32>,
) {
    boxes.clear();
    boxes.resize(tree.index_bound(), PackedBox::NONE);
    links.clear();
    links.resize(tree.index_bound(), PackedLink::NOTHING);
    places.clear();
    stack.clear();
    stack.push((tree.root(), NONE));
    while let Some((node, skip)) = stack.pop() {
        if tree.count(node) == 0 {
            continue; // the root of nothing
        }
        let first = places.len() as u32;
        places.extend(tree.own_objects(node).map(|(slot, _)| slot));
        let mut enter = skip;
        for child in tree.children(node).into_iter().flatten().rev().filter(|&child| tree.count(child) > 0) {
            stack.push((child, enter));
            enter = child.index;
        }
        boxes[node.index()] = PackedBox::new(&tree.bounds(node), NONE, 0);
        links[node.index()] = PackedLink {
            enter,
            skip,
            first,
            end: places.len() as u32,
            parent: tree.parent(node).map_or(NONE, |parent| parent.index),
        };
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use glam::Vec3;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::super::pack::tests::assert_same_layout;
    use super::*;
    use crate::geom::Aabb;
    use crate::query::gpu::Shaders;
    use crate::tree::{Straddlers, TreeConfig};

    #[test]
    fn structs_lie_in_memory_as_the_shader_thinks() {
        let module = wgpu::naga::front::wgsl::parse_str(&Shaders::default().enclose).expect("it parses");
        assert_same_layout!(&module, "Link", PackedLink, [enter, skip, first, end, parent]);
        PackedBox::assert_layout(&module);
    }

    /// All nodes that a walk visits which meets every node, but for one that it goes past.
    fn walk(links: &[PackedLink], root: u32, past: u32) -> Vec<u32> {
        let (mut at, mut visited) = (root, Vec::new());
        while at != links[root as usize].skip {
            visited.push(at);
            let link = links[at as usize];
            at = if at == past { link.skip } else { link.enter };
        }
        visited
    }

    #[test]
    fn a_walk_visits_a_subtree_depth_first_and_its_objects_are_a_range() {
        let mut dice = ChaCha8Rng::seed_from_u64(3);
        for (count, straddlers) in
            [0, 1, 5, 300].into_iter().flat_map(|n| [(n, Straddlers::Leaf), (n, Straddlers::StayInParent)])
        {
            let config = TreeConfig { bulk_leaf: 4, unasked_leaf: 4, straddlers, ..TreeConfig::stable() };
            let mut tree = Tree::new(config);
            for slot in 0..count {
                let mut v = |r: f32| Vec3::from_array(std::array::from_fn(|_| dice.random_range(-r..r)));
                let (center, half) = (v(50.0), v(4.0).abs());
                tree.insert(slot, &Aabb::from_center(center, half));
            }
            tree.update();
            let (mut stack, mut boxes, mut links, mut places) = Default::default();
            flatten(&tree, &mut stack, &mut boxes, &mut links, &mut places);
            let mut all = places.clone();
            all.sort_unstable();
            assert_eq!(all, (0..count).collect::<Vec<_>>(), "each object has one place");
            for node in tree.nodes().filter(|node| node.below > 0) {
                let index = node.id.index;
                let mut stack = vec![node.id];
                let mut expected = Vec::new();
                while let Some(node) = stack.pop() {
                    if tree.count(node) > 0 {
                        expected.push(node.index);
                        stack.extend(tree.children(node).into_iter().flatten().rev());
                    }
                }
                assert_eq!(walk(&links, index, NONE), expected);
                let link = links[index as usize];
                let own: Vec<u32> = tree.own_objects(node.id).map(|(slot, _)| slot).collect();
                assert_eq!(places[link.first as usize..link.end as usize], own);
                let last = links[expected[expected.len() - 1] as usize].end;
                assert_eq!((last - link.first) as usize, node.below, "all below follow");
                // One that is gone past takes its subtree along.
                let past = expected[expected.len() / 2];
                let without = walk(&links, index, past).len();
                let gone = if past == index { expected.len() } else { walk(&links, past, NONE).len() };
                assert_eq!(without, expected.len() - gone + 1);
            }
        }
    }
}
