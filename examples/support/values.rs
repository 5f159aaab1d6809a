//! What flags take, from text.

use clap::ValueEnum;
use tercet::geom::Viewport;

/// What `--backend` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The GPU where there is one, and else the CPU
    Auto,
    /// The CPU, on all cores; needs no GPU
    Software,
    /// wgpu, on a CPU that plays the GPU's part if need be; WGPU_BACKEND=vulkan|gl|dx12|metal
    /// chooses
    Wgpu,
    /// wgpu, and nothing is asked: the GPU culls by itself, nothing comes back. The policy says how it
    /// tests: hi-z, roc or hroc; auto takes hi-z. Meshes are drawn with all their triangles
    GpuDriven,
}

/// `KEY=VALUE`.
pub(super) fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write it as KEY=VALUE, for instance o_split=12".to_owned()),
    }
}

/// `WxH`, in pixels.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=Viewport::MAX_SIDE).contains(side));
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| format!("write it as 1280x720, each side 1 to {}", Viewport::MAX_SIDE))
}

/// How much of a world.
pub(super) fn scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|&scale: &f32| scale > 0.0 && scale <= 16.0);
    scale.ok_or_else(|| "it takes a number above 0 and up to 16".to_owned())
}
