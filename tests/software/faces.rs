//! Draw calls that show front faces only: the same as drawing only the triangles that are fronts.

use glam::{Affine3A, Mat4, Vec3};
use rand::RngExt;
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};
use tercet::query::QueryBackend;
use tercet::query::oracle::{Candidate, Oracle};
use tercet::query::software::{Faces, SoftwareQueries};
use tercet::scene::mesh::Mesh;
use tercet::scene::{Scene, SceneConfig, Traits};

use crate::support::{LEVELS, depth, dice, pixel_view, pool, soup, triangles};

fn frame(queries: &mut SoftwareQueries, view: &View, faces: Faces, calls: &[(Mesh, Affine3A)]) -> Vec<f32> {
    queries.begin(view).expect("begin");
    queries
        .draw(|pass| calls.iter().for_each(|(mesh, place)| pass.draw_faces(mesh, 0, faces, place)))
        .expect("draw");
    depth(queries)
}

/// A box whose fronts are outside.
fn cube() -> Mesh {
    let positions = Aabb::from_center(Vec3::ZERO, Vec3::splat(0.5)).corners().to_vec();
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices = faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    Mesh::new("cube", positions, indices).expect("a mesh")
}

/// A view in pixels has y down and z toward the eye: it shows the world mirrored, and a front is
/// what runs counter-clockwise where y is up.
#[test]
fn fronts_are_the_triangles_that_run_counter_clockwise() {
    let (width, height) = (256, 128);
    let view = pixel_view(width, height);
    let mut dice = dice(31);
    for count in [1, 5, 16, 700] {
        // Alone, tiny ones, and others of all sizes among them.
        let all = triangles(&mut dice, count, width, height);
        let fronts: Vec<_> = all
            .iter()
            .copied()
            .filter(|[a, b, c]| (b - a).as_dvec3().cross((c - a).as_dvec3()).z > 0.0)
            .collect();
        let here = Affine3A::IDENTITY;
        let want = frame(&mut SoftwareQueries::new(), &view, Faces::Both, &[(soup(&fronts), here)]);
        for level in LEVELS {
            for threads in [1, 2] {
                let mut queries = SoftwareQueries::with_level(level);
                let calls = [(soup(&all), here)];
                let got = pool(threads).install(|| frame(&mut queries, &view, Faces::Front, &calls));
                assert!(got == want, "{count} triangles, {threads} threads, {level:?}");
            }
        }
    }
}

/// From a far speck to a wall around the eye; mirrored or not, in every kind of view.
#[test]
fn the_back_of_a_box_is_left_out_and_its_front_is_not() {
    let viewport = Viewport::new(150, 210);
    let eye = View::look_at(Vec3::new(0.3, 0.2, 9.0), Vec3::ZERO, 60.0, 0.1, viewport)
        .expect("a view")
        .view_from_world();
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let plain = projection::perspective(1.1, 150.0 / 210.0, 0.1);
    let standard = projection::perspective_standard(1.1, 150.0 / 210.0, 0.1, 90.0);
    let views = [
        View::new(eye, plain, viewport).expect("a view"),
        View::new(eye, mirror * plain, viewport).expect("a view"),
        View::new(eye, projection::orthographic(12.0, 16.0, 0.1, 90.0), viewport).expect("a view"),
        View::new(eye, standard, viewport).expect("a view").with_target(
            DepthDirection::Standard,
            DepthFormat::Depth32Float,
            1,
        ),
    ];
    let mut dice = dice(8);
    for view in &views {
        let cleared = view.depth().cleared();
        for size in [0.2, 0.5, 2.0, 6.0] {
            let mut v = || dice.random_range(-1.0..1.0_f32);
            let turn = glam::Quat::from_scaled_axis(3.0 * Vec3::new(v(), v(), v()));
            for flip in [1.0, -1.0] {
                let scale = Vec3::new(flip, 1.0, 1.0) * size;
                let at = Vec3::new(v(), v(), v());
                let place = Affine3A::from_scale_rotation_translation(scale, turn, at);
                let calls = [(cube(), place)];
                let mut queries = SoftwareQueries::new();
                let both = frame(&mut queries, view, Faces::Both, &calls);
                let front = frame(&mut queries, view, Faces::Front, &calls);
                // Inside out, what is left is the back.
                let turned: Vec<u32> = cube().levels()[0]
                    .indices
                    .as_chunks::<3>()
                    .0
                    .iter()
                    .flat_map(|t| [t[0], t[2], t[1]])
                    .collect();
                let turned =
                    Mesh::new("turned", cube().levels()[0].positions.clone(), turned).expect("a mesh");
                let back = frame(&mut queries, view, Faces::Front, &[(turned, place)]);
                let covered = both.iter().filter(|&&n| n != cleared).count();
                assert!(covered > 0, "{size}");
                for ((&both, &front), &back) in both.iter().zip(&front).zip(&back) {
                    // Of a closed body, fronts and backs cover the same samples.
                    assert_eq!((front != cleared, back != cleared), (both != cleared, both != cleared));
                    assert_eq!(front.max(back), both);
                }
                let nearer = front.iter().zip(&back).filter(|(front, back)| front > back).count();
                assert!(nearer * 4 >= covered * 3, "{nearer} of {covered} samples at size {size}");
            }
        }
    }
}

