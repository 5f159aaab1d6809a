use rstar::{AABB, RTree, RTreeObject, SelectionFunction};
use tercet::geom::{Aabb, Frustum, View};

/// rstar's R*-tree: each moved box is removed and inserted again.
pub struct Rstar {
    tree: RTree<Item>,
    boxes: Vec<Aabb>,
}

#[derive(Clone, Copy, PartialEq)]
struct Item {
    aabb: Aabb,
    number: u32,
}

impl RTreeObject for Item {
    type Envelope = AABB<[f32; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.aabb.min.to_array(), self.aabb.max.to_array())
    }
}

impl super::Peer for Rstar {
    fn new(boxes: &[Aabb]) -> Self {
        let items = (0..).zip(boxes).map(|(number, &aabb)| Item { aabb, number });
        Self { tree: RTree::bulk_load(items.collect()), boxes: boxes.to_vec() }
    }

    fn update(&mut self, moved: &[Aabb]) {
        for ((number, aabb), old) in (0..).zip(moved).zip(&mut self.boxes) {
            self.tree.remove(&Item { aabb: *old, number });
            self.tree.insert(Item { aabb: *aabb, number });
            *old = *aabb;
        }
    }

    fn query(&mut self, view: &View, found: &mut Vec<u32>) {
        let hits = self.tree.locate_with_selection_function(Select(Frustum::new(view)));
        found.extend(hits.map(|item| item.number));
    }
}

struct Select(Frustum);

impl SelectionFunction<Item> for Select {
    fn should_unpack_parent(&self, envelope: &AABB<[f32; 3]>) -> bool {
        self.0.intersects(&Aabb::new(envelope.lower().into(), envelope.upper().into()))
    }

    fn should_unpack_leaf(&self, leaf: &Item) -> bool {
        self.0.intersects(&leaf.aabb)
    }
}
