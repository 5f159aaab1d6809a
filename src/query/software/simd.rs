//! The kernels compiled for the instruction sets that the machine may have.
//!
//! The kernels are written in the operations of [`Isa`] and inlined here into functions that may
//! use wider registers. This is the only file with `unsafe`.
#![expect(unsafe_code, reason = "instructions, and functions compiled for them, found at run time")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;
use std::sync::OnceLock;

use super::bands::{self, Frame, List};
use super::count::{self, Scene};
use super::footprint::{self, Footprint};
use super::hi_z::{self, Row};
#[cfg(target_arch = "x86_64")]
use super::isa::{LANES, Mask, TABLE};
use super::isa::{Isa, Portable};
use super::pass::DrawCall;
use super::sink::Sink;
use super::vertex::Screen;
use crate::geom::{Proxy, View};

/// An instruction set for the kernels. Results are the same at every level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// What the target always has: plain code over arrays, which the compiler turns into SSE2 on
    /// x86-64 and into NEON on AArch64.
    Portable,
    /// SSE4.1: 4 lanes.
    Sse41,
    /// AVX2: 8 lanes.
    Avx2,
    /// AVX-512 F, DQ, BW and VL: 16 lanes.
    Avx512,
}

impl SimdLevel {
    /// Every level, from the least to the best, whether this machine has it or not.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Sse41, Self::Avx2, Self::Avx512];

    /// The best level that this machine has. Detected once.
    pub fn detect() -> Self {
        static LEVEL: OnceLock<SimdLevel> = OnceLock::new();
        *LEVEL.get_or_init(detect)
    }
}

