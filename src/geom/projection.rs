//! Projection matrices into `0 ≤ z ≤ w`. Angles in radians, distances in metres.

use glam::camera::rh::proj::directx;
use glam::{Mat4, Vec2, Vec4};

/// Perspective, reversed z, infinite far plane.
pub fn perspective(fov_y: f32, aspect: f32, near: f32) -> Mat4 {
    directx::perspective_infinite_reverse(fov_y, aspect, near)
}

/// Perspective with a finite far plane, reversed z.
pub fn perspective_finite(fov_y: f32, aspect: f32, near: f32, far: f32) -> Mat4 {
    // Standard z with the planes exchanged is reversed z.
    directx::perspective(fov_y, aspect, far, near)
}

/// Perspective, standard z, finite far plane.
pub fn perspective_standard(fov_y: f32, aspect: f32, near: f32, far: f32) -> Mat4 {
    directx::perspective(fov_y, aspect, near, far)
}

/// Orthographic, reversed z. `width` and `height` are the box's full sides.
pub fn orthographic(width: f32, height: f32, near: f32, far: f32) -> Mat4 {
    let (x, y) = (width * 0.5, height * 0.5);
    directx::orthographic(-x, x, -y, y, far, near)
}

/// The projection with its near plane replaced by `plane` (view space, positive on the side
/// that is kept; mirrors and portals), for reversed z with a finite or infinite far plane.
///
/// After Lengyel, *Oblique View Frustum Depth Projection and Clipping* (2005), restated for
/// `0 ≤ z ≤ w` reversed: the near plane is `w − z ≥ 0`, so row z becomes row w minus a
/// multiple of the plane, with the multiple chosen so that z stays ≥ 0 at the corner of the
/// frustum that lies farthest along the plane's normal.
pub fn oblique(clip_from_view: Mat4, plane: Vec4) -> Mat4 {
    let view_from_clip = clip_from_view.inverse();
    let toward = view_from_clip.transpose() * plane;
    let corner = view_from_clip * Vec4::new(toward.x.signum(), toward.y.signum(), 0.0, 1.0);
    let row_w = clip_from_view.row(3);
    let scale = row_w.dot(corner) / plane.dot(corner);
    let row_z = row_w - plane * scale;
    let mut m = clip_from_view.transpose();
    m.z_axis = row_z;
    m.transpose()
}

/// The projection shifted by a fraction of a pixel, as temporal anti-aliasing does. `pixels`
/// points right and down.
pub fn jittered(clip_from_view: Mat4, pixels: Vec2, width: u32, height: u32) -> Mat4 {
    let shift = Vec2::new(2.0 * pixels.x / width as f32, -2.0 * pixels.y / height as f32);
    Mat4::from_translation(shift.extend(0.0)) * clip_from_view
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn an_oblique_near_plane_is_where_it_was_asked_for() {
        // The plane 0.6·x − 0.8·z = 2, kept beyond it.
        let plane = Vec4::new(0.6, 0.0, -0.8, -2.0);
        let m = oblique(perspective(1.0, 1.0, 0.1), plane);
        for on_plane in [Vec3::new(0.0, 0.0, -2.5), Vec3::new(0.4, 0.3, -2.2)] {
            let clip = m * on_plane.extend(1.0);
            assert!((clip.z / clip.w - 1.0).abs() < 1e-5, "{clip}");
        }
        let beyond = m * Vec4::new(0.0, 0.0, -30.0, 1.0);
        assert!((0.0..1.0).contains(&(beyond.z / beyond.w)));
        let before = m * Vec4::new(0.0, 0.0, -1.0, 1.0);
        assert!(before.z > before.w);
    }
}
