//! Per-pixel ray casting (HROC, stage 3): the rays of a group go down its subtree.
//!
//! A ray is a sample of the screen with the depth that is stored there. It meets a box if the box's
//! proxy covers the sample with an entry nearness that is not below that depth: it does not stop at the
//! nearest one. Sixteen rays, those of a tile, go side by side; all rays of a group visit a node
//! together, so each object is looked at once.

use super::super::count::{Inquiry, Scene};
use super::super::isa::Isa;
use super::super::simd;
use super::field::{Field, Tally};
use super::group_raster::{Packet, Rays};
use super::groups::FEW;
use crate::geom::{PixelRect, PlaneMask, Proxy, Question};
use crate::tree::NodeId;

impl Field<'_> {
    /// Flags the objects in and below a node that some ray meets.
    pub(super) fn cast_rays(&self, node: NodeId, mask: PlaneMask, rays: &Rays, tally: &mut Tally) {
        self.each_own(node, mask, |slot, bounds| {
            tally.tested += 1;
            let meets = |proxy: &Proxy| simd::meets(self.simd, self.scene, proxy, rays.packets());
            if self.passes(bounds, meets) {
                self.flag(slot);
            }
        });
        for (child, mask) in self.children(node, mask) {
            if self.tree.count(child) <= FEW {
                self.cast_rays(child, mask, rays, tally);
                continue;
            }
            tally.nodes += 1;
            match Question::of_group(&self.tree.bounds(child), self.sweep.view) {
                Question::Outside => {}
                Question::Ask(proxy) if super::is_usable(&proxy) => {
                    let mut met = Rays::NONE;
                    simd::those_that_meet(self.simd, self.scene, &proxy, rays.packets(), &mut met);
                    if !met.packets().is_empty() {
                        self.cast_rays(child, mask, &met, tally);
                    }
                }
                Question::Visible | Question::Ask(_) => self.cast_rays(child, mask, rays, tally),
            }
        }
    }
}

/// Whether some ray meets a box.
#[inline(always)]
pub(crate) fn meets<I: Isa>(scene: Scene<'_>, proxy: &Proxy, rays: &[Packet]) -> bool {
    let Some(question) = Inquiry::<I>::new(scene, proxy) else { return false };
    let mut on_it = rays.iter().filter(|packet| touches(&proxy.rect, packet));
    on_it.any(|packet| question.samples(packet.at[0], packet.at[1]).0 & packet.rays != 0)
}

/// Those rays that meet a box.
#[inline(always)]
pub(crate) fn those_that_meet<I: Isa>(scene: Scene<'_>, proxy: &Proxy, rays: &[Packet], met: &mut Rays) {
    let Some(question) = Inquiry::<I>::new(scene, proxy) else { return };
    for packet in rays.iter().filter(|packet| touches(&proxy.rect, packet)) {
        let rays = question.samples(packet.at[0], packet.at[1]).0 & packet.rays;
        if rays != 0 {
            met.push(Packet { rays, ..*packet });
        }
    }
}

/// Whether a tile shares a pixel with a rectangle.
#[inline(always)]
fn touches(rect: &PixelRect, packet: &Packet) -> bool {
    let [x, y] = packet.at;
    x < rect.x1 && y < rect.y1 && x + 4 > rect.x0 && y + 4 > rect.y0
}
