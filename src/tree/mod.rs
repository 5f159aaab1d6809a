//! Where it is: the adaptive ternary tree (Kovalčík & Tobola 2005).
//!
//! A node has no children or three: the two halves of its cell, and a third for the objects that
//! the splitting plane cuts. Objects lie wholly in the cell of their node, in runs of blocks of
//! sixteen boxes (`blocks`). Edits are noted; an update takes them over (`refit`), moves and places
//! objects (`place`), builds what has grown too full (`build`) and brings boxes and stamps up to
//! date; votes split and merge leaves (`adapt`). Until a view asks about nodes, leaves stay coarse.

mod adapt;
mod block;
mod blocks;
mod build;
mod compact;
mod config;
mod gather;
mod hull;
mod log;
mod node;
mod place;
mod refit;
mod refresh;
mod runs;
mod settle;
mod split;
mod stale;
mod traverse;
mod validate;
mod visit;

pub use adapt::{Vote, Votes};
pub use block::{Block, LANES};
pub(crate) use config::TIGHT_BOXES;
pub use config::{LeafSize, SplitAxis, SplitPlane, Straddlers, TightBoxes, TreeConfig};
pub use log::Edit;
pub(crate) use log::EditLog;
pub use node::{NodeId, Role};
pub use traverse::NodeInfo;
pub use visit::Walk;

use crate::geom::Aabb;
use blocks::Blocks;
pub(crate) use blocks::{Newest, grow};
use node::Nodes;
use refit::Dirty;

/// Counters of the tree: sizes now, and events since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TreeStats {
    /// Nodes alive.
    pub nodes: usize,
    /// Depth of the deepest leaf; 0 for a root alone. O(nodes).
    pub depth: usize,
    /// Leaves split, by votes or by the bulk build.
    pub splits: u64,
    /// Sibling triples merged.
    pub merges: u64,
    /// Objects that changed their node.
    pub moves: u64,
    /// Votes that undid a split or merge of less than [`Tree::FLIP_FRAMES`] ago.
    pub flips: u64,
}

/// The ternary tree over object slots and their boxes.
#[derive(Clone, Debug)]
pub struct Tree {
    config: TreeConfig,
    nodes: Nodes,
    blocks: Blocks,
    log: EditLog,
    stats: TreeStats,
    /// Counts updates; stamps of nodes compare with it.
    tick: u32,
    /// Reused by each refresh: blocks in which objects have moved.
    stale: Vec<u32>,
    /// Reused by each refresh: nodes of those blocks, and how many objects of each have moved.
    touched: Vec<(u32, u32)>,
    /// Objects whose new box their node does not hold.
    leavers: Vec<u32>,
    /// Objects that have no node yet; some may have been removed since.
    arrivals: Vec<u32>,
    /// How many have no node yet.
    waiting: usize,
    /// Nodes to refit, by depth.
    dirty: Dirty,
    /// Leaves that have grown past the bulk build's aim.
    crowded: Vec<u32>,
    /// Inner nodes that may have become superfluous.
    thinned: Vec<u32>,
    /// `O_split` as the costs have it.
    o_split: u32,
    /// Whether any view has asked a question so far.
    asked: bool,
    /// Where the search for idle leaves goes on.
    idle_cursor: usize,
    /// Reused by builds, splits and merges.
    scratch: Vec<split::Item>,
    /// Reused as the root grows: nodes that took its content.
    wrapped: Vec<u32>,
    /// Reused as the root grows and shrinks: nodes whose depth is to be set.
    deepening: Vec<(u32, u16)>,
    /// Reused by builds: what is still to be split.
    stack: Vec<build::Task>,
}

impl Tree {
    /// A split and a merge of the same node within this many updates count as a flip.
    pub const FLIP_FRAMES: u32 = 60;

    /// An empty tree.
    pub fn new(config: TreeConfig) -> Self {
        Self {
            o_split: config.o_split,
            asked: false,
            config,
            nodes: Nodes::with_root(),
            blocks: Blocks::default(),
            log: EditLog::default(),
            stats: TreeStats::default(),
            tick: 1,
            stale: Vec::new(),
            touched: Vec::new(),
            leavers: Vec::new(),
            arrivals: Vec::new(),
            waiting: 0,
            dirty: Dirty::default(),
            crowded: Vec::new(),
            thinned: Vec::new(),
            idle_cursor: 0,
            scratch: Vec::new(),
            wrapped: Vec::new(),
            deepening: Vec::new(),
            stack: Vec::new(),
        }
    }

    /// A tree without objects that goes on where this one is: it has been asked what this one has.
    pub(crate) fn emptied(&self) -> Self {
        Self { asked: self.asked, o_split: self.o_split, ..Self::new(self.config.clone()) }
    }

    /// The dials.
    pub fn config(&self) -> &TreeConfig {
        &self.config
    }

    /// Counters. O(nodes), for the depth.
    pub fn stats(&self) -> TreeStats {
        let depth = self.nodes().map(|n| n.depth as usize).max().unwrap_or(0);
        TreeStats { nodes: self.nodes.len(), depth, ..self.stats }
    }

    /// Objects in the tree.
    pub fn len(&self) -> usize {
        self.nodes.below[0] as usize + self.waiting
    }

    /// Whether it holds no object.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of updates so far.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// The box of an object slot, if the tree holds it. O(1).
    pub fn aabb_of(&self, slot: u32) -> Option<Aabb> {
        self.blocks.aabb_of(slot)
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.bytes() + self.blocks.bytes()
    }

    /// What changed in the tree's shape, for histories that follow it.
    pub(crate) fn log(&self) -> &EditLog {
        &self.log
    }
}
