//! The kernels compiled for the instruction sets that the machine may have.
//!
//! The kernels are ordinary code over fixed arrays, inlined here into functions that may use wider
//! registers. The arithmetic is the same, operation by operation (Rust never fuses or reorders
//! floats), so the results are the same bits at every level. This is the only file with `unsafe`.
#![expect(unsafe_code, reason = "calls into functions compiled for instruction sets found at run time")]

use std::sync::OnceLock;

use glam::{Mat4, Vec3};

use super::bin::{self, Chunk, Wave};
use super::count::{self, Scene};
use super::hi_z::{self, TileRow};
use super::raster::{self, Sink};
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

/// Defines a function that runs a kernel at a level.
macro_rules! dispatch {
    ($(#[$doc:meta])* $name:ident $([$($generics:tt)*] [$($names:tt)*])? ($($arg:ident: $type:ty),*) $(-> $result:ty)? = $kernel:expr) => {
        $(#[$doc])*
        pub(crate) fn $name $(<$($generics)*>)? (level: SimdLevel, $($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $kernel($($arg),*) }
                #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
                fn avx512 $(<$($generics)*>)? ($($arg: $type),*) $(-> $result)? { $kernel($($arg),*) }
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
            $kernel($($arg),*)
        }
    };
}

dispatch! {
    /// See [`vertex::transform`].
    transform(screen: &Screen, m: &Mat4, positions: &[Vec3], out: &mut [Vertex]) = vertex::transform
}
dispatch! {
    /// See [`bin::bin`].
    bin [const WITH_IDS: bool] [WITH_IDS] (wave: &Wave<'_>, index: usize, chunk: &mut Chunk) = bin::bin::<WITH_IDS>
}
dispatch! {
    /// See [`raster::band`].
    band [S: Sink] [S] (chunks: &[Chunk], band: usize, sink: &mut S) = raster::band
}
dispatch! {
    /// See [`hi_z::fold_tiles`].
    fold_tiles(row: TileRow<'_>) = hi_z::fold_tiles
}
dispatch! {
    /// See [`count::any`].
    any(scene: Scene<'_>, proxy: &Proxy) -> bool = count::any
}
dispatch! {
    /// See [`count::dual`].
    dual(scene: Scene<'_>, proxy: &Proxy) -> (u32, u32) = count::dual
}
