//! What moves about: swarms, and the bunny that they are made of.

use glam::Vec3;
use tercet::draw::Drawable;
use tercet::geom::Aabb;
use tercet::scene::Bounds;
use tercet::worlds::{self, Motion, Swarm};

use super::pinned::Fnv;

#[test]
fn a_swarm_stays_in_its_room_and_repeats_itself() {
    let room = Aabb::new(Vec3::new(-6.0, 0.0, -4.0), Vec3::new(6.0, 3.0, 4.0));
    let mesh = worlds::random(1, 1).meshes[3].clone();
    let swarm = Swarm::new(5, 200, mesh.clone(), room);
    let fly = |steps: usize| {
        let mut world = hecs::World::new();
        swarm.spawn(&mut world);
        (0..steps).for_each(|_| swarm.step(&mut world, Swarm::STEP));
        world
    };
    let mut world = fly(600);
    let mut before = fly(0);
    let start: Vec<Motion> = before.query_mut::<&Motion>().into_iter().copied().collect();
    let mut hash = Fnv::default();
    for (n, (bounds, drawable, motion)) in
        world.query_mut::<(&Bounds, &Drawable, &Motion)>().into_iter().enumerate()
    {
        assert!(room.contains_point(motion.position), "{n} is at {}", motion.position);
        assert_ne!(motion.position, start[n].position);
        assert!(
            (1.0..4.01).contains(&motion.velocity.length())
                && motion.velocity.abs() == start[n].velocity.abs()
        );
        let tall = motion.scale * mesh.bounds().size().y;
        assert!((0.79..1.51).contains(&tall), "{n} is {tall} m tall");
        let norm = motion.orientation.iter().map(|c| c * c).sum::<f32>();
        assert!((norm - 1.0).abs() < 1e-5 && motion.orientation != start[n].orientation);
        for p in mesh.levels().iter().flat_map(|l| &l.positions) {
            assert!(bounds.0.contains_point(drawable.world_from_object.transform_point3(*p)));
        }
        motion.position.to_array().iter().for_each(|c| hash.word(c.to_bits()));
        motion.orientation.iter().for_each(|c| hash.word(c.to_bits()));
    }
    assert_eq!(hash.0, 0x3D47_EA98_88F2_DCBB, "the same flight on every machine");
}

#[cfg(feature = "gltf")]
#[test]
fn the_bunny_comes_with_its_levels() {
    let bunny = worlds::bunny_mesh().unwrap();
    assert_eq!((bunny.name(), bunny.triangle_count(), bunny.levels().len()), ("bunny", 69_451, 10));
    let finest = &bunny.levels()[0];
    let mut known: Vec<[u32; 3]> = finest.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    known.sort_unstable();
    for pair in bunny.levels().windows(2) {
        let ratio = pair[0].indices.len() as f32 / pair[1].indices.len() as f32;
        assert!((1.6..2.5).contains(&ratio) && pair[1].error > pair[0].error);
        let from_finest = |p: &Vec3| known.binary_search(&p.to_array().map(f32::to_bits)).is_ok();
        assert!(pair[1].positions.iter().all(from_finest), "every vertex is one of the finest level");
        assert!(pair[1].error < 0.1 * bunny.bounds().size().y);
    }
}

/// What turned meshes gain by [`Mesh::bounds_under`]: measured are 1.022 and 1.024 times the
/// volume of the tightest box, against 2.93 and 3.68 for the box of the turned box.
#[cfg(feature = "gltf")]
#[test]
fn turned_meshes_have_tight_boxes() {
    let room = Aabb::from_center(Vec3::ZERO, Vec3::splat(10.0));
    for (mesh, loose) in [(worlds::bunny_mesh().unwrap(), 2.5), (worlds::teapot_mesh(), 3.2)] {
        let mut world = hecs::World::new();
        Swarm::new(3, 200, mesh.clone(), room).spawn(&mut world);
        let volume = |aabb: Aabb| f64::from(aabb.size().element_product());
        let mut ratios = [0.0; 2];
        for (bounds, drawable) in world.query_mut::<(&Bounds, &Drawable)>() {
            let place = drawable.world_from_object;
            let corners = mesh.levels().iter().flat_map(|l| &l.positions);
            let tightest = volume(Aabb::from_points(corners.map(|&p| place.transform_point3(p))));
            ratios[0] += volume(bounds.0) / tightest / 200.0;
            ratios[1] += volume(mesh.bounds().transformed(&place)) / tightest / 200.0;
        }
        println!("{}: {ratios:?} times the volume", mesh.name());
        assert!(ratios[0] < 1.03 && ratios[1] > loose, "{}: {ratios:?}", mesh.name());
    }
}
