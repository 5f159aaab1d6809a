use parry3d::bounding_volume::Aabb as ParryAabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace, TraversalAction};
use tercet::geom::{Aabb, Frustum, View};

/// parry3d's hierarchy: leaves updated in place, then its incremental refit.
pub struct Parry {
    bvh: Bvh,
    workspace: BvhWorkspace,
}

impl super::Peer for Parry {
    fn new(boxes: &[Aabb]) -> Self {
        let boxes: Vec<ParryAabb> = boxes.iter().map(converted).collect();
        Self { bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), workspace: BvhWorkspace::default() }
    }

    fn update(&mut self, moved: &[Aabb]) {
        for (i, aabb) in moved.iter().enumerate() {
            self.bvh.insert_or_update_partially(converted(aabb), i as u32, 0.0);
        }
        self.bvh.refit(&mut self.workspace);
    }

    fn query(&mut self, view: &View, found: &mut Vec<u32>) {
        let frustum = Frustum::new(view);
        self.bvh.traverse(|node| {
            let aabb = Aabb::new(node.mins().to_array().into(), node.maxs().to_array().into());
            if !frustum.intersects(&aabb) {
                return TraversalAction::Prune;
            }
            found.extend(node.leaf_data());
            TraversalAction::Continue
        });
    }
}

fn converted(aabb: &Aabb) -> ParryAabb {
    ParryAabb::new(aabb.min.to_array().into(), aabb.max.to_array().into())
}
