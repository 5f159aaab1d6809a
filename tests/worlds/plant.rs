//! The power plant.

use glam::Vec3;
use tercet::geom::Aabb;
use tercet::worlds::{self, Model, Placed, power_plant};

use super::surface::{corners, hull};

#[test]
fn the_plant_has_as_many_objects_and_triangles_as_the_papers() {
    for seed in [0, 1, 2, 42] {
        let plant = worlds::power_plant(seed, 1.0);
        assert_eq!(plant.objects.len(), 11_050, "seed {seed}");
        let millions = plant.triangles() as f64 * 1e-6;
        assert!((18.0..19.5).contains(&millions), "seed {seed}: {millions} million triangles");
        let size = plant.bounds.size();
        assert!(size.x <= 160.0 && size.y <= 55.0 && size.z <= 110.0, "seed {seed}: {size} m");
        assert!(plant.meshes.len() < 60, "the meshes are shared");
    }
}

#[test]
fn scale_changes_the_number_of_objects() {
    for (scale, objects) in [(0.1, 1105), (0.25, 2763), (0.5, 5525), (2.0, 22_100)] {
        assert_eq!(worlds::power_plant(3, scale).objects.len(), objects, "scale {scale}");
    }
    let least = worlds::power_plant(3, 1e-3).objects.len();
    assert!((250..500).contains(&least), "the bare building has {least} objects");
}

#[test]
fn nothing_stands_in_the_cameras_way() {
    const MARGIN: f32 = 0.25;
    for (seed, scale) in [(1, 1.0), (7, 0.3), (3, 0.1), (5, 0.01), (2, 2.5)] {
        let plant = worlds::power_plant(seed, scale);
        let path = power_plant::path(scale);
        let solids: Vec<Aabb> = plant.objects.iter().flat_map(|o| solids(&plant, o)).collect();
        for n in 0..=2000 {
            let eye = path.pose(n as f32 / 2000.0).eye;
            let hit = solids.iter().find(|s| s.distance_squared(eye) < MARGIN * MARGIN);
            assert!(hit.is_none(), "seed {seed}, scale {scale}, sample {n}: {eye} is at {hit:?}");
        }
    }
}

#[test]
fn the_flight_begins_and_ends_outside_and_visits_several_storeys() {
    for scale in [1.0, 0.1] {
        let (path, building) = (power_plant::path(scale), power_plant::interior(scale));
        let inside = |t: f32| building.contains_point(path.pose(t).eye);
        assert!(!inside(0.0) && !inside(1.0));
        let samples: Vec<f32> = (0..1000).map(|n| n as f32 / 1000.0).collect();
        let within = samples.iter().filter(|&&t| inside(t)).count();
        assert!(within > 500, "scale {scale}: only {within} of 1000 samples are inside");
        let walked: Vec<f32> = samples.iter().filter(|&&t| inside(t)).map(|&t| path.pose(t).eye.y).collect();
        let storeys = [1.7, 6.7, 16.7].map(|y| walked.iter().filter(|&&w| (w - y).abs() < 0.2).count());
        assert!(storeys.iter().filter(|&&n| n > 50).count() >= 2, "scale {scale}: {storeys:?}");
    }
}

/// Every level of every procedural mesh is closed (each edge is used as often in one direction
/// as in the other) and faces outward (its volume is positive).
#[test]
fn meshes_are_closed_and_face_outward() {
    let meshes = worlds::power_plant(1, 0.01).meshes.into_iter().chain(worlds::random(1, 1).meshes);
    for mesh in meshes {
        for (l, level) in mesh.levels().iter().enumerate() {
            let (open, volume) = hull(corners(level));
            assert_eq!(open, 0, "{}, level {l}: {open} open edges", mesh.name());
            assert!(volume > 0.0, "{}, level {l}: volume {volume}", mesh.name());
        }
    }
}

/// The boxes that an object is solid in: the pieces of a wall with an opening, else its bounds.
fn solids(model: &Model, object: &Placed) -> Vec<Aabb> {
    let mesh = &model.meshes[object.mesh];
    if !mesh.name().starts_with("wall with") {
        return vec![object.bounds];
    }
    let place = |p: &Vec3| object.world_from_object.transform_point3(*p);
    mesh.levels()[0].positions.chunks(8).map(|piece| Aabb::from_points(piece.iter().map(place))).collect()
}
