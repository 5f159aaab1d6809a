//! What a view may see by its frustum alone, nearest nodes first: the cheapest question.
//!
//! A node's box is tested against all planes at once, a plane a lane. Below a node that lies
//! within all of them nothing is tested; in a leaf that crosses some, those are tested against
//! sixteen objects at once. The arithmetic is [`Frustum::classify`]'s, operation by operation
//! (nothing is fused), so the answers are the same on every machine.

use std::any::Any;

use glam::Vec4;
use pulp::{Arch, Simd, WithSimd, b16};

use super::Tree;
use super::block::{Block, LANES};
use crate::geom::{Aabb, Frustum};

/// A walk through the tree by a view's frustum; kept, it needs no memory from the second on.
#[derive(Clone, Debug, Default)]
pub struct Walk {
    /// Nodes that meet the frustum, and a bit for each plane that their boxes cross.
    stack: Vec<(u32, u16)>,
}

impl Walk {
    /// An empty one.
    pub fn new() -> Self {
        Self::default()
    }

    /// Hands over each block that has objects whose boxes may meet the frustum, with a bit for
    /// each lane that does: exactly those that [`Frustum::intersects`]. The nodes come front to
    /// back as seen from `eye` (see [`View::eye`](crate::geom::View::eye)), by the planes that
    /// divide them: straddlers between the two halves, in no order within a leaf.
    ///
    /// To be called between an update and the next edit. O(nodes that meet the frustum).
    pub fn run(&mut self, tree: &Tree, frustum: &Frustum, eye: Vec4, found: impl FnMut(&Block, u16)) {
        self.stack.clear();
        let stack = &mut self.stack;
        Arch::new().dispatch(Visit { tree, planes: Planes::new(frustum), eye, stack, found });
    }
}

/// A walk under way, to be compiled for each instruction set.
struct Visit<'a, F> {
    tree: &'a Tree,
    planes: Planes,
    eye: Vec4,
    stack: &'a mut Vec<(u32, u16)>,
    found: F,
}

impl<F: FnMut(&Block, u16)> WithSimd for Visit<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let nodes = &self.tree.nodes;
        self.push(simd, 0, Planes::ALL);
        while let Some((node, crossed)) = self.stack.pop() {
            self.own(simd, node, crossed);
            let first = nodes.child[node as usize];
            if first == super::blocks::NONE {
                continue;
            }
            let axis = nodes.axis[node as usize] as usize;
            let high_is_nearer = match self.eye.w {
                0.0 => self.eye[axis] > 0.0,
                _ => self.eye[axis] > nodes.plane[node as usize],
            };
            let [far, near] = if high_is_nearer { [first, first + 1] } else { [first + 1, first] };
            for child in [far, first + 2, near] {
                self.push(simd, child, crossed);
            }
        }
    }
}

impl<F: FnMut(&Block, u16)> Visit<'_, F> {
    /// Puts a node on the way, unless it is empty or outside.
    #[inline(always)]
    fn push<S: Simd>(&mut self, simd: S, node: u32, mut crossed: u16) {
        if self.tree.nodes.below[node as usize] == 0 {
            return;
        }
        // Below a node that lies within all planes, everything does.
        if crossed != 0 {
            let [outside, across] = self.planes.classify(simd, &self.tree.nodes.bounds[node as usize]);
            if outside != 0 {
                return;
            }
            crossed = across;
        }
        self.stack.push((node, crossed));
    }

    /// Hands a node's own objects over.
    #[inline(always)]
    fn own<S: Simd>(&mut self, simd: S, node: u32, crossed: u16) {
        let run = self.tree.nodes.run[node as usize];
        let mut edges = [Edge::NONE; Planes::COUNT];
        let edges = self.planes.edges(crossed, &self.tree.nodes.bounds[node as usize], &mut edges);
        // Nearly always: then there is less to be looked at for each block.
        let single = edges.iter().all(|edge| edge.form.iter().all(|form| form.l.is_none()));
        for (block, held) in self.tree.blocks.of(run) {
            let lanes = match (crossed, single) {
                (0, _) => held,
                (_, true) => held & !outside::<S, true>(simd, block, edges),
                (_, false) => held & !outside::<S, false>(simd, block, edges),
            };
            if lanes != 0 {
                (self.found)(block, lanes);
            }
        }
    }
}

/// A frustum's planes, one a lane, filled up with planes that everything is within.
struct Planes {
    upper: [[f32; Self::ROOM]; 3],
    lower: [[f32; Self::ROOM]; 3],
    outer: [f32; Self::ROOM],
    inner: [f32; Self::ROOM],
}

impl Planes {
    const COUNT: usize = 6;
    const ALL: u16 = (1 << Self::COUNT) - 1;
    /// As many as the widest register has lanes.
    const ROOM: usize = 16;

    fn new(frustum: &Frustum) -> Self {
        let mut all = Self {
            upper: [[0.0; Self::ROOM]; 3],
            lower: [[0.0; Self::ROOM]; 3],
            outer: [1.0; Self::ROOM],
            inner: [1.0; Self::ROOM],
        };
        for (i, plane) in frustum.planes().iter().enumerate() {
            for axis in 0..3 {
                all.upper[axis][i] = plane.upper[axis];
                all.lower[axis][i] = plane.lower[axis];
            }
            (all.outer[i], all.inner[i]) = (plane.outer, plane.inner);
        }
        all
    }

