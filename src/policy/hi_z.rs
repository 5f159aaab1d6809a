//! *Hi-Z map* (Rákos 2010), between two phases: what was visible is drawn, a pyramid of farthest depths is
//! built over it, and the rectangle of every object in the frustum is compared with at most four of its
//! texels.
//!
//! It finds more than [`Roc`](super::Roc) does, and each test is shorter.

use super::Context;
use super::plan::{First, Plan, Targets, everything};
use super::two_phase::TwoPhase;
use crate::query::SweepTest;

/// Culling by the Hi-Z map.
pub type HiZ = TwoPhase<EveryRectangle>;

/// Every object's rectangle; see the module's documentation.
#[derive(Clone, Debug, Default)]
pub struct EveryRectangle;

impl Plan for EveryRectangle {
    const NAME: &'static str = "hi-z";
    const TEST: SweepTest = SweepTest::HiZ;

    fn plan(&mut self, cx: &Context<'_>, _: &First, targets: &mut Targets) {
        everything(cx, targets);
    }
}
