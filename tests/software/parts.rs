//! Meshes of many parts: what is left out of them changes no sample.

use glam::Vec3;
use rand::RngExt;
use tercet::geom::{View, Viewport};
use tercet::query::software::SoftwareQueries;
use tercet::scene::mesh::Mesh;

use crate::support::{LEVELS, depth, dice, draw, pool, soup};

/// A closed, bumpy surface around a point, by rings: triangles of many sizes.
fn bumpy(seed: u64, centre: Vec3, radius: f32, rings: u32) -> Mesh {
    let mut dice = dice(seed);
    let spokes = 2 * rings;
    let mut positions = Vec::new();
    for ring in 0..=rings {
        let polar = ring as f32 / rings as f32 * std::f32::consts::PI;
        for spoke in 0..spokes {
            let around = spoke as f32 / spokes as f32 * std::f32::consts::TAU;
            let direction = Vec3::new(polar.sin() * around.cos(), polar.cos(), polar.sin() * around.sin());
            positions.push(centre + direction * radius * dice.random_range(0.7..1.0));
        }
    }
    let quad = |ring: u32, spoke: u32| {
        let next = (spoke + 1) % spokes;
        let [a, b] = [spoke, next].map(|s| ring * spokes + s);
        let [c, d] = [spoke, next].map(|s| (ring + 1) * spokes + s);
        [a, c, b, b, c, d]
    };
    let quads = (0..rings).flat_map(|ring| (0..spokes).map(move |spoke| (ring, spoke)));
    Mesh::new("bumpy", positions, quads.flat_map(|(ring, spoke)| quad(ring, spoke)).collect())
        .expect("a mesh")
}

fn view() -> View {
    View::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 0.5, Viewport::new(150, 210)).expect("a view")
}

/// The greatest nearness of each pixel over the triangles of a mesh, each drawn alone: a mesh of one
/// triangle has one part.
fn each_alone(view: &View, mesh: &Mesh) -> Vec<f32> {
    let level = &mesh.levels()[0];
    let mut queries = SoftwareQueries::new();
    let mut want = Vec::new();
    for corners in level.indices.as_chunks::<3>().0 {
        draw(&mut queries, view, &[soup(&[corners.map(|v| level.positions[v as usize])])]);
        let alone = depth(&queries);
        want.resize(alone.len(), 0.0);
        want.iter_mut().zip(alone).for_each(|(kept, n): (&mut f32, f32)| *kept = kept.max(n));
    }
    want
}

#[test]
fn a_mesh_is_its_triangles() {
    // Far, across all bands and the edges, and around the eye, where much is clipped.
    let meshes =
        [(0, Vec3::new(0.0, 0.0, -9.0), 3.0), (1, Vec3::new(2.0, 1.0, -6.0), 5.0), (2, Vec3::ZERO, 2.0)]
            .map(|(seed, centre, radius)| bumpy(seed, centre, radius, 14));
    for mesh in meshes {
        let want = each_alone(&view(), &mesh);
        assert!(want.iter().filter(|&&n| n > 0.0).count() > 2000);
        for level in LEVELS {
            for threads in [1, 2] {
                let mut queries = SoftwareQueries::with_level(level);
                pool(threads).install(|| draw(&mut queries, &view(), std::slice::from_ref(&mesh)));
                assert!(depth(&queries) == want, "{level:?} (in fact {:?})", queries.level());
            }
        }
    }
}

#[test]
fn hidden_parts_are_left_out() {
    let wall =
        soup(&[[Vec3::new(0.0, -99.0, -5.0), Vec3::new(99.0, -99.0, -5.0), Vec3::new(0.0, 99.0, -5.0)]]);
    let mesh = bumpy(3, Vec3::new(0.0, 0.0, -12.0), 5.0, 40);
    let mut wall_last = SoftwareQueries::new();
    draw(&mut wall_last, &view(), &[mesh.clone(), wall.clone()]);
    let mut wall_first = SoftwareQueries::new();
    draw(&mut wall_first, &view(), &[wall, mesh.clone()]);
    assert!(depth(&wall_first) == depth(&wall_last));
    let mut alone = SoftwareQueries::new();
    draw(&mut alone, &view(), std::slice::from_ref(&mesh));
    let [all, front, half] =
        [mesh.triangle_count() as u64, alone.stats().rasterised, wall_first.stats().rasterised];
    assert!(front < all * 9 / 10, "the far side is not left out: {front} of {all}");
    assert!(half < front * 7 / 10, "what the wall hides is not left out: {half} of {front}");
}