/// The ground behind and before the eye is clipped: it shows from above only.
#[test]
fn what_is_clipped_has_a_front_too() {
    let [a, b, c, d] =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(1e4 * x, -1.0, 1e4 * z));
    let up = soup(&[[a, c, b], [a, d, c]]);
    let down = soup(&[[a, b, c], [a, c, d]]);
    let view = View::look_at(Vec3::ZERO, Vec3::new(0.0, -0.6, -1.0), 70.0, 0.1, Viewport::new(160, 120))
        .expect("a view");
    let mut queries = SoftwareQueries::new();
    let [both, up, down] = [(Faces::Both, &up), (Faces::Front, &up), (Faces::Front, &down)]
        .map(|(faces, mesh)| frame(&mut queries, &view, faces, &[(mesh.clone(), Affine3A::IDENTITY)]));
    assert!(both == up && both.iter().any(|&n| n > 0.0));
    assert!(down.iter().all(|&n| n == 0.0));
}

/// What only shows its back owns no sample.
#[test]
fn the_exact_visible_set_knows_fronts() {
    let quad = |z: f32| {
        let [a, b, c, d] =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
        [[a, b, c], [a, c, d]]
    };
    let turned = quad(1.0).map(|[a, b, c]| [a, c, b]);
    let meshes = [soup(&turned), soup(&quad(0.0))];
    let mut scene = Scene::new(SceneConfig::default());
    let ids = meshes.each_ref().map(|mesh| scene.insert(mesh.bounds(), Traits::default()));
    scene.update();
    let view = View::look_at(Vec3::new(0.0, 0.0, 9.0), Vec3::ZERO, 60.0, 0.1, Viewport::new(64, 64))
        .expect("a view");
    for (faces, seen) in [(Faces::Both, [true, false]), (Faces::Front, [false, true])] {
        let mut oracle = Oracle::new();
        let candidates: Vec<Candidate> = scene
            .objects()
            .map(|o| Candidate { object: o.object, bounds: o.bounds, not_occluder: false })
            .collect();
        let truth = oracle
            .look_at(&view, &candidates, |pass, objects| {
                for object in objects {
                    let which = usize::from(object.id == ids[1]);
                    pass.draw_faces(&meshes[which], 0, faces, &Affine3A::IDENTITY);
                }
            })
            .expect("a look");
        assert_eq!(ids.map(|id| truth.exact.contains(id)), seen, "{faces:?}");
        let shown = oracle.image().call[32 * 64 + 32];
        assert_eq!(oracle.owner(shown).id, if seen[0] { ids[0] } else { ids[1] });
    }
}
