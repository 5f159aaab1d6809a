//! Nodes, in struct-of-arrays, allocated three siblings at a time.
//!
//! ```text
//!   inner node ── plane on an axis ──┬── low       max ≤ plane
//!   (cell, bounds)                   ├── high      min ≥ plane, and not low
//!                                    └── straddle  min < plane < max
//! ```
//!
//! The cells of *low* and *high* are the halves of the parent's cell; the cell of *straddle* is
//! the parent's. Every object of a node lies wholly in the node's cell and straddles the planes
//! that the node's `straddled` names.

use glam::Vec3;

use super::blocks::{NONE, grow};
use super::runs::Run;
use crate::geom::Aabb;

/// A handle of a node: an index and the index's *identity generation*, which changes whenever the
/// index is given to another node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId {
    pub(crate) index: u32,
    pub(crate) identity: u32,
}

impl NodeId {
    /// The index: dense and reused; for side tables.
    pub const fn index(self) -> usize {
        self.index as usize
    }

    /// The identity generation.
    pub const fn identity(self) -> u32 {
        self.identity
    }
}

/// What a node is to its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The root.
    Root,
    /// The half below the plane.
    Low,
    /// The half above the plane.
    High,
    /// The child for the objects that the plane cuts.
    Straddle,
}

impl Role {
    /// The order of siblings in memory.
    pub(crate) const CHILDREN: [Self; 3] = [Self::Low, Self::High, Self::Straddle];
}

/// The last votes about a node: the greatest visible share that any view of one adaptation saw,
/// and when; 0 for never.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evidence {
    pub(crate) ratio: f32,
    pub(crate) at: u32,
}

/// All nodes, an array a field. Index 0 is the root.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nodes {
    pub(crate) cell: Vec<Aabb>,
    /// The planes, an axis, that every object of the node straddles; NaN where none.
    pub(crate) straddled: Vec<Vec3>,
    /// The box around everything below, as of the last refit.
    pub(crate) bounds: Vec<Aabb>,
    pub(crate) parent: Vec<u32>,
    /// The first of three children; [`NONE`] for a leaf.
    pub(crate) child: Vec<u32>,
    pub(crate) role: Vec<Role>,
    pub(crate) axis: Vec<u8>,
    pub(crate) plane: Vec<f32>,
    pub(crate) depth: Vec<u16>,
    /// The node's own objects: all of them in a leaf, straddlers of a binary tree's inner node.
    pub(crate) run: Vec<Run>,
    /// Objects in the node and below.
    pub(crate) below: Vec<u32>,
    pub(crate) identity: Vec<u32>,
    /// Content epoch: counts the updates in which an object entered, or moved in, the subtree.
    pub(crate) epoch: Vec<u32>,
    /// The update in which something below last moved or entered.
    pub(crate) moved_at: Vec<u32>,
    /// The update in which the node last split, or was merged; 0 for never.
    pub(crate) changed_at: Vec<u32>,
    pub(crate) evidence: Vec<Evidence>,
    /// The number of objects from which a split is tried again, after one that separated nothing;
    /// it falls with every move.
    pub(crate) retry_at: Vec<u32>,
    pub(crate) dirty: Vec<u8>,
    free: Vec<u32>,
}

impl Nodes {
    /// A root without objects.
    pub(crate) fn with_root() -> Self {
        let mut nodes = Self::default();
        nodes.grow(1);
        nodes.reset(0, NONE, Role::Root, Aabb::EMPTY, Vec3::NAN, 0);
        nodes
    }

    /// Indices in use or free.
    pub(crate) fn capacity(&self) -> usize {
        self.cell.len()
    }

    /// Nodes alive.
    pub(crate) fn len(&self) -> usize {
        self.capacity() - 3 * self.free.len()
    }

    pub(crate) fn id(&self, node: u32) -> NodeId {
        NodeId { index: node, identity: self.identity[node as usize] }
    }

    pub(crate) fn is_leaf(&self, node: u32) -> bool {
        self.child[node as usize] == NONE
    }

    /// Whether every object of the node straddles some plane.
    pub(crate) fn is_straddle(&self, node: u32) -> bool {
        !self.straddled[node as usize].is_nan_mask().all()
    }

