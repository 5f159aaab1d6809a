//! A camera that is flown by hand, or flies by itself.

use eframe::egui::{InputState, Key, PointerButton, Response};
use glam::{Mat3, Vec3};
use tercet::worlds::Pose;

use crate::support::scenario::Flight;

/// Radians for a point that the mouse is dragged.
const TURN: f32 = 0.003;
/// The steepest look up and down, radians: short of the poles, where there is no "up" any more.
const STEEPEST: f32 = 1.55;

/// Where the camera is, and who flies it.
pub struct Fly {
    eye: Vec3,
    /// Radians about the vertical; 0 looks along -z, positive turns left.
    yaw: f32,
    /// Radians above the horizon.
    pitch: f32,
    fov_y_degrees: f32,
    /// Metres a second.
    pub speed: f32,
    /// How far the scenario's own flight has got, 0 to `end`.
    pub along: f32,
    /// Where it starts anew, 0 to 1.
    pub end: f32,
    /// Whether the camera follows it.
    pub follows: bool,
}

impl Fly {
    /// At the start of a flight, and following it as far as `end`.
    pub fn new(flight: &Flight, end: f32, speed: f32) -> Self {
        let mut fly = Self {
            eye: Vec3::ZERO,
            yaw: 0.0,
            pitch: 0.0,
            fov_y_degrees: 60.0,
            speed,
            along: 0.0,
            end,
            follows: true,
        };
        fly.take(flight.pose(0.0));
        fly
    }

    /// Goes on along the flight by a part of it.
    pub fn follow(&mut self, flight: &Flight, part: f32) {
        if self.follows {
            let next = self.along + part * self.end;
            self.along = if next <= self.end { next } else { 0.0 };
            self.take(flight.pose(self.along));
        }
    }

    /// Takes keys, and the mouse over the picture. Whoever moves the camera flies it from then on.
    pub fn steer(&mut self, input: &InputState, picture: &Response, has_keys: bool) {
        let drag = picture.drag_delta();
        let turned = picture.dragged_by(PointerButton::Primary) && drag.length_sq() > 0.0;
        if turned {
            self.yaw -= drag.x * TURN;
            self.pitch = (self.pitch - drag.y * TURN).clamp(-STEEPEST, STEEPEST);
        }
        if picture.hovered() {
            // A notch of the wheel is about 50 points.
            self.speed = (self.speed * (input.smooth_scroll_delta().y * 0.005).exp()).clamp(1e-4, 1e6);
        }
        let mut way = Vec3::ZERO;
        if has_keys {
            let axes = self.axes();
            let keys = [
                (Key::W, -axes.z_axis),
                (Key::S, axes.z_axis),
                (Key::D, axes.x_axis),
                (Key::A, -axes.x_axis),
                (Key::E, Vec3::Y),
                (Key::Q, -Vec3::Y),
            ];
            way = keys.into_iter().filter(|(key, _)| input.key_down(*key)).map(|(_, way)| way).sum();
        }
        let hurry = if input.modifiers.shift { 5.0 } else { 1.0 };
        self.eye += way.normalize_or_zero() * self.speed * hurry * input.stable_dt.min(0.1);
        self.follows &= !turned && way == Vec3::ZERO;
    }

    /// Where the camera is.
    pub fn pose(&self) -> Pose {
        // As far ahead as the eye is from the origin: nearer, the direction would be rounded away.
        let ahead = self.eye.abs().max_element().max(1.0);
        let target = self.eye - self.axes().z_axis * ahead;
        Pose { eye: self.eye, target, fov_y_degrees: self.fov_y_degrees }
    }

    fn take(&mut self, pose: Pose) {
        let ahead = (pose.target - pose.eye).normalize_or(Vec3::NEG_Z);
        self.eye = pose.eye;
        self.yaw = (-ahead.x).atan2(-ahead.z);
        self.pitch = ahead.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST);
        self.fov_y_degrees = pose.fov_y_degrees;
    }

    /// Right, up and backward.
    fn axes(&self) -> Mat3 {
        Mat3::from_rotation_y(self.yaw) * Mat3::from_rotation_x(self.pitch)
    }
}

#[cfg(test)]
mod tests {
    use tercet::worlds::CameraPath;

    use super::*;

    #[test]
    fn it_looks_where_the_flight_looks() {
        for target in [Vec3::new(3.0, 1.0, -2.0), Vec3::new(-4.0, -2.0, 5.0), Vec3::new(0.0, 0.5, 9.0)] {
            let path = Flight::Path(CameraPath::new(50.0, [(Vec3::ONE, target), (Vec3::ONE * 2.0, target)]));
            let fly = Fly::new(&path, 1.0, 1.0);
            let pose = fly.pose();
            let (want, got) = ((target - Vec3::ONE).normalize(), pose.target - pose.eye);
            let got = got.normalize();
            assert!(want.distance(got) < 1e-5, "{got} instead of {want}");
        }
    }
}
