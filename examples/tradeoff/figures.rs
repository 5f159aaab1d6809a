//! What a setting costs and loses, added up from its frames.

use std::collections::HashMap;

use hecs::Entity;
use serde::{Deserialize, Serialize};

use support::lockstep::Measured;
use support::report::{FrameRecord, round};

/// A setting's figures: a line of the resume file, and of the tables. Shares are of 1, and of all
/// samples of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The median frame, milliseconds.
    pub median_ms: f64,
    /// Its time over the base's in the same batch: the median of the ratios frame by frame.
    pub time_ratio: f64,
    /// By how much the base's two copies in the same batch differ in time, over the lesser.
    pub noise: f64,
    /// Wrong samples, the mean frame.
    pub wrong_mean: f64,
    /// Wrong samples, the worst frame.
    pub wrong_worst: f64,
    /// The longest run of frames in which one and the same object was wrongly missing.
    pub longest_run: u32,
    /// The largest object lost in any frame: of how many samples of the finished frame it is the nearest.
    pub largest_lost: u32,
    /// Objects wrongly missing, the sum over the frames.
    pub lost: u64,
    /// Samples that show another object only because of the level of detail, the mean frame.
    pub detail_mean: f64,
    /// Objects drawn, the mean frame.
    pub drawn: f64,
    /// Objects in the exact set, the mean frame.
    pub exact: f64,
    /// Objects drawn beyond the exact set, the mean frame.
    pub extra: f64,
    /// Questions, the mean frame.
    pub queries: f64,
    /// Triangles drawn, the mean frame.
    pub triangles: f64,
}

impl Figures {
    /// The figures of a lane that `base` ran beside, for frames of so many samples. `base` are the times
    /// of its frames, and the noise in them.
    pub fn new(lane: &Measured, (base_ms, noise): (&[f64], f64), samples: f64) -> Self {
        let frames = &lane.frames;
        let mean = |figure: fn(&FrameRecord) -> f64| {
            frames.iter().map(figure).sum::<f64>() / frames.len().max(1) as f64
        };
        let wrong = |f: &FrameRecord| f.wrong_pixels.unwrap_or(0) as f64;
        let sizes = frames.iter().flat_map(|f| f.lost.iter().map(|(_, samples)| *samples));
        let lost_by_frame = frames.iter().map(|f| f.lost.iter().map(|(entity, _)| *entity));
        Self {
            median_ms: lane.summary.frame_ms.median,
            time_ratio: round(lane.time_over(base_ms.iter().copied())),
            noise: round(noise),
            wrong_mean: mean(wrong) / samples,
            wrong_worst: frames.iter().map(wrong).fold(0.0, f64::max) / samples,
            longest_run: longest_run(lost_by_frame),
            largest_lost: sizes.max().unwrap_or(0),
            lost: frames.iter().map(|f| f.lost.len() as u64).sum(),
            detail_mean: mean(|f| f.detail_pixels.unwrap_or(0) as f64) / samples,
            drawn: round(mean(|f| f.drawn.into())),
            exact: round(mean(|f| f.exact_visible.unwrap_or(0).into())),
            // What was drawn of the exact set is all of it but what was lost.
            extra: round(mean(|f| {
                f64::from(f.drawn) + f.lost.len() as f64 - f64::from(f.exact_visible.unwrap_or(0))
            })),
            queries: round(mean(|f| f.queries.into())),
            triangles: round(mean(|f| f.drawn_triangles as f64)),
        }
    }

    /// All that is wrong in a mean frame, whether an object is missing or drawn too coarsely: the greatest
    /// share that it can be.
    pub fn error(&self) -> f64 {
        self.wrong_mean + self.detail_mean
    }

    /// Objects drawn beyond the exact set, over that set.
    pub fn extra_ratio(&self) -> f64 {
        if self.exact > 0.0 { self.extra / self.exact } else { 0.0 }
    }
}

/// The times of two copies of the same lane as one, frame by frame, and by how much they differ.
pub fn base_of(a: &Measured, b: &Measured) -> (Vec<f64>, f64) {
    let times = a.times().zip(b.times()).map(|(a, b)| 0.5 * (a + b)).collect();
    let ratio = a.time_over(b.times());
    (times, ratio.max(1.0 / ratio) - 1.0)
}

/// The longest run of frames that one entity is in.
fn longest_run(frames: impl Iterator<Item = impl Iterator<Item = Entity>>) -> u32 {
    let mut runs: HashMap<Entity, u32> = HashMap::new();
    let mut longest = 0;
    for frame in frames {
        let next: HashMap<_, _> =
            frame.map(|entity| (entity, runs.get(&entity).map_or(1, |run| run + 1))).collect();
        runs = next;
        longest = runs.values().copied().fold(longest, u32::max);
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entities<const N: usize>() -> [Entity; N] {
        let mut world = hecs::World::new();
        std::array::from_fn(|_| world.spawn(()))
    }

    #[test]
    fn a_run_is_one_object_s_and_ends_when_it_is_drawn() {
        let [a, b, c] = entities();
        let run = |frames: &[&[Entity]]| longest_run(frames.iter().map(|frame| frame.iter().copied()));
        assert_eq!(run(&[]), 0);
        assert_eq!(run(&[&[], &[]]), 0);
        assert_eq!(run(&[&[a], &[b], &[c]]), 1, "three objects, a frame each");
        assert_eq!(run(&[&[a, b], &[b], &[], &[a], &[a, b]]), 2, "it starts anew after a frame without");
        assert_eq!(run(&[&[b], &[c, a], &[a, b], &[a], &[]]), 3);
    }

    #[test]
    fn a_reused_slot_is_another_object() {
        let mut world = hecs::World::new();
        let first = world.spawn(());
        world.despawn(first).expect("it is there");
        let second = world.spawn(());
        assert_eq!(first.id(), second.id());
        assert_eq!(longest_run([[first], [second]].into_iter().map(IntoIterator::into_iter)), 1);
    }
}
