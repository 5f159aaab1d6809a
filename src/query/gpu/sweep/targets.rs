//! What a sweep looks at: objects one by one, and groups into which rays are cast.
//!
//! # Whole screens
//!
//! Rays over the whole screen are what HROC is bad at, and a node that the device cannot place has them: one
//! that may hold the eye, and one whose errors in f32 are too large to say (`enclose.rs`). Policies open
//! groups that hold the eye, or cover more than their share of the screen, before they ask. What they find
//! out in f64 the device may not know in f32, and whoever sweeps without a policy may ask about anything. So
//! what the device may be unable to place is opened here, by the same rule on the host: its own objects are
//! looked at one by one, and its children in its stead. No ray is ever cast for it.

use glam::{DVec2, DVec3};

use super::boxes::FARTHEST;
use super::view::{SHARE, UNIT, is_askable};
use crate::geom::{Aabb, DepthDirection, PlaneMask, View};
use crate::query::Sweep;
use crate::scene::ObjectId;
use crate::tree::NodeId;

/// What one sweep looks at; memory is reused.
#[derive(Debug, Default)]
pub(super) struct Targets {
    /// Into which rays are cast.
    pub(super) groups: Vec<NodeId>,
    /// Objects that are looked at one by one.
    pub(super) ids: Vec<ObjectId>,
}

impl Targets {
    /// Lists what a sweep is about that meets the frustum; groups only if rays are to be cast. Else, and
    /// where a group is opened, those below them are found by walking down, with the planes that their nodes
    /// cross.
    pub(super) fn list(&mut self, sweep: &Sweep<'_>, by_rays: bool, stack: &mut Vec<(NodeId, PlaneMask)>) {
        let (tree, store, frustum) = (sweep.scene.tree(), sweep.scene.objects_store(), sweep.frustum);
        self.groups.clear();
        self.ids.clear();
        self.ids.extend(sweep.loose.iter().filter(|&&id| {
            let bounds = store.slot(id).and_then(|slot| tree.aabb_of(slot));
            bounds.is_some_and(|bounds| frustum.intersects(&bounds))
        }));
        stack.clear();
        stack.extend(sweep.groups.iter().map(|&group| (group, PlaneMask::ALL)));
        while let Some((node, mask)) = stack.pop() {
            if tree.count(node) == 0 {
                continue;
            }
            let bounds = tree.bounds(node);
            let Some(mask) = frustum.classify(&bounds, mask) else { continue };
            if by_rays && is_placed(&bounds, sweep.view) {
                self.groups.push(node);
                continue;
            }
            let inside = tree.own_inside(node, frustum, mask);
            self.ids.extend(inside.map(|(block, lane)| store.id(block.slots[lane])));
            stack.extend(tree.children(node).into_iter().flatten().map(|child| (child, mask)));
        }
    }
}

/// How many times the errors of an object's box are allowed for with a node's: the twin of the constant in
/// `shaders/sweep/enclose.wgsl`.
const ROOM: f64 = 3.0;

/// Whether the device is certain to find where the box of a node lies: if so, `enclose` in the shader does not
/// call it seen.
///
/// What the shader takes in f32 is taken in f64 here, by the same steps. Its corners err by less than a tenth
/// of what it allows for itself (`project.rs`), so an allowance that is a sixth larger, and limits a tenth
/// lower, are on the safe side of its own.
fn is_placed(aabb: &Aabb, view: &View) -> bool {
    let (low, high) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
    let magnitude = low.abs().max(high.abs());
    if !(magnitude.max_element() <= f64::from(FARTHEST) && is_askable(view)) {
        return false;
    }
    let error = view.clip_error(magnitude) * (ROOM * SHARE * 7.0 / 6.0);
    let viewport = view.viewport();
    let origin = DVec2::new(f64::from(viewport.x), f64::from(viewport.y));
    let size = DVec2::new(f64::from(viewport.width), f64::from(viewport.height));
    let half = 0.5 * size;
    let (mut least_w, mut near) = (f64::INFINITY, f64::INFINITY);
    let (mut first, mut last) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for k in 0..8 {
        let corner = DVec3::select(glam::BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low);
        let clip = *view.clip_from_world() * corner.extend(1.0);
        let before_near = match view.depth() {
            DepthDirection::Reversed => clip.w - clip.z,
            DepthDirection::Standard => clip.z,
        };
        (least_w, near) = (least_w.min(clip.w), near.min(before_near));
        let at = half + DVec2::new(half.x, -half.y) * DVec2::new(clip.x, clip.y) / clip.w;
        (first, last) = (first.min(at), last.max(at));
    }
    // Not what is greater, but what is not less: what is no number is not placed.
    if !(least_w > 4.0 * error.w && near > error.w + error.z) {
        return false;
    }
    let far_out = first.abs().max(last.abs());
    let snapped = ROOM * (DVec2::splat(2.0 / 16.0) + 40.0 * f64::from(UNIT) * (far_out + origin + size));
    let beside = (half + snapped).max((first - half).abs()).max((last - half).abs());
    let moved = (half * DVec2::new(error.x, error.y) + beside * error.w) / (least_w - error.w);
    let reach = snapped + moved + DVec2::splat(0.5);
    far_out.max_element() < 0.9e8 && reach.max_element() < 0.9 * 32.0
}
