//! What a scene shows without being asked: how much of it moves, and how much is in view. A few objects
//! speak for all, other ones each frame.

use super::super::Context;
use crate::geom::Aabb;
use crate::scene::ObjectId;

/// Shares of the scene's objects, 0 to 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Signs {
    /// That move.
    pub(super) moving: f32,
    /// That meet the frustum.
    pub(super) in_view: f32,
    /// Where this frame's objects were, to be compared in the next.
    sample: Vec<(ObjectId, Aabb)>,
    /// The slot at which the next sample begins.
    at: usize,
}

/// Objects a frame.
const SAMPLE: usize = 64;
/// How much a new frame counts.
const WEIGHT: f32 = 0.125;
/// Steps between two slots of a sample: a large prime, so that they lie anywhere.
const STRIDE: usize = 2_654_435_761;

impl Signs {
    /// Looks at the frame's scene. O(1).
    pub(super) fn look(&mut self, cx: &Context<'_>) {
        let store = cx.scene.objects_store();
        let (mut same, mut moved) = (0, 0);
        for (id, before) in self.sample.drain(..) {
            // What is gone says nothing.
            match store.slot(id).and_then(|slot| cx.tree.aabb_of(slot)) {
                Some(now) if now == before => same += 1,
                Some(_) => moved += 1,
                None => {}
            }
        }
        approach(&mut self.moving, moved, same + moved);
        let slots = cx.scene.slot_bound();
        let mut inside = 0;
        for n in 0..SAMPLE.min(slots) {
            let slot = ((self.at + n).wrapping_mul(STRIDE) % slots) as u32;
            if let Some(bounds) = cx.tree.aabb_of(slot) {
                inside += usize::from(cx.frustum.intersects(&bounds));
                self.sample.push((store.id(slot), bounds));
            }
        }
        self.at = self.at.wrapping_add(SAMPLE);
        approach(&mut self.in_view, inside, self.sample.len());
    }
}

fn approach(share: &mut f32, part: usize, whole: usize) {
    if whole > 0 {
        *share += WEIGHT * (part as f32 / whole as f32 - *share);
    }
}
