//! Each peer behind the same three calls, used as its documentation recommends for moving boxes.

pub mod bvh;
pub mod obvhs;
pub mod parry;
pub mod rstar;
pub mod tercet;

use ::tercet::geom::{Aabb, View};

/// A tree over boxes with the numbers 0, 1, 2 …
pub trait Peer {
    /// Builds it.
    fn new(boxes: &[Aabb]) -> Self;

    /// Takes the new boxes of the first so many objects.
    fn update(&mut self, moved: &[Aabb]);

    /// Lists the boxes that meet the frustum: all trees use the same test, so they find the same.
    fn query(&mut self, view: &View, found: &mut Vec<u32>);
}
