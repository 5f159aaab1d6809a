//! Which samples a triangle covers, and how near they are.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rand::RngExt;
use tercet::geom::{DepthDirection, DepthFormat, View, Viewport, projection};
use tercet::query::QueryBackend;
use tercet::query::software::{SimdLevel, SoftwareQueries};
use tercet::scene::mesh::Mesh;

use crate::support::{LEVELS, add, depth, dice, draw, pixel_view, pool, reference, soup, triangles};

/// Checks a frame of one triangle against the reference; returns what is wrong with it.
fn check(triangle: &[Vec3; 3], width: u32, height: u32, got: &[f32]) -> Result<(), String> {
    let (low, high) = triangle.iter().fold((1.0_f32, 0.0_f32), |(l, h), v| (l.min(v.z), h.max(v.z)));
    let allowed = 8.0 * f64::from(f32::EPSILON) * f64::from(high);
    for (i, (want, &got)) in reference(triangle, width, height).iter().zip(got).enumerate() {
        let (x, y) = (i as u32 % width, i as u32 / width);
        match want {
            None if got != 0.0 => return Err(format!("{triangle:?} covers ({x}, {y}), which it should not")),
            Some(_) if got == 0.0 => return Err(format!("{triangle:?} does not cover ({x}, {y})")),
            Some(want) if (want - f64::from(got)).abs() > allowed => {
                return Err(format!("{triangle:?} has {got} at ({x}, {y}), not {want}"));
            }
            Some(_) if got < low || got > high => {
                return Err(format!("{triangle:?} has {got} at ({x}, {y}), beyond its corners"));
            }
            _ => {}
        }
    }
    Ok(())
}

#[test]
fn each_triangle_covers_what_the_reference_says() {
    let sizes = [(64, 32), (32, 64), (1, 1), (256, 128), (16_384, 2), (2, 16_384)];
    for (seed, (width, height)) in sizes.into_iter().enumerate() {
        let count = if width * height < 4096 { 600 } else { 60 };
        let view = pixel_view(width, height);
        for level in LEVELS {
            let mut queries = SoftwareQueries::with_level(level);
            for triangle in triangles(&mut dice(seed as u64), count, width, height) {
                draw(&mut queries, &view, &[soup(&[triangle])]);
                check(&triangle, width, height, &depth(&queries)).unwrap();
            }
        }
    }
}

#[test]
fn the_check_sees_a_wrong_sample() {
    let triangle = [Vec3::new(2.0, 2.0, 0.5), Vec3::new(30.0, 3.0, 0.6), Vec3::new(7.0, 30.0, 0.7)];
    let mut queries = SoftwareQueries::new();
    draw(&mut queries, &pixel_view(32, 32), &[soup(&[triangle])]);
    let right = depth(&queries);
    check(&triangle, 32, 32, &right).unwrap();
    let covered = right.iter().position(|&n| n > 0.0).expect("a covered sample");
    for wrong in [0.0, right[covered] + 1e-5, 0.49, 0.71] {
        let mut image = right.clone();
        image[covered] = wrong;
        assert!(check(&triangle, 32, 32, &image).is_err(), "{wrong} passes for {}", right[covered]);
    }
    let mut image = right.clone();
    image[0] = 0.5;
    assert!(check(&triangle, 32, 32, &image).is_err(), "a surplus sample passes");
}

#[test]
fn the_nearest_triangle_of_many_wins() {
    let (width, height) = (128, 64);
    let all = triangles(&mut dice(7), 400, width, height);
    let mut want = vec![(0.0_f64, 0.0_f64); (width * height) as usize];
    for triangle in &all {
        let greatest = triangle.iter().fold(0.0_f32, |h, v| h.max(v.z));
        for (pixel, sample) in want.iter_mut().zip(reference(triangle, width, height)) {
            if let Some(nearness) = sample {
                pixel.0 = pixel.0.max(nearness);
                pixel.1 = pixel.1.max(f64::from(greatest));
            }
        }
    }
    let mut queries = SoftwareQueries::new();
    draw(&mut queries, &pixel_view(width, height), &[soup(&all)]);
    for (i, (got, (want, greatest))) in depth(&queries).iter().zip(&want).enumerate() {
        let allowed = 8.0 * f64::from(f32::EPSILON) * greatest;
        assert!((f64::from(*got) - want).abs() <= allowed, "sample {i} has {got}, not {want}");
    }
}

