//! What holds for every model and every path.

use glam::Vec3;
use tercet::draw::Drawable;
use tercet::geom::Aabb;
use tercet::scene::Bounds;
use tercet::worlds::{self, CameraPath, Pathology};

use super::surface::{corners, point_to_triangle};

#[test]
fn a_path_goes_through_its_points_without_jumps() {
    let points =
        [Vec3::ZERO, Vec3::new(10.0, 0.0, 0.0), Vec3::new(10.0, 0.5, 0.0), Vec3::new(0.0, 30.0, 5.0)];
    let path = CameraPath::new(45.0, points.map(|p| (p, p + Vec3::Z)));
    assert_eq!((path.pose(0.0).eye, path.pose(1.0).eye), (points[0], points[3]));
    assert_eq!((path.pose(-1.0), path.pose(f32::NAN)), (path.pose(0.0), path.pose(0.0)));
    assert_eq!(path.pose(0.5).fov_y_degrees, 45.0);
    let eyes: Vec<Vec3> = (0..=10_000).map(|n| path.pose(n as f32 * 1e-4).eye).collect();
    for point in points {
        let nearest = eyes.iter().map(|e| e.distance(point)).fold(f32::MAX, f32::min);
        assert!(nearest < 0.01, "{point} is passed at {nearest} m");
    }
    assert!(eyes.windows(2).all(|w| w[0].distance(w[1]) < 0.02));
    let still = CameraPath::new(60.0, [(Vec3::ONE, Vec3::ZERO)]);
    assert_eq!(still.pose(0.7).eye, Vec3::ONE);
}

#[test]
fn bounds_hold_every_vertex_of_every_level() {
    let mut models = vec![worlds::power_plant(1, 0.05), worlds::random(9, 500)];
    models.extend(Pathology::ALL.map(worlds::pathological));
    for model in models {
        let union = model.objects.iter().fold(Aabb::EMPTY, |all, o| all.union(&o.bounds));
        assert_eq!(model.bounds, union, "{}", model.name);
        for (n, object) in model.objects.iter().enumerate() {
            assert!(object.bounds.is_valid() && model.bounds.contains(&object.bounds), "{} {n}", model.name);
            for p in model.meshes[object.mesh].levels().iter().flat_map(|l| &l.positions) {
                let p = object.world_from_object.transform_point3(*p);
                assert!(
                    object.bounds.contains_point(p),
                    "{} {n}: {p} outside {:?}",
                    model.name,
                    object.bounds
                );
            }
        }
    }
}

/// The stated error of a level bounds the distance of the surfaces, sampled at vertices both ways.
#[test]
fn levels_keep_their_promise() {
    let others = [worlds::satellites(1, 0.01), worlds::factory(1, 0.01)];
    let others = others.into_iter().flat_map(|model| model.meshes);
    for mesh in worlds::power_plant(1, 0.01).meshes.into_iter().chain(others) {
        let levels = mesh.levels();
        assert_eq!(levels[0].error, 0.0, "{}", mesh.name());
        for pair in levels.windows(2) {
            assert!(pair[1].error > pair[0].error, "{}: errors must grow", mesh.name());
            assert!(pair[1].indices.len() < pair[0].indices.len(), "{}: levels must shrink", mesh.name());
        }
        for (l, level) in levels.iter().enumerate().skip(1) {
            for (from, to) in [(&levels[0], level), (level, &levels[0])] {
                let step = (from.positions.len() / 40).max(1);
                for p in from.positions.iter().step_by(step) {
                    let distance = corners(to).map(|t| point_to_triangle(*p, t)).fold(f32::MAX, f32::min);
                    let error = level.error;
                    let bound = error * 1.001 + 1e-5;
                    assert!(distance <= bound, "{}, level {l}: {distance} > {error} at {p}", mesh.name());
                }
            }
        }
    }
}

#[test]
fn a_model_spawns_what_it_holds() {
    let model = worlds::random(4, 50);
    let mut world = hecs::World::new();
    model.spawn(&mut world);
    let spawned: Vec<(Aabb, glam::Affine3A, [u8; 3])> = world
        .query_mut::<(&Bounds, &Drawable)>()
        .into_iter()
        .map(|(b, d)| (b.0, d.world_from_object, d.color))
        .collect();
    let held: Vec<_> = model.objects.iter().map(|o| (o.bounds, o.world_from_object, o.color)).collect();
    assert_eq!(spawned, held);
}

#[test]
fn pathologies_are_what_their_names_say() {
    let world = |kind| worlds::pathological(kind).objects;
    assert!(world(Pathology::Coincident).windows(2).all(|w| w[0].bounds == w[1].bounds));
    assert!(world(Pathology::Points).iter().filter(|o| o.bounds.min == o.bounds.max).count() >= 500);
    assert!(world(Pathology::Huge).iter().any(|o| o.bounds.size().min_element() > 10_000.0));
    let shells = world(Pathology::Shells);
    assert!(shells.windows(2).all(|w| w[1].bounds.contains(&w[0].bounds) && w[0].bounds != w[1].bounds));
    let sizes: Vec<f32> = world(Pathology::Extremes).iter().map(|o| o.bounds.size().max_element()).collect();
    assert!(sizes.iter().any(|&s| s < 1e-4) && sizes.iter().any(|&s| s > 1e6));
    assert!(world(Pathology::Grid).iter().all(|o| o.bounds.size() == Vec3::ONE));
    assert_eq!((world(Pathology::Single).len(), world(Pathology::Empty).len()), (1, 0));
}
