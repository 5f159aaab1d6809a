//! A view as the shader that makes proxies reads it: the twin of `View` in
//! `shaders/sweep/place.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3};

use super::boxes::{BOXED, FARTHEST};
use crate::geom::{DepthDirection, DepthFormat, SILHOUETTES, View};

/// The uniforms of a view.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(in crate::query::gpu) struct PackedView {
    clip_from_world: [[f32; 4]; 4],
    error: [[f32; 4]; 4],
    world_from_clip: [[f32; 4]; 4],
    silhouettes: [[u32; 4]; 27],
    origin: [f32; 2],
    size: [f32; 2],
    sign: f32,
    within_pixel: f32,
    step_share: f32,
    step: f32,
    cleared: f32,
    slack: f32,
    askable: u32,
    unused: u32,
}

/// How many times [`View::clip_error`] is allowed for: twice as in `geom/project.rs`, once for the
/// corners' own evaluation in f32, and some for the rounding of all that is made of it.
pub(super) const SHARE: f64 = 3.25;

/// Half of the distance from 1 to the next f32.
pub(super) const UNIT: f32 = 1.0 / 16_777_216.0;

/// Clip coordinates beyond this could overflow in what is made of them.
const GREATEST: f64 = 1e15;

impl PackedView {
    /// `slack` is added to the nearness of boxes.
    pub(in crate::query::gpu) fn new(view: &View, slack: f32) -> Self {
        let viewport = view.viewport();
        let at_origin = view.clip_error(DVec3::ZERO);
        let along = |axis| view.clip_error(axis) - at_origin;
        let error = DMat4::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z), at_origin) * SHARE;
        let world = *view.world_from_clip();
        let scale = world.to_cols_array().into_iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let (step_share, step) = match view.format() {
            DepthFormat::Depth32Float => (2.0 * UNIT, f32::MIN_POSITIVE),
            DepthFormat::Depth24Plus => (0.0, 2.0 * UNIT),
        };
        Self {
            clip_from_world: view.clip_from_world().as_mat4().to_cols_array_2d(),
            error: error.as_mat4().to_cols_array_2d().map(|column| column.map(f32::next_up)),
            world_from_clip: (world * (1.0 / scale)).as_mat4().to_cols_array_2d(),
            silhouettes: std::array::from_fn(silhouette),
            origin: [viewport.x as f32, viewport.y as f32],
            size: [viewport.width as f32, viewport.height as f32],
            sign: match view.depth() {
                DepthDirection::Reversed => 1.0,
                DepthDirection::Standard => -1.0,
            },
            within_pixel: if view.samples() > 1 { 0.5 } else { 0.0 },
            step_share,
            step,
            cleared: view.depth().cleared(),
            slack,
            askable: if is_askable(view) { BOXED } else { 0 },
            unused: 0,
        }
    }
}

/// Whether any box can be asked about in f32.
pub(super) fn is_askable(view: &View) -> bool {
    let farthest =
        view.clip_error(DVec3::splat(f64::from(FARTHEST))).max_element() / (16.0 * f64::from(UNIT));
    farthest < GREATEST
}

/// A silhouette: three bits a corner, four corners a pair of edges, and how many pairs there are.
fn silhouette(index: usize) -> [u32; 4] {
    let silhouette = &SILHOUETTES[index];
    let mut packed = [0, 0, 0, silhouette.len as u32];
    for (word, pair) in packed.iter_mut().zip(&silhouette.pairs[..silhouette.len]) {
        let corners = pair.as_flattened().iter().enumerate();
        *word = corners.fold(0, |bits, (i, &corner)| bits | (corner as u32) << (3 * i));
    }
    packed
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::super::super::pack::tests::assert_same_layout;
    use super::super::boxes::PackedBox;
    use super::*;
    use crate::query::gpu::Shaders;

    #[test]
    fn structs_lie_in_memory_as_the_shader_thinks() {
        let source = Shaders::default().project;
        let module = wgpu::naga::front::wgsl::parse_str(&source).expect("it parses");
        assert_same_layout!(
            &module,
            "View",
            PackedView,
            [
                clip_from_world,
                error,
                world_from_clip,
                silhouettes,
                origin,
                size,
                sign,
                within_pixel,
                step_share,
                step,
                cleared,
                slack,
                askable,
                unused
            ]
        );
        PackedBox::assert_layout(&module);
    }
}
