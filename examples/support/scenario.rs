//! Worlds with a flight through them: what the demos fly through, and programs that compare.

use hecs::World;
use tercet::geom::{View, Viewport};
use tercet::worlds::{
    self, CameraPath, Pose, Swarm, city, factory, fantasy, power_plant, satellites, teapots,
};

use super::flags::Flags;

/// Nothing is drawn that is nearer to the eye, metres.
const NEAR: f32 = 0.1;

/// A world, what moves in it, and a camera's way through it.
pub struct Scenario {
    /// In words.
    pub name: String,
    /// The app's world: entities with a `Bounds` component, which the engine reads, and whatever
    /// the app draws them from, here a `Drawable`.
    pub world: World,
    /// What moves, if anything does.
    pub swarm: Option<Swarm>,
    /// The camera's way.
    pub flight: Flight,
    /// Nothing is drawn that is nearer to the eye, metres.
    pub near: f32,
}

/// The camera's way.
#[derive(Clone, Debug)]
pub enum Flight {
    /// Smoothly through some points.
    Path(CameraPath),
    /// Frame by frame; never empty.
    Poses(Vec<Pose>),
    /// A part of another.
    Part {
        /// The whole.
        of: Box<Flight>,
        /// Its time at the start.
        from: f32,
        /// Its time at the end.
        to: f32,
    },
}

impl Flight {
    /// Where the camera is, `t` from 0 to 1.
    pub fn pose(&self, t: f32) -> Pose {
        match self {
            Self::Path(path) => path.pose(t),
            Self::Poses(poses) => poses[(t * (poses.len() - 1) as f32).round() as usize],
            Self::Part { of, from, to } => of.pose(from + (to - from) * t),
        }
    }
}

impl Scenario {
    /// The power plant of [`worlds::power_plant()`] with `flags.objects` bunnies in it.
    pub fn power_plant(flags: &Flags, moving: bool) -> anyhow::Result<Self> {
        let mut scenario = Self::power_plant_alone(flags);
        if flags.objects == 0 {
            return Ok(scenario);
        }
        let room = power_plant::interior(flags.scale);
        let bunnies = Swarm::new(flags.seed, flags.objects, worlds::bunny_mesh()?, room);
        bunnies.spawn(&mut scenario.world);
        scenario.name = format!("power plant + {}", several(flags.objects, moving, "bunny", "bunnies"));
        scenario.swarm = moving.then_some(bunnies);
        Ok(scenario)
    }

    /// The same without bunnies.
    pub fn power_plant_alone(flags: &Flags) -> Self {
        let mut world = World::new();
        worlds::power_plant(flags.seed, flags.scale).spawn(&mut world);
        let flight = Flight::Path(power_plant::path(flags.scale));
        Self { name: "power plant alone".to_owned(), world, swarm: None, flight, near: NEAR }
    }

    /// A cloud of [`teapots`]. Its room grows with their number, not their density.
    pub fn teapots(flags: &Flags, count: usize, moving: bool) -> Self {
        let cloud = Swarm::new(flags.seed, count, worlds::teapot_mesh(), teapots::room(count));
        let mut world = World::new();
        cloud.spawn(&mut world);
        Self {
            name: several(count, moving, "teapot", "teapots"),
            world,
            swarm: moving.then_some(cloud),
            flight: Flight::Path(teapots::path(count)),
            near: NEAR,
        }
    }

    /// The [`worlds::city()`], walked through, or run through with quick turns.
    pub fn city(flags: &Flags, fast: bool) -> Self {
        let path = if fast { city::fast_path(flags.scale) } else { city::path(flags.scale) };
        let name = if fast { "city, at a run" } else { "city" };
        Self::still(name, &worlds::city(flags.seed, flags.scale), path)
    }

    /// The [`worlds::fantasy()`]: few objects of many triangles.
    pub fn fantasy(flags: &Flags) -> Self {
        let path = fantasy::path(flags.scale);
        Self::still("fantasy", &worlds::fantasy(flags.seed, flags.scale), path)
    }

    /// The [`worlds::factory()`]: wide and detailed.
    pub fn factory(flags: &Flags) -> Self {
        let path = factory::path(flags.scale);
        Self::still("factory", &worlds::factory(flags.seed, flags.scale), path)
    }

    /// The [`worlds::satellites()`]: many detailed parts.
    pub fn satellites(flags: &Flags) -> Self {
        let path = satellites::path(flags.scale);
        Self::still("satellites", &worlds::satellites(flags.seed, flags.scale), path)
    }

    fn still(name: &str, model: &worlds::Model, path: CameraPath) -> Self {
        let mut world = World::new();
        model.spawn(&mut world);
        Self { name: name.to_owned(), world, swarm: None, flight: Flight::Path(path), near: NEAR }
    }

    /// The same world with a part of the flight: from one of its times to another, 0 to 1 each.
    pub fn part(mut self, from: f32, to: f32) -> Self {
        self.flight = Flight::Part { of: Box::new(self.flight), from, to };
        self
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
        self.look(self.flight.pose(t), flags.viewport())
    }

    /// The view of a pose.
    pub fn look(&self, pose: Pose, viewport: Viewport) -> anyhow::Result<View> {
        Ok(View::look_at(pose.eye, pose.target, pose.fov_y_degrees, self.near, viewport)?)
    }
}

/// "1 static teapot", "12 moving teapots".
fn several(count: usize, moving: bool, one: &str, many: &str) -> String {
    format!("{count} {} {}", if moving { "moving" } else { "static" }, if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_part_of_a_flight_is_flown_from_its_start_to_its_end() {
        let eyes =
            (0..=8).map(|n| Pose { eye: Vec3::X * n as f32, target: Vec3::NEG_Z, fov_y_degrees: 60.0 });
        let whole = Flight::Poses(eyes.collect());
        let part = Flight::Part { of: Box::new(whole), from: 0.25, to: 0.75 };
        assert_eq!([0.0, 0.5, 1.0].map(|t| part.pose(t).eye.x), [2.0, 4.0, 6.0]);
    }
}
