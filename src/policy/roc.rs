//! *ROC*, raster occlusion culling (2014), as Lee et al. 2021 compare with it: what was visible is drawn,
//! then the box of every object in the frustum is rasterised by itself.

use super::Context;
use super::plan::{First, Plan, Targets, everything};
use super::two_phase::TwoPhase;
use crate::query::SweepTest;

/// Raster occlusion culling.
pub type Roc = TwoPhase<EveryBox>;

/// Every object's own box; see the module's documentation.
#[derive(Clone, Debug, Default)]
pub struct EveryBox;

impl Plan for EveryBox {
    const NAME: &'static str = "roc";
    const TEST: SweepTest = SweepTest::Raster;

    fn plan(&mut self, cx: &Context<'_>, _: &First, targets: &mut Targets) {
        everything(cx, targets);
    }
}
