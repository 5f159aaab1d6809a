//! A camera that is flown by hand, or flies by itself.

use eframe::egui::{Key, PointerButton, Response};
use glam::{Mat3, Vec3};
use tercet::worlds::Pose;

use crate::scenario::Flight;

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
    pub fn steer(&mut self, picture: &Response) {
        // Before the input is looked at: a response locks it, too.
        let (drag, hovered) = (picture.drag_delta(), picture.hovered());
        let turned = picture.dragged_by(PointerButton::Primary) && drag.length_sq() > 0.0;
        let has_keys = !picture.ctx.egui_wants_keyboard_input();
        if turned {
            self.yaw -= drag.x * TURN;
            self.pitch = (self.pitch - drag.y * TURN).clamp(-STEEPEST, STEEPEST);
        }
        let axes = self.axes();
        let keys = [
            (Key::W, -axes.z_axis),
            (Key::S, axes.z_axis),
            (Key::D, axes.x_axis),
            (Key::A, -axes.x_axis),
            (Key::E, Vec3::Y),
            (Key::Q, -Vec3::Y),
        ];
        let (way, hurry, seconds, wheel) = picture.ctx.input(|input| {
            let down = keys.into_iter().filter(|(key, _)| has_keys && input.key_down(*key));
            let hurry = if input.modifiers.shift { 5.0 } else { 1.0 };
            let way: Vec3 = down.map(|(_, way)| way).sum();
            (way, hurry, input.stable_dt.min(0.1), input.smooth_scroll_delta().y)
        });
        if hovered {
            // A notch of the wheel is about 50 points.
            self.speed = (self.speed * (wheel * 0.005).exp()).clamp(1e-4, 1e6);
        }
        self.eye += way.normalize_or_zero() * self.speed * hurry * seconds;
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
    use eframe::egui::{Context, Event, Modifiers, RawInput, Rect, Sense, pos2, vec2};
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

    #[test]
    fn who_drags_or_holds_a_key_flies() {
        let path = Flight::Path(CameraPath::new(50.0, [(Vec3::ZERO, Vec3::NEG_Z), (Vec3::ONE, Vec3::NEG_Z)]));
        let at = |x: f32| Event::PointerMoved(pos2(x, 100.0));
        let button = |pressed| Event::PointerButton {
            pos: pos2(100.0, 100.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let w = Event::Key {
            key: Key::W,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let fly = |passes: &[&[Event]]| {
            let (ctx, mut fly) = (Context::default(), Fly::new(&path, 1.0, 1.0));
            for events in passes {
                let screen_rect = Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0)));
                let input = RawInput { screen_rect, events: events.to_vec(), ..RawInput::default() };
                let mut output = ctx.run_ui(input, |ui| {
                    let size = ui.available_size();
                    fly.steer(&ui.allocate_exact_size(size, Sense::click_and_drag()).1);
                });
                // Nobody paints it.
                output.textures_delta.clear();
            }
            fly
        };
        let left = fly(&[]);
        let (start, dragged) =
            (left.pose(), fly(&[&[at(100.0)], &[button(true)], &[at(160.0)], &[at(190.0)]]));
        assert!(left.follows && !dragged.follows && dragged.pose().target.x > start.target.x);
        let flown = fly(&[&[at(100.0)], &[w], &[]]);
        assert!(!flown.follows && flown.pose().eye.z < start.eye.z);
    }
}
