//! Each extreme in whole frames, by name: every policy on the software backend, against the oracle.

use glam::{DVec3, Mat4, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};
use tercet::query::software::SimdLevel;
use tercet::scene::{Scene, SceneConfig, Traits};
use tercet::tree::{Straddlers, TreeConfig};

use super::flight::{Flight, Placed, fly, wall_and_crowd};
use super::setting;

const SCREEN: Viewport = Viewport::new(96, 64);

fn honest(boxes: impl IntoIterator<Item = Aabb>) -> Vec<Placed> {
    boxes.into_iter().map(Placed::honest).collect()
}

/// From `distance` before the wall, straight at it, and from a little beside.
fn toward_the_wall(distance: f32, fov: f32, near: f32, viewport: Viewport) -> Vec<View> {
    [0.0, 0.05]
        .map(|beside| {
            let eye = Vec3::new(beside, 0.02, 1.0) * distance;
            View::look_at(eye, Vec3::ZERO, fov, near, viewport).expect("a view")
        })
        .to_vec()
}

/// The suite finds a lost object: one that stands before the wall, and is said to stand behind it.
#[test]
#[should_panic(expected = "lost")]
fn a_lie_about_bounds_is_found_out() {
    let mut world = honest(wall_and_crowd(1.0));
    let hidden = world[1].drawn;
    world.last_mut().expect("there are some").told = hidden;
    fly(&world, &toward_the_wall(15.0, 60.0, 0.1, SCREEN), false);
}

#[test]
fn coordinates_to_1e7_and_sizes_from_1e_6_to_1e7() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut power = |low: f32, high: f32| 10f32.powf(rng.random_range(low..=high));
    let mut scattered: Vec<Aabb> = Vec::new();
    for i in 0..200 {
        let toward = Vec3::new((i % 3) as f32 - 1.0, (i / 3 % 3) as f32 - 1.0, -((i / 9 % 2) as f32));
        let (far, size) = (power(-6.0, 7.0), power(-6.0, 7.0));
        let center = (toward * far).clamp(Vec3::splat(-1e7), Vec3::splat(1e7));
        let half = Vec3::new(size, size * power(-3.0, 0.0), size) * 0.5;
        // What would stand before the wall is put behind it.
        scattered.push(Aabb::from_center(center - Vec3::Z * (half.z + 1.0), half));
    }
    for scale in [1e-5, 1.0, 1e5] {
        let world = honest(wall_and_crowd(scale).into_iter().chain(scattered.iter().copied()));
        fly(&world, &toward_the_wall(15.0 * scale, 60.0, 0.01 * scale, SCREEN), true);
    }
}

/// Metres at 1e7 m from the origin: f32 has a step of one metre there. Little can be culled, and
/// nothing is lost.
#[test]
fn metres_at_1e7_metres() {
    let away = Vec3::new(1e7, -1e7, 1e7);
    let moved = |aabb: Aabb| Aabb::new(aabb.min + away, aabb.max + away);
    let world = honest(wall_and_crowd(1.0).into_iter().map(moved));
    let eye = away + Vec3::new(1.0, 2.0, 15.0);
    let view = View::look_at(eye, away, 60.0, 0.1, SCREEN).expect("a view");
    fly(&world, &[view], false);
}

#[test]
fn far_near_ratios_of_1e9() {
    let world = honest(wall_and_crowd(1.0));
    let view_from_world = Mat4::from_translation(Vec3::new(0.0, 0.0, -15.0));
    let (fov, aspect, near, far) = (1.0, 1.5, 1e-2, 1e7);
    for (clip_from_view, depth, format, culls) in [
        (
            projection::perspective_finite(fov, aspect, near, far),
            DepthDirection::Reversed,
            DepthFormat::Depth32Float,
            true,
        ),
        // All that is farther than some metres has the same depth here: it counts as visible.
        (
            projection::perspective_standard(fov, aspect, near, far),
            DepthDirection::Standard,
            DepthFormat::Depth32Float,
            false,
        ),
        (
            projection::perspective_standard(fov, aspect, near, far),
            DepthDirection::Standard,
            DepthFormat::Depth24Plus,
            false,
        ),
    ] {
        let view =
            View::new(view_from_world, clip_from_view, SCREEN).expect("a view").with_target(depth, format, 1);
        fly(&world, &[view], culls);
    }
}

#[test]
fn fields_of_view_from_a_tenth_of_a_degree_to_179() {
    let world = honest(wall_and_crowd(1.0));
    // At 179 degrees a pixel of a small screen is larger than the wall.
    let viewport = Viewport::new(960, 640);
    for fov in [0.1, 1.0, 120.0, 179.0] {
        fly(&world, &toward_the_wall(15.0, fov, 0.1, viewport), true);
    }
}

