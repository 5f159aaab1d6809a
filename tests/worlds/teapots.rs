//! The teapot, and the cloud of them.

use glam::Vec3;
use tercet::draw::Drawable;
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::worlds::{self, Model, Swarm, teapots};

use super::surface::{corners, farthest, hull};

#[test]
fn the_teapots_have_as_many_triangles_as_the_papers() {
    let mesh = worlds::teapot_mesh();
    let counts: Vec<usize> = mesh.levels().iter().map(|l| l.indices.len() / 3).collect();
    assert_eq!(counts, [10, 7, 5, 3, 2, 1].map(|n| 32 * n * n * 2));
    assert_eq!((mesh.triangle_count(), teapot_cloud(1, 2500).triangles()), (6400, 16_000_000));
    let flat = corners(&mesh.levels()[0]).filter(|[a, b, c]| a == b || b == c || c == a).count();
    assert_eq!(flat, 80, "one a quad around the tip of the lid and the middle of the bottom");
    let known = Aabb::new(Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.44, 3.15, 2.0));
    let off = (mesh.bounds().min - known.min).abs().max((mesh.bounds().max - known.max).abs());
    assert!(off.max_element() < 0.01, "y up, the spout toward +x: {:?}", mesh.bounds());
}

/// Patches meet without cracks: the only open edges are those of the sixteen curves that belong
/// to one patch. They are the inner rim, the lid's edge, and both ends of handle and spout.
#[test]
fn the_teapots_patches_meet_and_face_outward() {
    for (level, n) in worlds::teapot_mesh().levels().iter().zip([10, 7, 5, 3, 2, 1]) {
        // At n = 1 handle and spout are flat sheets, whose two sides close each other.
        let curves = if n == 1 { 8 } else { 16 };
        assert_eq!(hull(corners(level)).0, curves * n, "open edges at {n} quads a side");
        let triangles: Vec<_> = corners(level).collect();
        let patches: Vec<_> = triangles.chunks(2 * n * n).collect();
        let part = |patches: &[&[[Vec3; 3]]]| hull(patches.concat().into_iter()).1;
        let pot = part(&[&patches[..12], &patches[28..]].concat());
        let [handle, spout, lid] = [12..16, 16..20, 20..28].map(|range| part(&patches[range]));
        assert!(pot > 10.0 && lid > 2.0, "{n}: pot {pot}, lid {lid}");
        if n > 1 {
            assert!(handle > 0.1 && spout > 0.1, "{n}: handle {handle}, spout {spout}");
        }
    }
}

/// The stated errors bound the distance of the surfaces, sampled densely both ways, and are not
/// much larger than it.
#[test]
fn the_teapots_levels_keep_their_promise() {
    let mesh = worlds::teapot_mesh();
    let levels = mesh.levels();
    assert_eq!(levels[0].error, 0.0);
    for (l, level) in levels.iter().enumerate().skip(1) {
        assert!(level.error > levels[l - 1].error, "level {l}: errors must grow");
        let apart = farthest(&levels[0], level).max(farthest(level, &levels[0]));
        println!("level {l}: {apart} of {}", level.error);
        assert!(apart <= level.error, "level {l}: {apart} > {}", level.error);
        assert!(apart > 0.3 * level.error, "level {l}: {apart} is far below {}", level.error);
    }
}

#[test]
fn the_cloud_is_as_dense_whatever_its_number() {
    let density = |n: usize| n as f32 / teapots::room(n).size().element_product();
    for n in [1, 150, 2500, 1_000_000] {
        assert!((density(n) / density(2500) - 1.0).abs() < 1e-5, "{n}: {}", density(n));
        let scale = teapots::room(n).max.x / teapots::room(2500).max.x;
        let [eye, of_2500] = [n, 2500].map(|n| teapots::path(n).pose(0.3).eye);
        assert!(eye.distance(of_2500 * scale) < 1e-4 * eye.length());
    }
    assert_eq!((teapots::room(0), teapots::room(2500).max), (teapots::room(1), Vec3::splat(19.0)));
}

/// What the flight was made for: nearly all of the cloud is in the picture, and the eye passes
/// through its edge. The shares that are really visible are in docs/measurements.
#[test]
fn the_flight_around_the_teapots_has_nearly_all_in_the_frustum() {
    let (cloud, room, path) = (teapot_cloud(1, 2500), teapots::room(2500), teapots::path(2500));
    let (mut shares, mut inside) = (Vec::new(), 0);
    for n in 0..120 {
        let pose = path.pose(n as f32 / 119.0);
        let viewport = Viewport::new(1280, 720);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, viewport).unwrap();
        let frustum = Frustum::new(&view);
        let seen = cloud.objects.iter().filter(|o| frustum.intersects(&o.bounds)).count();
        shares.push(seen as f32 / cloud.objects.len() as f32);
        inside += usize::from(room.contains_point(pose.eye));
    }
    let mean = shares.iter().sum::<f32>() / shares.len() as f32;
    let least = shares.iter().fold(1.0, |least: f32, &share| least.min(share));
    assert!((0.90..0.97).contains(&mean) && least > 0.6, "mean {mean}, least {least}");
    assert!((4..20).contains(&inside), "{inside} of 120 frames are inside");
    assert!([0.0, 1.0].iter().all(|&t| !room.contains_point(path.pose(t).eye)));
}

/// The cloud of teapots as it is spawned.
pub(super) fn teapot_cloud(seed: u64, count: usize) -> Model {
    let mut world = hecs::World::new();
    let mut cloud = Model::new("teapots");
    cloud.meshes.push(worlds::teapot_mesh());
    Swarm::new(seed, count, cloud.meshes[0].clone(), teapots::room(count)).spawn(&mut world);
    for drawable in world.query_mut::<&Drawable>() {
        cloud.place(0, drawable.world_from_object, drawable.color);
    }
    cloud
}
