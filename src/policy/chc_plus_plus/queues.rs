//! The queues of CHC++: what waits to be asked, and what was asked.
//!
//! | queue | holds | is issued |
//! |---|---|---|
//! | i-queue | nodes that were hidden | in batches of `b`, and when nothing else is left to do |
//! | v-queue | visible leaves whose question is due; they are drawn already | while answers about the i-queue's nodes are awaited, and at the end |
//!
//! The *distance queue* is the walk's ([`Coherence`](super::super::coherence::Coherence)). The
//! *render queue* is the driver's: draws accumulate, and are flushed before a question goes out. So
//! batches of questions are batches of draws.

use std::ops::Range;

use super::super::front::Front;
use super::multiquery::{self, Alike};
use crate::geom::Proxy;
use crate::query::Ticket;

/// A node whose question waits to be asked, or has been asked.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    pub(super) front: Front,
    /// Its boxes, among the frame's proxies.
    pub(super) boxes: Range<usize>,
    /// What it is like.
    pub(super) alike: Alike,
    /// Frames for which it had been hidden.
    pub(super) hidden_for: u32,
    /// How likely it is that it still is; 0 for a node that must be asked about alone.
    pub(super) p_keep: f32,
}

/// A question.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    /// What it is about, among the nodes asked about.
    pub(super) nodes: Range<usize>,
    /// Whether it is about a leaf that was visible in the last frame.
    pub(super) was_visible: bool,
    /// Whether it repeats a part of one that failed.
    pub(super) is_group: bool,
    answered: bool,
}

/// The questions of one frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Queues {
    pub(super) proxies: Vec<Proxy>,
    invisible: Vec<Waiting>,
    /// Nodes of multiqueries that failed, in groups; and how many each has.
    groups: Vec<Waiting>,
    sizes: Vec<usize>,
    visible: Vec<Waiting>,
    /// The nodes asked about, in the order of asking.
    nodes: Vec<Waiting>,
    /// A ticket is an index.
    asked: Vec<Asked>,
    open: usize,
    /// The boxes of the multiquery that is being asked.
    gathered: Vec<Proxy>,
}

impl Queues {
    /// Starts a frame.
    pub(super) fn begin(&mut self) {
        self.proxies.clear();
        self.invisible.clear();
        self.groups.clear();
        self.sizes.clear();
        self.visible.clear();
        self.nodes.clear();
        self.asked.clear();
        self.open = 0;
    }

    /// Puts a node into the i-queue, and returns how many are there.
    pub(super) fn wait_invisible(&mut self, node: Waiting) -> usize {
        self.invisible.push(node);
        self.invisible.len()
    }

    /// Puts nodes that were asked about together into the i-queue again, in groups.
    pub(super) fn wait_in_groups(&mut self, nodes: Range<usize>) {
        let size = nodes.len().div_ceil(multiquery::groups(nodes.len()));
        self.sizes.extend(self.nodes[nodes.clone()].chunks(size).map(<[Waiting]>::len));
        self.groups.extend_from_slice(&self.nodes[nodes]);
    }

    /// Puts a leaf into the v-queue.
    pub(super) fn wait_visible(&mut self, leaf: Waiting) {
        self.visible.push(leaf);
    }

    /// Makes questions of the i-queue, the likeliest to stay hidden together: their numbers. Sets may be
    /// larger if they are repeated in groups. O(n log n).
    pub(super) fn issue_invisible(&mut self, regroup: bool) -> Range<usize> {
        let first = self.asked.len();
        for size in self.sizes.drain(..) {
            let nodes = self.nodes.len()..self.nodes.len() + size;
            self.nodes.extend(self.groups.drain(..size));
            self.asked.push(Asked { nodes, was_visible: false, is_group: true, answered: false });
        }
        // Stable: among equals, the nearest go first.
        self.invisible.sort_by(|a, b| b.p_keep.total_cmp(&a.p_keep));
        let mut left = &self.invisible[..];
        while !left.is_empty() {
            let size = multiquery::size(left.iter().map(|node| node.p_keep), regroup);
            let (together, rest) = left.split_at(size);
            let nodes = self.nodes.len()..self.nodes.len() + together.len();
            self.nodes.extend_from_slice(together);
            self.asked.push(Asked { nodes, was_visible: false, is_group: false, answered: false });
            left = rest;
        }
        self.invisible.clear();
        self.issued(first)
    }

    /// Makes a question of each leaf of the v-queue: their numbers.
    pub(super) fn issue_visible(&mut self) -> Range<usize> {
        let first = self.asked.len();
        for leaf in self.visible.drain(..) {
            let node = self.nodes.len();
            self.nodes.push(leaf);
            self.asked.push(Asked {
                nodes: node..node + 1,
                was_visible: true,
                is_group: false,
                answered: false,
            });
        }
        self.issued(first)
    }

    /// The boxes of a question.
    pub(super) fn boxes(&mut self, question: usize) -> &[Proxy] {
        let nodes = &self.nodes[self.asked[question].nodes.clone()];
        if let [node] = nodes {
            return &self.proxies[node.boxes.clone()];
        }
        self.gathered.clear();
        nodes.iter().for_each(|node| self.gathered.extend_from_slice(&self.proxies[node.boxes.clone()]));
        &self.gathered
    }

    /// A question that is answered for the first time.
    pub(super) fn close(&mut self, ticket: Ticket) -> Option<Asked> {
        let asked = self.asked.get_mut(ticket.0 as usize).filter(|asked| !asked.answered)?;
        asked.answered = true;
        self.open -= 1;
        Some(asked.clone())
    }

    /// A node that was asked about.
    pub(super) fn node(&self, node: usize) -> &Waiting {
        &self.nodes[node]
    }

    /// Whether some question has no answer yet.
    pub(super) fn is_open(&self) -> bool {
        self.open > 0
    }

    /// Whether a question is about more than one node.
    pub(super) fn is_multiquery(&self, question: usize) -> bool {
        self.asked[question].nodes.len() > 1
    }

    fn issued(&mut self, first: usize) -> Range<usize> {
        self.open += self.asked.len() - first;
        first..self.asked.len()
    }
}
