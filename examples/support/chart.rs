//! Charts over the frames of a run.

use std::ops::Range;

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::axis::{nice_top, plain};
use super::canvas::{INK, Sheet, px, text};
use super::report::percentile;

/// Curves over frames.
pub type Chart<'a, Y> = ChartContext<'a, BitMapBackend<'a>, Cartesian2d<RangedCoordf64, Y>>;

/// A figure of each frame.
pub struct Curve {
    /// Frame by frame.
    pub values: Vec<f64>,
    /// Its colour.
    pub color: RGBColor,
    /// Of the line, pixels.
    pub width: i32,
}

/// Draws curves, the later ones over the earlier; outside a range they run along its border.
pub fn draw<Y>(chart: &mut Chart<'_, Y>, range: Range<f64>, curves: &[Curve]) -> anyhow::Result<()>
where
    Y: Ranged<ValueType = f64>,
{
    for Curve { values, color, width } in curves {
        let points = values.iter().enumerate().map(|(i, y)| (i as f64, y.clamp(range.start, range.end)));
        chart.draw_series(LineSeries::new(points, color.stroke_width(px(*width) as u32)))?;
    }
    Ok(())
}

/// Where an axis for curves ends. A single slow frame (the first one builds the tree) must not
/// flatten all the others.
pub fn top(curves: &[Curve]) -> f64 {
    let high = |curve: &Curve| if curve.values.is_empty() { 0.0 } else { percentile(&curve.values, 97.0) };
    nice_top(1.1 * curves.iter().map(high).fold(0.0, f64::max))
}

/// The same for both ends of a logarithmic axis. Zeros are left out: they run along its border.
pub fn log_range(curves: &[Curve]) -> Range<f64> {
    let values: Vec<f64> = curves.iter().flat_map(|c| &c.values).copied().filter(|&y| y > 0.0).collect();
    let low = if values.is_empty() { 1.0 } else { percentile(&values, 1.0) };
    let bottom = 10f64.powf(low.log10().floor());
    bottom..top(curves).max(10.0 * bottom)
}

/// Axes on which curves over `frames` frames are drawn.
pub fn axes<'a>(
    area: &Sheet<'a>,
    frames: usize,
    range: Range<f64>,
    unit: &str,
) -> anyhow::Result<Chart<'a, RangedCoordf64>> {
    labelled_axes(area, frames, range, unit, decimals)
}

/// The same with a logarithmic range, from a number above 0.
pub fn log_axes<'a>(
    area: &Sheet<'a>,
    frames: usize,
    range: Range<f64>,
    unit: &str,
) -> anyhow::Result<Chart<'a, LogCoord<f64>>> {
    // All nine labels of a decade would lie over each other.
    let sparse = |y: &f64| {
        let digit = (y / 10f64.powf((y.log10() + 1e-9).floor())).round();
        if [1.0, 2.0, 5.0].contains(&digit) { decimals(y) } else { String::new() }
    };
    labelled_axes(area, frames, range.log_scale(), unit, sparse)
}

fn labelled_axes<'a, Y>(
    area: &Sheet<'a>,
    frames: usize,
    range: impl AsRangedCoord<CoordDescType = Y, Value = f64>,
    unit: &str,
    label: impl Fn(&f64) -> String,
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
        .y_label_formatter(&label)
        .draw()?;
    Ok(chart)
}

/// Titles a small chart among others; returns what is left below.
pub fn panel<'a>(area: &Sheet<'a>, title: &str) -> anyhow::Result<Sheet<'a>> {
    area.draw_text(title, &text(16, INK), (px(26), px(4)))?;
    Ok(area.split_vertically(px(26)).1)
}

/// As many decimals as there are.
pub fn decimals(y: &f64) -> String {
    format!("{}", (y * 1e6).round() / 1e6)
}

/// The number of a frame; ticks between two frames have none.
fn whole(x: &f64) -> String {
    if (x - x.round()).abs() < 1e-6 { format!("{x:.0}") } else { String::new() }
}
