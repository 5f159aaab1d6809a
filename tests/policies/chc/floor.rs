//! What CHC++ is for: in the city it asks at most half of CHC's questions, walking and at a run.

use hecs::World;
use tercet::Culler;
use tercet::draw::Drawable;
use tercet::geom::{View, Viewport};
use tercet::policy::{Chc, ChcPlusPlus, Policy};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds::{self, CameraPath, city};

const SCALE: f32 = 0.25;
const FRAMES: u32 = 120;

/// The questions of a whole way, and the objects drawn.
fn questions(policy: impl Policy, world: &World, path: &CameraPath) -> (u32, u32) {
    let (mut scene, mut eye) = (Scene::new(SceneConfig::default()), Culler::new(policy));
    scene.adapt([&mut eye]);
    let (mut queries, mut sum, mut drawn) = (SoftwareQueries::new(), 0, 0);
    for frame in 0..FRAMES {
        let pose = path.pose(frame as f32 / (FRAMES - 1) as f32);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, Viewport::new(1280, 720))
            .expect("a view");
        scene.sync(world);
        let stats = eye
            .frame(&scene, &view, &mut queries, |pass, objects| {
                for object in objects {
                    let d = world.get::<&Drawable>(object.entity()).expect("it was spawned with one");
                    pass.draw_mesh(&d.mesh, &d.world_from_object);
                }
            })
            .expect("a frame");
        scene.adapt([&mut eye]);
        (sum, drawn) = (sum + stats.queries, drawn + stats.drawn);
    }
    (sum, drawn)
}

#[test]
fn chc_plus_plus_asks_at_most_half_of_chcs_questions() {
    let mut world = World::new();
    worlds::city(1, SCALE).spawn(&mut world);
    for (way, path) in [("at a run", city::fast_path(SCALE)), ("walking", city::path(SCALE))] {
        let (chc, drawn) = questions(Chc::default(), &world, &path);
        let (plus_plus, drawn_plus_plus) = questions(ChcPlusPlus::default(), &world, &path);
        let ratio = f64::from(chc) / f64::from(plus_plus);
        println!("{way}: {ratio:.2} times the questions; {drawn} objects drawn, {drawn_plus_plus} by CHC++");
        assert!(ratio >= 2.0, "{way}: {chc} and {plus_plus} questions");
        assert!(f64::from(drawn_plus_plus) < 1.25 * f64::from(drawn), "{way}: it must not just draw more");
    }
}