/// A fan around a point covers each sample of its outline once: checked with the edges' other
/// triangles drawn apart, so that an overlap or a gap shows.
#[test]
fn fans_are_watertight() {
    let mut dice = dice(3);
    for round in 0..60 {
        let (width, height) = (64, 64);
        let spokes = dice.random_range(3..12);
        let grid = [1.0 / 256.0, 0.5, 1.0][round % 3];
        let on = |v: f32| (v / grid).round() * grid;
        let hub = Vec3::new(on(dice.random_range(20.0..44.0)), on(dice.random_range(20.0..44.0)), 0.5);
        // Far corners: the fan covers the viewport whole, however the rounding falls.
        let rim: Vec<Vec3> = (0..spokes)
            .map(|i| {
                let angle = (i as f32 + dice.random_range(0.0..0.5)) / spokes as f32 * std::f32::consts::TAU;
                let reach = dice.random_range(400.0..900.0);
                Vec3::new(on(hub.x + reach * angle.cos()), on(hub.y + reach * angle.sin()), 0.5)
            })
            .collect();
        let mut hits = vec![0; (width * height) as usize];
        let mut queries = SoftwareQueries::new();
        for i in 0..rim.len() {
            draw(
                &mut queries,
                &pixel_view(width, height),
                &[soup(&[[hub, rim[i], rim[(i + 1) % rim.len()]]])],
            );
            for (hit, nearness) in hits.iter_mut().zip(depth(&queries)) {
                *hit += usize::from(nearness > 0.0);
            }
        }
        assert!(hits.iter().all(|&h| h == 1), "round {round}: samples hit {:?} times", {
            let mut other: Vec<_> = hits.iter().filter(|&&h| h != 1).collect();
            other.dedup();
            other
        });
    }
}

/// A scene with every kind of triangle, in perspective.
fn mixed_scene(seed: u64) -> Vec<Mesh> {
    let mut dice = dice(seed);
    (0..60)
        .map(|_| {
            let at = Vec3::new(
                dice.random_range(-12.0..12.0),
                dice.random_range(-8.0..8.0),
                dice.random_range(-40.0..2.0),
            );
            let size = [0.02, 0.3, 2.0, 20.0][dice.random_range(0..4)];
            let all: Vec<[Vec3; 3]> = (0..dice.random_range(1..200))
                .map(|_| {
                    let mut v = || {
                        at + size
                            * Vec3::new(
                                dice.random_range(-1.0..1.0),
                                dice.random_range(-1.0..1.0),
                                dice.random_range(-1.0..1.0),
                            )
                    };
                    [v(), v(), v()]
                })
                .collect();
            soup(&all)
        })
        .collect()
}

#[test]
fn depth_is_the_same_bits_at_every_level_and_thread_count() {
    for (width, height) in [(1, 1), (1, 37), (17, 3), (333, 211), (1023, 767)] {
        let reversed =
            View::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 0.1, Viewport::new(width, height)).expect("a view");
        let standard = View::new(
            reversed.view_from_world(),
            projection::perspective_standard(1.2, width as f32 / height as f32, 0.1, 30.0),
            Viewport::new(width, height),
        )
        .expect("a view")
        .with_target(DepthDirection::Standard, DepthFormat::Depth32Float, 1);
        for view in [&reversed, &standard] {
            let meshes = mixed_scene(11);
            let mut first: Option<Vec<u32>> = None;
            for threads in [1, 2, 4] {
                pool(threads).install(|| {
                    for level in LEVELS {
                        let mut queries = SoftwareQueries::with_level(level);
                        // Twice: the second frame runs on used buffers.
                        for _ in 0..2 {
                            draw(&mut queries, view, &meshes[..30]);
                            add(&mut queries, &meshes[30..]);
                        }
                        let bits: Vec<u32> = depth(&queries).iter().map(|n| n.to_bits()).collect();
                        let want = first.get_or_insert_with(|| bits.clone());
                        assert!(
                            *want == bits,
                            "{width}×{height}, {threads} threads, {level:?}: depth differs"
                        );
                    }
                });
            }
            let cleared = view.depth().cleared();
            let drawn = first.expect("a frame").iter().filter(|&&b| f32::from_bits(b) > cleared).count();
            assert!(drawn > 0 || width == 1, "nothing drawn at {width}×{height}");
        }
    }
}

