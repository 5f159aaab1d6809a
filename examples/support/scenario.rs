//! Worlds with a flight through them, for programs that run several.

use hecs::World;
use tercet::geom::View;
use tercet::worlds::{self, CameraPath, Swarm, power_plant, teapots};

use super::flags::Flags;

/// Nothing is drawn that is nearer to the eye, metres.
const NEAR: f32 = 0.1;

/// A world, what moves in it, and a camera's way through it.
pub struct Scenario {
    /// In words.
    pub name: String,
    /// As the app has it.
    pub world: World,
    /// What moves, if anything does.
    pub swarm: Option<Swarm>,
    /// The camera's way.
    pub flight: CameraPath,
}

impl Scenario {
    /// The power plant of [`worlds::power_plant()`] with `flags.objects` bunnies in it.
    pub fn power_plant(flags: &Flags, moving: bool) -> anyhow::Result<Self> {
        let mut scenario = Self::power_plant_alone(flags);
        let room = power_plant::interior(flags.scale);
        let bunnies = Swarm::new(flags.seed, flags.objects, worlds::bunny_mesh()?, room);
        bunnies.spawn(&mut scenario.world);
        scenario.name = format!("power plant + {} {} bunnies", flags.objects, manner(moving));
        scenario.swarm = moving.then_some(bunnies);
        Ok(scenario)
    }

    /// The same without bunnies.
    pub fn power_plant_alone(flags: &Flags) -> Self {
        let mut world = World::new();
        worlds::power_plant(flags.seed, flags.scale).spawn(&mut world);
        let flight = power_plant::path(flags.scale);
        Self { name: "power plant alone".to_owned(), world, swarm: None, flight }
    }

    /// The cloud of [`teapots`] with `flags.objects` of them.
    pub fn teapots(flags: &Flags, moving: bool) -> Self {
        let count = flags.objects;
        let cloud = Swarm::new(flags.seed, count, worlds::teapot_mesh(), teapots::room(count));
        let mut world = World::new();
        cloud.spawn(&mut world);
        Self {
            name: format!("{count} {} teapots", manner(moving)),
            world,
            swarm: moving.then_some(cloud),
            flight: teapots::path(count),
        }
    }

    /// Moves what moves on by a frame.
    pub fn step(&mut self) {
        if let Some(swarm) = &self.swarm {
            swarm.step(&mut self.world, Swarm::STEP);
        }
    }

    /// The view of one frame of `flags.frames`.
    pub fn view(&self, frame: u32, flags: &Flags) -> anyhow::Result<View> {
        let t = flags.flight_end()? * frame as f32 / (flags.frames - 1).max(1) as f32;
        let pose = self.flight.pose(t);
        Ok(View::look_at(pose.eye, pose.target, pose.fov_y_degrees, NEAR, flags.viewport())?)
    }
}

fn manner(moving: bool) -> &'static str {
    if moving { "moving" } else { "static" }
}
