//! The ways of the camera: in the middle of the street, where nothing stands.

use glam::Vec3;

use super::super::CameraPath;
use super::super::shape::turn;
use super::{Grid, PITCH};

/// Above the street, metres.
const EYE: f32 = 1.7;
const FOV: f32 = 60.0;

/// Steps of a quarter of a block from crossing to crossing; the first three quarters of the turn at
/// a corner are looked at from the crossing itself.
fn route(grid: Grid) -> Vec<Vec3> {
    let (i, j) = (grid.wide / 2, grid.deep / 2);
    // From a block outside the middle, around two corners, to the middle.
    let corners = [(i + 1, j.saturating_sub(2)), (i + 1, j), (i - 1, j), (i - 1, j + 1), (i, j + 1)];
    let mut eyes = Vec::new();
    for pair in corners.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(|at| grid.crossing(at) + Vec3::Y * EYE);
        let steps = (from.distance(to) / PITCH * 4.0 + 0.5) as usize;
        eyes.extend((0..steps).map(|n| from + (to - from) * (n as f32 / steps as f32)));
    }
    eyes.push(grid.crossing(corners[corners.len() - 1]) + Vec3::Y * EYE);
    eyes
}

/// Where those who walk forward look: a few steps ahead.
fn ahead(eyes: &[Vec3], n: usize) -> Vec3 {
    let to = eyes[(n + 2).min(eyes.len() - 1)];
    let way = (to - eyes[n.min(eyes.len() - 2)]).normalize_or(Vec3::X);
    eyes[n] + way * 20.0 + Vec3::Y * 1.2
}

/// Along the streets, then up above the roofs, with a look all around.
pub(super) fn walk(grid: Grid) -> CameraPath {
    let eyes = route(grid);
    let mut controls: Vec<(Vec3, Vec3)> = (0..eyes.len()).map(|n| (eyes[n], ahead(&eyes, n))).collect();
    let last = eyes[eyes.len() - 1];
    const RISE: [f32; 8] = [3.0, 8.0, 16.0, 26.0, 38.0, 52.0, 66.0, 76.0];
    for (n, up) in RISE.into_iter().enumerate() {
        let (cos, sin) = turn(n, 16);
        let toward = Vec3::new(cos, 0.0, -sin) * 60.0;
        // From the street straight ahead; from above, down onto the roofs.
        controls.push((last + Vec3::Y * up, last + toward + Vec3::Y * (0.6 * up)));
    }
    CameraPath::new(FOV, controls)
}

/// The same streets without the steps between: twice backwards, and a quick turn at every second
/// step, that shows at once what the last frames hid.
pub(super) fn run(grid: Grid) -> CameraPath {
    let eyes = route(grid);
    let look = |n: usize| {
        let forward = ahead(&eyes, n) - eyes[n];
        let (third, side) = (3 * n / eyes.len(), Vec3::new(-forward.z, forward.y, forward.x));
        match (third, n % 4) {
            // Backwards: the way gone lies before the eye.
            (1, _) => eyes[n] - Vec3::new(forward.x, -forward.y, forward.z),
            (_, 2) => eyes[n] + side,
            (2, 3) => eyes[n] - Vec3::new(forward.x, -forward.y, forward.z),
            _ => eyes[n] + forward,
        }
    };
    CameraPath::new(FOV, (0..eyes.len()).map(|n| (eyes[n], look(n))))
}
