//! Sixteen lanes: the operations that the kernels are written in.
//!
//! Each operation means the same at every level, to the bit: integers wrap, floats round once an
//! operation and are never fused. So a kernel has one text, and its results are the same bits
//! whatever it is compiled for.

/// Samples, triangles or tiles that are worked on together.
pub(crate) const LANES: usize = 16;

/// A bit for each lane.
pub(crate) type Mask = u32;

/// All lanes.
pub(crate) const ALL: Mask = (1 << LANES) - 1;

/// The entries of a table that [`Isa::look_up`] reads.
pub(crate) const TABLE: usize = 64;

/// An instruction set. `I` are sixteen `i32`, `F` sixteen `f32`.
pub(crate) trait Isa {
    type I: Copy;
    type F: Copy;

    fn splat(v: i32) -> Self::I;
    fn load(v: &[i32; LANES]) -> Self::I;
    fn store(v: Self::I) -> [i32; LANES];
    /// Sixteen bytes, without sign.
    fn widen(v: &[u8; LANES]) -> Self::I;
    /// The table's entries at these indices, each below [`TABLE`].
    fn look_up(table: &[i32; TABLE], at: Self::I) -> Self::I;
    /// The same of a small table: indices below [`LANES`].
    fn pick(table: &[i32; LANES], at: Self::I) -> Self::I;
    fn add(a: Self::I, b: Self::I) -> Self::I;
    fn sub(a: Self::I, b: Self::I) -> Self::I;
    fn mul(a: Self::I, b: Self::I) -> Self::I;
    fn min(a: Self::I, b: Self::I) -> Self::I;
    fn max(a: Self::I, b: Self::I) -> Self::I;
    fn and(a: Self::I, b: Self::I) -> Self::I;
    fn or(a: Self::I, b: Self::I) -> Self::I;
    fn shift_left<const N: u32>(a: Self::I) -> Self::I;
    /// Keeps the sign.
    fn shift_right<const N: u32>(a: Self::I) -> Self::I;
    /// Where `a > b`.
    fn gt(a: Self::I, b: Self::I) -> Mask;
    /// The lanes where the mask is set, moved to the front in their order; the rest is anything.
    fn compress(mask: Mask, a: Self::I) -> Self::I;
    /// `b` where the mask is set, else `a`.
    fn blend(mask: Mask, a: Self::I, b: Self::I) -> Self::I;

    fn splat_f(v: f32) -> Self::F;
    fn load_f(v: &[f32; LANES]) -> Self::F;
    fn store_f(v: Self::F) -> [f32; LANES];
    fn look_up_f(table: &[f32; TABLE], at: Self::I) -> Self::F;
    fn pick_f(table: &[f32; LANES], at: Self::I) -> Self::F;
    /// The nearest float, ties to even.
    fn to_f(a: Self::I) -> Self::F;
    fn bits(a: Self::F) -> Self::I;
    fn add_f(a: Self::F, b: Self::F) -> Self::F;
    fn sub_f(a: Self::F, b: Self::F) -> Self::F;
    fn mul_f(a: Self::F, b: Self::F) -> Self::F;
    fn div_f(a: Self::F, b: Self::F) -> Self::F;
    /// `a < b ? a : b`, so `b` if either is not a number.
    fn min_f(a: Self::F, b: Self::F) -> Self::F;
    /// `a > b ? a : b`, so `b` if either is not a number.
    fn max_f(a: Self::F, b: Self::F) -> Self::F;
    /// Where `a > b`; nowhere for what is not a number.
    fn gt_f(a: Self::F, b: Self::F) -> Mask;
    /// Where `a ≥ b`; nowhere for what is not a number.
    fn ge_f(a: Self::F, b: Self::F) -> Mask;
    fn blend_f(mask: Mask, a: Self::F, b: Self::F) -> Self::F;