/// On a machine with 8 GiB to spare, `TERCET_LARGE=1` adds 16384 × 16384.
#[test]
fn viewports_from_1x1_to_16384() {
    const MOST: u32 = Viewport::MAX_SIDE;
    let world = honest(wall_and_crowd(1.0));
    for viewport in
        [Viewport::new(1, 1), Viewport::new(1, 64), Viewport::new(MOST, 1), Viewport::new(1, MOST)]
    {
        fly(&world, &toward_the_wall(15.0, 60.0, 0.1, viewport)[..1], true);
    }
    if setting("TERCET_LARGE", 0) != 0 {
        let view = &toward_the_wall(15.0, 60.0, 0.1, Viewport::new(MOST, MOST))[0];
        // One frame, so the leaves are to be fine before the first question.
        let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::default() };
        let mut flight = Flight::new(&world, tree, "dual-query", SimdLevel::detect());
        let outcome = flight.frame(view);
        assert!(outcome.culled > 0, "{outcome:?}");
    } else {
        eprintln!("16384 × 16384 is skipped: set TERCET_LARGE=1");
    }
}

#[test]
fn flat_linear_and_point_like_boxes() {
    let thin = |(i, mut aabb): (usize, Aabb)| {
        // The wall stays a wall, without thickness.
        let flat = if i == 0 { 0b100 } else { i % 8 };
        for axis in (0..3).filter(|axis| flat & (1 << axis) != 0) {
            aabb.max[axis] = aabb.min[axis];
        }
        aabb
    };
    let world = honest(wall_and_crowd(1.0).into_iter().enumerate().map(thin));
    fly(&world, &toward_the_wall(15.0, 60.0, 0.1, SCREEN), true);
}

#[test]
fn boxes_touching_the_frustum_planes() {
    let view = View::new(
        Mat4::from_translation(Vec3::new(0.0, 0.0, -16.0)),
        projection::orthographic(16.0, 16.0, 0.0, 64.0),
        Viewport::new(64, 64),
    )
    .expect("a view");
    // The planes are x = ±8, y = ±8, z = 16 and z = −48: boxes on both sides of each touch it.
    let touching = [-8.0f32, 8.0].into_iter().flat_map(|at| {
        [-1.0f32, 1.0].into_iter().flat_map(move |side| {
            let x = Aabb::from_points([Vec3::new(at, -1.0, 1.0), Vec3::new(at + side, 1.0, 2.0)]);
            let y = Aabb::from_points([Vec3::new(-1.0, at, 1.0), Vec3::new(1.0, at + side, 2.0)]);
            [x, y]
        })
    });
    let depths = [16.0f32, -48.0].into_iter().flat_map(|at| {
        [-1.0f32, 1.0]
            .map(|side| Aabb::from_points([Vec3::new(5.0, 5.0, at), Vec3::new(6.0, 6.0, at + side)]))
    });
    let world = honest(wall_and_crowd(0.25).into_iter().chain(touching).chain(depths));
    fly(&world, &[view], true);
}

/// `TERCET_COINCIDENT` sets how many: a million of them take some minutes.
#[test]
fn a_million_coincident_objects() {
    let count = setting("TERCET_COINCIDENT", 20_000) as usize;
    // Behind the wall, beside the crowd.
    let behind = Aabb::from_center(Vec3::new(13.0, 0.0, -5.0), Vec3::ONE);
    let mut world = honest(wall_and_crowd(1.0));
    world.extend((0..count).map(|_| Placed::honest(behind)));
    let views = toward_the_wall(15.0, 60.0, 0.1, SCREEN);
    for straddlers in [Straddlers::Split, Straddlers::Leaf, Straddlers::StayInParent] {
        let tree = TreeConfig { straddlers, ..TreeConfig::default() };
        let mut flight = Flight::new(&world, tree, "dual-query", SimdLevel::detect());
        // They stand in one leaf, and come out as one.
        assert!(flight.scene.tree().stats().nodes < 1000, "{:?}", flight.scene.tree().stats());
        let outcomes: Vec<_> = views.iter().map(|view| flight.frame(view)).collect();
        assert!(outcomes.iter().all(|o| o.culled >= count), "{outcomes:?}");
        // Seen from behind they all own samples, the same ones: ties count.
        let back =
            View::look_at(Vec3::new(13.5, 0.5, -11.0), behind.center(), 60.0, 0.1, SCREEN).expect("a view");
        let outcome = flight.frame(&back);
        assert!(outcome.visible >= count, "{outcome:?}");
    }
}