    /// A bit for each plane that a valid box is outside of, and for each that it does not lie within.
    #[inline(always)]
    fn classify<S: Simd>(&self, simd: S, aabb: &Aabb) -> [u16; 2] {
        let zero = simd.splat_f32s(0.0);
        let (mut outside, mut across) = (0, 0);
        for i in 0..Self::COUNT.div_ceil(S::F32_LANES) {
            let (mut most, mut fewest) = ([zero; 3], [zero; 3]);
            for axis in 0..3 {
                let (low, high) = (simd.splat_f32s(aabb.min[axis]), simd.splat_f32s(aabb.max[axis]));
                let upper = S::as_simd_f32s(&self.upper[axis]).0[i];
                let lower = S::as_simd_f32s(&self.lower[axis]).0[i];
                // Whatever the coefficients' signs: one of the four is the greatest.
                let (a, b) = (simd.mul_f32s(upper, low), simd.mul_f32s(upper, high));
                let (c, d) = (simd.mul_f32s(lower, low), simd.mul_f32s(lower, high));
                most[axis] = simd.max_f32s(simd.max_f32s(a, b), simd.max_f32s(c, d));
                fewest[axis] = simd.min_f32s(simd.min_f32s(a, b), simd.min_f32s(c, d));
            }
            let greatest = simd.add_f32s(sum(simd, most), S::as_simd_f32s(&self.outer).0[i]);
            let least = simd.add_f32s(sum(simd, fewest), S::as_simd_f32s(&self.inner).0[i]);
            outside |= bits_of(simd, simd.less_than_f32s(greatest, zero), i);
            across |= bits_of(simd, simd.less_than_f32s(least, zero), i);
        }
        [outside, across]
    }

    /// The planes that a node crosses, made ready for its blocks.
    #[inline(always)]
    fn edges<'a>(&self, crossed: u16, bounds: &Aabb, edges: &'a mut [Edge; Self::COUNT]) -> &'a [Edge] {
        let (mut count, mut rest) = (0, crossed);
        while rest != 0 && count < Self::COUNT {
            let plane = rest.trailing_zeros() as usize % Self::ROOM;
            rest &= rest - 1;
            edges[count].outer = self.outer[plane];
            for axis in 0..3 {
                let (u, l) = (self.upper[axis][plane], self.lower[axis][plane]);
                let above = bounds.min[axis] >= 0.0;
                edges[count].form[axis] = if (u >= 0.0) == (l >= 0.0) && (above || bounds.max[axis] <= 0.0) {
                    // u ≥ l, and products round in order: it is known which is the greater one.
                    Form { u: if above { u } else { l }, l: None, greatest: [u >= 0.0; 2] }
                } else {
                    Form { u, l: Some(l), greatest: [u >= 0.0, l >= 0.0] }
                };
            }
            count += 1;
        }
        &edges[..count]
    }
}

/// A plane that a node crosses.
#[derive(Clone, Copy)]
struct Edge {
    form: [Form; 3],
    outer: f32,
}

/// What an axis adds to a plane's form: the product with one coefficient, or the greater of two; and
/// for each whether it is with the greatest coordinate, or the least.
#[derive(Clone, Copy)]
struct Form {
    u: f32,
    l: Option<f32>,
    greatest: [bool; 2],
}

impl Edge {
    const NONE: Self = Self { form: [Form { u: 0.0, l: None, greatest: [false; 2] }; 3], outer: 0.0 };
}

/// The lanes of a block that are outside one of the planes; `SINGLE`: of which each axis has a single
/// product.
#[inline(always)]
fn outside<S: Simd, const SINGLE: bool>(simd: S, block: &Block, edges: &[Edge]) -> u16 {
    let mut bits = 0;
    for i in 0..LANES / S::F32_LANES {
        let mut least = simd.splat_f32s(0.0);
        for Edge { form, outer } in edges {
            let mut terms = [simd.splat_f32s(0.0); 3];
            for axis in 0..3 {
                let Form { u, l, greatest } = form[axis];
                let far = if greatest[0] { &block.max[axis] } else { &block.min[axis] };
                terms[axis] = simd.mul_f32s(simd.splat_f32s(u), S::as_simd_f32s(far).0[i]);
                if let Some(l) = l.filter(|_| !SINGLE) {
                    let far = if greatest[1] { &block.max[axis] } else { &block.min[axis] };
                    let other = simd.mul_f32s(simd.splat_f32s(l), S::as_simd_f32s(far).0[i]);
                    terms[axis] = simd.max_f32s(terms[axis], other);
                }
            }
            least = simd.min_f32s(least, simd.add_f32s(sum(simd, terms), simd.splat_f32s(*outer)));
        }
        bits |= bits_of(simd, simd.less_than_f32s(least, simd.splat_f32s(0.0)), i);
    }
    bits
}

/// In the order of [`Frustum::classify`]. Closures would not be compiled for the wide registers.
#[inline(always)]
fn sum<S: Simd>(simd: S, [x, y, z]: [S::f32s; 3]) -> S::f32s {
    simd.add_f32s(simd.add_f32s(x, y), z)
}

/// A mask of one register's lanes as bits of the block's.
#[inline(always)]
fn bits_of<S: Simd>(simd: S, mask: S::m32s, register: usize) -> u16 {
    // Where masks are bits already; the compiler knows which.
    if let Some(bits) = (&mask as &dyn Any).downcast_ref::<b16>() {
        return bits.0;
    }
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
