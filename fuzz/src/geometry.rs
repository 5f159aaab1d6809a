//! Bytes as matrices and boxes: the ways of asking about a box agree, and every bound is a number.

use arbitrary::Unstructured;
use glam::{Affine3A, Mat3A, Mat4, Vec3A};
use tercet::geom::{
    Aabb, DepthDirection, DepthFormat, Frustum, PlaneMask, Projected, Question, View, Viewport, project,
};

use super::numbers::{any_box, below, float, sound_view, vector};

/// Asks about boxes in a view of any matrices.
pub fn run(bytes: &[u8]) {
    let mut u = Unstructured::new(bytes);
    let view = if below(&mut u, 2) == 0 { any_view(&mut u) } else { sound_view(&mut u, Viewport::MAX_SIDE) };
    let Some(view) = view else { return };
    let frustum = Frustum::new(&view);
    while !u.is_empty() {
        let aabb = any_box(&mut u);
        check(&view, &frustum, &aabb);
        let matrix = Mat3A::from_cols_array(&std::array::from_fn(|_| float(&mut u)));
        let translation = Vec3A::from(vector(&mut u, float));
        check_transformed(&aabb, &Affine3A { matrix3: matrix, translation });
    }
}

fn any_view(u: &mut Unstructured<'_>) -> Option<View> {
    let mut matrix = || {
        let mut entries = Mat4::IDENTITY.to_cols_array();
        for _ in 0..below(u, 17) {
            entries[below(u, 16)] = float(u);
        }
        Mat4::from_cols_array(&entries)
    };
    let (view_from_world, clip_from_view) = (matrix(), matrix());
    let viewport = Viewport {
        x: below(u, 1 << 14) as u32,
        y: below(u, 1 << 14) as u32,
        width: below(u, (1 << 14) + 2) as u32,
        height: below(u, (1 << 14) + 2) as u32,
    };
    let depth = [DepthDirection::Reversed, DepthDirection::Standard][below(u, 2)];
    let format = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus][below(u, 2)];
    let view = View::new(view_from_world, clip_from_view, viewport).ok()?;
    Some(view.with_target(depth, format, below(u, 9) as u32))
}

fn check(view: &View, frustum: &Frustum, aabb: &Aabb) {
    let crossed = frustum.classify(aabb, PlaneMask::ALL);
    let (min, max) = (aabb.min, aabb.max);
    let lanes = ([&[min.x], &[min.y], &[min.z]], [&[max.x], &[max.y], &[max.z]]);
    let outside = frustum.outside_lanes(lanes.0, lanes.1, PlaneMask::ALL) == 1;
    assert_eq!(outside, crossed.is_none());
    assert_eq!(outside, !frustum.intersects(aabb));
    assert!(aabb.is_valid() || !outside, "an invalid box is outside");

    let projected = project(aabb, view);
    let question = Question::new(aabb, view);
    if !aabb.is_valid() {
        assert_eq!((projected, question), (Projected::Near, Question::Visible));
    }
    if let Projected::Rect(rect) = projected {
        let Viewport { width, height, .. } = view.viewport();
        assert!(0.0 <= rect.min.x && rect.min.x <= rect.max.x && rect.max.x <= width as f32, "{rect:?}");
        assert!(0.0 <= rect.min.y && rect.min.y <= rect.max.y && rect.max.y <= height as f32, "{rect:?}");
        assert!(rect.farthest <= rect.nearest, "{rect:?}");
    }
    if let Question::Ask(proxy) = question {
        assert!(matches!(projected, Projected::Rect(_)), "{projected:?} is asked about");
        assert!(proxy.rect.x1 <= view.viewport().width && proxy.rect.y1 <= view.viewport().height);
        assert!(proxy.rect.area() > 0 && proxy.nearest >= view.depth().cleared());
        for (x, y) in [(proxy.rect.x0, proxy.rect.y0), (proxy.rect.x1 - 1, proxy.rect.y1 - 1)] {
            assert!(proxy.edges.iter().flatten().all(|k| k.is_finite()), "{proxy:?}");
            assert!(proxy.nearness(x, y) <= proxy.nearest, "{proxy:?}");
        }
    }
}

/// A box under a transform holds its corners under it, whatever the transform.
fn check_transformed(aabb: &Aabb, target_from_source: &Affine3A) {
    let around = aabb.transformed(target_from_source);
    if !aabb.is_valid() || !around.is_valid() {
        return;
    }
    for corner in aabb.corners() {
        let p = target_from_source.transform_point3(corner);
        // A sum that overflows on the way is no point that could be drawn.
        assert!(!p.is_finite() || around.contains_point(p), "{p} is not in {around:?}");
    }
}