/// What the bounds of a hidden object say is no box: it is drawn always; all others are culled as ever,
/// and once it is mended so is it.
#[test]
fn nan_infinite_and_inverted_boxes() {
    let mut world = honest(wall_and_crowd(1.0));
    for (i, placed) in world.iter_mut().enumerate().filter(|(i, _)| i % 4 == 1) {
        let told = &mut placed.told;
        match i / 4 % 5 {
            0 => told.min.x = f32::NAN,
            1 => told.max = Vec3::INFINITY,
            2 => (told.min.y, told.max.y) = (told.max.y + 1.0, told.min.y),
            3 => *told = Aabb::new(Vec3::NAN, Vec3::NAN),
            _ => told.min.z = f32::NEG_INFINITY,
        }
    }
    let bad = world.iter().filter(|p| !p.told.is_valid()).count();
    let views = toward_the_wall(15.0, 60.0, 0.1, SCREEN);
    fly(&world, &views, true);

    let mut flight = Flight::new(&world, TreeConfig::default(), "dual-query", SimdLevel::detect());
    assert_eq!(flight.scene.objects().filter(|o| o.bad).count(), bad);
    let before = flight.frame(&views[0]);
    for (i, placed) in world.iter().enumerate() {
        assert!(flight.scene.set_bounds(flight.objects[i].0, placed.drawn));
    }
    flight.scene.update();
    assert_eq!(flight.scene.objects().filter(|o| o.bad).count(), 0);
    let after = flight.frame(&views[0]);
    assert!(after.culled > before.culled, "{before:?}, then {after:?}");
}

/// Centimetres at 1e7 m from the origin: told in f32 nothing can be culled there; near a new origin
/// all is. The exact visible set is the same before and after.
#[test]
fn rebasing_makes_centimetres_precise_again() {
    let away = DVec3::new(1e7, -1e7, 1e7);
    let near = wall_and_crowd(0.01);
    let bounds = |aabb: &Aabb, origin: DVec3| {
        Aabb::from_f64(away + aabb.min.as_dvec3(), away + aabb.max.as_dvec3(), origin)
    };
    // The app draws relative to where the camera is, as apps for large worlds do.
    let view = View::look_at(Vec3::new(0.0, 0.02, 0.15), Vec3::ZERO, 60.0, 1e-3, SCREEN).expect("a view");
    let told =
        |origin: DVec3| near.iter().map(move |aabb| Placed { drawn: *aabb, told: bounds(aabb, origin) });

    let world: Vec<_> = told(DVec3::ZERO).collect();
    let mut flight = Flight::new(&world, TreeConfig::default(), "dual-query", SimdLevel::detect());
    let coarse: Vec<Aabb> = world.iter().map(|placed| placed.told).collect();
    assert!(coarse.iter().all(|aabb| aabb.size().min_element() >= 1.0), "f32 has steps of a metre there");

    flight.scene.rebase(away);
    flight.scene.tree().validate().expect("a valid tree");
    for ((id, _), aabb) in flight.objects.iter().zip(&near) {
        let held = flight.scene.object(*id).expect("it is there").bounds.expect("it is in the tree");
        assert!(held.contains(aabb), "{held:?} does not hold {aabb:?}");
    }
    let before = flight.frame(&view);
    let exact_before = flight.truth(&view).exact;
    assert_eq!(before.culled, 0, "every box holds the eye");

    // The app tells the bounds again, now relative to the new origin.
    let moved: Vec<_> = flight.objects.iter().map(|(id, _)| *id).zip(told(away).map(|p| p.told)).collect();
    assert_eq!(flight.scene.sync_moved(moved), 0);
    let after = flight.frame(&view);
    assert_eq!(flight.truth(&view).exact, exact_before);
    assert_eq!(after.visible, before.visible);
    assert!(after.culled >= 50, "precise again: {after:?}");
}

/// To and fro a thousand times: no box shrinks, and none grows where the translation is exact.
#[test]
fn rebasing_to_and_fro_does_not_drift() {
    let mut scene = Scene::new(SceneConfig::default());
    let boxes = wall_and_crowd(1.0);
    let whole = |aabb: &Aabb| Aabb::new(aabb.min.floor(), aabb.max.ceil());
    let ids: Vec<_> = boxes.iter().map(|b| scene.insert(whole(b), Traits::default())).collect();
    scene.update();
    for step in 0..1000 {
        scene.rebase(DVec3::splat(f64::from(step % 7) * 1024.0));
    }
    scene.rebase(DVec3::ZERO);
    scene.tree().validate().expect("a valid tree");
    for (id, aabb) in ids.iter().zip(&boxes) {
        assert_eq!(scene.object(*id).and_then(|o| o.bounds), Some(whole(aabb)));
    }
}
