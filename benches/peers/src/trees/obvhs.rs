use obvhs::aabb::Aabb as ObvhsAabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use tercet::geom::{Aabb, Frustum, PlaneMask, View};

/// obvhs' binary hierarchy, one box a leaf: leaves updated in place, then a full refit.
pub struct Obvhs {
    bvh: Bvh2,
    stack: Vec<(u32, PlaneMask)>,
}

impl super::Peer for Obvhs {
    fn new(boxes: &[Aabb]) -> Self {
        let boxes: Vec<ObvhsAabb> = boxes.iter().map(converted).collect();
        let all = (0..boxes.len() as u32).collect();
        let mut builder = PlocBuilder::with_capacity(boxes.len());
        let mut bvh = builder.build(PlocSearchDistance::Medium, &boxes, all, SortPrecision::U64, 0);
        bvh.init_primitives_to_nodes_if_uninit();
        Self { bvh, stack: Vec::new() }
    }

    fn update(&mut self, moved: &[Aabb]) {
        for (aabb, &node) in moved.iter().zip(&self.bvh.primitives_to_nodes) {
            self.bvh.nodes[node as usize].set_aabb(converted(aabb));
        }
        self.bvh.refit_all();
    }

    fn query(&mut self, view: &View, found: &mut Vec<u32>) {
        let frustum = Frustum::new(view);
        self.stack.push((0, PlaneMask::ALL));
        while let Some((index, mask)) = self.stack.pop() {
            let node = &self.bvh.nodes[index as usize];
            let aabb = Aabb::new(node.aabb().min.into(), node.aabb().max.into());
            let Some(mask) = frustum.classify(&aabb, mask) else { continue };
            let first = node.first_index;
            if node.is_leaf() {
                let range = first as usize..(first + node.prim_count) as usize;
                found.extend(&self.bvh.primitive_indices[range]);
            } else {
                self.stack.extend([(first + 1, mask), (first, mask)]);
            }
        }
    }
}

fn converted(aabb: &Aabb) -> ObvhsAabb {
    ObvhsAabb::new(aabb.min.into(), aabb.max.into())
}
