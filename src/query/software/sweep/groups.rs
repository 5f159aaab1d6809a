//! Groups, one after the other: rasterise, then cast rays, or open.

use super::super::simd;
use super::field::{Field, Tally};
use super::group_raster::Rays;
use super::is_usable;
use crate::geom::{Aabb, PlaneMask, Proxy, Question};
use crate::tree::NodeId;

/// A group of no more objects is not asked about: its objects are.
pub(super) const FEW: usize = 2;

impl Field<'_> {
    /// Flags the objects in and below a node that pass. A group of which too much is in sight is
    /// opened: its children are groups of their own.
    pub(super) fn sweep_group(&self, node: NodeId, mask: PlaneMask, tally: &mut Tally) {
        if self.tree.count(node) <= FEW {
            return self.open(node, mask, tally);
        }
        tally.nodes += 1;
        match Question::of_group(&self.tree.bounds(node), self.sweep.view) {
            Question::Outside => {}
            Question::Ask(proxy) if is_usable(&proxy) => {
                let mut rays = Rays::NONE;
                simd::group_raster(self.simd, self.scene, &proxy, &mut rays);
                if rays.overflown {
                    self.open(node, mask, tally);
                } else if !rays.packets().is_empty() {
                    let count = |sum, packet: &super::group_raster::Packet| sum + packet.rays.count_ones();
                    tally.rays += u64::from(rays.packets().iter().fold(0, count));
                    self.cast_rays(node, mask, &rays, tally);
                }
            }
            Question::Visible | Question::Ask(_) => self.open(node, mask, tally),
        }
    }

    /// Whether something in or below a node may pass.
    pub(super) fn group_passes(&self, node: NodeId, by: impl FnOnce(&Proxy) -> bool) -> bool {
        match Question::of_group(&self.tree.bounds(node), self.sweep.view) {
            Question::Outside => false,
            Question::Visible => true,
            Question::Ask(proxy) => !is_usable(&proxy) || by(&proxy),
        }
    }

    /// Flags an object if its own proxy passes (ROC).
    pub(super) fn raster(&self, slot: u32, bounds: &Aabb) {
        if self.passes(bounds, |proxy| simd::any(self.simd, self.scene, proxy)) {
            self.flag(slot);
        }
    }

    fn open(&self, node: NodeId, mask: PlaneMask, tally: &mut Tally) {
        self.each_own(node, mask, |slot, bounds| {
            tally.tested += 1;
            self.raster(slot, bounds);
        });
        for (child, mask) in self.children(node, mask) {
            self.sweep_group(child, mask, tally);
        }
    }
}
