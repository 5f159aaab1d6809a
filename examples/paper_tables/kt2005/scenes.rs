//! The five scenes, and what the paper measured in them.

use support::flags::Flags;
use support::scenario::Scenario;

/// A scene of table 1.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    build: fn(&Flags) -> anyhow::Result<Scenario>,
    /// What the paper measured with the new algorithm.
    pub new: Published,
    /// What the paper measured with the old one.
    pub old: Published,
}

/// A cell of table 1, measured on an Athlon MP 2600+ with a GeForce 6800 GT.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// The whole fly-through.
    pub seconds: f64,
    /// Objects drawn a frame.
    pub drawn: f64,
    /// Questions a frame.
    pub queries: f64,
}

impl Scene {
    /// Makes the world.
    pub fn build(&self, flags: &Flags) -> anyhow::Result<Scenario> {
        (self.build)(flags)
    }
}

const fn published(seconds: f64, drawn: f64, queries: f64) -> Published {
    Published { seconds, drawn, queries }
}

/// Table 1, row by row.
pub const SCENES: [Scene; 5] = [
    Scene {
        build: |flags| Scenario::power_plant(flags, true),
        new: published(394.0, 408.0, 103.0),
        old: published(557.0, 812.0, 27.0),
    },
    Scene {
        build: |flags| Scenario::power_plant(flags, false),
        new: published(152.0, 276.0, 92.0),
        old: published(422.0, 747.0, 26.0),
    },
    Scene {
        build: |flags| Ok(Scenario::power_plant_alone(flags)),
        new: published(135.0, 272.0, 91.0),
        old: published(249.0, 656.0, 25.0),
    },
    Scene {
        build: |flags| Ok(Scenario::teapots(flags, flags.objects, true)),
        new: published(27.0, 2289.0, 59.0),
        old: published(29.0, 2474.0, 38.0),
    },
    Scene {
        build: |flags| Ok(Scenario::teapots(flags, flags.objects, false)),
        new: published(22.0, 1884.0, 96.0),
        old: published(24.0, 2135.0, 47.0),
    },
];
