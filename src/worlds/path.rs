//! Smooth camera flights.

use glam::Vec3;

use super::shape::turn;
use crate::geom::Aabb;

/// Where a camera is and what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The eye, in metres.
    pub eye: Vec3,
    /// A point straight ahead, in metres.
    pub target: Vec3,
    /// The vertical field of view.
    pub fov_y_degrees: f32,
}

/// A flight through control points along a centripetal Catmull–Rom spline (Yuksel, Schaefer and
/// Keyser, *Parameterization and Applications of Catmull–Rom Curves*, 2011), which neither loops
/// nor swings wide between unevenly spaced points. Its parameter is also the clock: a stretch
/// between two control points takes the root of its length, so the camera hurries over long
/// distances outside and takes its time in narrow places.
#[derive(Clone, Debug)]
pub struct CameraPath {
    points: Vec<Control>,
    /// Knot of each point, from 0, strictly increasing.
    knots: Vec<f32>,
    fov_y_degrees: f32,
}

#[derive(Clone, Copy, Debug)]
struct Control {
    eye: Vec3,
    target: Vec3,
}

impl CameraPath {
    /// The flight through `(eye, target)` pairs. The eye and its target move on the same clock.
    ///
    /// # Panics
    /// Without a single point, or with one that is not finite.
    pub fn new(fov_y_degrees: f32, controls: impl IntoIterator<Item = (Vec3, Vec3)>) -> Self {
        let points: Vec<_> = controls.into_iter().map(|(eye, target)| Control { eye, target }).collect();
        assert!(!points.is_empty(), "a path needs a control point");
        assert!(
            points.iter().all(|p| p.eye.is_finite() && p.target.is_finite()),
            "a control point is not finite"
        );
        let mut knots = vec![0.0];
        for pair in points.windows(2) {
            // Where only the target moves, its way counts, a quarter as much.
            let way = pair[0].eye.distance(pair[1].eye).max(0.25 * pair[0].target.distance(pair[1].target));
            knots.push(knots[knots.len() - 1] + way.max(1e-3).sqrt());
        }
        Self { points, knots, fov_y_degrees }
    }

    /// Once around a box, a little above it, looking at its middle: for worlds without a way
    /// through them. An empty box is circled as a point at the origin.
    pub fn around(bounds: &Aabb) -> Self {
        const POINTS: usize = 16;
        let (center, half) = match bounds.is_empty() {
            true => (Vec3::ZERO, Vec3::ZERO),
            false => (bounds.center(), bounds.max * 0.5 - bounds.min * 0.5),
        };
        let radius = 1.5 * half.length() + 1.0;
        let eye = |k| {
            let (cos, sin) = turn(k, POINTS);
            center + Vec3::new(radius * sin, 0.5 * radius, radius * cos)
        };
        Self::new(60.0, (0..=POINTS).map(|k| (eye(k), center)))
    }

    /// The pose at time `t`, 0 at the first point, 1 at the last; times outside are clamped, NaN
    /// is 0. O(log points).
    pub fn pose(&self, t: f32) -> Pose {
        let (eye, target) = self.at(if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) });
        Pose { eye, target, fov_y_degrees: self.fov_y_degrees }
    }

    fn at(&self, t: f32) -> (Vec3, Vec3) {
        let last = self.points.len() - 1;
        if last == 0 {
            return (self.points[0].eye, self.points[0].target);
        }
        let s = t * self.knots[last];
        let i = self.knots.partition_point(|&k| k <= s).clamp(1, last) - 1;
        let before = i.saturating_sub(1);
        let after = (i + 2).min(last);
        let index = [before, i, i + 1, after];
        let mut knots = index.map(|i| self.knots[i]);
        // A missing neighbour at either end is the end itself, one stretch earlier or later.
        if before == i {
            knots[0] = knots[1] - (knots[2] - knots[1]);
        }
        if after == i + 1 {
            knots[3] = knots[2] + (knots[2] - knots[1]);
        }
        let blend = |of: fn(&Control) -> Vec3| catmull_rom(index.map(|i| of(&self.points[i])), knots, s);
        (blend(|c| c.eye), blend(|c| c.target))
    }
}

/// Barry and Goldman's pyramid of linear blends.
fn catmull_rom(p: [Vec3; 4], k: [f32; 4], s: f32) -> Vec3 {
    let mix = |a: Vec3, b: Vec3, from: f32, to: f32| a + (b - a) * ((s - from) / (to - from));
    let a = [0, 1, 2].map(|i| mix(p[i], p[i + 1], k[i], k[i + 1]));
    let b = [0, 1].map(|i| mix(a[i], a[i + 1], k[i], k[i + 2]));
    mix(b[0], b[1], k[1], k[2])
}
