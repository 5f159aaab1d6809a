//! What is said of the frames to come, and how explanations read.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};
use tercet::Why;
use tercet::geom::Aabb;
use tercet::policy::{self, DualQuery, Fate};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::TreeConfig;
use tercet::worlds;

use super::watch::Watch;
use crate::stage::Stage;
use crate::{SCREEN, square};

/// Nothing moves: what is said of the frames to come is true.
#[test]
fn terms_are_kept() {
    for (name, dial) in
        [("statistical", "n_skip"), ("dual-query", "n_skip"), ("chc", "n_av"), ("chc++", "n_av")]
    {
        let mut policy = policy::by_name(name).expect("its name");
        policy.set(dial, "8").expect("its dial");
        let mut watch = Watch::new(TreeConfig::stable(), policy);
        let mut stage = Stage::new(worlds::random(3, 80), 3, SCREEN, false);
        let view = stage.next(0);
        let (mut terms, mut kept) = (HashMap::new(), 0);
        for _ in 0..40 {
            watch.frame(&stage, view.clone());
            for object in watch.scene.objects() {
                let id = object.object.id;
                let Why::Remembered { within: Some(within), .. } = watch.why(id) else {
                    kept += u32::from(terms.remove(&id) == Some(1));
                    continue;
                };
                let before = terms.insert(id, within);
                assert!(before.is_none_or(|before| before == within + 1), "{before:?}, then {within}");
            }
        }
        assert!(kept > 20, "{name}: {kept}");
    }
}

/// A wall before a ball: one line each, for people.
#[test]
fn explanations_read_well() {
    let tree = TreeConfig { bulk_leaf: 1, ..TreeConfig::stable() };
    let mut watch = Watch::new(tree, DualQuery::default());
    let view = watch.view.clone();
    let mut put = |x: f32, z: f32, half: Vec3, traits: Traits| {
        watch.scene.insert(Aabb::from_center(Vec3::new(x, 0.0, z), half), traits)
    };
    let wall = put(0.0, 0.0, Vec3::new(4.0, 4.0, 0.1), Traits::default());
    let ball = put(0.0, -5.0, Vec3::ONE, Traits::default());
    // Enough of them for nodes of their own.
    for i in 0..12 {
        put(0.1 * i as f32, -20.0 - 3.0 * i as f32, Vec3::ONE, Traits::default());
    }
    let far_left = put(-300.0, 0.0, Vec3::ONE, Traits::default());
    let sky = put(0.0, 0.0, Vec3::ONE, Traits { never_cull: true, ..Traits::default() });
    let bad = put(f32::NAN, 0.0, Vec3::ONE, Traits::default());
    watch.scene.update();
    assert_eq!(watch.why(wall), Why::Unknown { drawn: false }, "there was no frame yet");
    let square = square();
    watch
        .eye
        .frame(&watch.scene, &view, &mut watch.queries, |pass, objects| {
            if objects.iter().any(|o| o.id == wall) {
                pass.draw_mesh(&square, &Affine3A::from_scale(Vec3::splat(4.0)));
            }
        })
        .expect("a frame");
    let line = |object: ObjectId| watch.why(object).to_string();
    let lines = [wall, ball, far_left, sky, bad].map(line);
    assert!(lines[0].starts_with("drawn: of its node ") && lines[0].ends_with("samples visible"));
    assert!(lines[1].starts_with("culled: nothing of its node ") && lines[1].contains(" × 2.00 × "));
    assert_eq!(lines[2], "culled: it is outside the view");
    assert_eq!(lines[3], "drawn always, as the app wishes");
    assert_eq!(lines[4], "drawn always, until its box is a good one");

    let mut another = Scene::new(SceneConfig::default());
    let stranger = another.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
    another.update();
    assert_eq!(watch.eye.why(&another, &view, stranger), Why::Unknown { drawn: false });
    assert!(watch.eye.fates(&another, &view).all(|(_, fate)| fate == Fate::Unknown));
    watch.scene.remove(wall);
    watch.scene.update();
    assert_eq!(watch.why(wall), Why::Gone);
}
