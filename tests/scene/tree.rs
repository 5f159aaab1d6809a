//! How a tree divides space, and keeps doing so while things move.

use glam::Vec3;
use tercet::geom::{Aabb, Frustum, View, Viewport, projection};
use tercet::scene::{Scene, SceneConfig, Traits};
use tercet::tree::{LANES, Straddlers, TreeConfig, Walk};

/// A thousand objects at one point cannot be separated: one leaf holds them, and nothing loops.
#[test]
fn coincident_objects_share_a_leaf() {
    for straddlers in [Straddlers::Leaf, Straddlers::Split, Straddlers::StayInParent] {
        let tree = TreeConfig { straddlers, ..TreeConfig::default() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        for _ in 0..1000 {
            scene.insert(Aabb::new(Vec3::ONE, Vec3::ONE), Traits::default());
        }
        scene.update();
        scene.tree().validate().expect("a valid tree");
        assert_eq!(scene.tree().stats().nodes, 1);
    }
}

/// Objects that could not be told apart can be once they have moved.
#[test]
fn coincident_objects_that_spread_are_separated() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let ids: Vec<_> =
        (0..1000).map(|_| scene.insert(Aabb::new(Vec3::ONE, Vec3::ONE), Traits::default())).collect();
    scene.update();
    assert_eq!(scene.tree().stats().nodes, 1);
    for step in 1..=4 {
        for (i, &id) in ids.iter().enumerate() {
            let at = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * step as f32;
            scene.set_bounds(id, Aabb::from_center(at, Vec3::splat(0.1)));
        }
        scene.update();
        scene.tree().validate().expect("a valid tree");
    }
    assert!(scene.tree().stats().nodes > 500, "{:?}", scene.tree().stats());
}

/// The content epoch of every node above an object changes when it moves, and of no other.
#[test]
fn epochs_follow_what_moves() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let at = |i: usize, z: f32| Aabb::from_center(Vec3::new(i as f32 * 4.0, 0.0, z), Vec3::ONE);
    let ids: Vec<_> = (0..64).map(|i| scene.insert(at(i, 0.0), Traits::default())).collect();
    scene.update();
    let epochs = |scene: &Scene| -> Vec<_> {
        let tree = scene.tree();
        tree.nodes().map(|n| (n.bounds, tree.epoch(n.id), tree.is_settled(n.id))).collect()
    };
    let before = epochs(&scene);
    scene.set_bounds(ids[20], at(20, 0.0));
    scene.update();
    for (old, new) in before.iter().zip(epochs(&scene)) {
        let above = old.0.contains(&at(20, 0.0));
        assert_eq!(new.1 != old.1, above, "{:?}", old.0);
        assert!(!(above && new.2), "what has just moved is not settled");
    }
    for _ in 0..scene.tree().config().settle_frames {
        scene.update();
    }
    assert!(epochs(&scene).iter().all(|e| e.2), "at rest, everything settles");
}

/// A world that has moved far away and gathered there does not keep the depth of its journey.
#[test]
fn the_root_grows_and_shrinks_again() {
    let mut scene = Scene::new(SceneConfig { tree: fine(), ..SceneConfig::default() });
    let at = |p: Vec3, i: usize| {
        Aabb::from_center(p + Vec3::new((i % 10) as f32, (i / 10) as f32, 0.0) * 3.0, Vec3::splat(0.5))
    };
    let ids: Vec<_> = (0..200).map(|i| scene.insert(at(Vec3::ZERO, i), Traits::default())).collect();
    scene.update();
    let depth = scene.tree().stats().depth;
    let journey = [Vec3::X * 1e6, Vec3::new(-1e7, 1e7, 3.0), Vec3::splat(-5e6), Vec3::ZERO];
    for to in journey {
        for (i, &id) in ids.iter().enumerate() {
            scene.set_bounds(id, at(to, i));
            if i % 50 == 0 {
                scene.update();
                scene.tree().validate().expect("valid on the way");
            }
        }
        scene.update();
        scene.tree().validate().expect("valid on arrival");
    }
    let after = scene.tree().stats();
    assert!(after.depth <= depth + 60, "depth {depth} became {}", after.depth);
}

/// What a view may see by the tree is what it may see by looking at each object.
#[test]
fn a_walk_finds_what_the_frustum_meets() {
    for tree in [
        TreeConfig::default(),
        fine(),
        TreeConfig::paper(),
        TreeConfig { straddlers: Straddlers::StayInParent, ..fine() },
    ] {
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let at = |i: usize| Vec3::new((i * 7 % 41) as f32, (i * 11 % 37) as f32, (i * 13 % 43) as f32) - 20.0;
        let boxes: Vec<_> =
            (0..3000).map(|i| Aabb::from_center(at(i), Vec3::splat(0.2 + (i % 9) as f32 * 0.2))).collect();
        let ids: Vec<_> = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
        scene.update();
        let viewport = Viewport::new(640, 360);
        let upright =
            View::look_at(Vec3::new(3.0, 1.0, 25.0), Vec3::ZERO, 40.0, 0.1, viewport).expect("a view");
        let flat = projection::orthographic(20.0, 9.0, 0.1, 30.0);
        let flat = View::new(upright.view_from_world(), flat, viewport).expect("a view");
        for view in [upright, flat] {
            let frustum = Frustum::new(&view);
            let mut found = Vec::new();
            Walk::new().run(scene.tree(), &frustum, view.eye(), |block, lanes| {
                let lanes = (0..LANES).filter(|lane| lanes & (1 << lane) != 0);
                found.extend(lanes.map(|lane| block.slots[lane] as usize));
            });
            found.sort_unstable();
            let met = ids.iter().zip(&boxes).filter(|(_, b)| frustum.intersects(b));
            let met: Vec<_> = met.map(|(id, _)| id.slot()).collect();
            assert!(met.len() > 50 && met.len() < 2500, "{} of 3000", met.len());
            assert_eq!(found, met);
        }
    }
}

/// The default tree, with leaves as fine before the first question as after it.
fn fine() -> TreeConfig {
    TreeConfig { unasked_leaf: 2, ..TreeConfig::default() }
}
