//! Adding, moving and removing objects.

use glam::Vec3;

use super::blocks::{NONE, Newest, Tagged};
use super::config::Straddlers;
use super::node::Role;
use super::refit::{CONTENT, REGROUPED};
use super::{Edit, Tree};
use crate::geom::Aabb;

impl Tree {
    /// Adds an object that the tree does not hold; the next [`Tree::update`] places it. The box
    /// must be valid. O(1).
    pub(crate) fn insert(&mut self, slot: u32, aabb: &Aabb) {
        self.blocks.announce(slot, aabb);
        self.arrivals.push(slot);
        self.waiting += 1;
    }

    /// Gives an object that the tree holds a new box, which must be valid; the next
    /// [`Tree::update`] looks whether it stays in its cell. O(1).
    pub(crate) fn set_bounds(&mut self, slot: u32, aabb: &Aabb) {
        self.blocks.set(slot, aabb);
    }

    /// The same for many objects.
    #[inline(always)]
    pub(crate) fn newest(&mut self) -> Newest<'_> {
        self.blocks.newest()
    }

    /// Gives an object a tag, by which its owner knows it: 0 when it is inserted. O(1).
    pub(crate) fn set_tag(&mut self, slot: u32, tag: u32) {
        self.blocks.set_tag(slot, tag);
    }

    /// The objects' newest boxes and tags, to look at many.
    pub(crate) fn tagged(&self) -> Tagged<'_> {
        self.blocks.tagged()
    }

    /// Takes an object out. O(depth).
    pub(crate) fn remove(&mut self, slot: u32) {
        if self.blocks.is_waiting(slot) {
            self.blocks.renounce(slot);
            self.waiting -= 1;
        }
        let Some(node) = self.blocks.owner_of(slot) else { return };
        self.take(node, slot);
        self.leave_upward(node);
    }

    /// Moves the objects that have left their cells: each climbs to the first ancestor that holds
    /// it, and goes down from there.
    pub(super) fn relocate(&mut self) {
        let mut leavers = std::mem::take(&mut self.leavers);
        for slot in leavers.drain(..) {
            // It may have been removed since, have come back, or be listed twice.
            let Some(node) = self.blocks.owner_of(slot) else { continue };
            let Some(aabb) = self.blocks.aabb_of(slot) else { continue };
            if self.nodes.keeps(node, &aabb) {
                continue;
            }
            self.take(node, slot);
            // The climb ends before the root grows: growing gives the root's content another index.
            let mut at = node;
            loop {
                self.count_out(at);
                let parent = self.nodes.parent[at as usize];
                if parent == NONE {
                    self.hold_in_root(&aabb);
                    at = 0;
                    break;
                }
                at = parent;
                if self.nodes.holds(at, &aabb) {
                    self.nodes.below[at as usize] -= 1;
                    break;
                }
            }
            self.nodes.below[at as usize] += 1;
            let to = self.descend(at, &aabb);
            self.blocks.push_moving(&mut self.nodes.run[to as usize], to, slot, &aabb);
            self.arrive(to);
            self.stats.moves += 1;
        }
        self.leavers = leavers;
    }

    /// Places the objects that are new: one by one, or, where they are the first, all at once.
    pub(super) fn place_arrivals(&mut self) {
        let mut arrivals = std::mem::take(&mut self.arrivals);
        if self.nodes.is_leaf(0) && arrivals.len() as u32 >= self.build_from() {
            let waits = |&slot: &u32| Some((slot, self.blocks.aabb_of(slot)?));
            self.scratch.clear();
            self.scratch.extend(self.blocks.items(self.nodes.run[0]));
            arrivals.retain(|&slot| self.blocks.is_waiting(slot));
            arrivals.sort_unstable();
            arrivals.dedup();
            self.scratch.extend(arrivals.iter().filter_map(waits));
            self.nodes.below[0] += arrivals.len() as u32;
            arrivals.clear();
            self.build_all();
        }
        for slot in arrivals.drain(..) {
            // It may have been removed since, or be listed twice.
            let Some(aabb) = self.blocks.aabb_of(slot).filter(|_| self.blocks.is_waiting(slot)) else {
                continue;
            };
            self.hold_in_root(&aabb);
            self.nodes.below[0] += 1;
            let to = self.descend(0, &aabb);
            self.blocks.push(&mut self.nodes.run[to as usize], to, slot, &aabb);
            self.arrive(to);
        }
        self.waiting = 0;
        self.arrivals = arrivals;
    }

    /// Where an object belongs in the subtree of a node that holds it and has counted it already; it is
    /// counted on the way.
    fn descend(&mut self, mut at: u32, aabb: &Aabb) -> u32 {
        while !self.nodes.is_leaf(at) {
            let role = self.nodes.side(at, aabb);
            if role == Role::Straddle && self.config.straddlers == Straddlers::StayInParent {
                break;
            }
            at = self.nodes.child[at as usize] + role as u32 - Role::Low as u32;
            self.nodes.below[at as usize] += 1;
        }
        at
    }

    /// Marks a node that an object has come to.
    fn arrive(&mut self, node: u32) {
        self.touch(node, CONTENT | REGROUPED);
        self.note_crowded(node);
    }

    /// Lists a leaf for the next build once it has grown to the size from which one is tried.
    fn note_crowded(&mut self, node: u32) {
        let from = self.build_from().max(self.nodes.retry_at[node as usize]);
        if self.nodes.is_leaf(node) && self.nodes.run[node as usize].len >= from {
            self.crowded.push(node);
        }
    }

    /// Takes an object out of its node's run.
    fn take(&mut self, node: u32, slot: u32) {
        self.blocks.remove(&mut self.nodes.run[node as usize], node, slot);
        self.touch(node, REGROUPED);
    }

    fn leave_upward(&mut self, mut node: u32) {
        while node != NONE {
            self.count_out(node);
            node = self.nodes.parent[node as usize];
        }
    }

    /// One object less below a node. An inner node with at most one is superfluous.
    fn count_out(&mut self, node: u32) {
        self.nodes.below[node as usize] -= 1;
        if self.nodes.below[node as usize] <= 1 && !self.nodes.is_leaf(node) {
            self.thinned.push(node);
        }
    }

    /// Makes the root's cell hold a box. A root leaf simply takes a larger cell; an inner root
    /// becomes a half of one twice as large, as often as it takes. O(log(distance / size)), and
    /// O(nodes) if it grows at all: their depths change.
    fn hold_in_root(&mut self, aabb: &Aabb) {
        if self.nodes.is_leaf(0) {
            self.nodes.cell[0] = self.nodes.cell[0].union(aabb);
            return;
        }
        let mut wrapped = std::mem::take(&mut self.wrapped);
        for axis in 0..3 {
            while aabb.max[axis] > self.nodes.cell[0].max[axis] {
                wrapped.push(self.grow_root(axis, Role::High));
            }
            while aabb.min[axis] < self.nodes.cell[0].min[axis] {
                wrapped.push(self.grow_root(axis, Role::Low));
            }
        }
        if !wrapped.is_empty() {
            self.reorder(&wrapped);
            wrapped.clear();
        }
        self.wrapped = wrapped;
    }

    /// Doubles the root's cell on one axis, toward `new`: the half that is added. Returns the node
    /// that the root's content went to.
    fn grow_root(&mut self, axis: usize, new: Role) -> u32 {
        let old = self.nodes.cell[0];
        // A flat root could not grow by doubling; the square root keeps the step finite at the
        // far end of f32, where doubling would be infinite.
        let step = old.size()[axis].max(old.size().max_element() * 1e-3).max(f32::MIN_POSITIVE.sqrt());
        let mut cell = old;
        let plane = match new {
            Role::High => {
                cell.max[axis] = (old.max[axis] + step).next_up().min(f32::MAX);
                old.max[axis]
            }
            _ => {
                cell.min[axis] = (old.min[axis] - step).next_down().max(-f32::MAX);
                old.min[axis]
            }
        };
        self.wrap_root(cell, axis, plane, new)
    }

    /// Puts the root's content into the half of a new root that is not `new`.
    fn wrap_root(&mut self, cell: Aabb, axis: usize, plane: f32, new: Role) -> u32 {
        let from = self.nodes.id(0);
        // Splitting writes the new plane over the root's own, which its heir is still to get.
        let inner_cell = self.nodes.cell[0];
        let (child_of_old, changed_at) = (self.nodes.child[0], self.nodes.changed_at[0]);
        let (old_axis, old_plane) = (self.nodes.axis[0], self.nodes.plane[0]);
        self.nodes.child[0] = NONE;
        let first = self.nodes.split(0, axis, plane, self.tick);
        let to = if new == Role::High { first } else { first + 1 };
        self.nodes.child[0] = child_of_old;
        self.nodes.transplant(0, to);
        self.nodes.axis[to as usize] = old_axis;
        self.nodes.plane[to as usize] = old_plane;
        self.nodes.changed_at[to as usize] = changed_at;
        self.nodes.cell[to as usize] = inner_cell;
        self.nodes.straddled[to as usize] = Vec3::NAN;
        self.blocks.set_owner(self.nodes.run[to as usize], to);

        let (below, epoch, moved_at) = (self.nodes.below[0], self.nodes.epoch[0], self.nodes.moved_at[0]);
        let bounds = self.nodes.bounds[0];
        self.nodes.reset(0, NONE, Role::Root, cell, Vec3::NAN, 0);
        self.nodes.child[0] = first;
        self.nodes.axis[0] = axis as u8;
        self.nodes.plane[0] = plane;
        self.nodes.below[0] = below;
        self.nodes.epoch[0] = epoch;
        self.nodes.moved_at[0] = moved_at;
        self.nodes.bounds[0] = bounds;
        let far = if new == Role::High { first + 1 } else { first };
        let mut half = cell;
        match new {
            Role::High => half.min[axis] = plane,
            _ => half.max[axis] = plane,
        }
        self.nodes.cell[far as usize] = half;
        self.nodes.cell[first as usize + 2] = cell;
        self.log.push(Edit::Moved { from, to: self.nodes.id(to) });
        to
    }

    /// If the root's objects all lie in one inner half, that half becomes the root: a world that
    /// has shrunk does not keep the depth that it grew. O(nodes below), for their depths.
    pub(super) fn shrink_root(&mut self) {
        let mut shrunk = false;
        while let Some(heir) = self.sole_heir() {
            shrunk = true;
            let from = self.nodes.id(heir);
            let first = self.nodes.child[0];
            let cell = self.nodes.cell[heir as usize];
            let identity = self.nodes.identity[0].wrapping_add(1);
            self.nodes.transplant(heir, 0);
            self.blocks.set_owner(self.nodes.run[0], 0);
            self.nodes.cell[0] = cell;
            self.nodes.identity[0] = identity;
            self.nodes.free_triple(first);
            self.log.push(Edit::Moved { from, to: self.nodes.id(0) });
        }
        if shrunk {
            self.reorder(&[]);
        }
    }

    /// The half of the root that is an inner node and holds every object, if one does.
    fn sole_heir(&self) -> Option<u32> {
        let mut children = self.nodes.children(0);
        let heir = children.find(|&c| self.nodes.below[c as usize] > 0)?;
        let all = self.nodes.below[heir as usize] == self.nodes.below[0];
        let half = self.nodes.role[heir as usize] != Role::Straddle;
        let others_are_leaves = self.nodes.children(0).all(|c| c == heir || self.nodes.is_leaf(c));
        (all && half && others_are_leaves && !self.nodes.is_leaf(heir)).then_some(heir)
    }

    /// After indices near the root have changed: takes every node's depth anew, and lists the
    /// dirty ones by it.
    fn reorder(&mut self, wrapped: &[u32]) {
        let mut stack = std::mem::take(&mut self.deepening);
        stack.push((0, 0));
        while let Some((node, depth)) = stack.pop() {
            self.nodes.depth[node as usize] = depth;
            stack.extend(self.nodes.children(node).map(|c| (c, depth + 1)));
        }
        self.deepening = stack;
        // Index 0 and the node that took its content may each be the dirty one: both refit.
        let near = self.nodes.children(0).chain([0]);
        self.dirty.relist(&mut self.nodes, wrapped.iter().copied().chain(near));
    }
}