/// Drawing again changes no sample: the same triangle gives the same bits whatever it is drawn
/// among, and skipped draw calls are skipped rightly.
#[test]
fn drawing_again_changes_nothing() {
    let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 0.1, Viewport::new(200, 150)).expect("a view");
    let meshes = mixed_scene(5);
    let mut together = SoftwareQueries::new();
    draw(&mut together, &view, &meshes);
    let want = depth(&together);
    let mut apart = SoftwareQueries::with_level(SimdLevel::Portable);
    apart.begin(&view).expect("begin");
    for mesh in meshes.iter().rev() {
        add(&mut apart, std::slice::from_ref(mesh));
    }
    add(&mut apart, &meshes);
    assert!(depth(&apart) == want);
    assert!(apart.stats().skipped_calls > together.stats().skipped_calls, "no call was found hidden");
}

/// Small things just before, in and just behind a wall: those behind are skipped, and nothing else.
#[test]
fn hidden_draw_calls_are_skipped_and_no_others() {
    let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 0.1, Viewport::new(200, 150)).expect("a view");
    let mut dice = dice(31);
    let wall = soup(&[[
        Vec3::new(-99.0, -99.0, -10.0),
        Vec3::new(99.0, -99.0, -10.0),
        Vec3::new(0.0, 150.0, -10.0),
    ]]);
    let things: Vec<Mesh> = (0..200)
        .map(|i| {
            let at = Vec3::new(dice.random_range(-5.0..5.0), dice.random_range(-4.0..4.0), -10.0);
            let depth = [0.0, 1e-6, 1e-3, 0.5][i % 4] * dice.random_range(-1.0..1.0_f32);
            let mut v = || at + Vec3::new(dice.random_range(-0.5..0.5), dice.random_range(-0.5..0.5), depth);
            soup(&[[v(), v(), v()]])
        })
        .collect();
    let mut wall_last = SoftwareQueries::new();
    draw(&mut wall_last, &view, &things);
    // A few cover no sample.
    let nothing = wall_last.stats().skipped_calls;
    assert!(nothing < 10, "{nothing} draw calls are skipped that nothing hides");
    add(&mut wall_last, std::slice::from_ref(&wall));
    let mut wall_first = SoftwareQueries::new();
    draw(&mut wall_first, &view, std::slice::from_ref(&wall));
    add(&mut wall_first, &things);
    assert!(depth(&wall_last) == depth(&wall_first));
    assert!(wall_first.stats().skipped_calls > nothing + 40, "{:?}", wall_first.stats());
}

#[test]
fn broken_transforms_draw_nothing_and_do_not_panic() {
    let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 0.1, Viewport::new(64, 48)).expect("a view");
    let mesh = soup(&[[Vec3::new(-1.0, -1.0, -3.0), Vec3::new(1.0, -1.0, -3.0), Vec3::new(0.0, 1.0, -3.0)]]);
    let mut queries = SoftwareQueries::new();
    queries.begin(&view).expect("begin");
    let huge = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 0.0];
    queries
        .draw(|pass| {
            for value in huge {
                pass.draw_mesh(
                    &mesh,
                    &Affine3A { matrix3: Mat3A::IDENTITY, translation: Vec3A::new(value, 0.0, 1e30) },
                );
                pass.draw_mesh(&mesh, &Affine3A::from_scale(Vec3::new(value, value, value)));
                let mut skewed = Affine3A::IDENTITY;
                skewed.matrix3.x_axis.z = value;
                skewed.translation.z = 1e30;
                pass.draw_mesh(&mesh, &skewed);
            }
        })
        .expect("draw");
    assert!(depth(&queries).iter().all(|n| n.is_finite()));
}
