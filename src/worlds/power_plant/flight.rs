//! The camera's flight: half around the plant, in through a door, up and out.

use glam::Vec3;

use super::super::CameraPath;
use super::super::shape::turn;
use super::plan::Size;
use super::{BAY, STOREY};
use crate::geom::Aabb;

const EYE: f32 = 1.7;

/// The flight for a plant of this size.
pub(super) fn flight(size: Size) -> CameraPath {
    let mut eyes = Vec::new();
    approach(size, &mut eyes);
    let route = size.route();
    for (n, &bay) in route.iter().enumerate() {
        let at = size.center(bay) + Vec3::Y * EYE;
        if n > 0 {
            // The middle of the door: a control point that makes the way through it straight.
            eyes.push((eyes[eyes.len() - 1] + at) * 0.5);
        }
        eyes.push(at);
    }
    let top = eyes[eyes.len() - 1];
    let building = size.building();
    for (up, out) in [(4.0, 0.0), (10.0, 6.0), (18.0, 20.0), (26.0, 38.0)] {
        eyes.push(top + Vec3::new(out, up, 0.6 * out));
    }
    let targets = targets(&eyes, building);
    CameraPath::new(60.0, eyes.into_iter().zip(targets))
}

/// From above the eastern end around the south, down to the door in the west.
fn approach(size: Size, eyes: &mut Vec<Vec3>) {
    const POINTS: usize = 10;
    let building = size.building();
    let half = 0.5 * building.size();
    let (wide, deep) = (half.x + 32.0, half.z + 32.0);
    for n in 0..=POINTS {
        let (cos, sin) = turn(n, 2 * POINTS);
        let height = 12.0 + (0.9 * building.max.y + 4.0) * (1.0 - n as f32 / POINTS as f32);
        eyes.push(Vec3::new(wide * cos, height, deep * sin));
    }
    let door = size.center(super::plan::Bay { i: 0, j: size.aisle(), k: 0 });
    for (away, height) in [(18.0, 6.0), (10.0, 2.5), (5.0, EYE), (0.0, EYE)] {
        eyes.push(Vec3::new(door.x - 0.5 * BAY - away, height, door.z));
    }
}

/// What to look at from each point: far outside, the building; inside, a few points ahead, or
/// around when the way leads straight up.
fn targets(eyes: &[Vec3], building: Aabb) -> Vec<Vec3> {
    let heart = building.center();
    let look = |n: usize| {
        let eye = eyes[n];
        let inside = building.inflated(6.0).contains_point(eye) && eye.y < building.max.y + 0.5;
        if !inside {
            return heart;
        }
        let ahead = eyes[(n + 3).min(eyes.len() - 1)] - eye;
        let flat = Vec3::new(ahead.x, 0.0, ahead.z);
        if flat.length() < 0.4 * BAY {
            // One turn in eight steps of half a storey.
            let (cos, sin) = turn((2.0 * eye.y / STOREY) as usize % 8, 8);
            return eye + Vec3::new(cos, -0.15, sin) * BAY;
        }
        eye + flat.normalize() * BAY
    };
    (0..eyes.len()).map(look).collect()
}

/// Boxes around the flight's tube: nothing but the building itself may reach into them.
pub(super) struct Clearance(Vec<Aabb>);

impl Clearance {
    pub(super) fn around(path: &CameraPath) -> Self {
        const PIECES: usize = 700;
        const STEPS: usize = 4;
        const METRES: f32 = 0.9;
        let eye = |n: usize| path.pose(n as f32 / (PIECES * STEPS) as f32).eye;
        let piece = |p: usize| Aabb::from_points((p * STEPS..=(p + 1) * STEPS).map(eye)).inflated(METRES);
        Self((0..PIECES).map(piece).collect())
    }

    pub(super) fn allows(&self, bounds: &Aabb) -> bool {
        !self.0.iter().any(|tube| tube.intersects(bounds))
    }
}
