//! Group raster (HROC, stage 3): the samples of a group's proxy that are in sight. Each will cast a ray.

use super::super::count::{Inquiry, Scene, Visit};
use super::super::isa::{Isa, Mask};
use crate::geom::Proxy;

/// Rays through the samples of a tile, a bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Packet {
    /// The tile's first pixel.
    pub(crate) at: [u32; 2],
    pub(crate) rays: Mask,
}

/// The rays of a group. There is room for so many packets that to follow each is cheaper than to ask
/// about the boxes below the group by themselves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rays {
    packets: [Packet; Self::ROOM],
    len: usize,
    /// There are more than there is room for.
    pub(crate) overflown: bool,
}

impl Rays {
    const ROOM: usize = 48;
    pub(crate) const NONE: Self =
        Self { packets: [Packet { at: [0; 2], rays: 0 }; Self::ROOM], len: 0, overflown: false };

    pub(crate) fn packets(&self) -> &[Packet] {
        &self.packets[..self.len]
    }

    /// Adds a packet; false if there is no room.
    #[inline(always)]
    pub(crate) fn push(&mut self, packet: Packet) -> bool {
        self.overflown = self.len == Self::ROOM;
        if !self.overflown {
            self.packets[self.len] = packet;
            self.len += 1;
        }
        !self.overflown
    }
}

/// Finds the samples of a proxy that are in sight, until there are too many.
#[inline(always)]
pub(crate) fn group_raster<I: Isa>(scene: Scene<'_>, proxy: &Proxy, rays: &mut Rays) {
    let Some(question) = Inquiry::<I>::new(scene, proxy) else { return };
    question.walk(
        #[inline(always)]
        |visit| match visit {
            Visit::Children { part, far, .. } => {
                part.open &= !I::gt_f(far, part.entry_most);
                true
            }
            Visit::Samples { visible: 0, .. } => true,
            Visit::Samples { at, visible, .. } => rays.push(Packet { at, rays: visible }),
        },
    );
}
