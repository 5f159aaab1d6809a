//! What culling and a plain picture need of a material: a colour, and whether one sees through.

use gltf::json::Index;
use gltf::json::material::{AlphaMode, Material};
use gltf::json::validation::Checked;

use super::file::{File, get};

/// How a primitive's surface looks.
pub(super) struct Look {
    /// Red, green and blue, as sRGB shows them.
    pub(super) color: [u8; 3],
    /// Blended, cut out by a mask, or made of glass: what lies behind may show.
    pub(super) see_through: bool,
}

/// The look of a material; a primitive without one is white, and hides what is behind it.
pub(super) fn look(file: &File, material: Option<Index<Material>>) -> Result<Look, String> {
    let Some(index) = material else { return Ok(Look { color: [255; 3], see_through: false }) };
    let material = get(&file.root.materials, index, "material")?;
    let Checked::Valid(alpha) = material.alpha_mode else {
        return Err(format!("the alphaMode of material {} is none that glTF knows", index.value()));
    };
    let extensions = material.extensions.as_ref();
    let older = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref()).map(|p| p.diffuse_factor.0);
    let [red, green, blue, _] = older.unwrap_or(material.pbr_metallic_roughness.base_color_factor.0);
    let glass =
        extensions.and_then(|e| e.transmission.as_ref()).is_some_and(|t| t.transmission_factor.0 > 0.0);
    Ok(Look { color: [red, green, blue].map(srgb), see_through: glass || alpha != AlphaMode::Opaque })
}

/// A linear intensity in sRGB's encoding (IEC 61966-2-1).
fn srgb(linear: f32) -> u8 {
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    // The cast saturates: below 0 is black, above 1 is white, and so is NaN black.
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::srgb;

    #[test]
    fn intensities_are_encoded_and_clamped() {
        assert_eq!([0.0, 0.5, 1.0, 0.002].map(srgb), [0, 188, 255, 7]);
        assert_eq!([-1.0, 7.0, f32::NAN].map(srgb), [0, 255, 0]);
    }
}
