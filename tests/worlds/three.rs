//! The three worlds of many triangles: satellites, a factory, a valley with a castle.

use tercet::worlds::{self, Model, Placed, factory, fantasy, satellites};

use super::surface::{corners, hull};

#[test]
fn the_three_worlds_of_many_triangles_have_theirs() {
    // Objects at scale 1, and how many triangles each has on average.
    let count = |name: &str, model: &Model, objects: usize, each: std::ops::Range<f64>| {
        let mean = model.triangles() as f64 / model.objects.len() as f64;
        println!("{name}: {} objects, {} triangles, {mean} each", model.objects.len(), model.triangles());
        assert_eq!(model.objects.len(), objects, "{name}");
        assert!(each.contains(&mean), "{name}: {mean} triangles each");
    };
    count("satellites", &worlds::satellites(1, 1.0), 80 * 254, 1000.0..2000.0);
    count("factory", &worlds::factory(1, 1.0), 16_000, 1000.0..2000.0);
    count("fantasy", &worlds::fantasy(1, 1.0), 600, 6000.0..16_000.0);
    assert_eq!(worlds::satellites(2, 0.05).objects.len(), 4 * 254);
    assert_eq!(worlds::factory(2, 0.1).objects.len(), 1600);
    assert_eq!(worlds::fantasy(2, 0.25).objects.len(), 150);
    let least = [worlds::satellites(3, 1e-3), worlds::factory(3, 1e-3), worlds::fantasy(3, 1e-3)];
    let least = least.map(|model| model.objects.len());
    println!("at the least {least:?}");
    assert!(least[0] == 254 && (500..1300).contains(&least[1]) && least[2] == 51, "{least:?}");
}

/// Closed and turned outward, so that nothing is seen through; coarser levels are simpler.
#[test]
fn the_parts_of_the_three_worlds_are_closed() {
    let models = [worlds::satellites(1, 0.01), worlds::factory(1, 0.01), worlds::fantasy(1, 0.01)];
    for mesh in models.iter().flat_map(|model| &model.meshes).filter(|mesh| mesh.name() != "teapot") {
        for (l, level) in mesh.levels().iter().enumerate() {
            let (open, volume) = hull(corners(level));
            assert!(open == 0 && volume > 0.0, "{}, {l}: {open} open edges, volume {volume}", mesh.name());
        }
    }
}

#[test]
fn nothing_stands_in_the_way_through_the_three_worlds() {
    for (seed, scale) in [(1, 1.0), (7, 0.2), (3, 0.02)] {
        let worlds = [
            (worlds::satellites(seed, scale), satellites::path(scale)),
            (worlds::factory(seed, scale), factory::path(scale)),
            (worlds::fantasy(seed, scale), fantasy::path(scale)),
        ];
        for (model, path) in worlds {
            // The land has its own bounds in the fantasy's way; what stands on it has not.
            let solid = |o: &&Placed| !["land", "gate"].contains(&model.meshes[o.mesh].name());
            for n in 0..=1000 {
                let eye = path.pose(n as f32 / 1000.0).eye;
                let hit =
                    model.objects.iter().filter(solid).find(|o| o.bounds.distance_squared(eye) < 0.4 * 0.4);
                assert!(
                    hit.is_none(),
                    "{}, sample {n}: {eye} is at {:?}",
                    model.name,
                    hit.map(|o| (model.meshes[o.mesh].name(), o.bounds))
                );
            }
        }
    }
}
