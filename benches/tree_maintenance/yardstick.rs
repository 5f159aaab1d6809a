//! What the tree is measured against, in the same process: a frustum test over all boxes, a copy of
//! them, and reading those of the movers in no order.

use std::hint::black_box;

use glam::{Mat4, Vec4};
use pulp::f32x16;
use pulp::x86::V4;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use tercet::geom::{Aabb, View};

const LANES: usize = 16;

/// Six rows of sixteen. Aligned: rows that lie across two lines of memory, as chance would have it,
/// make the scan half as slow again.
#[repr(align(64))]
struct Block([[f32; LANES]; 6]);

/// All boxes in struct-of-arrays, sixteen to a block, in no order: what *scan* tests.
pub struct Scan {
    blocks: Vec<Block>,
    /// A bit a box: whether the view may see it.
    pub seen: Vec<u16>,
}

impl Scan {
    pub fn new(boxes: &[Aabb]) -> Self {
        let blocks = boxes.chunks(LANES).map(|chunk| {
            let mut block = [[f32::INFINITY; LANES]; 6];
            block[3..].fill([f32::NEG_INFINITY; LANES]);
            for (lane, b) in chunk.iter().enumerate() {
                for axis in 0..3 {
                    block[axis][lane] = b.min[axis];
                    block[3 + axis][lane] = b.max[axis];
                }
            }
            Block(block)
        });
        Self { blocks: blocks.collect(), seen: vec![0; boxes.len().div_ceil(LANES)] }
    }

    /// Tests every box against the six planes of a view, with the widest registers that there are.
    pub fn run(&mut self, view: &View) {
        let (planes, blocks, seen) = (planes(view), &self.blocks[..], &mut self.seen[..]);
        if let Some(simd) = V4::try_new() {
            simd.vectorize(Wide { simd, planes, blocks, seen });
        } else {
            blocks.iter().zip(seen).for_each(|(block, seen)| *seen = test(&block.0, &planes));
        }
    }

    /// How many boxes the last run found.
    pub fn count(&self) -> usize {
        self.seen.iter().map(|bits| bits.count_ones() as usize).sum()
    }
}

/// A plane `n·p + d ≥ 0`, and which row of a block has the corner farthest along `n`, an axis.
struct Plane {
    n: [f32; 3],
    d: f32,
    row: [usize; 3],
}

fn planes(view: &View) -> [Plane; 6] {
    let m: Mat4 = view.clip_from_world().as_mat4();
    let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
    [w + x, w - x, w + y, w - y, w - z, z].map(|p: Vec4| Plane {
        n: p.truncate().to_array(),
        d: p.w,
        row: [0, 1, 2].map(|axis| if p[axis] >= 0.0 { 3 + axis } else { axis }),
    })
}

/// The scan where there is AVX-512: an instruction does sixteen boxes.
struct Wide<'a> {
    simd: V4,
    planes: [Plane; 6],
    blocks: &'a [Block],
    seen: &'a mut [u16],
}

impl pulp::NullaryFnOnce for Wide<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let simd = self.simd;
        for (Block(block), seen) in self.blocks.iter().zip(self.seen) {
            let mut least = simd.splat_f32x16(f32::INFINITY);
            for Plane { n, d, row } in &self.planes {
                let far = |axis: usize, sum: f32x16| {
                    simd.mul_add_f32x16(simd.splat_f32x16(n[axis]), pulp::cast(block[row[axis] % 6]), sum)
                };
                let sum = far(0, far(1, far(2, simd.splat_f32x16(*d))));
                least = pulp::cast(simd.avx512f._mm512_min_ps(pulp::cast(least), pulp::cast(sum)));
            }
            *seen = simd.cmp_ge_f32x16(least, simd.splat_f32x16(0.0)).0;
        }
    }
}

fn test(block: &[[f32; LANES]; 6], planes: &[Plane; 6]) -> u16 {
    let mut least = [f32::INFINITY; LANES];
    for Plane { n, d, row } in planes {
        let [x, y, z] = row.map(|r| &block[r]);
        for lane in 0..LANES {
            let far = (n[0] * x[lane] + n[1] * y[lane]) + (n[2] * z[lane] + d);
            least[lane] = if far < least[lane] { far } else { least[lane] };
        }
    }
    let mut bits = 0;
    for (lane, &least) in least.iter().enumerate() {
        bits |= if least >= 0.0 { 1u32 << lane } else { 0 };
    }
    bits as u16
}

/// Copies all boxes: what *memcpy* costs.
pub fn copy(from: &[Aabb], to: &mut [Aabb]) {
    to.copy_from_slice(from);
}

/// Half a line of memory for each mover, read in no order: what nobody can do without who is told of boxes
/// in the app's order and keeps them by where they are.
pub struct Reads {
    halves: Vec<Half>,
    order: Vec<u32>,
}

#[derive(Clone, Copy)]
#[repr(align(32))]
struct Half([f32; 8]);

impl Reads {
    pub fn new(movers: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut order: Vec<u32> = (0..movers as u32).collect();
        for last in (1..movers).rev() {
            order.swap(last, rng.next_u64() as usize % (last + 1));
        }
        Self { halves: vec![Half([1.0; 8]); movers], order }
    }

    /// Reads all.
    pub fn run(&self) {
        let mut sum = [0.0; 8];
        for &mover in &self.order {
            let Half(half) = &self.halves[mover as usize];
            sum.iter_mut().zip(half).for_each(|(sum, &x)| *sum += x);
        }
        black_box(sum);
    }
}
