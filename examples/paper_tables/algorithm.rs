//! What a table compares: policies by name, with their dials.

use plotters::style::RGBColor;
use tercet::policy;

use support::flags::Flags;
use support::lockstep::Lane;
use support::stage::Stage;

/// A policy with its dials.
pub struct Algorithm {
    /// As the paper calls it.
    pub name: &'static str,
    /// Of its curves.
    pub color: RGBColor,
    /// As `--policy` calls it.
    pub policy: &'static str,
    /// Those that are not at their defaults.
    pub dials: &'static [(&'static str, &'static str)],
}

impl Algorithm {
    /// One that has seen nothing yet, on the software backend. Its own dials come after those of the
    /// command line.
    pub fn lane(&self, flags: &Flags) -> anyhow::Result<Lane> {
        self.lane_on(Stage::software(flags.detail()?), flags)
    }

    /// The same on a backend that draws as finely as the flags say.
    pub fn lane_on(&self, stage: Stage, flags: &Flags) -> anyhow::Result<Lane> {
        let mut policy = policy::by_name(self.policy)?;
        flags.turn(&mut *policy)?;
        for (key, value) in self.dials {
            policy.set(key, value)?;
        }
        Lane::on(stage, flags, policy, flags.tree()?)
    }
}
