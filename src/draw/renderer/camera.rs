//! A view as the shaders read it: the twin of the struct in `shaders/shared/camera.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::DVec4;

use crate::geom::View;

/// The uniforms of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PackedCamera {
    clip_from_world: [[f32; 4]; 4],
    eye: [f32; 4],
    size: [f32; 2],
    facing: f32,
    encodes: u32,
}

impl PackedCamera {
    /// `encodes`: whether colours are to be written as sRGB.
    pub(super) fn new(view: &View, encodes: bool) -> Self {
        let viewport = view.viewport();
        Self {
            clip_from_world: view.clip_from_world().as_mat4().to_cols_array_2d(),
            eye: view.eye().to_array(),
            size: [viewport.width as f32, viewport.height as f32],
            facing: facing(view),
            encodes: u32::from(encodes),
        }
    }
}

/// 1 if a triangle that is seen counter-clockwise turns its front to the eye, −1 if its back.
///
/// With the eye's clip coordinates (0, 0, k, 0), the determinant of three clip positions and the
/// eye's is, on the one hand, −k times that of the positions' (x, y, w), whose sign says which way
/// round they appear; on the other hand the view's times that of the four points in the world,
/// whose sign says on which side of the triangle the eye stands. So the two agree or not for all
/// triangles alike.
fn facing(view: &View) -> f32 {
    let eye = *view.world_from_clip() * DVec4::Z;
    let k = eye.dot(view.eye().as_dvec4());
    if view.clip_from_world().determinant() * k < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use glam::{Mat4, Vec3};
    use wgpu::naga::TypeInner;
    use wgpu::naga::front::wgsl;

    use super::super::pipelines::SOURCES;
    use super::*;
    use crate::geom::{Viewport, projection};

    #[test]
    fn the_struct_lies_in_memory_as_the_shaders_think() {
        for source in SOURCES {
            let module = wgsl::parse_str(source).expect("it parses");
            let camera = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Camera"));
            let Some(TypeInner::Struct { members, span }) = camera.map(|(_, t)| &t.inner) else {
                panic!("Camera is {camera:?}");
            };
            let have: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset)).collect();
            macro_rules! offsets {
                ($($field:ident),*) => { vec![$((stringify!($field), offset_of!(PackedCamera, $field) as u32)),*] };
            }
            assert_eq!(have, offsets!(clip_from_world, eye, size, facing, encodes));
            assert_eq!(*span as usize, size_of::<PackedCamera>());
        }
    }

    /// Asks where the corners of a triangle appear, and on which side of it the eye stands.
    #[test]
    fn mirrored_views_are_known() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        for eye in [Vec3::new(0.3, 0.2, 5.0), Vec3::new(0.3, 0.2, -5.0)] {
            let looking = glam::camera::rh::view::look_at_mat4(eye, Vec3::ZERO, Vec3::Y);
            for clip_from_view in [
                projection::perspective(1.0, 1.0, 0.1),
                projection::perspective_finite(1.0, 1.0, 0.1, 50.0),
                projection::perspective_standard(1.0, 1.0, 0.1, 50.0),
                projection::orthographic(9.0, 9.0, 0.1, 50.0),
            ] {
                for (view_from_world, clip_from_view) in [
                    (looking, clip_from_view),
                    (mirror * looking, clip_from_view),
                    (looking, mirror * clip_from_view),
                    (mirror * looking, mirror * clip_from_view),
                ] {
                    let view = View::new(view_from_world, clip_from_view, Viewport::new(9, 9)).unwrap();
                    let at = triangle.map(|p| view.clip_from_world().project_point3(p.as_dvec3()).truncate());
                    let counter_clockwise = (at[1] - at[0]).perp_dot(at[2] - at[0]) > 0.0;
                    let front = eye.z > 0.0;
                    assert_eq!(facing(&view) > 0.0, counter_clockwise == front, "{view:?}");
                }
            }
        }
    }
}
