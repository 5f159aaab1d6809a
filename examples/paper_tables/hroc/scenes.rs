//! The worlds after the paper's scenes, and the moving bunnies.

use super::published::{self, Published};
use support::flags::Flags;
use support::scenario::Scenario;

/// A world and the way through it.
pub struct Scene {
    /// In words.
    pub name: &'static str,
    build: fn(&Flags) -> anyhow::Result<Scenario>,
    /// What the paper measured in the scene that this one is after, if there is one.
    pub published: Option<&'static Published>,
}

/// In the order of the page.
pub const SCENES: [Scene; 6] = [
    Scene {
        name: "fantasy",
        build: |flags| Ok(Scenario::fantasy(flags)),
        published: Some(&published::FANTASY),
    },
    Scene {
        name: "factory",
        build: |flags| Ok(Scenario::factory(flags)),
        published: Some(&published::FACTORY),
    },
    Scene {
        name: "city",
        build: |flags| Ok(Scenario::city(flags, false)),
        published: Some(&published::CITY),
    },
    Scene {
        name: "city, at a run",
        build: |flags| Ok(Scenario::city(flags, true)),
        published: Some(&published::CITY_FAST),
    },
    Scene {
        name: "satellites",
        build: |flags| Ok(Scenario::satellites(flags)),
        published: Some(&published::SATELLITES),
    },
    Scene {
        name: "moving bunnies",
        build: |flags| {
            // As many for their plant as at full size.
            let objects = (flags.objects as f32 * flags.scale).round() as usize;
            Scenario::power_plant(&Flags { objects, ..flags.clone() }, true)
        },
        published: None,
    },
];

impl Scene {
    /// Makes the world.
    pub fn build(&self, flags: &Flags) -> anyhow::Result<Scenario> {
        (self.build)(flags)
    }
}
