//! What a policy of two phases asks about: all in which ROC, HROC, Hi-Z and the hybrid differ.

use std::fmt::Debug;

use super::Context;
use crate::dial::Dial;
use crate::geom::PlaneMask;
use crate::query::SweepTest;
use crate::scene::{ObjectId, ObjectSet};
use crate::tree::NodeId;
use crate::{Counter, Error};

/// What a policy of two phases asks about.
pub trait Plan: Debug + Default + Send + Sync {
    /// The policy's name.
    const NAME: &'static str;

    /// How the sweep tests.
    const TEST: SweepTest;

    /// Chooses what the sweep is about. The objects of the first phase are drawn already; whoever wants
    /// to know which of them are still visible adds them.
    fn plan(&mut self, cx: &Context<'_>, first: &First, targets: &mut Targets);

    /// See [`Policy::counters`](super::Policy::counters).
    fn counters(&self) -> Vec<Counter> {
        Vec::new()
    }

    /// See [`Policy::dials`](super::Policy::dials).
    fn dials(&self) -> Vec<Dial> {
        Vec::new()
    }

    /// Sets a dial by name; false if there is none of that name.
    ///
    /// # Errors
    /// [`Error::Dial`] for a value that it does not take.
    fn set(&mut self, _key: &str, _value: &str) -> Result<bool, Error> {
        Ok(false)
    }
}

/// The objects of the first phase.
#[derive(Clone, Debug, Default)]
pub struct First {
    /// Those that were drawn, in the order of drawing.
    pub objects: Vec<ObjectId>,
    /// The same, and those that were left out because nothing of them showed.
    pub set: ObjectSet,
    /// Whether the sweep must say which of them are still visible: nobody else will.
    pub retest: bool,
}

impl First {
    /// Whether there is something to find out about an object.
    pub fn is_asked(&self, id: ObjectId) -> bool {
        self.retest || !self.set.contains(id)
    }
}

/// What a sweep is about.
#[derive(Clone, Debug, Default)]
pub struct Targets {
    /// Nodes, none of them below another.
    pub groups: Vec<NodeId>,
    /// Objects that are tested by themselves.
    pub loose: Vec<ObjectId>,
}

/// Every object, unless none can be in view: then nothing is swept.
pub(super) fn everything(cx: &Context<'_>, targets: &mut Targets) {
    let root = cx.tree.root();
    if cx.tree.count(root) > 0 && cx.frustum.intersects(&cx.tree.bounds(root)) {
        targets.groups.push(root);
    }
}

/// The own objects of a node that meet the frustum, by slot.
pub(super) fn each_own(cx: &Context<'_>, node: NodeId, mut found: impl FnMut(u32)) {
    let Some(mask) = cx.frustum.classify(&cx.tree.bounds(node), PlaneMask::ALL) else { return };
    cx.tree.own_inside(node, cx.frustum, mask).for_each(|(block, lane)| found(block.slots[lane]));
}
