//! What the app draws of an indirect frame.

use wgpu::{Buffer, RenderPass};

use crate::scene::Batch;

/// What the objects of a [`Batch`] draw: a part of the app's index and vertex buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct BatchMesh {
    /// Indices.
    pub index_count: u32,
    /// The first of them in the index buffer.
    pub first_index: u32,
    /// Added to each.
    pub base_vertex: i32,
}

/// One indirect draw: the objects of a batch that a list holds.
#[derive(Clone, Copy, Debug)]
pub struct IndirectBatch<'a> {
    /// Whose objects they are.
    pub batch: Batch,
    /// Slots of objects ([`ObjectId::slot`](crate::scene::ObjectId::slot)), a `u32` an instance: the
    /// app looks up by them where things stand.
    pub instances: &'a Buffer,
    /// Where this batch's begin, in bytes.
    pub instances_offset: u64,
    /// The arguments of a `draw_indexed_indirect`.
    pub arguments: &'a Buffer,
    /// Where this batch's are, in bytes.
    pub arguments_offset: u64,
}

impl IndirectBatch<'_> {
    /// Binds the slots as a vertex buffer, and draws. Everything else is the app's to set before.
    pub fn draw(&self, pass: &mut RenderPass<'static>, vertex_buffer: u32) {
        pass.set_vertex_buffer(vertex_buffer, self.instances.slice(self.instances_offset..));
        pass.draw_indexed_indirect(self.arguments, self.arguments_offset);
    }
}
