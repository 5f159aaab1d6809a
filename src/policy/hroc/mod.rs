//! *HROC*, hierarchical raster occlusion culling: Lee et al. 2021.
//!
//! What was visible is drawn; the subtrees that hold none of it are the occludee groups ([`extract`]).
//! Only their boxes are rasterised; where a sample of one passes, a ray goes down its subtree and finds
//! the objects that it meets ([`SweepTest::Rays`]). So what is hidden in large pieces costs one box a
//! piece, and no answer is waited for in between.
//!
//! # Where we differ
//!
//! - A leaf holds several objects: the others of an occluder's leaf, and what inner nodes hold
//!   themselves, are tested one by one.
//! - A group whose box holds the eye, or covers more than a share of the screen (`share`), is opened
//!   before rays are cast, on every backend: rays over the whole screen are what the paper names as its
//!   weakness.
//! - The occluders are those of V that pass the depth test while they are drawn (*O*), where the backend
//!   tells which these are (`by_geometry`). Elsewhere they are all of V in the frustum; without occluder
//!   filtering their boxes are swept, to find out which are still visible.
//!
//! [`extract`]: extract::Extraction

mod extract;

use super::Context;
use super::plan::{First, Plan, Targets, each_own};
use super::two_phase::TwoPhase;
use crate::Error;
use crate::dial::{self, Dial};
use crate::geom::{Projected, project};
use crate::query::SweepTest;
use crate::scene::ObjectId;
use crate::tree::NodeId;
use extract::Extraction;

/// Hierarchical raster occlusion culling.
pub type Hroc = TwoPhase<Groups>;

/// Occludee groups; see the module's documentation.
#[derive(Clone, Debug)]
pub struct Groups {
    /// A group that covers more of the screen is opened; 1 opens only what holds the eye.
    pub share: f32,
    extraction: Extraction,
    stack: Vec<NodeId>,
}

impl Default for Groups {
    fn default() -> Self {
        Self { share: 0.25, extraction: Extraction::default(), stack: Vec::new() }
    }
}

impl Plan for Groups {
    const NAME: &'static str = "hroc";
    const TEST: SweepTest = SweepTest::Rays;

    fn plan(&mut self, cx: &Context<'_>, first: &First, targets: &mut Targets) {
        self.extract(cx, first.objects.iter().copied());
        let Targets { groups, loose } = targets;
        self.emit(cx, |node| groups.push(node), |id| loose.extend(Some(id).filter(|&id| first.is_asked(id))));
    }

    fn dials(&self) -> Vec<Dial> {
        vec![share_dial(self.share)]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<bool, Error> {
        if key == "share" {
            self.share = dial::number(key, value, 0.0..=1.0)?;
        }
        Ok(key == "share")
    }
}

/// The dial of [`Groups::share`].
pub(super) fn share_dial(share: f32) -> Dial {
    Dial::new("share", share, "share of the screen from which a group is opened before rays are cast")
}

impl Groups {
    /// Finds the groups that these occluders leave.
    pub(super) fn extract(&mut self, cx: &Context<'_>, occluders: impl Iterator<Item = ObjectId>) {
        self.extraction.begin(cx.tree);
        for id in occluders {
            if let Some(node) = cx.tree.node_of(id.slot() as u32) {
                self.extraction.add_occluder(cx.tree, node);
            }
        }
    }

    /// Hands over the groups in the frustum, opened where they are too large, and the own objects of all
    /// that is visible or was opened.
    pub(super) fn emit(
        &mut self,
        cx: &Context<'_>,
        mut group: impl FnMut(NodeId),
        mut loose: impl FnMut(ObjectId),
    ) {
        let store = cx.scene.objects_store();
        let mut own = |node| each_own(cx, node, |slot| loose(store.id(slot)));
        self.extraction.visible().iter().for_each(|&node| own(node));
        self.stack.clear();
        self.stack.extend_from_slice(self.extraction.groups(cx.tree));
        while let Some(node) = self.stack.pop() {
            if cx.tree.count(node) == 0 || !cx.frustum.intersects(&cx.tree.bounds(node)) {
                continue;
            }
            if self.is_too_large(cx, node) {
                own(node);
                self.stack.extend(cx.tree.children(node).into_iter().flatten());
            } else {
                group(node);
            }
        }
    }

    fn is_too_large(&self, cx: &Context<'_>, node: NodeId) -> bool {
        let viewport = cx.view.viewport();
        let screen = viewport.width as f32 * viewport.height as f32;
        match project(&cx.tree.bounds(node), cx.view) {
            Projected::Outside => false,
            Projected::Near => true,
            Projected::Rect(rect) => rect.area() > self.share * screen,
        }
    }
}
