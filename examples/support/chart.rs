//! Charts over the frames of a run.

use plotters::chart::MeshStyle;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{FAINT, GRID, INK, Sheet, px, text};

/// Curves over frames.
pub type Chart<'a, Y> = ChartContext<'a, BitMapBackend<'a>, Cartesian2d<RangedCoordf64, Y>>;

/// Axes on which curves over `frames` frames are drawn.
pub fn axes<'a, Y>(
    area: &Sheet<'a>,
    frames: usize,
    range: impl AsRangedCoord<CoordDescType = Y, Value = f64>,
    unit: &str,
) -> anyhow::Result<Chart<'a, Y>>
where
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let last = frames.saturating_sub(1).max(1) as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(px(20))
        .margin_top(px(6))
        .x_label_area_size(px(44))
        .y_label_area_size(px(66))
        .build_cartesian_2d(0.0..last, range)?;
    plain(&mut chart.configure_mesh())
        .disable_x_mesh()
        .x_desc("frame")
        .y_desc(unit)
        .x_label_formatter(&whole)
        .y_label_formatter(&|y| format!("{}", (y * 1e6).round() / 1e6))
        .draw()?;
    Ok(chart)
}

/// The house's style of axes and grid.
pub fn plain<'a, 'b, 'm, X, Y>(
    mesh: &'m mut MeshStyle<'a, 'b, X, Y, BitMapBackend<'a>>,
) -> &'m mut MeshStyle<'a, 'b, X, Y, BitMapBackend<'a>>
where
    X: Ranged,
    Y: Ranged,
{
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(px(1) as u32))
        .axis_style(FAINT.stroke_width(px(1) as u32))
        .label_style(text(13, FAINT))
        .axis_desc_style(text(14, INK))
}

/// A round number to end an axis at: the least of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten
/// that is not below `x`.
pub fn nice_top(x: f64) -> f64 {
    let x = x.max(1e-3);
    let power = 10f64.powf(x.log10().floor());
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|&top| top >= x)
        .unwrap_or(10.0 * power)
}

/// Titles a small chart among others; returns what is left below.
pub fn panel<'a>(area: &Sheet<'a>, title: &str) -> anyhow::Result<Sheet<'a>> {
    area.draw_text(title, &text(16, INK), (px(26), px(4)))?;
    Ok(area.split_vertically(px(26)).1)
}

/// The number of a frame; ticks between two frames have none.
fn whole(x: &f64) -> String {
    if (x - x.round()).abs() < 1e-6 { format!("{x:.0}") } else { String::new() }
}
