//! A world, and what all trees measured in it.

use crate::plan::Plan;
use support::lockstep::Measured;
use support::report::{Summary, percentile};

/// What the sweep found in a world.
pub struct Outcome {
    /// The world's, in words.
    pub name: String,
    /// By tree of the [`Plan`].
    lanes: Vec<Measured>,
    /// The base's time of each frame, milliseconds: the median of its copies.
    base_ms: Vec<f64>,
}

impl Outcome {
    /// What the lanes of a plan's trees measured, in their order.
    pub fn new(name: String, lanes: Vec<Measured>) -> Self {
        let copies = &lanes[..Plan::COPIES];
        let of_frame = |n: usize| copies.iter().map(|copy| copy.frames[n].frame_ms).collect::<Vec<_>>();
        let base_ms = (0..lanes[0].frames.len()).map(|n| percentile(&of_frame(n), 50.0)).collect();
        Self { name, lanes, base_ms }
    }

    /// A tree's figures.
    pub fn summary(&self, tree: usize) -> &Summary {
        &self.lanes[tree].summary
    }

    /// What a tree drew over what the base drew.
    pub fn drawn_of_base(&self, tree: usize) -> f64 {
        let drawn = |tree: usize| self.summary(tree).drawn.mean;
        if drawn(0) > 0.0 { drawn(tree) / drawn(0) } else { 1.0 }
    }

    /// A tree's time over the base's: the median of the ratios frame by frame.
    pub fn time_of_base(&self, tree: usize) -> f64 {
        self.lanes[tree].time_over(self.base_ms.iter().copied())
    }

    /// Objects wrongly culled in any frame by any tree, if the oracle looked.
    pub fn false_culls(&self) -> Option<u64> {
        self.lanes.iter().map(|lane| lane.summary.false_culls).sum()
    }

    /// By how much the base's copies differ in what they drew, over the least.
    pub fn drawn_noise(&self) -> f64 {
        self.noise(|a, b| a.summary.drawn.mean / b.summary.drawn.mean.max(1.0))
    }

    /// By how much the base's copies differ in time, over the least.
    pub fn time_noise(&self) -> f64 {
        self.noise(|a, b| a.time_over(b.times()))
    }

    /// The greatest ratio of two copies, less 1.
    fn noise(&self, ratio: impl Fn(&Measured, &Measured) -> f64) -> f64 {
        let copies = &self.lanes[..Plan::COPIES];
        let ratios = copies.iter().flat_map(|a| copies.iter().map(|b| ratio(a, b)));
        ratios.fold(1.0, f64::max) - 1.0
    }
}