    /// The least value of each of sixteen runs of sixteen.
    fn least(runs: &[[f32; LANES]; LANES]) -> Self::F;
    /// The greatest value of each of sixteen runs of sixteen.
    fn greatest(runs: &[[f32; LANES]; LANES]) -> Self::F;
}

// Kernels call these rather than `map` and `from_fn` of the standard library: what is not inlined
// into the function that a kernel is compiled in is compiled without its instructions.

/// The same value in all lanes, of each.
#[inline(always)]
pub(crate) fn splat_each<I: Isa, const N: usize>(v: [f32; N]) -> [I::F; N] {
    let mut out = [I::splat_f(0.0); N];
    for i in 0..N {
        out[i] = I::splat_f(v[i]);
    }
    out
}

/// The lanes of each as an array.
#[inline(always)]
pub(crate) fn store_each<I: Isa, const N: usize>(v: [I::I; N]) -> [[i32; LANES]; N] {
    let mut out = [[0; LANES]; N];
    for i in 0..N {
        out[i] = I::store(v[i]);
    }
    out
}

/// The same for floats.
#[inline(always)]
pub(crate) fn store_each_f<I: Isa, const N: usize>(v: [I::F; N]) -> [[f32; LANES]; N] {
    let mut out = [[0.0; LANES]; N];
    for i in 0..N {
        out[i] = I::store_f(v[i]);
    }
    out
}

/// The sums of each and each.
#[inline(always)]
pub(crate) fn add_each<I: Isa, const N: usize>(mut a: [I::I; N], b: [I::I; N]) -> [I::I; N] {
    for i in 0..N {
        a[i] = I::add(a[i], b[i]);
    }
    a
}

/// One lane of each.
#[inline(always)]
pub(crate) fn of_lane<T: Copy, const N: usize>(rows: &[[T; LANES]; N], lane: usize) -> [T; N] {
    let mut out = [rows[0][lane]; N];
    for i in 1..N {
        out[i] = rows[i][lane];
    }
    out
}

/// Without the sign.
#[inline(always)]
pub(crate) fn magnitude<I: Isa>(v: I::F) -> I::F {
    I::max_f(v, I::sub_f(I::splat_f(0.0), v))
}

/// The least of sixteen.
#[inline(always)]
pub(crate) fn least(run: &[f32; LANES]) -> f32 {
    run.iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a })
}

/// The greatest of sixteen.
#[inline(always)]
pub(crate) fn greatest(run: &[f32; LANES]) -> f32 {
    run.iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a })
}

/// What an affine function of three variables yields: `((c0·x + c1·y) + c2·z) + c3`.
#[inline(always)]
pub(crate) fn affine<I: Isa>(c: [f32; 4], [x, y, z]: [I::F; 3]) -> I::F {
    let c = splat_each::<I, 4>(c);
    let sum = I::add_f(I::mul_f(c[0], x), I::mul_f(c[1], y));
    I::add_f(I::add_f(sum, I::mul_f(c[2], z)), c[3])
}

/// Plain arrays, for any machine: what the compiler makes of them is up to it.
pub(crate) struct Portable;

#[inline(always)]
fn map<A: Copy, R>(a: [A; LANES], f: impl Fn(A) -> R) -> [R; LANES] {
    std::array::from_fn(|i| f(a[i]))
}

#[inline(always)]
fn zip<A: Copy, R>(a: [A; LANES], b: [A; LANES], f: impl Fn(A, A) -> R) -> [R; LANES] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

#[inline(always)]
fn mask(bits: [bool; LANES]) -> Mask {
    (0..LANES).fold(0, |mask, i| mask | Mask::from(bits[i]) << i)
}

#[inline(always)]
fn blend<A: Copy>(mask: Mask, a: [A; LANES], b: [A; LANES]) -> [A; LANES] {
    std::array::from_fn(|i| if mask >> i & 1 != 0 { b[i] } else { a[i] })
}

impl Isa for Portable {
    type I = [i32; LANES];
    type F = [f32; LANES];

