//! *Hybrid*, which Lee et al. 2021 propose for scenes in which things move: what stands still goes by
//! groups and rays ([`Hroc`](super::Hroc)), what moves by its own box ([`Roc`](super::Roc)).
//!
//! An object is *awake* from the update in which it came or moved until it has kept still for
//! `settle_frames` of the tree ([`awake`]). While it is awake it is no occluder that opens nodes, and
//! it is swept by itself, not below a group; so a crowd that runs through a hall tears no groups apart.
//! One sweep has both, so nothing falls between them in the frame in which it falls asleep or wakes.
//!
//! A scene in which nothing is awake has no movers in its sweeps; where nothing is settled, no group is
//! asked about.
//!
//! [`awake`]: awake::Awake

mod awake;

use super::Context;
use super::hroc::{Groups, share_dial};
use super::plan::{First, Plan, Targets};
use super::two_phase::TwoPhase;
use crate::dial::{self, Dial};
use crate::query::SweepTest;
use crate::{Counter, Error};
use awake::Awake;

/// Raster culling of movers, hierarchical raster culling of the rest.
pub type Hybrid = TwoPhase<MoversApart>;

/// Groups of what is settled, movers alone; see the module's documentation.
#[derive(Clone, Debug, Default)]
pub struct MoversApart {
    groups: Groups,
    awake: Awake,
}

impl Plan for MoversApart {
    const NAME: &'static str = "hybrid";
    const TEST: SweepTest = SweepTest::Rays;

    fn plan(&mut self, cx: &Context<'_>, first: &First, targets: &mut Targets) {
        let Self { groups, awake } = self;
        awake.look(cx);
        groups.extract(cx, first.objects.iter().copied().filter(|&id| !awake.contains(id)));
        let Targets { groups: asked, loose } = targets;
        groups.emit(
            cx,
            |node| asked.extend(Some(node).filter(|&node| awake.any_settled(cx, node))),
            |id| loose.extend(Some(id).filter(|&id| !awake.contains(id) && first.is_asked(id))),
        );
        loose.extend(awake.objects().iter().filter(|&&id| first.is_asked(id)));
    }

    fn counters(&self) -> Vec<Counter> {
        vec![Counter { key: "awake", count: self.awake.objects().len() as u32 }]
    }

    fn dials(&self) -> Vec<Dial> {
        vec![share_dial(self.groups.share)]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<bool, Error> {
        if key == "share" {
            self.groups.share = dial::number(key, value, 0.0..=1.0)?;
        }
        Ok(key == "share")
    }
}
