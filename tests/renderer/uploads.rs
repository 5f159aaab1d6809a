//! What is sent to the device: what is drawn, each frame anew, and meshes once.

use glam::{Affine3A, Vec3};
use hecs::World;
use tercet::Culler;
use tercet::draw::{Detail, Drawable, Drawn, Renderer, Shading};
use tercet::geom::{View, Viewport, projection};
use tercet::policy::{self, Policy};
use tercet::query::QueryBackend;
use tercet::query::gpu::GpuQueries;
use tercet::scene::mesh::Mesh;
use tercet::scene::{Bounds, Scene, SceneConfig};
use tercet::worlds::{self, power_plant};

use crate::pixels::{FORMAT, Target, objects, shoot};
use crate::support::gpus;

/// Bytes of an object: three rows of its transform, and a colour of 16 bits a channel.
const OBJECT: u64 = 3 * 16 + 8;

#[test]
fn a_steady_frame_uploads_what_it_draws_and_nothing_else() {
    for gpu in gpus() {
        let mut world = World::new();
        let model = worlds::power_plant(3, 0.05);
        model.spawn(&mut world);
        let pose = power_plant::path(0.05).pose(0.1);
        let view = View::look_at(pose.eye, pose.target, 60.0, 0.1, Viewport::new(128, 72)).expect("a view");
        let mut scene = Scene::new(SceneConfig::default());
        let mut policy = policy::by_name("dual-query").expect("a policy of that name");
        // Without skipping questions, which would draw something else every frame.
        policy.set("n_skip", "0").expect("a dial of that name");
        let mut eye = Culler::new(policy);
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, Some(FORMAT)).expect("a renderer");
        let target = Target::new(&gpu, &view);
        let mut before = None;
        for _ in 0..6 {
            scene.sync(&world);
            queries.target(&target.frame_targets());
            renderer.begin(&view, Detail::default(), Shading::Lit);
            let mut drawn = Drawn::default();
            let frame = eye.frame(&scene, &view, &mut queries, |pass, objects| {
                drawn += renderer.draw(pass, &world, objects);
            });
            let (frame, stats) = (frame.expect("a frame"), renderer.stats());
            assert_eq!(stats.drawn, drawn);
            assert_eq!(drawn.instances, u64::from(frame.drawn));
            assert_eq!(stats.uploaded, OBJECT * drawn.instances, "{stats:?}");
            assert!(frame.drawn > 0 && (frame.drawn as usize) < model.objects.len(), "{frame:?}");
            assert!(drawn.draws <= drawn.instances && drawn.triangles >= drawn.instances, "{drawn:?}");
            let kept = (stats.frame_buffers, stats.meshes, stats.mesh_bytes);
            assert!(before.is_none_or(|before| before == kept), "{stats:?}, before {before:?}");
            // Its first frames may draw more.
            before = (eye.entered().is_empty()).then_some(kept);
        }
        assert!(before.is_some(), "the frame became steady");
        renderer.begin(&view, Detail::default(), Shading::Lit);
        queries.begin(&view).expect("begin");
        let mut all = Drawn::default();
        queries.draw(|pass| all = renderer.draw(pass, &world, &objects(&world))).expect("draw");
        queries.end().expect("end");
        let levels: u64 = model.meshes.iter().map(|mesh| mesh.levels().len() as u64).sum();
        assert_eq!(all.instances as usize, model.objects.len());
        assert!(all.draws <= levels, "a draw for each level of a mesh at most: {all:?}");
        for mesh in &model.meshes {
            renderer.forget(mesh);
        }
        assert_eq!((renderer.stats().meshes, renderer.stats().mesh_bytes), (0, 0));
    }
}

/// Tiles of a pixel each, in many calls, fill several buffers: none may overwrite another.
#[test]
fn objects_of_all_calls_of_a_frame_have_a_place_of_their_own() {
    let side = 64;
    let view = flat_view(side);
    let tiles: Vec<Mesh> = (0..5).map(|n| tile(&format!("tile {n}"))).collect();
    let mut world = World::new();
    for i in 0..side * side {
        let place = Affine3A::from_translation(Vec3::new((i % side) as f32, (i / side) as f32, 0.0));
        let mesh = tiles[(i % 5) as usize].clone();
        let color = [(i % side) as u8, (i / side) as u8, 200];
        world.spawn((Bounds(mesh.bounds_under(&place)), Drawable { mesh, world_from_object: place, color }));
    }
    for gpu in gpus() {
        let shot = shoot(&gpu, &view, Shading::Unlit, |renderer, pass| {
            let forgotten = tile("forgotten");
            renderer.upload(&forgotten);
            for objects in objects(&world).chunks(300) {
                renderer.draw(pass, &world, objects);
                renderer.forget(&forgotten);
            }
            let stats = renderer.stats();
            assert_eq!(stats.uploaded, OBJECT * u64::from(side * side));
            assert!(stats.frame_buffers > 1 && stats.meshes == tiles.len(), "{stats:?}");
        });
        for (i, &color) in shot.colors.iter().enumerate() {
            // Rows of pixels go down.
            let (x, y) = (i as u32 % side, side - 1 - i as u32 / side);
            assert_eq!(color.to_le_bytes(), [x as u8, y as u8, 200, 255], "pixel ({x}, {y})");
        }
    }
}

/// A pixel a metre, seen along −z; the origin is the lower left corner.
pub fn flat_view(side: u32) -> View {
    let clip_from_view = projection::orthographic(side as f32, side as f32, 0.0, 100.0);
    let half = side as f32 * 0.5;
    let view_from_world = glam::Mat4::from_translation(Vec3::new(-half, -half, -50.0));
    View::new(view_from_world, clip_from_view, Viewport::new(side, side)).expect("a view")
}

/// A square of a metre, at the origin in x and y.
pub fn tile(name: &str) -> Mesh {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    Mesh::new(name, corners, vec![0, 1, 2, 0, 2, 3]).expect("a mesh")
}
