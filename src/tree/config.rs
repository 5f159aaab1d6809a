//! The tree's dials.

use crate::Error;
use crate::dial::{self, Dial};

/// When a node's question is about the tight box of its objects instead of its cell
/// (Kovalčík & Tobola 2005, *TightBoxes*). The box of a straddle child is always tight: its cell
/// is its parent's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum TightBoxes {
    /// Never: the cell.
    Never,
    /// When nothing below the node has moved for `settle_frames`.
    Settled,
    /// Always: each frame's refit is used at once.
    Always,
}

/// Where the objects go that a splitting plane cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Straddlers {
    /// Into a third child that is never split further (the paper's ternary tree).
    Leaf,
    /// Into a third child that may be split along the other axes.
    Split,
    /// They stay in the inner node, as in the 2005 paper's baseline, a binary tree.
    StayInParent,
}

/// Which axis a split prefers. The other axes are tried when it does not separate anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitAxis {
    /// The longest side.
    Longest,
    /// The axis that points most along the view of the camera that voted, so that the halves lie
    /// one behind the other (Kovalčík & Tobola 2005).
    ViewAligned,
}

/// Where on its axis the splitting plane goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitPlane {
    /// Halfway through the cell, as published.
    Middle,
    /// Where the surface-area heuristic is least, the straddlers charged with the whole box: this
    /// prefers planes that cut few objects. It chooses the axis too.
    SurfaceArea,
}

/// How many objects make a leaf worth splitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeafSize {
    /// `o_split`, as published.
    Fixed,
    /// `o_split`, or more where questions are dear: see [`Tree::adapt`](super::Tree).
    FromCosts,
}

/// The dials of the ternary tree. Symbols as in Kovalčík & Tobola 2005.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeConfig {
    /// A leaf splits when `visible / total ≥ r_split` …
    pub r_split: f32,
    /// … and it holds at least this many objects.
    pub o_split: u32,
    /// Three sibling leaves merge when for each `visible / total ≤ r_merge` …
    pub r_merge: f32,
    /// … and each holds at most this many objects.
    pub o_merge: u32,
    /// Whether the costs that the views have seen raise `o_split`.
    pub leaf_size: LeafSize,
    /// Preferred axis of a split.
    pub axis: SplitAxis,
    /// Position of a split.
    pub plane: SplitPlane,
    /// What becomes of the objects that a plane cuts.
    pub straddlers: Straddlers,
    /// When questions use tight boxes.
    pub tight_boxes: TightBoxes,
    /// Frames without movement after which a node counts as settled.
    pub settle_frames: u32,
    /// Objects that the bulk build leaves in a leaf, at most, where they can be separated. A leaf
    /// that grows past four times as many is built anew.
    pub bulk_leaf: u32,
    /// The same, while no view has asked any question and the size of leaves follows the costs:
    /// then leaves need only be good for frustum tests and cheap to keep. From 50 000 objects on twice
    /// as many, up to four times as many from 100 000 on. The first view that
    /// asks makes the leaves as fine as `bulk_leaf` and the costs have them.
    pub unasked_leaf: u32,
    /// Frames that a node waits after a split before it may merge, and after a merge before it may
    /// split. 0: the published rule, which oscillates.
    pub cooldown: u32,
    /// Whether a merge is refused that would make a leaf fit to split again.
    pub merge_below_split: bool,
    /// Splits and merges a frame, at most, each.
    pub budget: u32,
    /// Frames without any evidence after which leaves that qualify by their counts merge.
    pub idle_frames: u32,
}

impl TreeConfig {
    /// The published rule: view-aligned middle planes, straddle leaves, tight boxes where
    /// settled, no hysteresis, no budget to speak of.
    pub const fn paper() -> Self {
        Self {
            r_split: 0.25,
            o_split: 12,
            r_merge: 0.75,
            o_merge: 5,
            leaf_size: LeafSize::Fixed,
            axis: SplitAxis::ViewAligned,
            plane: SplitPlane::Middle,
            straddlers: Straddlers::Leaf,
            tight_boxes: TightBoxes::Settled,
            settle_frames: 4,
            bulk_leaf: 12,
            unasked_leaf: 12,
            cooldown: 0,
            merge_below_split: false,
            budget: u32::MAX,
            idle_frames: 600,
        }
    }

    /// The default: leaves of one or two objects, as far as they can be told apart, or of more
    /// where asking costs more than drawing a few objects in vain; planes that cut few objects,
    /// straddlers split along the other axes, boxes always tight; hysteresis and a budget for
    /// what the votes change.
    pub const fn stable() -> Self {
        Self {
            r_split: 0.001,
            o_split: 2,
            r_merge: 0.0,
            o_merge: 2,
            leaf_size: LeafSize::FromCosts,
            axis: SplitAxis::Longest,
            plane: SplitPlane::SurfaceArea,
            straddlers: Straddlers::Split,
            tight_boxes: TightBoxes::Always,
            settle_frames: 4,
            bulk_leaf: 2,
            unasked_leaf: 512,
            cooldown: 30,
            merge_below_split: true,
            budget: 1024,
            idle_frames: 600,
        }
    }

