//! Objects move to and fro, are found by their frustum, and the tree follows, all in memory that
//! earlier frames have made.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stats_alloc::Region;
use tercet::Culler;
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::policy::FrustumOnly;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::Walk;

use super::ALLOCATOR;

pub(crate) fn check() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut vec3 =
        |low: f32, high: f32| Vec3::from_array(std::array::from_fn(|_| rng.random_range(low..high)));
    let boxes: Vec<Aabb> = (0..5000).map(|_| Aabb::from_center(vec3(0.0, 68.0), vec3(0.1, 1.0))).collect();
    let steps: Vec<Vec3> = boxes.iter().map(|_| vec3(-0.05, 0.05)).collect();
    let mut scene = Scene::new(SceneConfig::default());
    let ids: Vec<ObjectId> = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
    let eye = Vec3::splat(34.0);
    let view = View::look_at(eye, eye - Vec3::Z, 75.0, 0.1, Viewport::new(256, 256)).expect("a view");
    let frustum = Frustum::new(&view);
    let mut walk = Walk::new();
    let mut seen = 0;
    let mut frame = |scene: &mut Scene, frame: i32| {
        // 50 frames one way, 50 back: a world that goes nowhere.
        let away = 50 - (frame % 100 - 50).abs();
        let at = |(i, b): (usize, &Aabb)| {
            (ids[i], Aabb::new(b.min + steps[i] * away as f32, b.max + steps[i] * away as f32))
        };
        scene.sync_moved(boxes.iter().enumerate().map(at));
        walk.run(scene.tree(), &frustum, view.eye(), |_, lanes| seen += lanes.count_ones());
        scene.adapt::<Culler<FrustumOnly>>([]);
    };
    // Room for blocks grows to what the fullest moment takes, which comes late.
    (0..4000).for_each(|f| frame(&mut scene, f));
    scene.tree().validate().expect("a valid tree");
    let moves = scene.tree().stats().moves;
    let region = Region::new(ALLOCATOR);
    (4000..6000).for_each(|f| frame(&mut scene, f));
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert!(scene.tree().stats().moves > moves + 1000, "objects did change their nodes");
    assert!(seen > 0);
}
