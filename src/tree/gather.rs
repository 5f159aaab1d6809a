//! Rows of sixteen boxes from boxes that lie anywhere in memory: half of what a moving object costs.
//!
//! A box is two loads of four words, and rows are made of columns in registers. With AVX-512 that is
//! about a hundred instructions for sixteen boxes, so that many blocks are on their way from memory
//! at once. Everywhere else the same is done by fours. Numbers are only moved and compared: results
//! are the same on every machine.

use glam::{Mat4, Vec3, Vec4};
#[cfg(target_arch = "x86_64")]
use pulp::x86::V4;
#[cfg(target_arch = "x86_64")]
use pulp::{cast, f32x8, f32x16};

use super::block::{Block, LANES};
use super::hull::Hull;
use crate::geom::Aabb;

/// The newest box of an object in half a line of memory, with two words of its owners.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Words {
    /// The box.
    pub(super) aabb: Aabb,
    /// Where the object is.
    pub(super) location: u32,
    /// What the scene knows it by.
    pub(super) tag: u32,
}

impl Words {
    /// No box: the empty one.
    pub(super) const NOTHING: Self = Self::new(&Aabb::EMPTY, u32::MAX);

    /// A box that is somewhere, without a tag.
    pub(super) const fn new(aabb: &Aabb, location: u32) -> Self {
        Self { aabb: *aabb, location, tag: 0 }
    }

    /// All words: one load, for they are in their order.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn all(&self) -> [f32; 8] {
        let Self { aabb: Aabb { min, max }, location, tag } = *self;
        [min.x, min.y, min.z, max.x, max.y, max.z, f32::from_bits(location), f32::from_bits(tag)]
    }

    /// Half of the words: one load again.
    #[inline(always)]
    fn half(&self, half: usize) -> [f32; 4] {
        let Self { aabb: Aabb { min, max }, location, tag } = *self;
        match half {
            0 => [min.x, min.y, min.z, max.x],
            _ => [max.y, max.z, f32::from_bits(location), f32::from_bits(tag)],
        }
    }
}

/// What a node asks of its objects: to lie in its cell, across planes (NaN where there is none).
#[derive(Clone, Copy)]
pub(super) struct Site {
    pub(super) cell: Aabb,
    pub(super) straddled: Vec3,
}

/// What renewing a block found: a bit for each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) hull: Hull,
    /// Its box is another one than before.
    pub(super) moved: u16,
    /// It does not lie as the site asks: see [`Nodes::holds`](super::node::Nodes::holds).
    pub(super) out: u16,
}

impl Found {
    /// Of a block in which there is nothing.
    pub(super) const NOTHING: Self = Self { hull: Hull::EMPTY, moved: 0, out: 0 };
}

/// Renews blocks with one kind of registers.
pub(super) trait Gather: Copy {
    /// Takes the boxes of all lanes anew, each from its slot's words; the last of these are nobody's.
    fn renew(self, block: &mut Block, newest: &[Words], site: &Site) -> Found;
}

// No closures here: they would not be compiled for the wide registers.
#[cfg(target_arch = "x86_64")]
impl Gather for V4 {
    #[inline(always)]
    fn renew(self, block: &mut Block, newest: &[Words], site: &Site) -> Found {
        let Some(last) = newest.len().checked_sub(1) else { return Found::NOTHING };
        let mut boxes = [&Words::NOTHING; LANES];
        for (words, &slot) in boxes.iter_mut().zip(&block.slots) {
            // Lanes without an object get the last: a minimum is less than a look whether there is one.
            *words = &newest[(slot as usize).min(last)];
        }
        let pairs = pairs(self, &boxes);
        let (min, max) = rows(self, &pairs);
        let (mut moved, mut out) = (0, 0);
        for axis in 0..3 {
            let (low, high) = (min[axis], max[axis]);
            moved |= self.cmp_not_eq_f32x16(low, cast(block.min[axis])).0;
            moved |= self.cmp_not_eq_f32x16(high, cast(block.max[axis])).0;
            (block.min[axis], block.max[axis]) = (cast(low), cast(high));
        }
        let hull = hull(self, &pairs);
        // Most blocks lie in their cell as a whole, and most cells are across nothing.
        if !hull.is_within(&Hull::around(&site.cell)) {
            for axis in 0..3 {
                out |= self.cmp_lt_f32x16(min[axis], self.splat_f32x16(site.cell.min[axis])).0;
                out |= self.cmp_gt_f32x16(max[axis], self.splat_f32x16(site.cell.max[axis])).0;
            }
        }
        if !site.straddled.is_nan_mask().all() {
            for axis in 0..3 {
                let plane = self.splat_f32x16(site.straddled[axis]);
                out |= self.cmp_ge_f32x16(min[axis], plane).0 | self.cmp_le_f32x16(max[axis], plane).0;
            }
        }
        out &= self.cmp_lt_f32x16(min[0], self.splat_f32x16(f32::INFINITY)).0;
        Found { hull, moved, out }
    }
}

