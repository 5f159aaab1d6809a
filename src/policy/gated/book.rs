//! What frames took, drawn whole and asking, and what a frame would take that were drawn whole.

use super::gate::Plan;
use crate::costs::FrameCost;

/// See the module's documentation.
#[derive(Clone, Debug, Default)]
pub(super) struct Book {
    /// Frames that asked, since the last trial began.
    pub(super) asking: Recent,
    /// Frames drawn whole, since the gate was last shut.
    pub(super) drawing_all: Recent,
    /// Of a frame drawn whole: seconds an object, and objects.
    object: Option<(f32, f32)>,
    /// Of the drawing of a frame that asks, seconds an object: lately, and when [`Book::object`]
    /// was still new. The first over the second says how much dearer objects have become since.
    drawing: Option<f32>,
    drawing_then: Option<f32>,
}

/// How many times the objects that it last drew whole it believes to know the cost of: what stands
/// near is dear by its samples, and says little of many objects far away.
const FURTHEST: f32 = 2.0;

impl Book {
    /// Enters what a frame took. What a verdict waits for counts alone.
    pub(super) fn enter(&mut self, plan: Plan, cost: FrameCost, is_verdict: bool) {
        let objects = cost.drawn.max(1) as f32;
        match plan {
            // A probe is no part of drawing; and the first frame, which has one, is like no other.
            Plan::Whole { probe: true } => {}
            Plan::Whole { probe: false } => {
                let each = cost.total / objects;
                let before = self.object.filter(|_| !is_verdict).map(|(each, _)| each);
                self.object = Some((smooth(before, each), objects));
                (self.drawing, self.drawing_then) = (None, None);
                self.drawing_all.push(cost.total);
            }
            Plan::Ask { .. } => {
                self.asking.push(cost.total);
                let drawing = smooth(self.drawing, cost.draw / objects);
                self.drawing = Some(drawing);
                self.drawing_then.get_or_insert(drawing);
            }
        }
    }

    /// What a frame took that drew so many objects and asked nothing, seconds. None before the first of
    /// which that is known.
    pub(super) fn whole(&self, objects: f32) -> Option<f32> {
        let (each, then) = self.object?;
        Some(each * objects.min(FURTHEST * then))
    }

    /// What it would take now: objects may have become dearer since. Of a policy that has settled.
    pub(super) fn whole_now(&self, objects: f32) -> Option<f32> {
        let dearer = match (self.drawing, self.drawing_then) {
            (Some(now), Some(then)) if then > 0.0 => (now / then).clamp(0.25, 4.0),
            _ => 1.0,
        };
        Some(self.whole(objects)? * dearer)
    }

    /// Whether nothing was ever entered.
    pub(super) fn is_empty(&self) -> bool {
        self.object.is_none() && self.asking.lately().is_none()
    }
}

fn smooth(before: Option<f32>, now: f32) -> f32 {
    const WEIGHT: f32 = 0.25;
    before.map_or(now, |before| before + WEIGHT * (now - before))
}

/// The last frames of a kind: medians, which a frame that was held up does not change.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recent {
    /// Seconds, the latest first.
    frames: [f32; KEPT],
    known: usize,
}

const KEPT: usize = 12;
/// Frames of which a median is taken.
const OF: usize = 4;

impl Recent {
    fn push(&mut self, seconds: f32) {
        self.frames.rotate_right(1);
        self.frames[0] = seconds;
        self.known = (self.known + 1).min(KEPT);
    }

    pub(super) fn clear(&mut self) {
        self.known = 0;
    }

    /// The median of the last four frames, or as many as there are.
    pub(super) fn lately(&self) -> Option<f32> {
        median(&self.frames[..self.known.min(OF)])
    }

    /// What a frame takes of the one before it, by the trend: 1 where it does not fall. None before
    /// there are two times four frames.
    pub(super) fn trend(&self) -> Option<f32> {
        let between = self.known.checked_sub(OF).filter(|&frames| frames >= OF)?;
        let before = median(&self.frames[between..self.known])?;
        Some((self.lately()? / before).min(1.0).powf(1.0 / between as f32))
    }

    /// Whether four frames are known at least.
    pub(super) fn is_settled(&self) -> bool {
        self.known >= OF
    }
}

/// Of an even number, the mean of the two in the middle.
fn median(frames: &[f32]) -> Option<f32> {
    let mut sorted = [0.0; OF];
    let sorted = &mut sorted[..frames.len()];
    sorted.copy_from_slice(frames);
    sorted.sort_by(f32::total_cmp);
    let last = frames.len().checked_sub(1)?;
    Some(0.5 * (sorted[last / 2] + sorted[last.div_ceil(2)]))
}
