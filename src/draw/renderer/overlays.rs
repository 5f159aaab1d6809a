//! What lies over a frame: the edges of boxes, and polygons on the screen.

use std::ops::Range;

use bytemuck::{Pod, Zeroable, cast_slice};
use wgpu::RenderPass;

use super::Renderer;
use super::kinds::{Kind, Source};
use crate::geom::{Aabb, ScreenOutline};

/// What hides the edges of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Lines {
    /// Whatever is nearer.
    #[default]
    DepthTested,
    /// Nothing.
    XRay,
}

/// A box as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct BoxEdges {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
    pub(super) color: [u8; 4],
}

/// A point of the screen as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Corner {
    pub(super) pixel: [f32; 2],
    pub(super) color: [u8; 4],
}

/// Two vertices for each of twelve edges.
const EDGE_VERTICES: u32 = 24;

impl Renderer {
    /// Draws the edges of boxes, one pixel wide, in sRGB colours with alpha. Invalid boxes are left
    /// out. The depth stays as it is.
    pub fn draw_boxes(&mut self, pass: &mut RenderPass<'static>, boxes: &[(Aabb, [u8; 4])], lines: Lines) {
        let kind = match lines {
            Lines::DepthTested => Kind::Edges,
            Lines::XRay => Kind::XRayEdges,
        };
        let valid = boxes.iter().filter(|(aabb, _)| aabb.is_valid());
        let edges: Vec<BoxEdges> = valid
            .map(|&(aabb, color)| BoxEdges { low: aabb.min.to_array(), high: aabb.max.to_array(), color })
            .collect();
        self.draw_overlay(pass, kind, cast_slice(&edges), 0..EDGE_VERTICES, 0..edges.len() as u32);
    }

    /// Draws polygons over everything, in sRGB colours with alpha, with an opaque border. The depth
    /// stays as it is.
    pub fn draw_outlines(&mut self, pass: &mut RenderPass<'static>, outlines: &[(ScreenOutline, [u8; 4])]) {
        let (mut polygons, mut borders) = (Vec::new(), Vec::new());
        for (outline, color) in outlines {
            let [r, g, b, _] = *color;
            let corner = |i: usize, color| Corner { pixel: outline.points[i].to_array(), color };
            let count = outline.points.len();
            for i in 1..count.saturating_sub(1) {
                polygons.extend([0, i, i + 1].map(|i| corner(i, *color)));
            }
            for i in 0..count {
                borders.extend([i, (i + 1) % count].map(|i| corner(i, [r, g, b, u8::MAX])));
            }
        }
        for (kind, corners) in [(Kind::Polygons, polygons), (Kind::Borders, borders)] {
            self.draw_overlay(pass, kind, cast_slice(&corners), 0..corners.len() as u32, 0..1);
        }
    }

    /// Draws something of one vertex buffer over the frame.
    fn draw_overlay(
        &mut self,
        pass: &mut RenderPass<'static>,
        kind: Kind,
        bytes: &[u8],
        vertices: Range<u32>,
        instances: Range<u32>,
    ) {
        let (Some(frame), Some(_), false) = (&self.frame, self.color, bytes.is_empty()) else { return };
        let (buffer, offset) = self.arena.write(&self.device, &self.queue, bytes);
        self.uploaded += bytes.len() as u64;
        self.pipelines.set(pass, (&self.device, &self.queue), kind, Source::Instances, &frame.view);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(0, buffer.slice(offset..));
        pass.draw(vertices, instances);
    }
}
