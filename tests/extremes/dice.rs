//! Random views and boxes that crowd at the extremes: millions of them a minute, which is why they
//! are not proptest's.

use glam::{DVec4, Mat4, Quat, Vec3, Vec4Swizzles};
use rand::{Rng, RngExt};
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport};

use super::samples::lens::{Lens, direction, log_range};

/// A box in a view, and some of its points.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) aabb: Aabb,
    pub(crate) points: [Vec3; 4],
}

fn side(rng: &mut impl Rng) -> u32 {
    match rng.random_range(0..4) {
        0 => [1, 2, 3, Viewport::MAX_SIDE][rng.random_range(0..4)],
        _ => log_range(rng, 1.0, Viewport::MAX_SIDE as f32).round() as u32,
    }
}

/// A view of any kind that the engine promises to handle; half of them at some end of the range.
pub(crate) fn view(rng: &mut impl Rng) -> View {
    let mut viewport = Viewport::new(side(rng), side(rng));
    if rng.random_bool(0.2) {
        (viewport.x, viewport.y) = (side(rng), side(rng));
    }
    let fov = match rng.random_range(0..5) {
        0 => 0.1,
        1 => 179.0,
        2 => log_range(rng, 0.1, 10.0),
        3 => rng.random_range(120.0..179.0f32),
        _ => rng.random_range(30.0..90.0f32),
    };
    let (fov, near) = (fov.to_radians(), log_range(rng, 1e-3, 100.0));
    let far = near * if rng.random_bool(0.5) { 1e9 } else { log_range(rng, 2.0, 1e9) };
    let lens = Lens { viewport, fov, near, far, widths: 1e-3..1e7 };
    let (clip_from_view, depth) = lens.projection(rng);
    let turn = match rng.random_range(0..3) {
        0 => Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * rng.random_range(0..4) as f32),
        _ => Quat::from_axis_angle(direction(rng), rng.random_range(0.0..std::f32::consts::TAU)),
    };
    let eye = direction(rng) * [0.0, 1.0, 100.0, 1e4, 1e7][rng.random_range(0..5)];
    let format = if rng.random_bool(0.3) { DepthFormat::Depth24Plus } else { DepthFormat::Depth32Float };
    let samples = if rng.random_bool(0.2) { 4 } else { 1 };
    View::new(Mat4::from_rotation_translation(turn, -(turn * eye)), clip_from_view, viewport)
        .expect("every one of these is a usable view")
        .with_target(depth, format, samples)
}

/// A box that has something to do with a view: at a place that it shows, on one of its planes, or
/// around its eye.
pub(crate) fn case(rng: &mut impl Rng, view: &View) -> Case {
    let (anchor, pixel) = anchor(rng, view);
    let scale = match rng.random_range(0..4) {
        0 => log_range(rng, 1e-6, 1e7),
        1 => pixel * log_range(rng, 0.05, 3.0),
        _ => pixel * log_range(rng, 1.0, 1e4),
    };
    let size = Vec3::from_array(std::array::from_fn(|_| match rng.random_range(0..8) {
        0 | 1 => 0.0,
        2 => log_range(rng, 1e-4, 1.0),
        _ => rng.random_range(0.2..=1.0),
    }));
    let size = (size * scale).clamp(Vec3::ZERO, Vec3::splat(1e7));
    // The anchor is a corner, or on a face, or inside.
    let share = Vec3::from_array(std::array::from_fn(|_| match rng.random_range(0..4) {
        0 => 0.0,
        1 => 1.0,
        _ => rng.random_range(0.0..=1.0),
    }));
    let min = anchor - size * share;
    let mut aabb = Aabb::new(min, min + size);
    let eye = view.eye();
    if eye.w != 0.0 && rng.random_bool(0.15) {
        // A face in one plane with the eye, or nearly so.
        let axis = rng.random_range(0..3);
        let off = [0.0, 1e-6, 1e-3][rng.random_range(0..3)] * scale;
        aabb.min[axis] = eye[axis] + off;
        aabb.max[axis] = aabb.min[axis] + size[axis];
    }
    let points = std::array::from_fn(|_| {
        Vec3::from_array(std::array::from_fn(|axis| {
            let (low, high) = (aabb.min[axis], aabb.max[axis]);
            match rng.random_range(0..5) {
                0 | 1 => low,
                2 | 3 => high,
                _ => (low + (high - low) * rng.random::<f32>()).clamp(low, high),
            }
        }))
    });
    Case { aabb, points }
}

/// A place of the world, and about how long a pixel is there, in metres.
fn anchor(rng: &mut impl Rng, view: &View) -> (Vec3, f32) {
    let eye = view.eye();
    if eye.w != 0.0 && rng.random_bool(0.05) {
        return (eye.xyz(), log_range(rng, 1e-6, 1e3));
    }
    let away = 10f64.powf(-rng.random_range(0.0..9.0));
    let depth = match (rng.random_range(0..8), view.depth()) {
        (0, _) => [0.0, 1.0][rng.random_range(0..2)],
        (1, _) => rng.random_range(0.0..1.0),
        (_, DepthDirection::Reversed) => away,
        (_, DepthDirection::Standard) => 1.0 - away,
    };
    let mut across = || match rng.random_range(0..5) {
        0 => [-1.0, 1.0][rng.random_range(0..2)],
        1 => rng.random_range(-3.0..3.0),
        _ => rng.random_range(-1.05..1.05),
    };
    let (x, y) = (across(), across());
    let at = |x: f64| {
        let p = view.world_from_clip() * DVec4::new(x, y, depth, 1.0);
        p.truncate() / p.w
    };
    let pixel = at(x).distance(at(x + 2.0 / f64::from(view.viewport().width))) as f32;
    let place = at(x).as_vec3();
    // The far plane may be at infinity.
    if place.abs().max_element() < 1e12 && pixel < 1e9 {
        (place, pixel)
    } else {
        (eye.xyz() + direction(rng) * 1e7, 1.0)
    }
}
