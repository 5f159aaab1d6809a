//! Strategies that concentrate on the extremes: most of what they make lies at some end of the range
//! that the engine promises to bear. What fails shrinks toward the origin, 1 m and 60 degrees.

use glam::{Mat4, Quat, Vec3};
use proptest::prelude::*;
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};

/// Coordinates to ±1e7, metres.
pub(crate) fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -10.0f32..10.0,
        1 => Just(0.0f32),
        2 => (-6.0f32..7.0, any::<bool>()).prop_map(|(e, negative)| 10f32.powf(e) * if negative { -1.0 } else { 1.0 }),
        2 => prop_oneof![Just(1e7f32), Just(-1e7f32)],
    ]
}

/// Sizes from 1e-6 to 1e7, metres, and none.
pub(crate) fn size() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => 0.1f32..10.0,
        2 => Just(0.0f32),
        2 => (-6.0f32..7.0).prop_map(|e| 10f32.powf(e)),
        1 => prop_oneof![Just(1e-6f32), Just(1e7f32)],
    ]
}

fn vector(number: impl Strategy<Value = f32> + Clone + 'static) -> impl Strategy<Value = Vec3> {
    [number.clone(), number.clone(), number].prop_map(Vec3::from)
}

/// Any valid box within the range.
pub(crate) fn sound_box() -> impl Strategy<Value = Aabb> {
    (vector(coordinate().boxed()), vector(size().boxed())).prop_map(|(min, size)| Aabb::new(min, min + size))
}

/// A box that is flat, or a line, or a point.
pub(crate) fn thin_box() -> impl Strategy<Value = Aabb> {
    (sound_box(), 1u8..8).prop_map(|(mut aabb, flat)| {
        for axis in (0..3).filter(|axis| flat & (1 << axis) != 0) {
            aabb.max[axis] = aabb.min[axis];
        }
        aabb
    })
}

/// A box that no tree can hold: not a number, infinite, or inverted on some axis.
pub(crate) fn bad_box() -> impl Strategy<Value = Aabb> {
    let bad = prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY)];
    prop_oneof![
        (sound_box(), 0usize..6, bad).prop_map(|(mut aabb, i, bad)| {
            if i < 3 {
                aabb.min[i] = bad
            } else {
                aabb.max[i - 3] = bad
            }
            aabb
        }),
        (sound_box(), 0usize..3).prop_map(|(mut aabb, axis)| {
            aabb.min[axis] = aabb.max[axis].next_up();
            aabb
        }),
        Just(Aabb::EMPTY),
    ]
}

/// What of a view is to be extreme; the rest is ordinary.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ends {
    pub(crate) eye: bool,
    pub(crate) far_over_near: bool,
    pub(crate) field_of_view: bool,
    pub(crate) viewport: bool,
}

impl Ends {
    pub(crate) const ALL: Self = Self { eye: true, far_over_near: true, field_of_view: true, viewport: true };
}

/// A view of every projection and depth convention.
pub(crate) fn view(ends: Ends) -> impl Strategy<Value = View> {
    let eye = if ends.eye { vector(coordinate().boxed()).boxed() } else { vector(-20.0f32..20.0).boxed() };
    let planes = if ends.far_over_near {
        (-3.0f32..2.0).prop_map(|e| (10f32.powf(e), 1e9)).boxed()
    } else {
        Just((0.1, 1e4)).boxed()
    };
    let fov = if ends.field_of_view {
        prop_oneof![Just(0.1f32), Just(179.0), 0.1f32..1.0, 170.0f32..179.0].boxed()
    } else {
        Just(60.0).boxed()
    };
    let side = || {
        if ends.viewport {
            prop_oneof![Just(1u32), Just(Viewport::MAX_SIDE), 1..=Viewport::MAX_SIDE].boxed()
        } else {
            Just(320).boxed()
        }
    };
    let sides = (side(), side());
    let turn = (0.0f32..6.3, -1.5f32..1.5);
    (eye, planes, fov, sides, turn, 0u8..5, 0u8..3).prop_map(
        |(eye, (near, ratio), fov, (width, height), turn, kind, target)| {
            let (aspect, far) = (width as f32 / height as f32, near * ratio);
            let fov = fov.to_radians();
            let (clip_from_view, depth) = match kind {
                0 => (projection::perspective(fov, aspect, near), DepthDirection::Reversed),
                1 => (projection::perspective_finite(fov, aspect, near, far), DepthDirection::Reversed),
                2 => (projection::perspective_standard(fov, aspect, near, far), DepthDirection::Standard),
                3 => (projection::orthographic(50.0, 50.0, near, far), DepthDirection::Reversed),
                _ => (
                    projection::jittered(
                        projection::perspective(fov, aspect, near),
                        glam::vec2(0.4, -0.3),
                        width,
                        height,
                    ),
                    DepthDirection::Reversed,
                ),
            };
            let turn = Quat::from_rotation_x(turn.1) * Quat::from_rotation_y(turn.0);
            let format = if target == 1 { DepthFormat::Depth24Plus } else { DepthFormat::Depth32Float };
            let samples = if target == 2 { 4 } else { 1 };
            View::new(
                Mat4::from_rotation_translation(turn, -(turn * eye)),
                clip_from_view,
                Viewport::new(width, height),
            )
            .expect("every one of these is a usable view")
            .with_target(depth, format, samples)
        },
    )
}

/// A matrix that has no inverse.
pub(crate) fn singular_matrix() -> impl Strategy<Value = Mat4> {
    let entry = || prop_oneof![Just(0.0f32), Just(1.0), -10.0f32..10.0, Just(1e6)];
    let entries = [(); 16].map(|()| entry());
    (entries, 0usize..4, 0usize..4, -4i8..4).prop_map(|(entries, column, other, times)| {
        let mut m = Mat4::from_cols_array(&entries);
        // A column is a multiple of another one, by a power of two, which is exact; or zero.
        *m.col_mut(column) =
            if column == other { glam::Vec4::ZERO } else { m.col(other) * 2f32.powi(times.into()) };
        m
    })
}
