//! Where the nodes of the tree lie on the screen: a rectangle and a nearest point each.
//!
//! # Why rays find what rasters find
//!
//! *Claim.* If the proxy of an object that is asked about covers a pixel with an entry nearness of at
//! least some n, then each node above the object has a rectangle that holds the pixel, and a nearest
//! point of at least n. So a ray through the pixel comes to the object.
//!
//! An object's proxy lies within its rectangle, and is nowhere nearer than its nearest point; so it is
//! enough that a node's rectangle holds those of its objects, and its point is as near. (Its outline
//! and planes would not do. Their slopes are those of edges as they were computed, and where two short
//! ones meet in f32, an outline may reach beyond that of a larger box.)
//!
//! Both come from the same stage (`place` in the shader), but a node's errors are taken three times.
//! Let e be by how much a computed corner may be wrong, and r how far a rectangle is moved outward for
//! that and everything else. Exactly, the node's corners lie no further inside than the object's; so
//! it is enough that 3r of the node is at least e of both and r of the object. By `project.rs`, e is
//! less than r/2; and r grows with coordinates and falls with the least w, which are the node's own
//! but for e again, at most a twelfth of w. The same holds for nearness.
//!
//! Who is *outside* with three times the error is outside with one. A box that may reach behind the
//! eye is outside only if it lies 100 pixels beside the view: an object below it that is asked about
//! has an r below 32 pixels, and a rectangle that is empty. Objects that cannot be asked about are
//! seen, whatever becomes of their nodes.

use bytemuck::{Pod, Zeroable};
use wgpu::{BindGroup, BufferUsages, Device, ShaderModule};

use super::array::DeviceArray;
use super::asked::SEEN;
use super::flat::FlatTree;
use super::stage::Stage;
use crate::geom::PixelRect;
use crate::query::gpu::clock::Tape;

/// The twin of `Node` in `shaders/shared/nodes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(in crate::query::gpu) struct PackedNode {
    rect: [u32; 4],
    nearest: f32,
    enter: u32,
    skip: u32,
    first: u32,
    end: u32,
    parent: u32,
    verdict: u32,
    unused: u32,
}

impl PackedNode {
    /// The pixels where what lies below may own samples; None if the device cannot say.
    pub(super) fn pixels(&self) -> Option<PixelRect> {
        let [x0, y0, x1, y1] = self.rect;
        (self.verdict != SEEN).then_some(PixelRect { x0, y0, x1, y1 })
    }
}

/// The nodes of a tree on the screen.
pub(in crate::query::gpu) type Nodes = DeviceArray<PackedNode>;

/// Those of no tree.
pub(in crate::query::gpu) fn nodes(device: &Device) -> Nodes {
    DeviceArray::new(device, "tercet nodes", BufferUsages::STORAGE | BufferUsages::COPY_SRC)
}

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Enclose(Stage);

impl Enclose {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true)];
        Self(Stage::new(device, module, ("tercet enclose", "enclose"), buffers))
    }

    /// Records the enclosing of all nodes.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        view: &BindGroup,
        tree: &FlatTree,
        nodes: &Nodes,
    ) {
        let [boxes, links] = tree.nodes();
        self.0.record(tape, view, &[(0, boxes), (1, links), (2, nodes.all())], nodes.count());
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::super::super::pack::tests::assert_same_layout;
    use super::*;
    use crate::query::gpu::Shaders;

    #[test]
    fn structs_lie_in_memory_as_the_shaders_think() {
        let Shaders { enclose, enlist, sweep_rays, .. } = Shaders::default();
        for source in [&enclose, &enlist, &sweep_rays.single, &sweep_rays.multisampled] {
            let module = wgpu::naga::front::wgsl::parse_str(source).expect("it parses");
            assert_same_layout!(
                &module,
                "Node",
                PackedNode,
                [rect, nearest, enter, skip, first, end, parent, verdict, unused]
            );
        }
    }
}
