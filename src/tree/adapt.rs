//! Votes split and merge leaves (Kovalčík & Tobola 2005, *adaptation*).
//!
//! A vote is the dual answer to a question about one node: how many samples of its box passed,
//! of how many. Any view's vote can split; a merge takes the agreement of all views that answered
//! about the three leaves in the same adaptation: the evidence kept is the greatest share that any
//! of them saw. So views that share a scene are best passed to one call.
//!
//! *Leaf size from costs* ([`LeafSize::FromCosts`], ours; the paper leaves open how its constants
//! might be found). Splitting a leaf of `n` objects costs about one question a frame more, worth
//! `q` objects, and saves those that are hidden; if they are a quarter, it pays from `n = 4 q` on.
//! So `O_split` is `4 q`, but never less than the dial, and three leaves that together hold less
//! than half as many merge, whatever their answers say; the bulk build aims at that half as well.
//! (The rule for skipping questions counts an object in vain as several; here it counts as one, or
//! leaves would stay fine where drawing is cheap.)

use glam::Vec3;

use super::build::Extent;
use super::config::LeafSize;
use super::node::{Evidence, NodeId};
use super::refit::REGROUPED;
use super::runs::Run;
use super::{Edit, Tree};
use crate::Costs;

/// One view's answer about one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vote {
    /// The node that was asked about.
    pub node: NodeId,
    /// Samples of its box that passed the depth test.
    pub visible: u32,
    /// Samples that its box covers; 0 is neutral.
    pub total: u32,
}

/// All answers of one view in its last frame.
#[derive(Clone, Debug, Default)]
pub struct Votes {
    /// Direction of view, for view-aligned planes.
    pub forward: Vec3,
    /// What asking and drawing cost this view.
    pub costs: Costs,
    /// Whether its policy asks about nodes, even if it found none to ask about.
    pub asks: bool,
    /// In the order of the answers.
    pub votes: Vec<Vote>,
}

impl Votes {
    /// Forgets all votes and keeps the memory.
    pub fn clear(&mut self) {
        self.votes.clear();
        self.asks = false;
    }

    /// A vote from counts.
    pub fn count(&mut self, node: NodeId, visible: u32, total: u32) {
        self.votes.push(Vote { node, visible, total });
    }

    /// A node that holds the eye or crosses the near plane: it cannot be asked, and counts as
    /// wholly visible.
    pub fn near(&mut self, node: NodeId) {
        self.count(node, 1, 1);
    }
}

/// Rounds through all nodes, in the time that makes leaves idle, in the search for such leaves.
const IDLE_ROUNDS: usize = 2;

/// Frames for which an answer speaks for a merge: a view skips its questions for less, by default.
const FRESH_FRAMES: u32 = 32;

