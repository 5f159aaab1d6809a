//! The city.

use tercet::worlds::{self, city};

use super::surface::{corners, hull};

#[test]
fn the_city_has_its_number_of_objects_and_they_are_simple() {
    for (seed, scale, objects) in [(1, 1.0, 200_000), (2, 0.25, 50_000), (3, 0.03, 6000)] {
        let city = worlds::city(seed, scale);
        assert_eq!(city.objects.len(), objects, "seed {seed}, scale {scale}");
        let each = city.triangles() as f64 / objects as f64;
        assert!((30.0..120.0).contains(&each), "seed {seed}, scale {scale}: {each} triangles each");
        assert!(city.meshes.len() < 40, "the meshes are shared");
    }
    let least = worlds::city(3, 1e-3).objects.len();
    assert!((1000..2000).contains(&least), "the bare city has {least} objects");
}

/// Closed and turned outward, so that nothing is seen through.
#[test]
fn the_citys_parts_are_closed() {
    for mesh in worlds::city(1, 0.01).meshes {
        let (open, volume) = hull(corners(&mesh.levels()[0]));
        assert!(open == 0 && volume > 0.0, "{}: {open} open edges, volume {volume}", mesh.name());
    }
}

#[test]
fn nothing_stands_in_the_way_of_those_who_walk_and_run() {
    for (seed, scale) in [(1, 0.2), (7, 0.05), (3, 0.01)] {
        let city = worlds::city(seed, scale);
        for path in [city::path(scale), city::fast_path(scale)] {
            for n in 0..=1000 {
                let eye = path.pose(n as f32 / 1000.0).eye;
                let hit = city.objects.iter().find(|o| o.bounds.distance_squared(eye) < 0.4 * 0.4);
                assert!(hit.is_none(), "seed {seed}, scale {scale}, sample {n}: {eye} is at {hit:?}");
            }
        }
    }
}

/// At street level for most of the walk, above most roofs at the end; at a run the eye turns by more
/// than a right angle within a twentieth of the way, again and again, and looks back where it came from.
#[test]
fn the_walk_rises_above_the_roofs_and_the_run_turns_quickly() {
    let (walk, run) = (city::path(1.0), city::fast_path(1.0));
    let street = (0..200).filter(|&n| walk.pose(n as f32 / 199.0).eye.y < 2.0).count();
    assert!((120..190).contains(&street) && walk.pose(1.0).eye.y > 60.0, "{street} of 200 at street level");
    let forward = |t: f32| (run.pose(t).target - run.pose(t).eye).normalize();
    let turns = (0..20).filter(|&n| {
        (0..20).any(|k| {
            let at = n as f32 / 20.0;
            forward(at).dot(forward(at + k as f32 / 400.0)) < 0.0
        })
    });
    let turns = turns.count();
    let backward = (1..200).filter(|&n| {
        let [before, at] = [n - 1, n].map(|n| run.pose(n as f32 / 199.0));
        (at.eye - before.eye).dot(at.target - at.eye) < 0.0
    });
    let backward = backward.count();
    assert!(turns >= 5 && backward >= 40, "{turns} quick turns, {backward} of 200 frames backwards");
}
