//! Vertex buffers as the shaders read them.

use std::mem::offset_of;

use wgpu::{VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode};

use super::batch::Instance;
use super::normals::Vertex;
use super::overlays::{BoxEdges, Corner};

/// Of meshes.
pub(super) const VERTICES: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: VertexStepMode::Vertex,
    attributes: &[
        attribute(0, VertexFormat::Float32x3, offset_of!(Vertex, position)),
        attribute(1, VertexFormat::Snorm16x4, offset_of!(Vertex, normal)),
    ],
};

/// Transforms and colours.
pub(super) const INSTANCES: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<Instance>() as u64,
    step_mode: VertexStepMode::Instance,
    attributes: &[
        attribute(2, VertexFormat::Float32x4, offset_of!(Instance, rows)),
        attribute(3, VertexFormat::Float32x4, offset_of!(Instance, rows) + 16),
        attribute(4, VertexFormat::Float32x4, offset_of!(Instance, rows) + 32),
        attribute(5, VertexFormat::Unorm16x4, offset_of!(Instance, color)),
    ],
};

/// Whose the instances are, beside them.
pub(super) const IDS: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<u32>() as u64,
    step_mode: VertexStepMode::Instance,
    attributes: &[attribute(6, VertexFormat::Uint32, 0)],
};

/// Slots of objects, as an indirect frame lists them.
pub(super) const SLOTS: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<u32>() as u64,
    step_mode: VertexStepMode::Instance,
    attributes: &[attribute(2, VertexFormat::Uint32, 0)],
};

/// Boxes, by their edges.
pub(super) const BOXES: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<BoxEdges>() as u64,
    step_mode: VertexStepMode::Instance,
    attributes: &[
        attribute(0, VertexFormat::Float32x3, offset_of!(BoxEdges, low)),
        attribute(1, VertexFormat::Float32x3, offset_of!(BoxEdges, high)),
        attribute(2, VertexFormat::Unorm8x4, offset_of!(BoxEdges, color)),
    ],
};

/// Of polygons on the screen.
pub(super) const CORNERS: VertexBufferLayout<'_> = VertexBufferLayout {
    array_stride: size_of::<Corner>() as u64,
    step_mode: VertexStepMode::Vertex,
    attributes: &[
        attribute(0, VertexFormat::Float32x2, offset_of!(Corner, pixel)),
        attribute(1, VertexFormat::Unorm8x4, offset_of!(Corner, color)),
    ],
};

const fn attribute(shader_location: u32, format: VertexFormat, offset: usize) -> VertexAttribute {
    VertexAttribute { format, offset: offset as u64, shader_location }
}
