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
                #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
                fn avx512 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $module::$name::<Avx512 $($extra)*>($($arg),*) }
                let best = SimdLevel::detect();
                if level == SimdLevel::Avx512 && best >= SimdLevel::Avx512 {
                    // SAFETY: the features were found on this machine.
                    return unsafe { avx512 $(::<$($names)*>)? ($($arg),*) };
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
