//! Bytes to the numbers that break things.

use arbitrary::Unstructured;
use glam::{Mat4, Quat, Vec3};
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};

/// A number of `0..end`; 0 once the bytes are used up.
pub fn below(u: &mut Unstructured<'_>, end: usize) -> usize {
    u.int_in_range(0..=end - 1).unwrap_or(0)
}

/// Any float at all, with a preference for small whole ones and for the ends of the range.
pub fn float(u: &mut Unstructured<'_>) -> f32 {
    const ENDS: [f32; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-6,
        1e7,
        -1e7,
        f32::MIN_POSITIVE,
        1e-45,
        f32::MAX,
        f32::MIN,
        3e38,
        0.1,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    match below(u, 4) {
        0 => f32::from_bits(u.arbitrary().unwrap_or_default()),
        1 => ENDS[below(u, ENDS.len())],
        2 => f32::from(u.arbitrary::<i8>().unwrap_or_default()),
        _ => f32::from(u.arbitrary::<i16>().unwrap_or_default()) / 64.0,
    }
}

/// A float within the range that the engine promises.
pub fn coordinate(u: &mut Unstructured<'_>) -> f32 {
    let x = float(u);
    if x.is_finite() { x.clamp(-1e7, 1e7) } else { 0.0 }
}

/// Three floats.
pub fn vector(u: &mut Unstructured<'_>, number: fn(&mut Unstructured<'_>) -> f32) -> Vec3 {
    Vec3::new(number(u), number(u), number(u))
}

/// Any six floats: flat, inverted and infinite boxes among them, and points.
pub fn any_box(u: &mut Unstructured<'_>) -> Aabb {
    let min = vector(u, float);
    match below(u, 4) {
        0 => Aabb::new(min, min),
        1 => Aabb::new(min, vector(u, float)),
        _ => {
            let other = vector(u, float);
            Aabb::new(min.min(other), min.max(other))
        }
    }
}

/// A box that is valid, within the promised range.
pub fn sound_box(u: &mut Unstructured<'_>) -> Aabb {
    let (a, b) = (vector(u, coordinate), vector(u, coordinate));
    match below(u, 3) {
        0 => Aabb::new(a, a),
        1 => Aabb::from_points([a, a + b * 1e-3]),
        _ => Aabb::from_points([a, b]),
    }
}

/// A view that an app might have, if the numbers make one.
pub fn sound_view(u: &mut Unstructured<'_>, most_pixels: u32) -> Option<View> {
    let side = |u: &mut Unstructured<'_>| 1 + below(u, most_pixels as usize) as u32;
    let mut viewport = Viewport::new(side(u), side(u));
    if below(u, 4) == 0 {
        (viewport.x, viewport.y) = (side(u), side(u));
    }
    let aspect = viewport.width as f32 / viewport.height as f32;
    let fov = [0.1f32, 5.0, 60.0, 90.0, 179.0][below(u, 5)].to_radians();
    let near = [1e-3f32, 0.1, 1.0, 100.0][below(u, 4)];
    let far = near * [2.0f32, 1e3, 1e9][below(u, 3)];
    let (clip_from_view, depth) = match below(u, 4) {
        0 => (projection::perspective(fov, aspect, near), DepthDirection::Reversed),
        1 => (projection::perspective_finite(fov, aspect, near, far), DepthDirection::Reversed),
        2 => (projection::perspective_standard(fov, aspect, near, far), DepthDirection::Standard),
        _ => (projection::orthographic(far * aspect, far, near, far), DepthDirection::Reversed),
    };
    let eye = vector(u, coordinate);
    let turn = Quat::from_rotation_y(float(u) % 7.0) * Quat::from_rotation_x(float(u) % 7.0);
    let view_from_world = Mat4::from_rotation_translation(turn, -(turn * eye));
    let format = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus][below(u, 2)];
    Some(View::new(view_from_world, clip_from_view, viewport).ok()?.with_target(depth, format, 1))
}
