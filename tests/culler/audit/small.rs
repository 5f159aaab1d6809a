//! By hand: what the app has to answer for, and scenes that cannot be audited.

use glam::{Affine3A, Vec3};
use hecs::{Entity, World};
use tercet::audit::{Audit, Auditor, Blame};
use tercet::geom::{Aabb, View};
use tercet::policy::{self, DrawAll, Policy};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::{Bounds, ObjectRef, Scene, SceneConfig, Traits};
use tercet::{Culler, Error, Why};

use crate::{SCREEN, square};

#[test]
fn an_object_that_leaves_its_box_is_the_apps_own_error() {
    // It asks about each object by itself.
    let roc = || policy::by_name("roc").expect("its name");
    let (audit, _) = behind_a_wall(0.0, roc());
    assert_eq!((audit.lost.len(), audit.culled, audit.drawn), (0, 1, 1));
    let (audit, entity) = behind_a_wall(3.0, roc());
    assert_eq!(audit.lost.len(), 1);
    let lost = audit.lost[0];
    assert_eq!((lost.object.entity(), lost.blame, lost.dial()), (entity, Blame::Bounds, None));
    assert_eq!((u64::from(lost.samples), lost.recount.map(|r| r.visible)), (audit.wrong_pixels, Some(0)));
    assert!(lost.samples > 50 && lost.to_string().contains("Bounds"), "{lost}");
}

#[test]
fn a_list_that_was_given_is_to_blame_itself() {
    let mut given = policy::by_name("exact").expect("its name");
    given.give_recorded(&[]);
    let (audit, _) = behind_a_wall(0.0, given);
    // The wall; and the small square hides behind nothing that was drawn, but it does so in the whole frame.
    assert_eq!(audit.lost.len(), 1);
    assert_eq!((audit.lost[0].blame, audit.lost[0].why), (Blame::List, Why::Given { drawn: false }));
    assert!(audit.lost[0].to_string().contains("the list that the policy was given"));
}

#[test]
fn a_scene_with_edits_under_way_is_refused() {
    let mut scene = Scene::new(SceneConfig::default());
    scene.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
    let view = View::look_at(Vec3::Z * 8.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    let eye = Culler::new(DrawAll::default());
    let refused = Auditor::new(0).check(&scene, &view, &eye, |_, _| {}).map(|audit| audit.is_some());
    assert!(matches!(refused, Err(Error::PendingEdits(1))));
}

/// A wall, and a small square behind it that is drawn as far to the side as `aside`, metres, from its box.
fn behind_a_wall(aside: f32, policy: impl Policy) -> (Audit, Entity) {
    let square = square();
    let mut world = World::new();
    let wall = Affine3A::from_scale(Vec3::splat(2.0));
    let small =
        Affine3A::from_translation(Vec3::new(1.0, 0.0, -1.0)) * Affine3A::from_scale(Vec3::splat(0.5));
    world.spawn((Bounds(square.bounds().transformed(&wall)), wall));
    let moved = Affine3A::from_translation(Vec3::X * aside) * small;
    let entity = world.spawn((Bounds(square.bounds().transformed(&small)), moved));
    let (mut scene, mut eye) = (Scene::new(SceneConfig::default()), Culler::new(policy));
    scene.adapt([&mut eye]);
    scene.sync(&world);
    let view = View::look_at(Vec3::Z * 8.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    let draw = |pass: &mut SoftwarePass, objects: &[ObjectRef]| {
        for object in objects {
            pass.draw_mesh(&square, &world.get::<&Affine3A>(object.entity()).expect("its place"));
        }
    };
    let mut queries = SoftwareQueries::new();
    for _ in 0..3 {
        eye.frame(&scene, &view, &mut queries, draw).expect("a frame");
    }
    let mut auditor = Auditor::new(1);
    let audit = auditor.check(&scene, &view, &eye, draw).expect("it looks").expect("it is due");
    (audit.clone(), entity)
}
