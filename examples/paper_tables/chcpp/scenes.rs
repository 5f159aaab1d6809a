//! The city, which stands in for the paper's Vienna and Pompeii: along its streets, above its
//! roofs, and at a run.

use support::flags::Flags;
use support::scenario::{Flight, Scenario};

/// A way through the city.
#[derive(Clone, Copy)]
pub struct Scene {
    /// In words.
    pub name: &'static str,
    build: fn(&Flags) -> Scenario,
}

/// In the order of the page.
pub const SCENES: [Scene; 3] = [
    Scene {
        name: "street level",
        build: |flags| {
            let city = Scenario::city(flags, false);
            let end = take_off(&city.flight);
            city.part(0.0, end)
        },
    },
    Scene {
        name: "rising above the roofs",
        build: |flags| {
            let city = Scenario::city(flags, false);
            let start = take_off(&city.flight);
            city.part(start, 1.0)
        },
    },
    Scene { name: "at a run, with quick turns", build: |flags| Scenario::city(flags, true) },
];

impl Scene {
    /// Makes the world.
    pub fn build(&self, flags: &Flags) -> Scenario {
        Scenario { name: format!("city, {}", self.name), ..(self.build)(flags) }
    }
}

/// When a walk leaves the street for the air, 0 to 1.
fn take_off(flight: &Flight) -> f32 {
    /// Above all eyes on foot, metres.
    const HIGH: f32 = 2.0;
    const STEPS: u32 = 1000;
    let time = |n: u32| n as f32 / STEPS as f32;
    (0..STEPS).map(time).find(|&t| flight.pose(t).eye.y > HIGH).unwrap_or(1.0)
}
