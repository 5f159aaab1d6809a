use bvh::aabb::{Aabb as BvhAabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh as Hierarchy;
use nalgebra::Point3;
use tercet::geom::{Aabb, Frustum, View};

/// bvh's hierarchy: moved shapes are taken out and put in again.
pub struct Bvh {
    bvh: Hierarchy<f32, 3>,
    shapes: Vec<Shape>,
    indices: Vec<usize>,
}

struct Shape {
    aabb: Aabb,
    number: u32,
    node: usize,
}

impl super::Peer for Bvh {
    fn new(boxes: &[Aabb]) -> Self {
        let numbered = (0..).zip(boxes);
        let mut shapes: Vec<_> = numbered.map(|(number, &aabb)| Shape { aabb, number, node: 0 }).collect();
        Self { bvh: Hierarchy::build(&mut shapes), shapes, indices: (0..boxes.len()).collect() }
    }

    fn update(&mut self, moved: &[Aabb]) {
        // A shape is taken out by its old box, so that it is only now given the new one.
        for (shape, aabb) in self.shapes.iter_mut().zip(moved) {
            shape.aabb = *aabb;
        }
        self.bvh.update_shapes(&self.indices[..moved.len()], &mut self.shapes);
    }

    fn query(&mut self, view: &View, found: &mut Vec<u32>) {
        let query = Query(Frustum::new(view));
        let hits = self.bvh.traverse_iterator(&query, &self.shapes);
        found.extend(hits.filter(|shape| query.0.intersects(&shape.aabb)).map(|shape| shape.number));
    }
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> BvhAabb<f32, 3> {
        let point = |p: glam::Vec3| Point3::from(p.to_array());
        BvhAabb::with_bounds(point(self.aabb.min), point(self.aabb.max))
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

struct Query(Frustum);

impl IntersectsAabb<f32, 3> for Query {
    fn intersects_aabb(&self, aabb: &BvhAabb<f32, 3>) -> bool {
        let corner = |p: Point3<f32>| glam::Vec3::new(p.x, p.y, p.z);
        self.0.intersects(&Aabb::new(corner(aabb.min), corner(aabb.max)))
    }
}
