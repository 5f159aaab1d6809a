//! Each extreme of a view or a box against exact arithmetic, by name. The sweep in `differential`
//! meets them all at once, and more often; these say which one it was, and shrink.

use glam::{Mat4, Vec3};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tercet::Error;
use tercet::geom::{Aabb, Frustum, PlaneMask, Projected, Question, View, Viewport, project, projection};

use super::check::holds;
use super::strategies::{Ends, bad_box, singular_matrix, sound_box, thin_box, view};

/// Cases a test: the sweep has the millions.
const CASES: u32 = 512;

/// Every routine holds for every such box in every such view.
fn holds_for(views: impl Strategy<Value = View>, boxes: impl Strategy<Value = Aabb>) {
    let mut runner = TestRunner::new(ProptestConfig { cases: CASES, ..ProptestConfig::default() });
    runner
        .run(&(views, boxes), |(view, aabb)| holds(&view, &aabb).map_err(TestCaseError::fail))
        .unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn coordinates_to_1e7_and_sizes_from_1e_6_to_1e7() {
    holds_for(view(Ends { eye: true, ..Ends::default() }), sound_box());
}

#[test]
fn far_near_ratios_of_1e9() {
    holds_for(view(Ends { far_over_near: true, ..Ends::default() }), sound_box());
}

#[test]
fn fields_of_view_from_a_tenth_of_a_degree_to_179() {
    holds_for(view(Ends { field_of_view: true, ..Ends::default() }), sound_box());
}

#[test]
fn viewports_from_1x1_to_16384() {
    holds_for(view(Ends { viewport: true, ..Ends::default() }), sound_box());
}

#[test]
fn flat_linear_and_point_like_boxes() {
    holds_for(view(Ends::ALL), thin_box());
}

#[test]
fn all_extremes_at_once() {
    holds_for(view(Ends::ALL), sound_box());
}

/// A box whose corner, edge or face lies on a plane of the frustum, seen from outside: it shares a
/// point with the view, so it is never outside. The planes of these views are exact in f32.
#[test]
fn boxes_touching_the_frustum_planes() {
    let viewport = Viewport::new(64, 64);
    let square =
        View::new(Mat4::IDENTITY, projection::orthographic(64.0, 64.0, 0.0, 128.0), viewport).unwrap();
    // At 90 degrees the side planes are x = ±z and y = ±z.
    let fov = std::f32::consts::FRAC_PI_2;
    let right_angle =
        View::new(Mat4::IDENTITY, projection::perspective_finite(fov, 1.0, 1.0, 128.0), viewport).unwrap();
    for size in [0.0, 1e-6, 1.0, 1e7] {
        for (plane, touching) in [
            ("left", Aabb::new(Vec3::new(-32.0 - size, -1.0, -32.0), Vec3::new(-32.0, 1.0, -32.0))),
            ("right", Aabb::new(Vec3::new(32.0, -1.0, -32.0), Vec3::new(32.0 + size, 1.0, -32.0))),
            ("bottom", Aabb::new(Vec3::new(-1.0, -32.0 - size, -32.0), Vec3::new(1.0, -32.0, -32.0))),
            ("top", Aabb::new(Vec3::new(-1.0, 32.0, -32.0), Vec3::new(1.0, 32.0 + size, -32.0))),
            ("far", Aabb::new(Vec3::new(-1.0, -1.0, -128.0 - size), Vec3::new(1.0, 1.0, -128.0))),
            ("corner", Aabb::new(Vec3::splat(-32.0) - Vec3::new(size, size, 0.0), Vec3::splat(-32.0))),
        ] {
            for view in [&square, &right_angle] {
                let frustum = Frustum::new(view);
                assert!(frustum.intersects(&touching), "{plane}, {size}");
                assert!(frustum.classify(&touching, PlaneMask::ALL).is_some(), "{plane}, {size}");
                assert_ne!(project(&touching, view), Projected::Outside, "{plane}, {size}");
                holds(view, &touching).unwrap_or_else(|why| panic!("{plane}, {size}: {why}"));
            }
        }
        for (view, near) in [(&square, 0.0), (&right_angle, -1.0)] {
            let touching = Aabb::new(Vec3::new(-0.5, -0.5, near), Vec3::new(0.5, 0.5, near + size));
            assert!(Frustum::new(view).intersects(&touching), "near, {size}");
            assert_ne!(Question::new(&touching, view), Question::Outside, "near, {size}");
            holds(view, &touching).unwrap_or_else(|why| panic!("near, {size}: {why}"));
        }
    }
    // And what clearly does not touch is outside.
    let beside = Aabb::new(Vec3::new(40.0, -1.0, -32.0), Vec3::new(50.0, 1.0, -31.0));
    assert!(!Frustum::new(&square).intersects(&beside) && !Frustum::new(&right_angle).intersects(&beside));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, ..ProptestConfig::default() })]

    /// Nothing is known of such a box: it is never outside, never asked about, always visible.
    #[test]
    fn nan_infinite_and_inverted_boxes(view in view(Ends::ALL), aabb in bad_box()) {
        prop_assert!(!aabb.is_valid());
        let frustum = Frustum::new(&view);
        prop_assert!(frustum.intersects(&aabb) && frustum.classify(&aabb, PlaneMask::ALL).is_some());
        prop_assert_eq!(project(&aabb, &view), Projected::Near);
        prop_assert_eq!(Question::new(&aabb, &view), Question::Visible);
    }

    /// The error names the matrix.
    #[test]
    fn singular_matrices(singular in singular_matrix(), turn in 0.0f32..6.0) {
        let (viewport, sound) = (Viewport::new(9, 9), projection::perspective(1.0, 1.0, 0.1));
        let names = |view: Result<View, Error>, expected: &str| {
            matches!(view, Err(Error::Matrix { name, .. }) if name == expected)
        };
        prop_assert!(names(View::new(singular, sound, viewport), "view_from_world"));
        prop_assert!(names(View::new(Mat4::from_rotation_y(turn), singular, viewport), "clip_from_view"));
    }

    /// A matrix with an entry that is no number is refused by name; no viewport beyond its limits is
    /// taken.
    #[test]
    fn nan_matrices_and_empty_viewports(entry in 0usize..16, bad in prop_oneof![Just(f32::NAN), Just(f32::INFINITY)]) {
        let mut entries = Mat4::IDENTITY.to_cols_array();
        entries[entry] = bad;
        let spoiled = Mat4::from_cols_array(&entries);
        let refused = View::new(spoiled, Mat4::IDENTITY, Viewport::new(1, 1));
        let is_named = matches!(&refused, Err(Error::Matrix { name: "view_from_world", .. }));
        prop_assert!(is_named);
        for (width, height) in [(0, 1), (1, 0), (Viewport::MAX_SIDE + 1, 1), (1, u32::MAX)] {
            let refused = View::new(Mat4::IDENTITY, Mat4::IDENTITY, Viewport::new(width, height));
            let is_named = matches!(&refused, Err(Error::Viewport { width: w, height: h }) if (*w, *h) == (width, height));
            prop_assert!(is_named);
        }
    }
}