    /// The binary tree of Bittner and Havran 2001: cells halved along their longest side, straddlers in
    /// inner nodes, questions about cells, which fill space. It is left as it is built.
    pub const fn binary() -> Self {
        Self {
            straddlers: Straddlers::StayInParent,
            tight_boxes: TightBoxes::Never,
            plane: SplitPlane::Middle,
            axis: SplitAxis::Longest,
            leaf_size: LeafSize::Fixed,
            bulk_leaf: 1,
            unasked_leaf: 1,
            ..Self::stable()
        }
    }

    /// Sets one dial by name, as `--set` does; `preset=paper` or `preset=stable` sets all.
    ///
    /// # Errors
    /// [`Error::Dial`] for a name or a value that does not exist, naming those that do.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "preset" => {
                *self = dial::choice(key, value, &[("paper", Self::paper()), ("stable", Self::stable())])?;
            }
            "r_split" => self.r_split = dial::number(key, value, 0.0..=1.0)?,
            "o_split" => self.o_split = dial::number(key, value, 2..=u32::MAX)?,
            "r_merge" => self.r_merge = dial::number(key, value, 0.0..=1.0)?,
            "o_merge" => self.o_merge = dial::number(key, value, 0..=u32::MAX)?,
            "leaf_size" => self.leaf_size = dial::choice(key, value, LEAF_SIZES)?,
            "axis" => self.axis = dial::choice(key, value, AXES)?,
            "plane" => self.plane = dial::choice(key, value, PLANES)?,
            "straddlers" => self.straddlers = dial::choice(key, value, STRADDLERS)?,
            "tight_boxes" => self.tight_boxes = dial::choice(key, value, TIGHT_BOXES)?,
            "settle_frames" => self.settle_frames = dial::number(key, value, 0..=u32::MAX)?,
            "bulk_leaf" => self.bulk_leaf = dial::number(key, value, 1..=1 << 20)?,
            "unasked_leaf" => self.unasked_leaf = dial::number(key, value, 1..=1 << 20)?,
            "cooldown" => self.cooldown = dial::number(key, value, 0..=u32::MAX)?,
            "merge_below_split" => self.merge_below_split = dial::switch(key, value)?,
            "budget" => self.budget = dial::number(key, value, 0..=u32::MAX)?,
            "idle_frames" => self.idle_frames = dial::number(key, value, 1..=u32::MAX)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }

    /// Every dial with its value.
    pub fn dials(&self) -> Vec<Dial> {
        vec![
            Dial::new("r_split", self.r_split, "visible share from which a leaf splits, 0 to 1"),
            Dial::new("o_split", self.o_split, "objects from which a leaf splits, at least 2"),
            Dial::new("r_merge", self.r_merge, "visible share up to which three leaves merge, 0 to 1"),
            Dial::new("o_merge", self.o_merge, "objects a leaf up to which three leaves merge"),
            Dial::choice("leaf_size", self.leaf_size, LEAF_SIZES, "what the size of leaves follows"),
            Dial::choice("axis", self.axis, AXES, "preferred axis of a split"),
            Dial::choice("plane", self.plane, PLANES, "position of a split"),
            Dial::choice("straddlers", self.straddlers, STRADDLERS, "where the objects go that a plane cuts"),
            Dial::choice("tight_boxes", self.tight_boxes, TIGHT_BOXES, "when questions use tight boxes"),
            Dial::new("settle_frames", self.settle_frames, "frames without movement until a node is settled"),
            Dial::new("bulk_leaf", self.bulk_leaf, "objects a leaf that the bulk build aims at"),
            Dial::new("unasked_leaf", self.unasked_leaf, "the same, until the first view that asks"),
            Dial::new(
                "cooldown",
                self.cooldown,
                "frames from a split to the earliest merge, and the reverse",
            ),
            Dial::new("merge_below_split", self.merge_below_split, "refuse merges that could split again"),
            Dial::new("budget", self.budget, "splits and merges a frame, at most"),
            Dial::new("idle_frames", self.idle_frames, "frames without evidence until small leaves merge"),
        ]
    }
}

const LEAF_SIZES: &[(&str, LeafSize)] = &[("fixed", LeafSize::Fixed), ("costs", LeafSize::FromCosts)];
const AXES: &[(&str, SplitAxis)] = &[("longest", SplitAxis::Longest), ("view", SplitAxis::ViewAligned)];
const PLANES: &[(&str, SplitPlane)] = &[("middle", SplitPlane::Middle), ("sah", SplitPlane::SurfaceArea)];
const STRADDLERS: &[(&str, Straddlers)] =
    &[("leaf", Straddlers::Leaf), ("split", Straddlers::Split), ("parent", Straddlers::StayInParent)];
pub(crate) const TIGHT_BOXES: &[(&str, TightBoxes)] =
    &[("never", TightBoxes::Never), ("settled", TightBoxes::Settled), ("always", TightBoxes::Always)];

impl Default for TreeConfig {
    fn default() -> Self {
        Self::stable()
    }
}
