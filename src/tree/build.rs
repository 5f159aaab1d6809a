//! Building below a leaf: in bulk, where many objects arrive at once, and one level for a vote.

use std::ops::Range;

use glam::Vec3;

use super::config::{LeafSize, Straddlers};
use super::node::{Role, side};
use super::refit::{CONTENT, REGROUPED};
use super::split::{Item, Site, choose};
use super::{Edit, Tree};

/// Objects from which the leaves of a tree that nobody asks are larger in proportion, and how much larger.
const LARGE: u32 = 25_000;
const LARGEST: u32 = 4;

/// How far to build.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    /// Leaves of at most this many objects are left alone.
    pub(super) leaf: u32,
    /// Levels to add, at most.
    pub(super) levels: u32,
}

/// Objects of `scratch` that are to become a node: split by a plane, or stored if there is none.
#[derive(Clone, Debug)]
pub(super) struct Task {
    node: u32,
    objects: Range<usize>,
    /// Levels added above it.
    level: u32,
    plane: Option<(usize, f32)>,
}

impl Tree {
    /// Builds below the leaves that have grown past what the configuration aims at. O(n log n) in
    /// their objects.
    pub(super) fn build_crowded(&mut self) {
        while let Some(leaf) = self.crowded.pop() {
            let full = self.nodes.run[leaf as usize].len > self.bulk_leaf();
            if self.nodes.is_alive(leaf) && self.nodes.is_leaf(leaf) && full {
                let extent = Extent { leaf: self.bulk_leaf(), levels: u32::MAX };
                self.build(leaf, None, extent);
            }
        }
    }

    /// Objects that a leaf of the bulk build holds at most: at least half of what makes a leaf worth
    /// splitting, or what is built would merge. Where the size of leaves follows the costs and
    /// nobody has asked anything yet, many: fine leaves are there to be asked about.
    pub(super) fn bulk_leaf(&self) -> u32 {
        match self.config.leaf_size {
            LeafSize::Fixed => self.config.bulk_leaf,
            LeafSize::FromCosts if self.asked => self.config.bulk_leaf.max(self.o_split / 2),
            LeafSize::FromCosts => self.config.bulk_leaf.max(self.unasked_leaf()),
        }
    }

    /// Leaves are there to find what a frustum meets: the more objects there are, the larger may each be,
    /// for the same share of the world.
    fn unasked_leaf(&self) -> u32 {
        let times = (self.nodes.below[0] / LARGE).clamp(1, LARGEST);
        self.config.unasked_leaf.saturating_mul(times)
    }

    /// The size from which a leaf is built anew.
    pub(super) fn build_from(&self) -> u32 {
        self.bulk_leaf().max(1).saturating_mul(4)
    }

    /// The first view that asks: from now on leaves are as fine as the configuration has them.
    /// O(n log n), once in a tree's life.
    pub(super) fn refine(&mut self) {
        self.asked = true;
        let large = |&node: &u32| {
            self.nodes.is_alive(node)
                && self.nodes.is_leaf(node)
                && self.nodes.run[node as usize].len > self.bulk_leaf()
        };
        let leaves: Vec<u32> = (0..self.nodes.capacity() as u32).filter(large).collect();
        self.crowded.extend(leaves);
        self.build_crowded();
    }

    /// Makes the tree anew from all objects, which `scratch` holds and the root's count includes.
    pub(super) fn build_all(&mut self) {
        let extent = Extent { leaf: self.bulk_leaf(), levels: u32::MAX };
        self.touch(0, CONTENT | REGROUPED);
        if !self.build_scratch(0, None, extent) {
            let mut items = std::mem::take(&mut self.scratch);
            self.blocks.release(&mut self.nodes.run[0]);
            self.fill(0, &items, CONTENT);
            items.clear();
            self.scratch = items;
        }
        self.blocks.leave_room();
        // A scene is rarely loaded twice: the build's own memory is as large as the scene.
        self.scratch = Vec::new();
        self.stack = Vec::new();
    }

