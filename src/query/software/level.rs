//! Which instructions the machine has.

use std::sync::OnceLock;

/// An instruction set for the kernels. Results are the same at every level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// What the target always has: plain code over arrays, which the compiler turns into SSE2 on
    /// x86-64 and into NEON on AArch64.
    Portable,
    /// SSE4.1: 4 lanes.
    Sse41,
    /// AVX2, and the instructions that count and move bits which came with it: 8 lanes.
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
    // Each level has all that those below it need.
    let sse41 = is_x86_feature_detected!("sse4.1");
    let avx2 = sse41
        && is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt");
    let avx512 = avx2
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512vl");
    match (avx512, avx2, sse41) {
        (true, ..) => SimdLevel::Avx512,
        (_, true, _) => SimdLevel::Avx2,
        (.., true) => SimdLevel::Sse41,
        _ => SimdLevel::Portable,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> SimdLevel {
    SimdLevel::Portable
}