impl Tree {
    /// Splits and merges leaves after the votes of all views. O(votes + changes).
    pub(crate) fn adapt<'a>(&mut self, ballots: impl Iterator<Item = &'a Votes> + Clone) {
        let all = ballots.clone().flat_map(|b| b.votes.iter().map(move |v| (v, b.forward)));
        for (vote, _) in all.clone() {
            self.weigh(vote);
        }
        // Builds and merges read the blocks.
        self.refresh();
        self.find_leaf_size(ballots.clone());
        if !self.asked && ballots.into_iter().any(|b| b.asks || !b.votes.is_empty()) {
            self.refine();
        }
        let (mut splits, mut merges) = (self.config.budget, self.config.budget);
        for (vote, forward) in all.clone() {
            if splits > 0 && self.may_split(vote.node) && self.split(vote.node.index, forward) {
                splits -= 1;
            }
        }
        for (vote, _) in all {
            if merges == 0 {
                break;
            }
            if let Some(parent) = self.too_small_parent(vote.node) {
                self.merge(parent);
                merges -= 1;
            } else if let Some(parent) = self.mergeable_parent(vote.node) {
                self.count_flip(self.nodes.changed_at[parent as usize]);
                self.merge(parent);
                merges -= 1;
            }
        }
        self.merge_idle(merges);
        self.refit();
    }

    /// Merges inner nodes that hold at most one object any more, whoever sees them. That follows
    /// the objects, not the votes, and is no flip.
    pub(super) fn collapse_thinned(&mut self) {
        while let Some(node) = self.thinned.pop() {
            let few = self.nodes.is_alive(node) && self.nodes.below[node as usize] <= 1;
            if few && self.has_leaf_children(node) {
                self.merge(node);
                self.thinned.extend(self.parent(self.nodes.id(node)).map(|p| p.index));
            }
        }
    }

    /// Records a vote as evidence: the greatest share of this frame's.
    fn weigh(&mut self, vote: &Vote) {
        if vote.total == 0 || !self.nodes.is_current(vote.node) {
            return;
        }
        let ratio = vote.visible as f32 / vote.total as f32;
        let tick = self.tick;
        let evidence = &mut self.nodes.evidence[vote.node.index()];
        let ratio = if evidence.at == tick { evidence.ratio.max(ratio) } else { ratio };
        *evidence = Evidence { ratio, at: tick };
    }

    /// Follows the costs of the view that asks at the least cost. As long as they want from two
    /// thirds to four thirds of the size that is, it stays: costs are never quite the same.
    fn find_leaf_size<'a>(&mut self, ballots: impl Iterator<Item = &'a Votes>) {
        if self.config.leaf_size == LeafSize::Fixed {
            return;
        }
        let asked = ballots.filter(|ballot| !ballot.votes.is_empty());
        let question = asked.map(|ballot| ballot.costs.question()).min_by(f32::total_cmp);
        let Some(question) = question else { return };
        let wanted = self.config.o_split.max((4.0 * question) as u32);
        let (to, from) = (u64::from(wanted), u64::from(self.o_split));
        if 3 * to > 4 * from || 3 * to < 2 * from {
            self.o_split = wanted;
        }
    }

    /// `visible / total ≥ R_split` and `objects ≥ O_split`, and no merge just before.
    fn may_split(&self, node: NodeId) -> bool {
        if !self.nodes.is_current(node) || !self.nodes.is_leaf(node.index) {
            return false;
        }
        let n = node.index();
        let Evidence { ratio, at } = self.nodes.evidence[n];
        let len = self.nodes.run[n].len;
        at == self.tick
            && ratio >= self.config.r_split
            && len >= self.o_split.max(self.nodes.retry_at[n])
            && self.has_cooled(node.index)
    }

    /// The parent of a voting leaf, if its three children are not worth their questions. This needs
    /// no time to cool: what has merged is too small by half to split or to be built anew.
    fn too_small_parent(&self, node: NodeId) -> Option<u32> {
        if self.config.leaf_size == LeafSize::Fixed || !self.nodes.is_current(node) {
            return None;
        }
        let parent = self.parent(node)?.index;
        let too_small = self.nodes.below[parent as usize] < self.o_split / 2;
        (too_small && self.has_leaf_children(parent)).then_some(parent)
    }

    /// The parent of a voting leaf, if its three children are to merge: for each
    /// `visible / total ≤ R_merge` and `objects ≤ O_merge`. An empty child is neutral; a missing
    /// or stale answer holds.
    fn mergeable_parent(&self, node: NodeId) -> Option<u32> {
        if !self.nodes.is_current(node) {
            return None;
        }
        let parent = self.parent(node)?.index;
        let agree = self.nodes.children(parent).all(|child| {
            let Evidence { ratio, at } = self.nodes.evidence[child as usize];
            let fresh = at != 0 && self.tick.wrapping_sub(at) < FRESH_FRAMES;
            self.nodes.below[child as usize] == 0 || (fresh && ratio <= self.config.r_merge)
        });
        (agree && self.fits_in_leaf(parent) && self.has_cooled(parent)).then_some(parent)
    }

    /// The counts' half of the merge rule.
    fn fits_in_leaf(&self, parent: u32) -> bool {
        let small = |child| self.nodes.below[child as usize] <= self.config.o_merge;
        let stable = !self.config.merge_below_split
            || self.nodes.below[parent as usize] < self.o_split.max(self.bulk_leaf());
        self.has_leaf_children(parent) && stable && self.nodes.children(parent).all(small)
    }

    fn has_leaf_children(&self, node: u32) -> bool {
        !self.nodes.is_leaf(node) && self.nodes.children(node).all(|c| self.nodes.is_leaf(c))
    }

    fn has_cooled(&self, node: u32) -> bool {
        let changed_at = self.nodes.changed_at[node as usize];
        changed_at == 0 || self.tick.wrapping_sub(changed_at) >= self.config.cooldown
    }

    fn split(&mut self, leaf: u32, forward: Vec3) -> bool {
        let changed_at = self.nodes.changed_at[leaf as usize];
        let split = self.build(leaf, Some(forward), Extent { leaf: 1, levels: 1 });
        if split {
            self.count_flip(changed_at);
        }
        split
    }

    /// Makes a leaf of an inner node whose children are leaves.
    fn merge(&mut self, parent: u32) {
        let children = self.nodes.child[parent as usize];
        let ids = [0, 1, 2].map(|i| self.nodes.id(children + i));
        let mut run = self.nodes.run[parent as usize];
        self.blocks.reserve(&mut run, parent, self.nodes.below[parent as usize]);
        let mut items = std::mem::take(&mut self.scratch);
        for child in children..children + 3 {
            let mut old: Run = self.nodes.run[child as usize];
            items.clear();
            items.extend(self.blocks.items(old));
            self.blocks.release(&mut old);
            for (slot, aabb) in &items {
                self.blocks.push(&mut run, parent, *slot, aabb);
            }
        }
        self.scratch = items;
        self.nodes.run[parent as usize] = run;
        self.nodes.retry_at[parent as usize] = 0;
        // The children's evidence dies with them; theirs was below the threshold.
        self.nodes.evidence[parent as usize] = Evidence { ratio: 0.0, at: 0 };
        self.nodes.join(parent, self.tick);
        self.log.push(Edit::Merged { parent: self.nodes.id(parent), children: ids });
        self.stats.merges += 1;
        self.touch(parent, REGROUPED);
    }

    /// Merges leaves that qualify by their counts and that no view has asked about for long: out
    /// of view or behind a hidden ancestor, a fine division earns nothing.
    fn merge_idle(&mut self, mut budget: u32) {
        let capacity = self.nodes.capacity();
        let looked_at = (IDLE_ROUNDS * capacity).div_ceil(self.config.idle_frames as usize);
        for _ in 0..looked_at.min(capacity) {
            self.idle_cursor = (self.idle_cursor + 1) % capacity;
            let node = self.idle_cursor as u32;
            if budget == 0 || !self.nodes.is_alive(node) || !self.fits_in_leaf(node) {
                continue;
            }
            // From the split on, if nobody has asked since.
            let built = self.nodes.changed_at[node as usize];
            let idle = |n: u32| {
                let last = self.nodes.evidence[n as usize].at.max(built);
                self.tick.wrapping_sub(last) >= self.config.idle_frames
            };
            if idle(node) && self.nodes.children(node).all(idle) && self.has_cooled(node) {
                self.merge(node);
                budget -= 1;
            }
        }
    }

    fn count_flip(&mut self, changed_at: u32) {
        if changed_at != 0 && self.tick.wrapping_sub(changed_at) < Self::FLIP_FRAMES {
            self.stats.flips += 1;
        }
    }
}