    /// Splits a leaf, and what comes of it, as far as `extent` says. Returns whether it split.
    pub(super) fn build(&mut self, leaf: u32, forward: Option<Vec3>, extent: Extent) -> bool {
        self.scratch.clear();
        self.scratch.extend(self.blocks.items(self.nodes.run[leaf as usize]));
        self.build_scratch(leaf, forward, extent)
    }

    /// The same for the objects in `scratch`, which are the leaf's.
    fn build_scratch(&mut self, leaf: u32, forward: Option<Vec3>, extent: Extent) -> bool {
        let mut items = std::mem::take(&mut self.scratch);
        if leaf == 0 {
            for (_, aabb) in &items {
                self.nodes.cell[0] = self.nodes.cell[0].union(aabb);
            }
        }
        let plane = self.plane_for(leaf, &items, forward);
        if plane.is_none() {
            self.nodes.retry_at[leaf as usize] = (2 * items.len() as u32).max(4);
            self.scratch = items;
            return false;
        }
        self.blocks.release(&mut self.nodes.run[leaf as usize]);
        // New nodes have news only if their objects are new: a split alone moves nothing.
        let why = self.nodes.dirty[leaf as usize] & CONTENT;
        let mut stack = std::mem::take(&mut self.stack);
        stack.push(Task { node: leaf, objects: 0..items.len(), level: 0, plane });
        while let Some(Task { node, objects, level, plane }) = stack.pop() {
            let part = &mut items[objects.clone()];
            let Some((axis, plane)) = plane else {
                self.fill(node, part, why);
                continue;
            };
            let first = self.nodes.split(node, axis, plane, self.tick);
            let children = [0, 1, 2].map(|i| self.nodes.id(first + i));
            self.log.push(Edit::Split { parent: self.nodes.id(node), children });
            self.stats.splits += 1;
            self.touch(node, REGROUPED);
            let [low, high] = partition(part, axis, plane);
            let mut ranges = [0..low, low..high, high..part.len()];
            if self.config.straddlers == Straddlers::StayInParent {
                self.fill(node, &part[ranges[2].clone()], why);
                ranges[2] = 0..0;
            }
            for (child, within) in (first..).zip(ranges) {
                self.nodes.below[child as usize] = within.len() as u32;
                if within.is_empty() {
                    continue;
                }
                let deeper = within.len() as u32 > extent.leaf && level + 1 < extent.levels;
                let plane = if deeper { self.plane_for(child, &part[within.clone()], forward) } else { None };
                if deeper && plane.is_none() {
                    self.nodes.retry_at[child as usize] = (2 * within.len() as u32).max(4);
                }
                let objects = objects.start + within.start..objects.start + within.end;
                stack.push(Task { node: child, objects, level: level + 1, plane });
            }
        }
        self.stack = stack;
        self.scratch = items;
        true
    }

    /// Stores objects in a node's run.
    fn fill(&mut self, node: u32, items: &[Item], why: u8) {
        let mut run = self.nodes.run[node as usize];
        self.blocks.reserve(&mut run, node, items.len() as u32);
        for (slot, aabb) in items {
            self.blocks.push(&mut run, node, *slot, aabb);
        }
        self.nodes.run[node as usize] = run;
        self.touch(node, why | REGROUPED);
    }

    fn plane_for(&self, node: u32, items: &[Item], forward: Option<Vec3>) -> Option<(usize, f32)> {
        let n = node as usize;
        let site = Site {
            items,
            cell: self.nodes.cell[n],
            straddled: self.nodes.straddled[n],
            role: self.nodes.role[n],
            forward,
        };
        choose(&site, &self.config)
    }
}

/// Orders objects low, high, straddling; returns where high begins, and where straddling does.
fn partition(items: &mut [Item], axis: usize, plane: f32) -> [usize; 2] {
    let (mut low, mut at, mut straddling) = (0, 0, items.len());
    while at < straddling {
        match side(&items[at].1, axis, plane) {
            Role::Low => {
                items.swap(low, at);
                low += 1;
                at += 1;
            }
            Role::Straddle => {
                straddling -= 1;
                items.swap(at, straddling);
            }
            Role::High | Role::Root => at += 1,
        }
    }
    [low, straddling]
}
