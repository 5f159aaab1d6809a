//! Colours of objects, and the formats that they are drawn in.

use wgpu::{Device, TextureFormat, TextureFormatFeatureFlags, TextureUsages};

use crate::Error;

/// A colour with another laid over it.
pub(super) fn tinted(color: [u8; 3], [r, g, b, alpha]: [u8; 4]) -> [u8; 3] {
    let alpha = u32::from(alpha);
    let mix = |own: u8, over: u8| (u32::from(own) * (255 - alpha) + u32::from(over) * alpha + 127) / 255;
    [mix(color[0], r) as u8, mix(color[1], g) as u8, mix(color[2], b) as u8]
}

/// The linear fraction of 65535 that an sRGB byte stands for.
pub(super) fn linear(byte: usize) -> u16 {
    let c = byte as f64 / 255.0;
    let linear = if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    (linear * 65535.0).round() as u16
}

/// Whether a format takes linear colours: encodes them itself, or has the range for them.
pub(super) fn takes_linear(format: TextureFormat) -> bool {
    use TextureFormat::{Rg11b10Ufloat, Rgba16Float, Rgba32Float};
    format.is_srgb() || matches!(format, Rg11b10Ufloat | Rgba16Float | Rgba32Float)
}

/// Refuses what cannot be a colour target.
pub(super) fn check(format: TextureFormat, device: &Device) -> Result<(), Error> {
    let unusable = |why| Err(Error::Target { why: format!("{format:?} {why}: use Rgba8UnormSrgb") });
    if !format.has_color_aspect() || format.components() < 3 {
        return unusable("is no colour of at least three channels");
    }
    let features = format.guaranteed_format_features(device.features());
    if !features.allowed_usages.contains(TextureUsages::RENDER_ATTACHMENT)
        || !features.flags.contains(TextureFormatFeatureFlags::BLENDABLE)
    {
        return unusable("cannot be drawn to and blended on this device");
    }
    Ok(())
}