/// Two boxes a register, four lanes apart: so rows come out in order.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn pairs(simd: V4, boxes: &[&Words; LANES]) -> [f32x16; 8] {
    let f = simd.avx512f;
    let mut all = [simd.splat_f32x16(0.0); 8];
    for (i, pair) in all.iter_mut().enumerate() {
        let first = i / 4 * 8 + i % 4;
        let (low, high): (f32x8, f32x8) = (cast(boxes[first].all()), cast(boxes[first + 4].all()));
        *pair = cast(f._mm512_insertf64x4::<1>(f._mm512_castpd256_pd512(cast(low)), cast(high)));
    }
    all
}

/// The rows of least and of greatest coordinates.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn rows(simd: V4, pairs: &[f32x16; 8]) -> ([f32x16; 3], [f32x16; 3]) {
    let f = simd.avx512f;
    // In each quarter of a register a word of four boxes; the quarters by turns of the first half of the
    // words and of the second.
    let (a, b) = (columns(simd, pairs, 0), columns(simd, pairs, 4));
    let (mut low, mut high) = ([simd.splat_f32x16(0.0); 4], [simd.splat_f32x16(0.0); 4]);
    for i in 0..4 {
        low[i] = cast(f._mm512_shuffle_f32x4::<0b10_00_10_00>(cast(a[i]), cast(b[i])));
        high[i] = cast(f._mm512_shuffle_f32x4::<0b11_01_11_01>(cast(a[i]), cast(b[i])));
    }
    ([low[0], low[1], low[2]], [low[3], high[0], high[1]])
}

/// Four registers from the given one on, turned by fours.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn columns(simd: V4, pairs: &[f32x16; 8], from: usize) -> [f32x16; 4] {
    let f = simd.avx512f;
    let (a, b) = (cast(pairs[from]), cast(pairs[from + 1]));
    let (c, d) = (cast(pairs[from + 2]), cast(pairs[from + 3]));
    let (ab, cd) =
        (f._mm512_castps_pd(f._mm512_unpacklo_ps(a, b)), f._mm512_castps_pd(f._mm512_unpacklo_ps(c, d)));
    let (upper_ab, upper_cd) =
        (f._mm512_castps_pd(f._mm512_unpackhi_ps(a, b)), f._mm512_castps_pd(f._mm512_unpackhi_ps(c, d)));
    [
        cast(f._mm512_unpacklo_pd(ab, cd)),
        cast(f._mm512_unpackhi_pd(ab, cd)),
        cast(f._mm512_unpacklo_pd(upper_ab, upper_cd)),
        cast(f._mm512_unpackhi_pd(upper_ab, upper_cd)),
    ]
}

/// The box around all boxes: of columns first, and across a register once at the end.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn hull(simd: V4, pairs: &[f32x16; 8]) -> Hull {
    let f = simd.avx512f;
    let (mut least, mut most) = (cast(pairs[0]), cast(pairs[0]));
    for &pair in &pairs[1..] {
        least = f._mm512_min_ps(least, cast(pair));
        most = f._mm512_max_ps(most, cast(pair));
    }
    let [a, b]: [[f32; 8]; 2] = cast(least);
    let [c, d]: [[f32; 8]; 2] = cast(most);
    let least: [f32; 8] = cast(simd.avx._mm256_min_ps(cast(a), cast(b)));
    let most: [f32; 8] = cast(simd.avx._mm256_max_ps(cast(c), cast(d)));
    let ([min_x, min_y, min_z, ..], [_, _, _, max_x, max_y, max_z, ..]) = (least, most);
    Hull::around(&Aabb::new([min_x, min_y, min_z].into(), [max_x, max_y, max_z].into()))
}

/// Registers of four, which every machine has.
#[derive(Clone, Copy)]
pub(super) struct ByFours;

