//! What a sweep over random boxes met.

use std::ops::{Add, AddAssign};

/// Counts, which add up.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) cases: u64,
    /// Boxes with a point that the view shows, among those looked at.
    pub(super) shown: u64,
    /// Boxes that lie wholly beyond one plane, exactly; and how many of those each routine keeps.
    pub(super) beyond: u64,
    pub(super) beyond_kept: [u64; 3],
    /// Boxes that lie wholly ahead of eye and near plane and meet the view; and how many of those are
    /// not projected, or not asked about.
    pub(super) ahead: u64,
    pub(super) ahead_near: u64,
    pub(super) ahead_unasked: u64,
    /// Rectangles, and those that are wider than the exact one on some side by more than a quarter of a
    /// pixel, by more than one.
    pub(super) rects: u64,
    pub(super) wide: [u64; 2],
    pub(super) asked: u64,
    /// Pixel centres within r of a point that is shown.
    pub(super) samples: u64,
    pub(super) faults: u64,
}

impl Add for Tally {
    type Output = Self;

    fn add(mut self, o: Self) -> Self {
        self += o;
        self
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, o: Self) {
        self.cases += o.cases;
        self.shown += o.shown;
        self.beyond += o.beyond;
        (0..3).for_each(|i| self.beyond_kept[i] += o.beyond_kept[i]);
        self.ahead += o.ahead;
        self.ahead_near += o.ahead_near;
        self.ahead_unasked += o.ahead_unasked;
        self.rects += o.rects;
        (0..2).for_each(|i| self.wide[i] += o.wide[i]);
        self.asked += o.asked;
        self.samples += o.samples;
        self.faults += o.faults;
    }
}
