//! A level of the pyramid of farthest depths (Hi-Z), over the picture: near is bright.

use eframe::egui::{
    Color32, ColorImage, Context, Rect, TextureHandle, TextureOptions, Ui, load::SizedTexture,
};

use crate::stage::Level;

/// Shows a level.
#[derive(Default)]
pub struct PyramidView {
    texture: Option<TextureHandle>,
}

impl PyramidView {
    /// Paints a level, of this number from 1 on, over the picture of a viewport so many pixels wide and high.
    pub fn paint(&mut self, ui: &Ui, place: Rect, level: &Level, number: u32, pixels: [u32; 2]) {
        let texture = self.upload(ui.ctx(), image(level));
        // The last texels of an odd side reach beyond the viewport.
        let side = |texels: u32, pixels: u32| ((u64::from(texels) << number) as f32) / pixels as f32;
        let size =
            place.size() * eframe::egui::vec2(side(level.width, pixels[0]), side(level.height, pixels[1]));
        let painter = ui.painter().with_clip_rect(place);
        let uv = Rect::from_min_max((0.0, 0.0).into(), (1.0, 1.0).into());
        painter.image(texture.id, Rect::from_min_size(place.min, size), uv, Color32::WHITE);
    }

    fn upload(&mut self, ctx: &Context, image: ColorImage) -> SizedTexture {
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::NEAREST),
            None => self.texture = Some(ctx.load_texture("pyramid", image, TextureOptions::NEAREST)),
        }
        let texture = self.texture.as_ref().expect("it was made");
        SizedTexture::from_handle(texture)
    }
}

/// Grey by the logarithm of nearness, which is one over the distance: each doubling is as much darker. What
/// nothing was drawn on is black.
fn image(level: &Level) -> ColorImage {
    let drawn = || level.nearness.iter().copied().filter(|&nearness| nearness > 0.0);
    let (far, near) = (drawn().fold(f32::INFINITY, f32::min), drawn().fold(0.0, f32::max));
    let span = (near / far).ln().max(f32::MIN_POSITIVE);
    let grey = |&nearness: &f32| match nearness > 0.0 {
        true => Color32::from_gray(40 + (215.0 * (nearness / far).ln() / span) as u8),
        false => Color32::BLACK,
    };
    ColorImage::new([level.width as usize, level.height as usize], level.nearness.iter().map(grey).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_bright_and_nothing_is_black() {
        let level = Level { width: 2, height: 2, nearness: vec![0.0, 1e-4, 1e-2, 1.0] };
        let greys: Vec<u8> = image(&level).pixels.iter().map(Color32::r).collect();
        assert_eq!((greys[0], greys[1], greys[3]), (0, 40, 255));
        assert!((146..=148).contains(&greys[2]), "{greys:?}");
    }
}
