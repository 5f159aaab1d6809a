//! The kernels compiled for the instruction sets that the machine may have.
//!
//! The kernels are written in the operations of [`Isa`] and inlined here into functions that may
//! use wider registers. This is the only file with `unsafe`.
#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "instructions, and functions compiled for them, found at run time")
)]

use super::bands::{self, Frame, List};
use super::batch::{self, Found};
use super::count::{self, Scene};
use super::footprint::{self, Footprint};
use super::hi_z::{self, Row};
use super::isa::Portable;
use super::level::SimdLevel;
use super::pass::DrawCall;
use super::sink::Sink;
use super::sweep::{self, Packet, Rays};
use super::vertex::Screen;
use crate::geom::{Proxy, View};

#[cfg(target_arch = "x86_64")]
use x86::{Avx2, Avx512, Sse41};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::super::isa::{Isa, LANES, Mask, TABLE};

    /// Methods of [`Isa`] that are one instruction on one register.
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

    /// A bit for each lane, by lane.
    const LANE_BITS: [i32; LANES] =
        [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16_384, 32_768];

    #[target_feature(enable = "avx2")]
    #[inline]
    fn greater_256(a: __m256, b: __m256) -> __m256 {
        _mm256_cmp_ps::<_CMP_GT_OQ>(a, b)
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn greater_or_equal_256(a: __m256, b: __m256) -> __m256 {
        _mm256_cmp_ps::<_CMP_GE_OQ>(a, b)
    }

    /// An instruction on each of two or four registers.
    macro_rules! each {
    (2, $f:ident, $($a:ident),*) => { [$f($($a[0]),*), $f($($a[1]),*)] };
    (4, $f:ident, $($a:ident),*) => { [$f($($a[0]),*), $f($($a[1]),*), $f($($a[2]),*), $f($($a[3]),*)] };
}

    /// The sign bits of two or four registers.
    macro_rules! mask {
        (2, $bits:ident, $a:ident) => {
            ($bits($a[0]) | $bits($a[1]) << 8) as Mask
        };
        (4, $bits:ident, $a:ident) => {
            ($bits($a[0]) | $bits($a[1]) << 4 | $bits($a[2]) << 8 | $bits($a[3]) << 12) as Mask
        };
    }

    /// An instruction set with registers of fewer than sixteen lanes: everything is done to several.
    macro_rules! several {
    (
        $(#[$doc:meta])* $name:ident, $count:tt registers,
        $i:ty, $f:ty,
        splat [$splat:ident, $splat_f:ident], cast [$as_i:ident, $as_f:ident, $convert:ident],
        integers [$add:ident, $sub:ident, $mul:ident, $min:ident, $max:ident, $and:ident, $or:ident],
        shifts [$shift_left:ident, $shift_right:ident], compare [$gt:ident, $eq:ident],
        floats [$add_f:ident, $sub_f:ident, $mul_f:ident, $div_f:ident, $min_f:ident, $max_f:ident],
        masks [$gt_f:ident, $ge_f:ident, $bits:ident, $blend:ident]
    ) => {
        $(#[$doc])*
                pub(crate) struct $name;

                impl $name {
            /// All bits of the lanes where a mask is set.
            #[inline(always)]
            fn expand(mask: Mask) -> [$f; $count] {
                let (bit, all) = (Self::load(&LANE_BITS), Self::splat(mask as i32));
                // SAFETY: only kernels at this level are given the type, so the machine has the
                // instructions.
                unsafe {
                    let both = each!($count, $and, bit, all);
                    let set = each!($count, $eq, both, bit);
                    each!($count, $as_f, set)
                }
            }
        }

                impl Isa for $name {
            type I = [$i; $count];
            type F = [$f; $count];

            several! { @each $count,
                add(a, b) = $add; sub(a, b) = $sub; mul(a, b) = $mul; min(a, b) = $min; max(a, b) = $max;
                and(a, b) = $and; or(a, b) = $or;
            }
            several! { @each_f $count,
                add_f(a, b) = $add_f; sub_f(a, b) = $sub_f; mul_f(a, b) = $mul_f; div_f(a, b) = $div_f;
                min_f(a, b) = $min_f; max_f(a, b) = $max_f;
            }

            #[inline(always)]
            fn splat(v: i32) -> Self::I {
                // SAFETY: as for `expand`.
                unsafe { [$splat(v); $count] }
            }

            #[inline(always)]
            fn splat_f(v: f32) -> Self::F {
                // SAFETY: as for `expand`.
                unsafe { [$splat_f(v); $count] }
            }

            #[inline(always)]
            fn load(v: &[i32; LANES]) -> Self::I {
                // SAFETY: as many bytes, and all of them mean something.
                unsafe { std::mem::transmute::<[i32; LANES], Self::I>(*v) }
            }

            #[inline(always)]
            fn load_f(v: &[f32; LANES]) -> Self::F {
                // SAFETY: as many bytes, and all of them mean something.
                unsafe { std::mem::transmute::<[f32; LANES], Self::F>(*v) }
            }

            #[inline(always)]
            fn bits(a: Self::F) -> Self::I {
                // SAFETY: as for `expand`.
                unsafe { each!($count, $as_i, a) }
            }

            #[inline(always)]
            fn to_f(a: Self::I) -> Self::F {
                // SAFETY: as for `expand`.
                unsafe { each!($count, $convert, a) }
            }

            #[inline(always)]
            fn gt(a: Self::I, b: Self::I) -> Mask {
                // SAFETY: as for `expand`.
                unsafe {
                    let greater = each!($count, $gt, a, b);
                    let greater = each!($count, $as_f, greater);
                    mask!($count, $bits, greater)
                }
            }

            #[inline(always)]
            fn gt_f(a: Self::F, b: Self::F) -> Mask {
                // SAFETY: as for `expand`.
                unsafe {
                    let greater = each!($count, $gt_f, a, b);
                    mask!($count, $bits, greater)
                }
            }

            #[inline(always)]
            fn ge_f(a: Self::F, b: Self::F) -> Mask {
                // SAFETY: as for `expand`.
                unsafe {
                    let greater = each!($count, $ge_f, a, b);
                    mask!($count, $bits, greater)
                }
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
            fn pick(table: &[i32; LANES], at: Self::I) -> Self::I {
                let (at, mut out) = (Self::store(at), [0; LANES]);
                for i in 0..LANES {
                    out[i] = table[at[i] as usize % LANES];
                }
                Self::load(&out)
            }

            #[inline(always)]
            fn pick_f(table: &[f32; LANES], at: Self::I) -> Self::F {
                let (at, mut out) = (Self::store(at), [0.0; LANES]);
                for i in 0..LANES {
                    out[i] = table[at[i] as usize % LANES];
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
                // SAFETY: as for `expand`.
                unsafe {
                    let by = [_mm_cvtsi32_si128(N as i32); $count];
                    each!($count, $shift_left, a, by)
                }
            }

            #[inline(always)]
            fn shift_right<const N: u32>(a: Self::I) -> Self::I {
                // SAFETY: as for `expand`.
                unsafe {
                    let by = [_mm_cvtsi32_si128(N as i32); $count];
                    each!($count, $shift_right, a, by)
                }
            }

            #[inline(always)]
            fn blend(mask: Mask, a: Self::I, b: Self::I) -> Self::I {
                // SAFETY: as for `expand`.
                unsafe { Self::bits(Self::blend_f(mask, each!($count, $as_f, a), each!($count, $as_f, b))) }
            }

            #[inline(always)]
            fn blend_f(mask: Mask, a: Self::F, b: Self::F) -> Self::F {
                let mask = Self::expand(mask);
                // SAFETY: as for `expand`.
                unsafe { each!($count, $blend, a, b, mask) }
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
    (@each $count:tt, $($name:ident($a:ident, $b:ident) = $f:ident;)*) => {
        $(
            #[inline(always)]
            fn $name($a: Self::I, $b: Self::I) -> Self::I {
                // SAFETY: as for `expand`.
                unsafe { each!($count, $f, $a, $b) }
            }
        )*
    };
    (@each_f $count:tt, $($name:ident($a:ident, $b:ident) = $f:ident;)*) => {
        $(
            #[inline(always)]
            fn $name($a: Self::F, $b: Self::F) -> Self::F {
                // SAFETY: as for `expand`.
                unsafe { each!($count, $f, $a, $b) }
            }
        )*
    };
    (@fold $count:tt, $runs:ident, $fold:ident, $order:tt) => {{
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
        Avx2, 2 registers,
        __m256i, __m256,
        splat [_mm256_set1_epi32, _mm256_set1_ps],
        cast [_mm256_castps_si256, _mm256_castsi256_ps, _mm256_cvtepi32_ps],
        integers [_mm256_add_epi32, _mm256_sub_epi32, _mm256_mullo_epi32, _mm256_min_epi32, _mm256_max_epi32,
            _mm256_and_si256, _mm256_or_si256],
        shifts [_mm256_sll_epi32, _mm256_sra_epi32], compare [_mm256_cmpgt_epi32, _mm256_cmpeq_epi32],
        floats [_mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps, _mm256_min_ps, _mm256_max_ps],
        masks [greater_256, greater_or_equal_256, _mm256_movemask_ps, _mm256_blendv_ps]
    }

    several! {
        /// [`SimdLevel::Sse41`].
        Sse41, 4 registers,
        __m128i, __m128,
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
    pub(crate) struct Avx512;

    impl Isa for Avx512 {
        type I = __m512i;
        type F = __m512;

        single! {
            splat(v: i32) -> __m512i = _mm512_set1_epi32(v);
            load(v: &[i32; LANES]) -> __m512i = _mm512_loadu_si512(v.as_ptr().cast());
            store(v: __m512i) -> [i32; LANES] = std::mem::transmute::<__m512i, [i32; LANES]>(v);
            widen(v: &[u8; LANES]) -> __m512i = _mm512_cvtepu8_epi32(_mm_loadu_si128(v.as_ptr().cast()));
            pick(table: &[i32; LANES], at: __m512i) -> __m512i = _mm512_permutexvar_epi32(at, Self::load(table));
            pick_f(table: &[f32; LANES], at: __m512i) -> __m512 = _mm512_permutexvar_ps(at, Self::load_f(table));
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
                #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
                fn avx2 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $module::$name::<Avx2 $($extra)*>($($arg),*) }
                #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512dq,avx512bw,avx512vl")]
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
    /// See [`batch::answer`].
    answer(scene: Scene<'_>, proxies: &[Proxy], found: &mut [Found]) = batch []
}

dispatch! {
    /// See [`sweep::group_raster`].
    group_raster(scene: Scene<'_>, proxy: &Proxy, rays: &mut Rays) = sweep []
}
dispatch! {
    /// See [`sweep::meets`].
    meets(scene: Scene<'_>, proxy: &Proxy, rays: &[Packet]) -> bool = sweep []
}
dispatch! {
    /// See [`sweep::those_that_meet`].
    those_that_meet(scene: Scene<'_>, proxy: &Proxy, rays: &[Packet], met: &mut Rays) = sweep []
}

/// Asks for the line of memory in which a value begins, because it will be read soon. A hint: it has
/// no effect but on time, and none at all where the machine has no such instruction.
#[inline(always)]
pub(crate) fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has SSE, and the address is that of a value that lives.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(
            std::ptr::from_ref(value).cast(),
        );
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
