use tercet::geom::{Aabb, Frustum, View};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::Walk;

/// The ternary tree, everything included: placement, refit, settling, adaptation.
pub struct Tercet {
    scene: Scene,
    ids: Vec<ObjectId>,
    walk: Walk,
}

impl super::Peer for Tercet {
    fn new(boxes: &[Aabb]) -> Self {
        let mut scene = Scene::new(SceneConfig::default());
        let ids = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
        scene.update();
        Self { scene, ids, walk: Walk::new() }
    }

    fn update(&mut self, moved: &[Aabb]) {
        self.scene.sync_moved(self.ids.iter().copied().zip(moved.iter().copied()));
        self.scene.adapt::<tercet::Culler<tercet::policy::FrustumOnly>>([]);
    }

    fn query(&mut self, view: &View, found: &mut Vec<u32>) {
        self.walk.run(self.scene.tree(), &Frustum::new(view), view.eye(), |block, lanes| {
            let mut rest = lanes;
            while rest != 0 {
                found.push(block.slots[rest.trailing_zeros() as usize]);
                rest &= rest - 1;
            }
        });
    }
}