    #[inline(always)]
    fn splat(v: i32) -> Self::I {
        [v; LANES]
    }
    #[inline(always)]
    fn load(v: &[i32; LANES]) -> Self::I {
        *v
    }
    #[inline(always)]
    fn store(v: Self::I) -> [i32; LANES] {
        v
    }
    #[inline(always)]
    fn widen(v: &[u8; LANES]) -> Self::I {
        map(*v, i32::from)
    }
    #[inline(always)]
    fn look_up(table: &[i32; TABLE], at: Self::I) -> Self::I {
        map(at, |i| table[i as usize % TABLE])
    }
    #[inline(always)]
    fn pick(table: &[i32; LANES], at: Self::I) -> Self::I {
        map(at, |i| table[i as usize % LANES])
    }
    #[inline(always)]
    fn add(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, i32::wrapping_add)
    }
    #[inline(always)]
    fn sub(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, i32::wrapping_sub)
    }
    #[inline(always)]
    fn mul(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, i32::wrapping_mul)
    }
    #[inline(always)]
    fn min(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, Ord::min)
    }
    #[inline(always)]
    fn max(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, Ord::max)
    }
    #[inline(always)]
    fn and(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn or(a: Self::I, b: Self::I) -> Self::I {
        zip(a, b, |a, b| a | b)
    }
    #[inline(always)]
    fn shift_left<const N: u32>(a: Self::I) -> Self::I {
        map(a, |a| a << N)
    }
    #[inline(always)]
    fn shift_right<const N: u32>(a: Self::I) -> Self::I {
        map(a, |a| a >> N)
    }
    #[inline(always)]
    fn gt(a: Self::I, b: Self::I) -> Mask {
        mask(zip(a, b, |a, b| a > b))
    }
    #[inline(always)]
    fn compress(mut mask: Mask, a: Self::I) -> Self::I {
        let (mut out, mut count) = (a, 0);
        while mask != 0 {
            out[count] = a[mask.trailing_zeros() as usize % LANES];
            count += 1;
            mask &= mask - 1;
        }
        out
    }
    #[inline(always)]
    fn blend(mask: Mask, a: Self::I, b: Self::I) -> Self::I {
        blend(mask, a, b)
    }
    #[inline(always)]
    fn splat_f(v: f32) -> Self::F {
        [v; LANES]
    }
    #[inline(always)]
    fn load_f(v: &[f32; LANES]) -> Self::F {
        *v
    }
    #[inline(always)]
    fn store_f(v: Self::F) -> [f32; LANES] {
        v
    }
    #[inline(always)]
    fn look_up_f(table: &[f32; TABLE], at: Self::I) -> Self::F {
        map(at, |i| table[i as usize % TABLE])
    }
    #[inline(always)]
    fn pick_f(table: &[f32; LANES], at: Self::I) -> Self::F {
        map(at, |i| table[i as usize % LANES])
    }
    #[inline(always)]
    fn to_f(a: Self::I) -> Self::F {
        map(a, |a| a as f32)
    }
    #[inline(always)]
    fn bits(a: Self::F) -> Self::I {
        map(a, |a| a.to_bits() as i32)
    }
    #[inline(always)]
    fn add_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max_f(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn gt_f(a: Self::F, b: Self::F) -> Mask {
        mask(zip(a, b, |a, b| a > b))
    }
    #[inline(always)]
    fn ge_f(a: Self::F, b: Self::F) -> Mask {
        mask(zip(a, b, |a, b| a >= b))
    }
    #[inline(always)]
    fn blend_f(mask: Mask, a: Self::F, b: Self::F) -> Self::F {
        blend(mask, a, b)
    }
    #[inline(always)]
    fn least(runs: &[[f32; LANES]; LANES]) -> Self::F {
        map(*runs, |run| least(&run))
    }
    #[inline(always)]
    fn greatest(runs: &[[f32; LANES]; LANES]) -> Self::F {
        map(*runs, |run| greatest(&run))
    }
}
