//! Frame numbers that begin again.

use glam::Vec3;

use super::Culler;
use crate::geom::{Aabb, View, Viewport};
use crate::policy;
use crate::query::software::SoftwareQueries;
use crate::scene::{Scene, SceneConfig, Traits};

/// What was drawn in frame 2, and not for 2³² − 1 frames after it, is drawn in the next frame 2; what is
/// in sight all the time is drawn throughout.
#[test]
fn frame_numbers_that_wrap_lose_nothing() {
    let mut scene = Scene::new(SceneConfig::default());
    for i in 0..20 {
        scene.insert(Aabb::from_center(Vec3::X * 3.0 * i as f32, Vec3::ONE), Traits::default());
    }
    scene.update();
    let toward = |target: Vec3| {
        View::look_at(Vec3::new(10.0, 0.0, 9.0), target, 70.0, 0.1, Viewport::new(32, 18)).expect("a view")
    };
    let (there, away) = (toward(Vec3::X * 10.0), toward(Vec3::new(10.0, 0.0, 90.0)));
    let own_minds = policy::NAMES.iter().map(|name| policy::by_name(name).expect("a policy of that name"));
    for policy in own_minds.filter(|policy| policy.wants_recorded().is_none()) {
        let mut eye = Culler::new(policy);
        let mut queries = SoftwareQueries::new();
        // Nothing is drawn into the depth, so nothing hides anything.
        let mut frame = |eye: &mut Culler<_>, view: &View| {
            eye.frame(&scene, view, &mut queries, |_, _| {}).expect("a frame").drawn
        };
        let seen = [&away, &there, &away].map(|view| frame(&mut eye, view));
        assert!(seen[1] > 0);
        eye.frame = u32::MAX - 2;
        for view in [&away, &away, &away, &there, &there, &away] {
            let expected = if std::ptr::eq(view, &there) { seen[1] } else { seen[0] };
            assert_eq!(frame(&mut eye, view), expected, "{} in frame {}", eye.policy.name(), eye.frame);
        }
        assert_eq!(eye.frame, 4);
    }
}
