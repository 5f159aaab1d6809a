//! The boxes around nodes' blocks, in the widest registers that the machine has.

use pulp::{Arch, Simd, WithSimd};

use super::block::{Block, LANES};
use super::blocks::{Blocks, NONE};
use super::node::Nodes;
use crate::geom::Aabb;

/// The box around some blocks.
pub(super) fn around(blocks: &[Block]) -> Aabb {
    Arch::new().dispatch(Around(blocks))
}

struct Around<'a>(&'a [Block]);

impl WithSimd for Around<'_> {
    type Output = Aabb;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Aabb {
        bounds(simd, self.0)
    }
}

/// Measures nodes in which objects have moved, and lists the objects that have left.
pub(super) struct Moved<'a> {
    pub(super) list: &'a [u32],
    pub(super) blocks: &'a Blocks,
    pub(super) nodes: &'a mut Nodes,
    pub(super) leavers: &'a mut Vec<u32>,
}

impl WithSimd for Moved<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for &node in self.list {
            let blocks = self.blocks.of(self.nodes.run[node as usize]);
            let bounds = bounds(simd, blocks);
            // One compare, as long as the box around all objects stays in the cell.
            if !self.nodes.keeps_all_within(node, &bounds) {
                list_leavers(simd, blocks, self.nodes, node, self.leavers);
            }
            if self.nodes.is_leaf(node) {
                self.nodes.bounds[node as usize] = bounds;
            }
        }
    }
}

/// The box around some blocks: rows against rows first, and across a row once at the end.
#[inline(always)]
fn bounds<S: Simd>(simd: S, blocks: &[Block]) -> Aabb {
    let mut least = [simd.splat_f32s(f32::INFINITY); 3];
    let mut most = [simd.splat_f32s(f32::NEG_INFINITY); 3];
    for block in blocks {
        for axis in 0..3 {
            for i in 0..LANES / S::F32_LANES {
                least[axis] = simd.min_f32s(least[axis], S::as_simd_f32s(&block.min[axis]).0[i]);
                most[axis] = simd.max_f32s(most[axis], S::as_simd_f32s(&block.max[axis]).0[i]);
            }
        }
    }
    let mut all = Aabb::EMPTY;
    for axis in 0..3 {
        all.min[axis] = simd.reduce_min_f32s(least[axis]);
        all.max[axis] = simd.reduce_max_f32s(most[axis]);
    }
    all
}

/// Lists the objects of a node that it does not keep.
#[inline(always)]
fn list_leavers<S: Simd>(simd: S, blocks: &[Block], nodes: &Nodes, node: u32, leavers: &mut Vec<u32>) {
    let divided = !nodes.is_leaf(node);
    for block in blocks {
        let mut lanes = if divided { u16::MAX } else { leaving(simd, block, nodes, node) };
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            if block.slots[lane] != NONE && !(divided && nodes.keeps(node, &block.aabb(lane))) {
                leavers.push(block.slots[lane]);
            }
        }
    }
}

/// The lanes whose objects a leaf does not hold, and any lanes without one: see [`Nodes::holds`].
#[inline(always)]
fn leaving<S: Simd>(simd: S, block: &Block, nodes: &Nodes, node: u32) -> u16 {
    let (cell, straddled) = (nodes.cell[node as usize], nodes.straddled[node as usize]);
    let mut bits = 0;
    for i in 0..LANES / S::F32_LANES {
        let mut out = simd.less_than_f32s(simd.splat_f32s(0.0), simd.splat_f32s(0.0));
        for axis in 0..3 {
            let low = S::as_simd_f32s(&block.min[axis]).0[i];
            let high = S::as_simd_f32s(&block.max[axis]).0[i];
            out = simd.or_m32s(out, simd.less_than_f32s(low, simd.splat_f32s(cell.min[axis])));
            out = simd.or_m32s(out, simd.less_than_f32s(simd.splat_f32s(cell.max[axis]), high));
            // NaN, where nothing is straddled, compares false.
            let plane = simd.splat_f32s(straddled[axis]);
            out = simd.or_m32s(out, simd.less_than_or_equal_f32s(plane, low));
            out = simd.or_m32s(out, simd.less_than_or_equal_f32s(high, plane));
        }
        bits |= bits_of(simd, out, i);
    }
    bits
}

/// A mask of one register's lanes as bits of the block's.
#[inline(always)]
pub(super) fn bits_of<S: Simd>(simd: S, mask: S::m32s, register: usize) -> u16 {
    // Lanes as different powers of two add up to their bits, exactly.
    let powers = S::as_simd_f32s(&POWERS).0[register];
    simd.reduce_sum_f32s(simd.select_f32s(mask, powers, simd.splat_f32s(0.0))) as u16
}

const POWERS: [f32; LANES] = {
    let mut powers = [1.0; LANES];
    let mut i = 1;
    while i < LANES {
        powers[i] = 2.0 * powers[i - 1];
        i += 1;
    }
    powers
};
