//! Reading the tree: what policies, pictures and the driver walk.

use glam::{Vec3, Vec4};

use super::Tree;
use super::block::{Block, lanes};
use super::blocks::NONE;
use super::node::{NodeId, Role};
use crate::geom::{Aabb, Frustum, PlaneMask};

/// A node as pictures and statistics see it.
#[derive(Clone, Copy, Debug)]
pub struct NodeInfo {
    /// Its handle.
    pub id: NodeId,
    /// What it is to its parent.
    pub role: Role,
    /// 0 for the root.
    pub depth: u16,
    /// The space it owns.
    pub cell: Aabb,
    /// The box around everything below; empty for an empty node.
    pub bounds: Aabb,
    /// Whether it is a straddle child, or below one: all of its objects cross some plane.
    pub is_straddle: bool,
    /// Whether it has no children.
    pub is_leaf: bool,
    /// Objects of its own.
    pub own: usize,
    /// Objects of its own and below.
    pub below: usize,
}

impl Tree {
    /// The root.
    pub fn root(&self) -> NodeId {
        self.nodes.id(0)
    }

    /// Whether a node has no children.
    pub fn is_leaf(&self, node: NodeId) -> bool {
        self.nodes.is_leaf(node.index)
    }

    /// Low, high and straddle child of an inner node.
    pub fn children(&self, node: NodeId) -> Option<[NodeId; 3]> {
        let first = self.nodes.child[node.index()];
        (first != NONE).then(|| [0, 1, 2].map(|i| self.nodes.id(first + i)))
    }

    /// The parent, but for the root.
    pub fn parent(&self, node: NodeId) -> Option<NodeId> {
        let parent = self.nodes.parent[node.index()];
        (parent != NONE).then(|| self.nodes.id(parent))
    }

    /// The node that holds an object slot as its own, if the tree holds it. O(1).
    pub fn node_of(&self, slot: u32) -> Option<NodeId> {
        Some(self.nodes.id(self.blocks.owner_of(slot)?))
    }

    /// Objects in a node and below.
    pub fn count(&self, node: NodeId) -> usize {
        self.nodes.below[node.index()] as usize
    }

    /// Objects of a node's own: all of a leaf's, a binary tree's straddlers of an inner node.
    pub fn own_count(&self, node: NodeId) -> usize {
        self.nodes.run[node.index()].len as usize
    }

    /// The blocks that a node's own objects lie in, with a bit for each lane that is theirs: nodes of
    /// few objects share a block.
    pub fn own(&self, node: NodeId) -> impl Iterator<Item = (&Block, u16)> {
        self.blocks.of(self.nodes.run[node.index()])
    }

    /// A node's own objects whose boxes meet a frustum, each as a lane of a block; `mask` has the planes
    /// that the node crosses.
    pub fn own_inside<'a>(
        &'a self,
        node: NodeId,
        frustum: &'a Frustum,
        mask: PlaneMask,
    ) -> impl Iterator<Item = (&'a Block, usize)> {
        self.own(node).flat_map(move |(block, held)| {
            let outside = frustum.outside_lanes(block.min.each_ref(), block.max.each_ref(), mask);
            lanes(held & !outside as u16).map(move |lane| (block, lane))
        })
    }

    /// A node's own objects: their slots, and their boxes.
    pub fn own_objects(&self, node: NodeId) -> impl Iterator<Item = (u32, Aabb)> {
        self.blocks.items(self.nodes.run[node.index()])
    }

    /// The box around everything in a node and below.
    pub fn bounds(&self, node: NodeId) -> Aabb {
        self.nodes.bounds[node.index()]
    }

    /// The space that a node owns.
    pub fn cell(&self, node: NodeId) -> Aabb {
        self.nodes.cell[node.index()]
    }

    /// The content epoch: it changes when an object enters the subtree, or moves in it.
    pub fn epoch(&self, node: NodeId) -> u32 {
        self.nodes.epoch[node.index()]
    }

    /// Indices of nodes are below this: the size of a side table.
    pub fn index_bound(&self) -> usize {
        self.nodes.capacity()
    }

    /// How far in front of the viewer a node begins: a key that orders front to back. The square
    /// of the distance from the eye for a perspective view; the distance along the view for an
    /// orthographic one (`eye.w == 0`).
    pub fn distance(&self, node: NodeId, eye: Vec4) -> f32 {
        distance(&self.nodes.bounds[node.index()], eye)
    }

    /// Every node, parents before their children.
    pub fn nodes(&self) -> impl Iterator<Item = NodeInfo> {
        let mut stack = vec![0];
        std::iter::from_fn(move || {
            let node = stack.pop()?;
            stack.extend(self.nodes.children(node).rev());
            let n = node as usize;
            Some(NodeInfo {
                id: self.nodes.id(node),
                role: self.nodes.role[n],
                depth: self.nodes.depth[n],
                cell: self.nodes.cell[n],
                bounds: self.nodes.bounds[n],
                is_straddle: self.nodes.is_straddle(node),
                is_leaf: self.nodes.is_leaf(node),
                own: self.nodes.run[n].len as usize,
                below: self.nodes.below[n] as usize,
            })
        })
    }
}

/// See [`Tree::distance`].
pub(crate) fn distance(aabb: &Aabb, eye: Vec4) -> f32 {
    if eye.w != 0.0 {
        return aabb.distance_squared(eye.truncate());
    }
    // `eye` points toward the viewer: the corner farthest along it is the nearest.
    let toward = eye.truncate();
    let corner = Vec3::select(toward.cmpge(Vec3::ZERO), aabb.max, aabb.min);
    -corner.dot(toward)
}
