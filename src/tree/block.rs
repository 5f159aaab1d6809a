//! Sixteen boxes, each coordinate contiguous.

use super::blocks::NONE;
use super::hull::Hull;
use crate::geom::Aabb;

/// Objects a block: one 512-bit register a coordinate.
pub const LANES: usize = 16;

/// Sixteen boxes as six rows of coordinates, and whose they are.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Block {
    /// Least x, least y, least z.
    pub min: [[f32; LANES]; 3],
    /// Greatest x, greatest y, greatest z.
    pub max: [[f32; LANES]; 3],
    /// Object slots; `u32::MAX` in lanes that hold no object.
    pub slots: [u32; LANES],
}

impl Block {
    /// A block without objects: its boxes are neutral under union and outside every frustum.
    pub(super) const EMPTY: Self =
        Self { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3], slots: [NONE; LANES] };

    /// The box of one lane.
    pub fn aabb(&self, lane: usize) -> Aabb {
        let corner = |rows: &[[f32; LANES]; 3]| [rows[0][lane], rows[1][lane], rows[2][lane]].into();
        Aabb::new(corner(&self.min), corner(&self.max))
    }

    pub(super) fn put(&mut self, lane: usize, slot: u32, aabb: &Aabb) {
        self.slots[lane] = slot;
        for axis in 0..3 {
            self.min[axis][lane] = aabb.min[axis];
            self.max[axis][lane] = aabb.max[axis];
        }
    }

    /// The box around all lanes.
    pub(super) fn hull(&self) -> Hull {
        let mut all = Aabb::EMPTY;
        for axis in 0..3 {
            all.min[axis] = extreme(&self.min[axis], lesser);
            all.max[axis] = extreme(&self.max[axis], greater);
        }
        Hull::around(&all)
    }
}

/// The lanes that a mask names, in order.
pub(super) fn lanes(mut mask: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// The least or the greatest of a row: four at a time, which is what every machine can do at once.
#[inline(always)]
fn extreme(row: &[f32; LANES], of: impl Fn(f32, f32) -> f32) -> f32 {
    let mut four = [row[0], row[1], row[2], row[3]];
    for next in row[4..].chunks_exact(4) {
        for (most, &next) in four.iter_mut().zip(next) {
            *most = of(*most, next);
        }
    }
    of(of(four[0], four[1]), of(four[2], four[3]))
}

/// The smallest box around two, neither of which is NaN anywhere: two instructions an axis.
#[inline(always)]
pub(super) fn union(a: &Aabb, b: &Aabb) -> Aabb {
    let mut all = *a;
    for axis in 0..3 {
        all.min[axis] = lesser(a.min[axis], b.min[axis]);
        all.max[axis] = greater(a.max[axis], b.max[axis]);
    }
    all
}

/// One instruction, unlike `f32::min`, which must also sort out NaN: the tree holds none.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
