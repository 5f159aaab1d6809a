//! The ways that are walked: always the same metres, in more or fewer frames.

use support::flags::Flags;
use support::scenario::{Flight, Scenario};

/// A way through a world, and what the paper measured on its own.
#[derive(Clone, Copy)]
pub struct Walk {
    /// In words.
    pub name: &'static str,
    build: fn(&Flags) -> Scenario,
    /// The part of the world's flight that is walked.
    part: (f32, f32),
    /// Questions that B, C and D saved of A's in one of the paper's scenes, 0 to 1. The scenes are
    /// not ours: the first stands beside the first.
    pub published: [f64; 3],
}

/// In the order of the page.
pub const WALKS: [Walk; 2] = [
    // From the door on.
    Walk {
        name: "power plant",
        build: Scenario::power_plant_alone,
        part: (0.4, 0.7),
        published: [0.47, 0.50, 0.67],
    },
    // Along a street and around a corner.
    Walk {
        name: "city",
        build: |flags| Scenario::city(flags, false),
        part: (0.2, 0.4),
        published: [0.49, 0.51, 0.72],
    },
];

impl Walk {
    /// Makes the world.
    pub fn build(&self, flags: &Flags) -> Scenario {
        (self.build)(flags).part(self.part.0, self.part.1)
    }
}

/// The frames of a walk at a speed: at that of the table, `--frames` steps.
pub fn frames(flags: &Flags, speed: f64) -> u32 {
    (f64::from(flags.frames) / speed).round().max(1.0) as u32 + 1
}

/// Metres from frame to frame, the mean.
pub fn step(flight: &Flight, flags: &Flags) -> f64 {
    let steps = flags.frames - 1;
    let eye = |n: u32| flight.pose(n as f32 / steps as f32).eye;
    (0..steps).map(|n| f64::from(eye(n).distance(eye(n + 1)))).sum::<f64>() / f64::from(steps)
}