    /// The indices of an inner node's children.
    pub(crate) fn children(&self, node: u32) -> std::ops::Range<u32> {
        match self.child[node as usize] {
            NONE => 0..0,
            first => first..first + 3,
        }
    }

    /// Gives a leaf three empty children on the two sides of a plane and across it.
    pub(crate) fn split(&mut self, node: u32, axis: usize, plane: f32, tick: u32) -> u32 {
        let first = self.free.pop().unwrap_or_else(|| self.grow(3));
        let n = node as usize;
        let (cell, straddled, depth) = (self.cell[n], self.straddled[n], self.depth[n] + 1);
        let (mut low, mut high) = (cell, cell);
        low.max[axis] = plane;
        high.min[axis] = plane;
        let mut across = straddled;
        across[axis] = plane;
        self.reset(first, node, Role::Low, low, straddled, depth);
        self.reset(first + 1, node, Role::High, high, straddled, depth);
        self.reset(first + 2, node, Role::Straddle, cell, across, depth);
        self.child[n] = first;
        self.axis[n] = axis as u8;
        self.plane[n] = plane;
        self.changed_at[n] = tick;
        for child in first as usize..first as usize + 3 {
            self.moved_at[child] = self.moved_at[n];
        }
        first
    }

    /// Makes an inner node a leaf and frees its children, which must be empty leaves by now.
    pub(crate) fn join(&mut self, node: u32, tick: u32) {
        let first = std::mem::replace(&mut self.child[node as usize], NONE);
        self.changed_at[node as usize] = tick;
        self.free_triple(first);
    }

    /// Gives three siblings' indices back.
    pub(crate) fn free_triple(&mut self, first: u32) {
        for child in first as usize..first as usize + 3 {
            // Whoever still holds the freed node's identity must not find it again.
            self.identity[child] = self.identity[child].wrapping_add(1);
            self.parent[child] = NONE;
            self.child[child] = NONE;
            self.run[child] = Run::EMPTY;
            self.below[child] = 0;
        }
        self.free.push(first);
    }

    /// Whether an index is that of a node, not a freed one.
    pub(crate) fn is_alive(&self, node: u32) -> bool {
        node == 0 || self.parent.get(node as usize).is_some_and(|&p| p != NONE)
    }

    /// Whether a handle still names the node that it was made for.
    pub(crate) fn is_current(&self, id: NodeId) -> bool {
        self.is_alive(id.index) && self.identity[id.index as usize] == id.identity
    }

    /// Whether a node's objects may include this box: inside the cell, across the planes.
    pub(crate) fn holds(&self, node: u32, aabb: &Aabb) -> bool {
        let n = node as usize;
        let s = self.straddled[n];
        // NaN, where nothing is straddled, compares false.
        self.cell[n].contains(aabb) && !(aabb.min.cmpge(s) | aabb.max.cmple(s)).any()
    }

    /// Whether an object may stay in a node: in the cell, across the planes, and, in an inner
    /// node, still cut by its plane.
    pub(crate) fn keeps(&self, node: u32, aabb: &Aabb) -> bool {
        if node == 0 && self.is_leaf(0) {
            return true;
        }
        self.holds(node, aabb) && (self.is_leaf(node) || self.side(node, aabb) == Role::Straddle)
    }

    /// Which child of an inner node a box belongs to.
    pub(crate) fn side(&self, node: u32, aabb: &Aabb) -> Role {
        side(aabb, self.axis[node as usize] as usize, self.plane[node as usize])
    }