impl Gather for ByFours {
    #[inline(always)]
    fn renew(self, block: &mut Block, newest: &[Words], site: &Site) -> Found {
        let (mut moved, mut out) = (0, 0);
        let (mut least, mut most) = ([Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]);
        for from in (0..LANES).step_by(4) {
            let boxes = [0, 1, 2, 3].map(|i| {
                let slot = block.slots[from + i];
                newest.get(slot as usize).unwrap_or(&Words::NOTHING)
            });
            let half = |half| {
                let [a, b, c, d] = boxes.map(|words| words.half(half).into());
                Mat4::from_cols(a, b, c, d).transpose()
            };
            let (near, far) = (half(0), half(1));
            let min = [near.x_axis, near.y_axis, near.z_axis];
            let max = [near.w_axis, far.x_axis, far.y_axis];
            for axis in 0..3 {
                let rows = (&mut block.min[axis][from..], &mut block.max[axis][from..]);
                let differs =
                    min[axis].cmpne(Vec4::from_slice(rows.0)) | max[axis].cmpne(Vec4::from_slice(rows.1));
                let plane = Vec4::splat(site.straddled[axis]);
                let outside = min[axis].cmplt(Vec4::splat(site.cell.min[axis]))
                    | max[axis].cmpgt(Vec4::splat(site.cell.max[axis]))
                    | min[axis].cmpge(plane)
                    | max[axis].cmple(plane);
                moved |= (differs.bitmask() as u16) << from;
                let held = min[axis].cmplt(Vec4::INFINITY);
                out |= ((outside & held).bitmask() as u16) << from;
                min[axis].write_to_slice(rows.0);
                max[axis].write_to_slice(rows.1);
                (least[axis], most[axis]) = (least[axis].min(min[axis]), most[axis].max(max[axis]));
            }
        }
        let corner = |rows: [f32; 3]| Vec3::from_array(rows);
        let hull = Aabb::new(corner(least.map(Vec4::min_element)), corner(most.map(Vec4::max_element)));
        Found { hull: Hull::around(&hull), moved, out }
    }
}

#[cfg(test)]
mod tests {
    use super::super::blocks::NONE;
    use super::*;

    /// A block of boxes on round numbers, some of which have moved, some left, and some lanes empty.
    fn example() -> (Block, Vec<Words>, Site) {
        let mut block = Block::EMPTY;
        let mut newest = Vec::new();
        for lane in 0..13 {
            let at = Vec3::new((lane * 5 % 7) as f32, (lane * 3 % 11) as f32, lane as f32);
            let old = Aabb::new(at - 1.0, at + 1.0);
            let shift = if lane % 3 == 0 { 1.0 } else { 0.0 };
            block.put(lane, 12 - lane as u32, &old);
            newest.push(Words::new(&Aabb::new(old.min + shift, old.max + 2.0 * shift), 7));
        }
        newest.reverse();
        newest.push(Words::NOTHING);
        let cell = Aabb::new(Vec3::splat(-1.0), Vec3::new(6.0, 9.0, 12.0));
        (block, newest, Site { cell, straddled: Vec3::new(f32::NAN, 5.0, f32::NAN) })
    }

    fn renewed(gather: impl Gather) -> (Block, Found) {
        let (mut block, newest, site) = example();
        let found = gather.renew(&mut block, &newest, &site);
        (block, found)
    }

    #[test]
    fn a_renewed_block_is_what_its_objects_are() {
        let (old, newest, site) = example();
        let (block, found) = renewed(ByFours);
        let mut around = Aabb::EMPTY;
        for lane in 0..LANES {
            assert_eq!(block.slots[lane], old.slots[lane]);
            if block.slots[lane] == NONE {
                assert!(block.aabb(lane).is_empty() && (found.moved | found.out) & 1 << lane == 0);
                continue;
            }
            let (was, is) = (old.aabb(lane), newest[block.slots[lane] as usize].aabb);
            around = around.union(&is);
            assert_eq!(block.aabb(lane), is);
            assert_eq!(found.moved & 1 << lane != 0, was != is, "lane {lane}");
            let held = site.cell.contains(&is) && is.min.y < 5.0 && 5.0 < is.max.y;
            assert_eq!(found.out & 1 << lane != 0, !held, "lane {lane}");
        }
        assert_eq!(found.hull.aabb(), around);
        assert!(found.moved != 0 && found.out != 0, "{found:?}");
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn all_registers_agree() {
        let Some(wide) = V4::try_new() else { return };
        let ((block, found), (other, also)) = (renewed(ByFours), wide.vectorize(|| renewed(wide)));
        assert_eq!(found, also);
        assert_eq!((block.slots, block.min, block.max), (other.slots, other.min, other.max));
    }
}
