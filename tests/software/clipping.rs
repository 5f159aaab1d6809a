//! Triangles that cross the near plane, the far plane, or reach out of sight by miles.

use glam::{DVec2, DVec3, DVec4, Vec3};
use rand::RngExt;
use tercet::geom::{DepthDirection, DepthFormat, View, Viewport, projection};
use tercet::query::software::SoftwareQueries;

use crate::support::{depth, dice, draw, soup};

/// What a sample should hold.
enum Want {
    Covered(f64),
    Empty,
    /// Too close to an edge or a plane for a rasteriser that snaps.
    Either,
}

/// A sample of a triangle without any clipping: barycentrics in homogeneous coordinates (Olano and
/// Greer 1997), so that nothing is divided by a w of the wrong sign.
fn sample(corners: &[DVec4; 3], ndc: DVec2, pixel: DVec2) -> Want {
    let row = |c: &DVec4| DVec3::new(c.x, c.y, c.w);
    let m = corners.each_ref().map(row);
    let determinant = m[0].dot(m[1].cross(m[2]));
    let point = DVec3::new(ndc.x, ndc.y, 1.0);
    let mut close = determinant.abs() < 1e-9 * m[0].length() * m[1].length() * m[2].length();
    let mut inside = true;
    let mut weights = [0.0; 3];
    for k in 0..3 {
        let edge = m[(k + 1) % 3].cross(m[(k + 2) % 3]) / determinant;
        let e = edge.dot(point);
        // The edge's distance in pixels, allowing two subpixels for snapped corners.
        let reach = (edge.x * pixel.x).abs() + (edge.y * pixel.y).abs();
        close |= e.abs() <= reach / 64.0;
        inside &= e > 0.0;
        weights[k] = e;
    }
    let sum = |f: fn(&DVec4) -> f64| (0..3).map(|k| weights[k] * f(&corners[k])).sum::<f64>();
    // The weights are those of a point on the sample's ray, with w = 1 by construction.
    let depth = sum(|c| c.z) / sum(|c| c.w);
    close |= !(1e-4..1.0 - 1e-4).contains(&depth) && (-1e-2..1.01).contains(&depth);
    match (close, inside && (0.0..=1.0).contains(&depth)) {
        (true, _) => Want::Either,
        (false, true) => Want::Covered(depth),
        (false, false) => Want::Empty,
    }
}

#[test]
fn clipped_triangles_agree_with_homogeneous_coverage() {
    let (width, height) = (96, 64);
    let viewport = Viewport::new(width, height);
    let aspect = width as f32 / height as f32;
    let eye = glam::Mat4::IDENTITY;
    let views = [
        View::new(eye, projection::perspective(1.2, aspect, 0.5), viewport).expect("a view"),
        View::new(eye, projection::perspective_finite(1.2, aspect, 0.5, 20.0), viewport).expect("a view"),
        View::new(eye, projection::orthographic(12.0, 8.0, 0.5, 20.0), viewport).expect("a view"),
        View::new(eye, projection::perspective_standard(1.2, aspect, 0.5, 20.0), viewport)
            .expect("a view")
            .with_target(DepthDirection::Standard, DepthFormat::Depth32Float, 1),
    ];
    let mut dice = dice(21);
    let (mut checked, mut covered) = (0, 0);
    for view in &views {
        for round in 0..400 {
            // From beside the eye to miles out, before and behind.
            let reach = [3.0, 40.0, 2000.0, 1e6][round % 4];
            let mut corner = || {
                let far = if dice.random_range(0..2) == 0 { 3.0 } else { reach };
                Vec3::new(
                    dice.random_range(-far..far),
                    dice.random_range(-far..far),
                    dice.random_range(-far..far),
                )
            };
            let triangle = [corner(), corner(), corner()];
            let mut queries = SoftwareQueries::new();
            draw(&mut queries, view, &[soup(&[triangle])]);
            let got = depth(&queries);
            let clip = triangle.map(|p| *view.clip_from_world() * p.as_dvec3().extend(1.0));
            let pixel = DVec2::new(2.0 / f64::from(width), 2.0 / f64::from(height));
            for (i, &got) in got.iter().enumerate() {
                let (x, y) = (f64::from(i as u32 % width) + 0.5, f64::from(i as u32 / width) + 0.5);
                let ndc = DVec2::new(x * pixel.x - 1.0, 1.0 - y * pixel.y);
                let empty = got == view.depth().cleared();
                match sample(&clip, ndc, pixel) {
                    Want::Either => continue,
                    Want::Empty => assert!(empty, "{triangle:?} covers ({x}, {y}) with {got}"),
                    Want::Covered(want) => {
                        assert!(!empty, "{triangle:?} does not cover ({x}, {y}) of {view:?}");
                        let depth = f64::from(view.depth().nearness(got));
                        assert!(
                            (depth - want).abs() < 0.02,
                            "{triangle:?}: {depth} at ({x}, {y}), not {want}"
                        );
                        covered += 1;
                    }
                }
                checked += 1;
            }
        }
    }
    assert!(checked > 1_000_000 && covered > 50_000, "{checked} samples decided, {covered} covered");
}

/// A ground plane from behind the eye to the horizon, split in two along a diagonal: no sample of
/// the seam is lost where both halves are clipped.
#[test]
fn a_clipped_seam_has_no_gap() {
    let mut dice = dice(9);
    for round in 0..40 {
        let yaw: f32 = dice.random_range(-3.0..3.0);
        let side = [50.0, 3e3, 1e5, 1e7][round % 4];
        let turn = |x: f32, z: f32| {
            let (s, c) = yaw.sin_cos();
            Vec3::new(c * x - s * z, -1.0, s * x + c * z)
        };
        let corners =
            [turn(-side, -side * 1.1), turn(side * 0.9, -side), turn(side, side), turn(-side * 1.2, side)];
        let view = View::look_at(Vec3::ZERO, Vec3::new(0.0, -0.6, -1.0), 70.0, 0.1, Viewport::new(160, 120))
            .expect("a view");
        let mut queries = SoftwareQueries::new();
        let halves = [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]];
        draw(&mut queries, &view, &[soup(&halves)]);
        let image = queries.depth();
        for y in 60..120 {
            let empty = image.row(y).filter(|&n| n == 0.0).count();
            assert_eq!(empty, 0, "round {round}: {empty} samples of row {y} are lost");
        }
    }
}
