//! The kernels compiled for the instruction sets that the machine may have.
//!
//! The kernels are ordinary code over fixed arrays, inlined here into functions that may use wider
//! registers. The arithmetic is the same, operation by operation (Rust never fuses or reorders
//! floats), so the results are the same bits at every level. Where the compiler does not find the
//! best instruction by itself, [`Isa`] names it. This is the only file with `unsafe`.
#![expect(unsafe_code, reason = "calls into functions compiled for instruction sets found at run time")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64 as x86;
use std::sync::OnceLock;

use glam::{Mat4, Vec3};

use super::bin::{self, Chunk, Wave};
use super::count::{self, Scene};
use super::hi_z::{self, TileRow};
use super::raster::{self, LANES, Sink};
use super::vertex::{self, Screen, Vertex};
use crate::geom::Proxy;

/// An instruction set for the kernels. Results are the same at every level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// What the target always has.
    Scalar,
    /// AVX2: 8 lanes.
    Avx2,
    /// AVX-512 F, DQ, BW and VL: 16 lanes.
    Avx512,
}

impl SimdLevel {
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
    } else {
        SimdLevel::Scalar
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> SimdLevel {
    SimdLevel::Scalar
}

/// What kernels do differently at each level, with the same result.
pub(crate) trait Isa {
    /// Sets each lane of `kept` to that of `values` if it is greater; what is equal or not a number
    /// leaves it.
    fn keep_greatest(kept: &mut [f32; LANES], values: &[f32; LANES]);

    /// A bit for each lane with a negative value.
    fn negative(values: &[i32; LANES]) -> u32;
}

/// [`SimdLevel::Scalar`]; the others must agree with it.
pub(crate) struct Scalar;

impl Isa for Scalar {
    #[inline(always)]
    fn keep_greatest(kept: &mut [f32; LANES], values: &[f32; LANES]) {
        for (kept, &value) in kept.iter_mut().zip(values) {
            *kept = if value > *kept { value } else { *kept };
        }
    }

    #[inline(always)]
    fn negative(values: &[i32; LANES]) -> u32 {
        let mut bits = 0;
        for (i, &value) in values.iter().enumerate() {
            bits |= (value >> 31) & (1 << i);
        }
        bits as u32
    }
}

// Left to itself, the compiler stores the greater lanes under a mask. The next triangle's load
// cannot be served from such a store before it has reached the cache: half of all time was
// spent there. Hence whole stores.

#[cfg(target_arch = "x86_64")]
struct Avx2;

#[cfg(target_arch = "x86_64")]
impl Isa for Avx2 {
    #[inline(always)]
    fn keep_greatest(kept: &mut [f32; LANES], values: &[f32; LANES]) {
        for (kept, values) in kept.as_chunks_mut::<8>().0.iter_mut().zip(values.as_chunks::<8>().0) {
            // SAFETY: only kernels at this level are given the type, so the machine has AVX2. The
            // pointers are to eight floats each, of any alignment.
            unsafe {
                let greatest = x86::_mm256_max_ps(
                    x86::_mm256_loadu_ps(values.as_ptr()),
                    x86::_mm256_loadu_ps(kept.as_ptr()),
                );
                x86::_mm256_storeu_ps(kept.as_mut_ptr(), greatest);
            }
        }
    }

    #[inline(always)]
    fn negative(values: &[i32; LANES]) -> u32 {
        let (halves, _) = values.as_chunks::<8>();
        let bits = |half: &[i32; 8]| {
            // SAFETY: only kernels at this level are given the type, so the machine has AVX2. The
            // pointer is to eight integers, of any alignment.
            unsafe { x86::_mm256_movemask_ps(x86::_mm256_loadu_ps(half.as_ptr().cast())) as u32 }
        };
        bits(&halves[0]) | bits(&halves[1]) << 8
    }
}

#[cfg(target_arch = "x86_64")]
struct Avx512;

#[cfg(target_arch = "x86_64")]
impl Isa for Avx512 {
    #[inline(always)]
    fn keep_greatest(kept: &mut [f32; LANES], values: &[f32; LANES]) {
        // SAFETY: only kernels at this level are given the type, so the machine has AVX-512 F. The
        // pointers are to sixteen floats each, of any alignment.
        unsafe {
            let greatest = x86::_mm512_max_ps(
                x86::_mm512_loadu_ps(values.as_ptr()),
                x86::_mm512_loadu_ps(kept.as_ptr()),
            );
            x86::_mm512_storeu_ps(kept.as_mut_ptr(), greatest);
        }
    }

    #[inline(always)]
    fn negative(values: &[i32; LANES]) -> u32 {
        // SAFETY: only kernels at this level are given the type, so the machine has AVX-512 F and
        // DQ. The pointer is to sixteen integers, of any alignment.
        unsafe { u32::from(x86::_mm512_movepi32_mask(x86::_mm512_loadu_si512(values.as_ptr().cast()))) }
    }
}

/// Defines a function that runs a kernel at a level; it is given as its versions for each.
macro_rules! dispatch {
    ($(#[$doc:meta])* $name:ident $([$($generics:tt)*] [$($names:tt)*])? ($($arg:ident: $type:ty),*) $(-> $result:ty)? = $scalar:expr, $avx2:expr, $avx512:expr) => {
        $(#[$doc])*
        pub(crate) fn $name $(<$($generics)*>)? (level: SimdLevel, $($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $avx2($($arg),*) }
                #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
                fn avx512 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $avx512($($arg),*) }
                let best = SimdLevel::detect();
                if level == SimdLevel::Avx512 && best >= SimdLevel::Avx512 {
                    // SAFETY: the features were found on this machine.
                    return unsafe { avx512 $(::<$($names)*>)? ($($arg),*) };
                }
                if level >= SimdLevel::Avx2 && best >= SimdLevel::Avx2 {
                    // SAFETY: the feature was found on this machine.
                    return unsafe { avx2 $(::<$($names)*>)? ($($arg),*) };
                }
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = level;
            $scalar($($arg),*)
        }
    };
}

dispatch! {
    /// See [`vertex::transform`].
    transform(screen: &Screen, m: &Mat4, positions: &[Vec3], out: &mut [Vertex]) = vertex::transform, vertex::transform, vertex::transform
}
dispatch! {
    /// See [`bin::bin`].
    bin [const WITH_IDS: bool] [WITH_IDS] (wave: &Wave<'_>, index: usize, chunk: &mut Chunk) = bin::bin::<Scalar, WITH_IDS>, bin::bin::<Avx2, WITH_IDS>, bin::bin::<Avx512, WITH_IDS>
}
dispatch! {
    /// See [`raster::band`].
    band [S: Sink] [S] (chunks: &[Chunk], band: usize, sink: &mut S) = raster::band::<Scalar, S>, raster::band::<Avx2, S>, raster::band::<Avx512, S>
}
dispatch! {
    /// See [`hi_z::fold_tiles`].
    fold_tiles(row: TileRow<'_>) = hi_z::fold_tiles, hi_z::fold_tiles, hi_z::fold_tiles
}
dispatch! {
    /// See [`count::any`].
    any(scene: Scene<'_>, proxy: &Proxy) -> bool = count::any, count::any, count::any
}
dispatch! {
    /// See [`count::dual`].
    dual(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) = count::dual, count::dual, count::dual
}

/// Asks for the line of memory in which a value begins, because it will be read soon. A hint: it has
/// no effect but on time, and none at all where the machine has no such instruction.
#[inline(always)]
pub(crate) fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has SSE, and the address is that of a value that lives.
    unsafe {
        x86::_mm_prefetch::<{ x86::_MM_HINT_T0 }>(std::ptr::from_ref(value).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}