    /// Memory held, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.capacity()
            * (2 * size_of::<Aabb>()
                + size_of::<Vec3>()
                + size_of::<Run>()
                + size_of::<Evidence>()
                + 9 * size_of::<u32>()
                + 5)
    }

    /// Moves a node's content to another index of the same shape (the root, as it grows or
    /// shrinks); the old index keeps a copy that the caller overwrites.
    pub(crate) fn transplant(&mut self, from: u32, to: u32) {
        let (f, t) = (from as usize, to as usize);
        self.bounds[t] = self.bounds[f];
        self.child[t] = self.child[f];
        self.axis[t] = self.axis[f];
        self.plane[t] = self.plane[f];
        self.run[t] = self.run[f];
        self.below[t] = self.below[f];
        self.epoch[t] = self.epoch[f];
        self.moved_at[t] = self.moved_at[f];
        self.changed_at[t] = self.changed_at[f];
        self.evidence[t] = self.evidence[f];
        self.retry_at[t] = self.retry_at[f];
        self.dirty[t] = self.dirty[f];
        for child in self.children(to) {
            self.parent[child as usize] = to;
        }
    }

    pub(crate) fn reset(
        &mut self,
        node: u32,
        parent: u32,
        role: Role,
        cell: Aabb,
        straddled: Vec3,
        depth: u16,
    ) {
        let n = node as usize;
        self.cell[n] = cell;
        self.straddled[n] = straddled;
        self.bounds[n] = Aabb::EMPTY;
        self.parent[n] = parent;
        self.child[n] = NONE;
        self.role[n] = role;
        self.depth[n] = depth;
        self.run[n] = Run::EMPTY;
        self.below[n] = 0;
        self.identity[n] = self.identity[n].wrapping_add(1);
        self.epoch[n] = 0;
        self.moved_at[n] = 0;
        self.changed_at[n] = 0;
        self.evidence[n] = Evidence { ratio: 0.0, at: 0 };
        self.retry_at[n] = 0;
        self.dirty[n] = 0;
    }

    fn grow(&mut self, count: usize) -> u32 {
        let first = self.capacity();
        let total = first + count;
        grow(&mut self.cell, total, Aabb::EMPTY);
        grow(&mut self.straddled, total, Vec3::NAN);
        grow(&mut self.bounds, total, Aabb::EMPTY);
        grow(&mut self.parent, total, NONE);
        grow(&mut self.child, total, NONE);
        grow(&mut self.role, total, Role::Root);
        grow(&mut self.axis, total, 0);
        grow(&mut self.plane, total, 0.0);
        grow(&mut self.depth, total, 0);
        grow(&mut self.run, total, Run::EMPTY);
        grow(&mut self.below, total, 0);
        grow(&mut self.identity, total, 0);
        grow(&mut self.epoch, total, 0);
        grow(&mut self.moved_at, total, 0);
        grow(&mut self.changed_at, total, 0);
        grow(&mut self.evidence, total, Evidence { ratio: 0.0, at: 0 });
        grow(&mut self.retry_at, total, 0);
        grow(&mut self.dirty, total, 0);
        first as u32
    }
}

/// Which side of a plane a box lies on. A box that ends on the plane, or lies in it, is low.
pub(crate) fn side(aabb: &Aabb, axis: usize, plane: f32) -> Role {
    if aabb.max[axis] <= plane {
        Role::Low
    } else if aabb.min[axis] >= plane {
        Role::High
    } else {
        Role::Straddle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Identities begin again after 2³² owners of an index: a handle is still told from those of the
    /// owners before and after it. One that is 2³² owners old is not, and need not be: what is remembered
    /// by it decides what is asked, never what is hidden.
    #[test]
    fn identities_that_wrap_are_told_apart() {
        let mut nodes = Nodes::with_root();
        nodes.cell[0] = Aabb::new(Vec3::ZERO, Vec3::ONE);
        let first = nodes.split(0, 0, 0.5, 1);
        nodes.join(0, 1);
        nodes.identity[first as usize..].fill(u32::MAX - 5);
        let mut old: Vec<NodeId> = Vec::new();
        for _ in 0..8 {
            assert_eq!(nodes.split(0, 0, 0.5, 1), first, "the same indices");
            let ids = nodes.children(0).map(|child| nodes.id(child));
            let ids: Vec<_> = ids.collect();
            assert!(ids.iter().all(|&id| nodes.is_current(id) && !old.contains(&id)));
            nodes.join(0, 1);
            old.extend(ids);
            assert!(old.iter().all(|&id| !nodes.is_current(id)));
        }
        assert!(old.iter().any(|id| id.identity() < 5), "they have wrapped: {old:?}");
    }
}