#[cfg(target_arch = "x86_64")]
fn detect() -> SimdLevel {
    if is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512vl")
    {
        SimdLevel::Avx512
    } else if is_x86_feature_detected!("avx2") {
        SimdLevel::Avx2
    } else if is_x86_feature_detected!("sse4.1") {
        SimdLevel::Sse41
    } else {
        SimdLevel::Portable
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> SimdLevel {
    SimdLevel::Portable
}

/// Methods of [`Isa`] that are one instruction on one register.
#[cfg(target_arch = "x86_64")]
macro_rules! single {
    ($($name:ident($($arg:ident: $type:ty),*) -> $result:ty = $body:expr;)*) => {
        $(
            #[inline(always)]
            fn $name($($arg: $type),*) -> $result {
                // SAFETY: only kernels at this level are given the type, so the machine has the
                // instructions. Pointers come from references to as many bytes as are read.
                unsafe { $body }
            }
        )*
    };
}

/// An instruction set with registers of fewer than sixteen lanes: everything is done to several.
#[cfg(target_arch = "x86_64")]
macro_rules! several {
    (
        $(#[$doc:meta])* $name:ident, $count:literal registers of $lanes:literal,
        $i:ty, $f:ty, load [$load:ident, $load_f:ident],
        splat [$splat:ident, $splat_f:ident], cast [$as_i:ident, $as_f:ident, $convert:ident],
        integers [$add:ident, $sub:ident, $mul:ident, $min:ident, $max:ident, $and:ident, $or:ident],
        shifts [$shift_left:ident, $shift_right:ident], compare [$gt:ident, $eq:ident],
        floats [$add_f:ident, $sub_f:ident, $mul_f:ident, $div_f:ident, $min_f:ident, $max_f:ident],
        masks [$gt_f:expr, $ge_f:expr, $bits:ident, $blend:ident]
    ) => {
        $(#[$doc])*
        #[cfg(target_arch = "x86_64")]
        pub(crate) struct $name;

        #[cfg(target_arch = "x86_64")]
        impl $name {
            /// All bits of the lanes where a mask is set.
            #[inline(always)]
            fn expand(mask: Mask) -> [$f; $count] {
                let bit: [i32; LANES] = std::array::from_fn(|lane| 1 << lane);
                // SAFETY: only kernels at this level are given the type, so the machine has the
                // instructions.
                unsafe {
                    let (bit, all) = (Self::load(&bit), $splat(mask as i32));
                    let mut out = [$splat_f(0.0); $count];
                    for i in 0..$count {
                        out[i] = $as_f($eq($and(bit[i], all), bit[i]));
                    }
                    out
                }
            }
        }

        #[cfg(target_arch = "x86_64")]
        impl Isa for $name {
            type I = [$i; $count];
            type F = [$f; $count];

            several! { @one $count,
                splat(v: i32) -> $i = |_i| $splat(v);
                load(v: &[i32; LANES]) -> $i = |i| $load(v.as_ptr().add($lanes * i).cast());
                add(a: Self::I, b: Self::I) -> $i = |i| $add(a[i], b[i]);
                sub(a: Self::I, b: Self::I) -> $i = |i| $sub(a[i], b[i]);
                mul(a: Self::I, b: Self::I) -> $i = |i| $mul(a[i], b[i]);
                min(a: Self::I, b: Self::I) -> $i = |i| $min(a[i], b[i]);
                max(a: Self::I, b: Self::I) -> $i = |i| $max(a[i], b[i]);
                and(a: Self::I, b: Self::I) -> $i = |i| $and(a[i], b[i]);
                or(a: Self::I, b: Self::I) -> $i = |i| $or(a[i], b[i]);
                bits(a: Self::F) -> $i = |i| $as_i(a[i]);
                splat_f(v: f32) -> $f = |_i| $splat_f(v);
                load_f(v: &[f32; LANES]) -> $f = |i| $load_f(v.as_ptr().add($lanes * i));
                to_f(a: Self::I) -> $f = |i| $convert(a[i]);
                add_f(a: Self::F, b: Self::F) -> $f = |i| $add_f(a[i], b[i]);
                sub_f(a: Self::F, b: Self::F) -> $f = |i| $sub_f(a[i], b[i]);
                mul_f(a: Self::F, b: Self::F) -> $f = |i| $mul_f(a[i], b[i]);
                div_f(a: Self::F, b: Self::F) -> $f = |i| $div_f(a[i], b[i]);
                min_f(a: Self::F, b: Self::F) -> $f = |i| $min_f(a[i], b[i]);
                max_f(a: Self::F, b: Self::F) -> $f = |i| $max_f(a[i], b[i]);
            }
            several! { @mask $count, $lanes, $bits,
                gt(a: Self::I, b: Self::I) = |i| $as_f($gt(a[i], b[i]));
                gt_f(a: Self::F, b: Self::F) = |i| $gt_f(a[i], b[i]);
                ge_f(a: Self::F, b: Self::F) = |i| $ge_f(a[i], b[i]);
            }

            #[inline(always)]
            fn store(v: Self::I) -> [i32; LANES] {
                // SAFETY: as many bytes, and all of them mean something.
                unsafe { std::mem::transmute::<Self::I, [i32; LANES]>(v) }
            }

            #[inline(always)]
            fn store_f(v: Self::F) -> [f32; LANES] {
                // SAFETY: as many bytes, and all of them mean something.
                unsafe { std::mem::transmute::<Self::F, [f32; LANES]>(v) }
            }

            #[inline(always)]
            fn widen(v: &[u8; LANES]) -> Self::I {
                let mut wide = [0; LANES];
                for i in 0..LANES {
                    wide[i] = i32::from(v[i]);
                }
                Self::load(&wide)
            }

            #[inline(always)]
            fn look_up(table: &[i32; TABLE], at: Self::I) -> Self::I {
                let (at, mut out) = (Self::store(at), [0; LANES]);
                for i in 0..LANES {
                    out[i] = table[at[i] as usize % TABLE];
                }
                Self::load(&out)
            }

            #[inline(always)]
            fn look_up_f(table: &[f32; TABLE], at: Self::I) -> Self::F {
                let (at, mut out) = (Self::store(at), [0.0; LANES]);
                for i in 0..LANES {
                    out[i] = table[at[i] as usize % TABLE];
                }
                Self::load_f(&out)
            }

            #[inline(always)]
            fn compress(mut mask: Mask, a: Self::I) -> Self::I {
                let (a, mut out, mut count) = (Self::store(a), [0; LANES], 0);
                while mask != 0 {
                    out[count % LANES] = a[mask.trailing_zeros() as usize % LANES];
                    count += 1;
                    mask &= mask - 1;
                }
                Self::load(&out)
            }

            #[inline(always)]
            fn shift_left<const N: u32>(a: Self::I) -> Self::I {
                let mut out = a;
                for i in 0..$count {
                    // SAFETY: as for `expand`.
                    out[i] = unsafe { $shift_left(a[i], _mm_cvtsi32_si128(N as i32)) };
                }
                out
            }

            #[inline(always)]
            fn shift_right<const N: u32>(a: Self::I) -> Self::I {
                let mut out = a;
                for i in 0..$count {
                    // SAFETY: as for `expand`.
                    out[i] = unsafe { $shift_right(a[i], _mm_cvtsi32_si128(N as i32)) };
                }
                out
            }

            #[inline(always)]
            fn blend(mask: Mask, a: Self::I, b: Self::I) -> Self::I {
                let (mask, mut out) = (Self::expand(mask), a);
                for i in 0..$count {
                    // SAFETY: as for `expand`.
                    out[i] = unsafe { $as_i($blend($as_f(a[i]), $as_f(b[i]), mask[i])) };
                }
                out
            }

            #[inline(always)]
            fn blend_f(mask: Mask, a: Self::F, b: Self::F) -> Self::F {
                let (mask, mut out) = (Self::expand(mask), a);
                for i in 0..$count {
                    // SAFETY: as for `expand`.
                    out[i] = unsafe { $blend(a[i], b[i], mask[i]) };
                }
                out
            }

            #[inline(always)]
            fn prefetch<T>(what: &T) {
                // SAFETY: a hint, which reads nothing.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(what).cast()) }
            }

            #[inline(always)]
            fn least(runs: &[[f32; LANES]; LANES]) -> Self::F {
                several! { @fold $count, runs, $min_f, < }
            }

            #[inline(always)]
            fn greatest(runs: &[[f32; LANES]; LANES]) -> Self::F {
                several! { @fold $count, runs, $max_f, > }
            }
        }
    };
    (@one $count:literal, $($name:ident($($arg:ident: $type:ty),*) -> $result:ty = |$i:ident| $body:expr;)*) => {
        $(
            #[inline(always)]
            fn $name($($arg: $type),*) -> [$result; $count] {
                // SAFETY: as for `expand`; pointers come from references to as many bytes as are
                // read.
                unsafe {
                    let mut out = [std::mem::zeroed::<$result>(); $count];
                    for $i in 0..$count {
                        out[$i] = $body;
                    }
                    out
                }
            }
        )*
    };
    (@mask $count:literal, $lanes:literal, $bits:ident, $($name:ident($($arg:ident: $type:ty),*) = |$i:ident| $body:expr;)*) => {
        $(
            #[inline(always)]
            fn $name($($arg: $type),*) -> Mask {
                let mut mask = 0;
                for $i in 0..$count {
                    // SAFETY: as for `expand`.
                    mask |= unsafe { $bits($body) as Mask } << ($lanes * $i);
                }
                mask
            }
        )*
    };
    (@fold $count:literal, $runs:ident, $fold:ident, $order:tt) => {{
        let mut out = [0.0; LANES];
        for (out, run) in out.iter_mut().zip($runs) {
            let run = Self::load_f(run);
            let mut folded = run[0];
            for i in 1..$count {
                // SAFETY: as for `expand`.
                folded = unsafe { $fold(folded, run[i]) };
            }
            // The lanes of the one register that is left are the first of these.
            let lanes = Self::store_f([folded; $count]);
            *out = lanes[0];
            for i in 1..LANES / $count {
                if lanes[i] $order *out {
                    *out = lanes[i];
                }
            }
        }
        Self::load_f(&out)
    }};
}

several! {
    /// [`SimdLevel::Avx2`].
    Avx2, 2 registers of 8,
    __m256i, __m256, load [_mm256_loadu_si256, _mm256_loadu_ps],
    splat [_mm256_set1_epi32, _mm256_set1_ps],
    cast [_mm256_castps_si256, _mm256_castsi256_ps, _mm256_cvtepi32_ps],
    integers [_mm256_add_epi32, _mm256_sub_epi32, _mm256_mullo_epi32, _mm256_min_epi32, _mm256_max_epi32,
        _mm256_and_si256, _mm256_or_si256],
    shifts [_mm256_sll_epi32, _mm256_sra_epi32], compare [_mm256_cmpgt_epi32, _mm256_cmpeq_epi32],
    floats [_mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps, _mm256_min_ps, _mm256_max_ps],
    masks [_mm256_cmp_ps::<_CMP_GT_OQ>, _mm256_cmp_ps::<_CMP_GE_OQ>, _mm256_movemask_ps, _mm256_blendv_ps]
}

several! {
    /// [`SimdLevel::Sse41`].
    Sse41, 4 registers of 4,
    __m128i, __m128, load [_mm_loadu_si128, _mm_loadu_ps],
    splat [_mm_set1_epi32, _mm_set1_ps],
    cast [_mm_castps_si128, _mm_castsi128_ps, _mm_cvtepi32_ps],
    integers [_mm_add_epi32, _mm_sub_epi32, _mm_mullo_epi32, _mm_min_epi32, _mm_max_epi32, _mm_and_si128,
        _mm_or_si128],
    shifts [_mm_sll_epi32, _mm_sra_epi32], compare [_mm_cmpgt_epi32, _mm_cmpeq_epi32],
    floats [_mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps, _mm_min_ps, _mm_max_ps],
    masks [_mm_cmpgt_ps, _mm_cmpge_ps, _mm_movemask_ps, _mm_blendv_ps]
}

/// One value of each run, by folding pairs of registers into one, four times: half of the lanes
/// of the one beside half of those of the other.
#[cfg(target_arch = "x86_64")]
macro_rules! fold_runs {
    ($runs:ident, $fold:ident) => {{
        let (mut halves, mut quarters) = ([_mm512_setzero_ps(); 8], [_mm512_setzero_ps(); 4]);
        // The order of the runs is such that they come out sorted.
        for i in 0..8 {
            let first = [0, 8, 1, 9, 2, 10, 3, 11][i];
            let (a, b) = (Self::load_f(&$runs[first]), Self::load_f(&$runs[first + 4]));
            halves[i] = $fold(
                _mm512_shuffle_f32x4::<0b01_00_01_00>(a, b),
                _mm512_shuffle_f32x4::<0b11_10_11_10>(a, b),
            );
        }
        for i in 0..4 {
            let (a, b) = (halves[2 * i], halves[2 * i + 1]);
            quarters[i] = $fold(
                _mm512_shuffle_f32x4::<0b10_00_10_00>(a, b),
                _mm512_shuffle_f32x4::<0b11_01_11_01>(a, b),
            );
        }
        let [a, b, c, d] = quarters;
        let even = _mm512_castps_pd($fold(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b)));
        let odd = _mm512_castps_pd($fold(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d)));
        $fold(
            _mm512_castpd_ps(_mm512_unpacklo_pd(even, odd)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(even, odd)),
        )
    }};
}

/// [`SimdLevel::Avx512`].
#[cfg(target_arch = "x86_64")]
pub(crate) struct Avx512;

#[cfg(target_arch = "x86_64")]
impl Isa for Avx512 {
    type I = __m512i;
    type F = __m512;

    single! {
        splat(v: i32) -> __m512i = _mm512_set1_epi32(v);
        load(v: &[i32; LANES]) -> __m512i = _mm512_loadu_si512(v.as_ptr().cast());
        store(v: __m512i) -> [i32; LANES] = std::mem::transmute::<__m512i, [i32; LANES]>(v);
        widen(v: &[u8; LANES]) -> __m512i = _mm512_cvtepu8_epi32(_mm_loadu_si128(v.as_ptr().cast()));
        add(a: __m512i, b: __m512i) -> __m512i = _mm512_add_epi32(a, b);
        sub(a: __m512i, b: __m512i) -> __m512i = _mm512_sub_epi32(a, b);
        mul(a: __m512i, b: __m512i) -> __m512i = _mm512_mullo_epi32(a, b);
        min(a: __m512i, b: __m512i) -> __m512i = _mm512_min_epi32(a, b);
        max(a: __m512i, b: __m512i) -> __m512i = _mm512_max_epi32(a, b);
        and(a: __m512i, b: __m512i) -> __m512i = _mm512_and_si512(a, b);
        or(a: __m512i, b: __m512i) -> __m512i = _mm512_or_si512(a, b);
        gt(a: __m512i, b: __m512i) -> Mask = Mask::from(_mm512_cmpgt_epi32_mask(a, b));
        compress(mask: Mask, a: __m512i) -> __m512i = _mm512_maskz_compress_epi32(mask as u16, a);
        blend(mask: Mask, a: __m512i, b: __m512i) -> __m512i = _mm512_mask_blend_epi32(mask as u16, a, b);
        splat_f(v: f32) -> __m512 = _mm512_set1_ps(v);
        load_f(v: &[f32; LANES]) -> __m512 = _mm512_loadu_ps(v.as_ptr());
        store_f(v: __m512) -> [f32; LANES] = std::mem::transmute::<__m512, [f32; LANES]>(v);
        to_f(a: __m512i) -> __m512 = _mm512_cvtepi32_ps(a);
        bits(a: __m512) -> __m512i = _mm512_castps_si512(a);
        add_f(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        sub_f(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        mul_f(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        div_f(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        min_f(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        max_f(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        gt_f(a: __m512, b: __m512) -> Mask = Mask::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b));
        ge_f(a: __m512, b: __m512) -> Mask = Mask::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b));
        blend_f(mask: Mask, a: __m512, b: __m512) -> __m512 = _mm512_mask_blend_ps(mask as u16, a, b);
    }

    #[inline(always)]
    fn shift_left<const N: u32>(a: __m512i) -> __m512i {
        // SAFETY: as for `single`.
        unsafe { _mm512_slli_epi32::<N>(a) }
    }

    #[inline(always)]
    fn shift_right<const N: u32>(a: __m512i) -> __m512i {
        // SAFETY: as for `single`.
        unsafe { _mm512_srai_epi32::<N>(a) }
    }

    #[inline(always)]
    fn look_up(table: &[i32; TABLE], at: __m512i) -> __m512i {
        let (quarters, _) = table.as_chunks::<LANES>();
        // SAFETY: as for `single`. Bit 4 of an index chooses the register of a pair, bit 5 the pair.
        unsafe {
            let low = _mm512_permutex2var_epi32(Self::load(&quarters[0]), at, Self::load(&quarters[1]));
            let high = _mm512_permutex2var_epi32(Self::load(&quarters[2]), at, Self::load(&quarters[3]));
            let upper = _mm512_test_epi32_mask(at, _mm512_set1_epi32(32));
            _mm512_mask_blend_epi32(upper, low, high)
        }
    }

    #[inline(always)]
    fn look_up_f(table: &[f32; TABLE], at: __m512i) -> __m512 {
        let (quarters, _) = table.as_chunks::<LANES>();
        // SAFETY: as for `look_up`.
        unsafe {
            let low = _mm512_permutex2var_ps(Self::load_f(&quarters[0]), at, Self::load_f(&quarters[1]));
            let high = _mm512_permutex2var_ps(Self::load_f(&quarters[2]), at, Self::load_f(&quarters[3]));
            let upper = _mm512_test_epi32_mask(at, _mm512_set1_epi32(32));
            _mm512_mask_blend_ps(upper, low, high)
        }
    }

    #[inline(always)]
    fn prefetch<T>(what: &T) {
        // SAFETY: a hint, which reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(what).cast()) }
    }

    #[inline(always)]
    fn least(runs: &[[f32; LANES]; LANES]) -> __m512 {
        // SAFETY: as for `single`.
        unsafe { fold_runs!(runs, _mm512_min_ps) }
    }

    #[inline(always)]
    fn greatest(runs: &[[f32; LANES]; LANES]) -> __m512 {
        // SAFETY: as for `single`.
        unsafe { fold_runs!(runs, _mm512_max_ps) }
    }
}

/// Defines a function that runs a kernel at a level; it is given as its versions for each.
macro_rules! dispatch {
    ($(#[$doc:meta])* $name:ident $([$($generics:tt)*] [$($names:tt)*])? ($($arg:ident: $type:ty),*) $(-> $result:ty)? = $module:ident [$($extra:tt)*]) => {
        $(#[$doc])*
        pub(crate) fn $name $(<$($generics)*>)? (level: SimdLevel, $($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "sse4.1")]
                fn sse41 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $module::$name::<Sse41 $($extra)*>($($arg),*) }
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $module::$name::<Avx2 $($extra)*>($($arg),*) }
                #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
                fn avx512 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $module::$name::<Avx512 $($extra)*>($($arg),*) }
                let best = SimdLevel::detect();
                if level == SimdLevel::Avx512 && best >= SimdLevel::Avx512 {
                    // SAFETY: the features were found on this machine.
                    return unsafe { avx512 $(::<$($names)*>)? ($($arg),*) };
                }
                if level == SimdLevel::Avx2 && best >= SimdLevel::Avx2 {
                    // SAFETY: the feature was found on this machine.
                    return unsafe { avx2 $(::<$($names)*>)? ($($arg),*) };
                }
                if level == SimdLevel::Sse41 && best >= SimdLevel::Sse41 {
                    // SAFETY: the feature was found on this machine.
                    return unsafe { sse41 $(::<$($names)*>)? ($($arg),*) };
                }
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = level;
            $module::$name::<Portable $($extra)*>($($arg),*)
        }
    };
}

dispatch! {
    /// See [`bands::band`].
    band [S: Sink] [S] (frame: &Frame<'_>, list: &mut List, sink: &mut S) = bands [, S]
}
dispatch! {
    /// See [`footprint::footprint`].
    footprint(view: &View, screen: &Screen, call: &DrawCall) -> Footprint = footprint []
}
dispatch! {
    /// See [`hi_z::fold_row`].
    fold_row(row: Row<'_>) = hi_z []
}
dispatch! {
    /// See [`count::any`].
    any(scene: Scene<'_>, proxy: &Proxy) -> bool = count []
}
dispatch! {
    /// See [`count::dual`].
    dual(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) = count []
}
