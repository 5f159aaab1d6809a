//! A sheet of paper for the plots: text in our own font, smooth lines, PNG out.

use std::path::Path;
use std::sync::Once;

use anyhow::{Context, anyhow};
use image::{RgbImage, imageops};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

/// What plots draw on.
pub type Sheet<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// How many times larger a plot is drawn than it is saved. The bitmap backend does not smooth
/// the edges of thick lines and polygons; shrinking the sheet does.
pub const SCALE: i32 = 2;

/// Text and axes.
pub const INK: RGBColor = RGBColor(38, 44, 54);
/// Subtitles, ticks and notes.
pub const FAINT: RGBColor = RGBColor(104, 114, 128);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(226, 230, 235);

const MARGIN: i32 = 28;

/// Pixels of the saved picture as pixels of the sheet.
pub const fn px(length: i32) -> i32 {
    length * SCALE
}

/// A font style: `size` in pixels of the saved picture.
pub fn text(size: i32, color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", px(size)).into_font().color(&color)
}

/// Draws a picture of `width` × `height` pixels with `draw` and saves it as a PNG file.
pub fn save(
    path: &Path,
    (width, height): (u32, u32),
    draw: impl FnOnce(&Sheet<'_>) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    register_fonts();
    let (w, h) = (width * SCALE as u32, height * SCALE as u32);
    let mut pixels = vec![255; (w * h * 3) as usize];
    {
        let sheet = BitMapBackend::with_buffer(&mut pixels, (w, h)).into_drawing_area();
        sheet.fill(&WHITE)?;
        draw(&sheet)?;
        sheet.present()?;
    }
    let large = RgbImage::from_raw(w, h, pixels).ok_or_else(|| anyhow!("the sheet has the wrong size"))?;
    imageops::resize(&large, width, height, imageops::FilterType::Triangle)
        .save(path)
        .with_context(|| format!("cannot write {}", path.display()))
}

/// A swatch of the legend.
pub struct Key {
    /// The colour that it explains.
    pub color: RGBColor,
    /// In plain words.
    pub label: String,
}

impl Key {
    /// A colour and its meaning.
    pub fn new(color: RGBColor, label: impl Into<String>) -> Self {
        Self { color, label: label.into() }
    }
}

/// Writes title, subtitle and a legend over the sheet; returns what is left below.
pub fn heading<'a>(
    sheet: &Sheet<'a>,
    title: &str,
    subtitle: &str,
    legend: &[Key],
) -> anyhow::Result<Sheet<'a>> {
    let bold = ("sans-serif", px(22), FontStyle::Bold).into_font().color(&INK);
    sheet.draw_text(title, &bold, (px(MARGIN), px(20)))?;
    sheet.draw_text(subtitle, &text(14, FAINT), (px(MARGIN), px(49)))?;
    let (width, _) = sheet.dim_in_pixel();
    let (mut x, mut y) = (px(MARGIN), px(78));
    for key in legend {
        let style = text(14, INK);
        let (w, _) = sheet.estimate_text_size(&key.label, &style)?;
        if x + px(20) + w as i32 > width as i32 - px(MARGIN) {
            (x, y) = (px(MARGIN), y + px(22));
        }
        let swatch = [(x, y - px(1)), (x + px(13), y + px(12))];
        sheet.draw(&Rectangle::new(swatch, key.color.filled()))?;
        sheet.draw_text(&key.label, &style, (x + px(19), y))?;
        x += px(19 + 22) + w as i32;
    }
    Ok(sheet.split_vertically(y + px(28)).1)
}

fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        for (style, bytes) in [
            (FontStyle::Normal, include_bytes!("font/Inter-Regular.ttf").as_slice()),
            (FontStyle::Bold, include_bytes!("font/Inter-SemiBold.ttf").as_slice()),
        ] {
            let parsed = register_font("sans-serif", style, bytes);
            assert!(parsed.is_ok(), "the font files beside this module are whole");
        }
    });
}
