//! What is under the cursor: every object whose box the line of sight meets, nearest first.

use glam::{DVec3, DVec4, Vec3};
use tercet::geom::{Aabb, View};
use tercet::scene::{Scene, SceneObject};

/// Objects listed at most.
const MOST: usize = 6;

/// The objects behind a point of the picture, 0 to 1 from its upper left; nearest first, with the
/// distance to their box in metres. O(objects).
pub fn along(scene: &Scene, view: &View, (x, y): (f32, f32)) -> Vec<(f32, SceneObject)> {
    let at = |depth: f64| {
        let ndc = DVec4::new(f64::from(x) * 2.0 - 1.0, 1.0 - f64::from(y) * 2.0, depth, 1.0);
        let point = view.world_from_clip() * ndc;
        point.truncate() / point.w
    };
    // Reversed z: 1 is the near plane.
    let (near, farther) = (at(1.0), at(0.5));
    let ahead = (farther - near).normalize_or_zero();
    let mut hits: Vec<_> =
        scene.objects().filter_map(|object| Some((enters(object.bounds?, near, ahead)?, object))).collect();
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    hits.truncate(MOST);
    hits
}

/// Where a ray enters a box (0 if it starts there), by the slabs of its sides.
fn enters(bounds: Aabb, from: DVec3, ahead: DVec3) -> Option<f32> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (mut first, mut last) = (0.0, f64::INFINITY);
    for axis in 0..3 {
        if ahead[axis] == 0.0 {
            // Between the planes of these sides all along, or never.
            if !(min[axis]..=max[axis]).contains(&from[axis]) {
                return None;
            }
            continue;
        }
        let to = [min, max].map(|side| (side[axis] - from[axis]) / ahead[axis]);
        first = f64::max(first, to[0].min(to[1]));
        last = f64::min(last, to[0].max(to[1]));
    }
    (first <= last).then_some(first as f32)
}

/// A box's size in words.
pub fn size(bounds: &Aabb) -> String {
    let Vec3 { x, y, z } = bounds.size();
    format!("{x:.2} × {y:.2} × {z:.2} m")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_what_is_ahead() {
        let bounds = Aabb::from_center(Vec3::new(0.0, 0.0, -5.0), Vec3::ONE);
        let hit = |from: DVec3, ahead: DVec3| enters(bounds, from, ahead);
        assert_eq!(hit(DVec3::ZERO, DVec3::NEG_Z), Some(4.0));
        assert_eq!(hit(DVec3::new(0.0, 0.0, -5.0), DVec3::X), Some(0.0));
        assert_eq!(hit(DVec3::ZERO, DVec3::Z), None);
        assert_eq!(hit(DVec3::X * 3.0, DVec3::NEG_Z), None);
        assert_eq!(hit(DVec3::X, DVec3::NEG_Z), Some(4.0), "along a side");
    }
}
