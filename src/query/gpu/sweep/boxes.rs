//! The objects' boxes as the shaders read them, by slot.

use bytemuck::{Pod, Zeroable};

use crate::geom::Aabb;
use crate::scene::Scene;

/// The twin of `Box` in `shaders/sweep/place.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(in crate::query::gpu) struct PackedBox {
    low: [f32; 3],
    kind: u32,
    high: [f32; 3],
    /// The leaf that holds it.
    node: u32,
}

/// There is a box to ask about.
pub(in crate::query::gpu) const BOXED: u32 = 1;
/// It is not asked about, but seen.
pub(in crate::query::gpu) const ALWAYS: u32 = 2;
/// It hides nothing, and is drawn last.
pub(in crate::query::gpu) const LATE: u32 = 4;

/// Boxes that reach farther are not asked about, so that nothing overflows in f32.
pub(super) const FARTHEST: f32 = 1e9;

impl PackedBox {
    /// Nothing.
    pub(super) const NONE: Self = Self { low: [0.0; 3], kind: 0, high: [0.0; 3], node: u32::MAX };

    /// A box, of an object or of a node.
    pub(super) fn new(aabb: &Aabb, node: u32, traits: u32) -> Self {
        let farthest = aabb.min.abs().max(aabb.max.abs()).max_element();
        let kind = if farthest <= FARTHEST { BOXED } else { ALWAYS };
        Self { low: aabb.min.to_array(), kind: kind | traits, high: aabb.max.to_array(), node }
    }

    pub(super) fn aabb(&self) -> Aabb {
        Aabb::new(self.low.into(), self.high.into())
    }
}

/// Lists the objects of a scene by slot. O(slots).
pub(in crate::query::gpu) fn collect(scene: &Scene, boxes: &mut Vec<PackedBox>) {
    let (tree, store) = (scene.tree(), scene.objects_store());
    let late = |slot: u32| if store.is_occluder(slot) { 0 } else { LATE };
    boxes.clear();
    boxes.extend((0..scene.slot_bound() as u32).map(|slot| {
        let node = tree.node_of(slot).map_or(u32::MAX, |node| node.index);
        tree.aabb_of(slot).map_or(PackedBox::NONE, |aabb| PackedBox::new(&aabb, node, late(slot)))
    }));
    for &slot in store.always() {
        boxes[slot as usize] = PackedBox { kind: ALWAYS | late(slot), ..PackedBox::NONE };
    }
}

#[cfg(test)]
impl PackedBox {
    /// Checks that a shader thinks the same of where its members lie.
    pub(in crate::query::gpu) fn assert_layout(module: &wgpu::naga::Module) {
        use std::mem::offset_of;
        crate::query::gpu::pack::tests::assert_same_layout!(module, "Box", Self, [low, kind, high, node]);
    }
}
