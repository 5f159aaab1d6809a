//! A path through a scene that nobody has described: all that is known is the boxes in it.

use std::f32::consts::TAU;

use glam::Vec3;
use tercet::geom::Aabb;
use tercet::worlds::CameraPath;

/// In a scene of so few objects there is nothing to walk through.
const FEW: usize = 3;

/// In along the longest horizontal axis, at eye height, about the middle, where the camera looks
/// all around, and out at the other end, with a look back. A few objects are circled instead, and
/// so is a scene that is high and narrow. O(objects).
pub(crate) fn through(bounds: &Aabb, objects: &[Aabb]) -> CameraPath {
    let size = bounds.size();
    let narrow = size.x.max(size.z) <= 0.2 * size.y;
    if narrow || objects.len() <= FEW { around(bounds) } else { along(bounds, objects) }
}

/// Nothing nearer to the eye is drawn, metres: 10 cm, less in a scene that is small itself.
pub(crate) fn near(bounds: &Aabb) -> f32 {
    (1e-3 * extent(bounds)).min(0.1)
}

fn along(bounds: &Aabb, objects: &[Aabb]) -> CameraPath {
    let size = bounds.size();
    let (ahead, length) = if size.x >= size.z { (Vec3::X, size.x) } else { (Vec3::Z, size.z) };
    let side = ahead.cross(Vec3::Y);
    let center = bounds.center();
    let center = Vec3::new(center.x, eye_height(bounds), center.z);
    let middle = freest(center, ahead * length, side * side.abs().dot(size), objects);
    // Where the eye is, in lengths of the scene from its middle; and where it looks, likewise.
    let at = |eye: f32, target: f32| (middle + ahead * length * eye, middle + ahead * length * target);
    let outside = 0.7;
    let mut controls = vec![at(-outside, 0.0), at(-0.45, 0.2), at(-0.2, 0.3)];
    const VIEWS: usize = 12;
    for n in 0..=VIEWS {
        let (sin, cos) = (TAU * n as f32 / VIEWS as f32).sin_cos();
        // A step a view, so that parallax shows what is behind what.
        let eye = middle + ahead * length * (0.02 * n as f32 / VIEWS as f32);
        controls.push((eye, eye + (ahead * cos + side * sin) * 0.3 * length));
    }
    controls.extend([at(0.2, 0.6), at(0.45, 0.9), at(outside, outside + 0.3)]);
    controls.push(((middle + ahead * length * outside * 1.1), middle));
    CameraPath::new(60.0, controls)
}

/// The middle of the walk, moved aside by as little as makes it the freest: many a building has a
/// wall right in its middle, and one would see nothing else.
fn freest(center: Vec3, along: Vec3, across: Vec3, objects: &[Aabb]) -> Vec3 {
    const STEPS: i16 = 64;
    let in_boxes = |middle: &Vec3| -> usize {
        let eye = |step: i16| *middle + along * (f32::from(step) / f32::from(STEPS) - 0.5);
        (0..=STEPS).map(|step| objects.iter().filter(|o| o.contains_point(eye(step))).count()).sum()
    };
    let aside = [0.0, 0.03, -0.03, 0.07, -0.07, 0.12, -0.12, 0.18, -0.18];
    // The first of those that are equally free.
    aside.map(|part| center + across * part).into_iter().min_by_key(in_boxes).unwrap_or(center)
}

fn around(bounds: &Aabb) -> CameraPath {
    const POINTS: usize = 16;
    let (center, radius) = (bounds.center(), 1.1 * extent(bounds));
    let control = |n: usize| {
        let (sin, cos) = (TAU * n as f32 / POINTS as f32).sin_cos();
        (center + radius * Vec3::new(sin, 0.3, cos), center)
    };
    CameraPath::new(50.0, (0..=POINTS).map(control))
}

/// 1.7 m above the floor, if there is a floor that one could stand on: in a scene lower than a
/// room, or so high that it cannot be meant in metres, halfway up.
fn eye_height(bounds: &Aabb) -> f32 {
    let height = bounds.size().y;
    bounds.min.y + if (2.0..500.0).contains(&height) { 1.7 } else { 0.5 * height }
}

/// The diagonal; for a point, enough to tell the eye's coordinates from the point's.
fn extent(bounds: &Aabb) -> f32 {
    let precision = 1e-5 * bounds.center().abs().max_element();
    bounds.size().length().max(precision).clamp(1e-6, 1e30)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tercet::geom::{Frustum, View, Viewport};

    /// Every scene can be seen: from a grain to a continent, and flat as a plate or a needle.
    #[test]
    fn every_frame_of_every_path_is_a_view_of_the_scene() {
        let sizes = [1e-3, 0.2, 1.0, 40.0, 1e4, 1e7];
        let shapes = [
            Vec3::ONE,
            Vec3::new(3.0, 0.1, 1.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.1, 0.0, 2.0),
            Vec3::ZERO,
        ];
        for (size, shape) in sizes.iter().flat_map(|&s| shapes.map(|shape| (s, shape))) {
            let bounds = Aabb::from_center(Vec3::new(5.0, -2.0, 9.0) * size, 0.5 * size * shape);
            for objects in [1, 1000] {
                let path = through(&bounds, &vec![bounds; objects]);
                let poses = (0..=100).map(|n| path.pose(n as f32 / 100.0));
                let seen = poses.filter(|p| {
                    View::look_at(p.eye, p.target, p.fov_y_degrees, near(&bounds), Viewport::new(64, 36))
                        .is_ok_and(|view| Frustum::new(&view).intersects(&bounds))
                });
                let seen = seen.count();
                assert!(seen > 60, "{bounds:?}: seen in {seen} frames of 101");
            }
        }
    }

    #[test]
    fn the_walk_goes_from_one_end_to_the_other_through_the_middle() {
        let bounds = Aabb::new(Vec3::ZERO, Vec3::new(10.0, 3.0, 40.0));
        let path = through(&bounds, &[bounds; 500]);
        let eyes: Vec<Vec3> = (0..=200).map(|n| path.pose(n as f32 / 200.0).eye).collect();
        assert!(eyes[0].z < 0.0 && eyes[200].z > 40.0);
        assert!(eyes.iter().all(|e| (e.x - 5.0).abs() < 1e-3 && (e.y - 1.7).abs() < 1e-3));
        let inside = eyes.iter().filter(|e| bounds.contains_point(**e)).count();
        assert!(inside > 100, "{inside} frames of 201 are inside");
    }

    #[test]
    fn the_walk_keeps_out_of_a_wall_in_the_middle() {
        let bounds = Aabb::new(Vec3::ZERO, Vec3::new(20.0, 3.0, 40.0));
        let wall = Aabb::new(Vec3::new(9.8, 0.0, 0.0), Vec3::new(10.2, 3.0, 40.0));
        let path = through(&bounds, &[wall, bounds, bounds, bounds]);
        assert!((0..=200).all(|n| !wall.contains_point(path.pose(n as f32 / 200.0).eye)));
    }
}
