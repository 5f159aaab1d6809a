//! What counts as a wave.

use glam::{Affine3A, Vec3};

use super::Culler;
use crate::geom::{View, Viewport};
use crate::policy;
use crate::query::software::{SoftwarePass, SoftwareQueries};
use crate::scene::mesh::Mesh;
use crate::scene::{ObjectRef, Scene, SceneConfig, Traits};

/// A policy that sweeps waits for each of its sweeps, once; not for draws that say what they have shown.
#[test]
fn draws_that_answer_are_not_waited_for() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let tile = Mesh::new("tile", corners.to_vec(), vec![0, 1, 2, 0, 2, 3]).expect("a mesh");
    let mut scene = Scene::new(SceneConfig::default());
    let place = |i: usize| match i {
        0 => Affine3A::from_scale(Vec3::splat(6.0)),
        _ => Affine3A::from_translation(Vec3::new((i % 10) as f32 - 4.5, (i / 10) as f32 - 2.0, -4.0)),
    };
    for i in 0..50 {
        scene.insert(tile.bounds().transformed(&place(i)), Traits::default());
    }
    scene.update();
    let view = View::look_at(Vec3::Z * 9.0, Vec3::ZERO, 60.0, 0.1, Viewport::new(64, 36)).expect("a view");
    for name in ["roc", "hroc", "hi-z", "hybrid"] {
        let (mut questions, mut tried) = ([0; 2], 0);
        for by_geometry in [false, true] {
            let mut policy = policy::by_name(name).expect("a policy of that name");
            policy.set("by_geometry", &by_geometry.to_string()).expect("a dial of that name");
            let mut eye = Culler::new(policy);
            let mut queries = SoftwareQueries::new();
            queries.set_true_shapes(true);
            for frame in 0..4 {
                let draw = |pass: &mut SoftwarePass, objects: &[ObjectRef]| {
                    objects.iter().for_each(|object| pass.draw_mesh(&tile, &place(object.id.slot())));
                };
                let stats = eye.frame(&scene, &view, &mut queries, draw).expect("a frame");
                assert_eq!(stats.waves, stats.queries, "{name}, frame {frame}: {stats:?}");
                questions[usize::from(by_geometry)] += stats.queries;
                tried += stats.left_out;
            }
        }
        assert!(questions.iter().all(|&count| count > 0), "{name}: {questions:?}");
        assert!(tried > 0, "{name}: some draws have answered");
    }
}
