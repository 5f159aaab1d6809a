//! The plot: nanoseconds an object that moves, over the number of objects.

use std::path::Path;

use plotters::prelude::*;

use crate::canvas::{self, FAINT, Key, px};
use crate::chart::{nice_top, plain};
use crate::measure::Row;

const COLORS: [(f64, RGBColor); 3] =
    [(0.2, RGBColor(66, 133, 190)), (0.5, RGBColor(214, 120, 50)), (1.0, RGBColor(90, 150, 80))];

/// Draws a curve for each share of movers, and what writing alone costs.
pub fn save(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let each = |row: &Row, seconds: f64| seconds * 1e9 / (row.count as f64 * row.moving);
    let moving = || rows.iter().filter(|row| row.moving > 0.0);
    let top = nice_top(moving().map(|row| each(row, row.update)).fold(0.0, f64::max));
    let last = rows.iter().map(|row| row.count).max().unwrap_or(10_000) as f64;
    let shares = COLORS.map(|(share, color)| Key::new(color, format!("{:.0} % move", 100.0 * share)));
    let legend: Vec<Key> = shares.into_iter().chain([Key::new(FAINT, "merely writing the boxes")]).collect();
    canvas::save(path, (900, 520), |sheet| {
        let subtitle = "Boxes at constant density, steps of 0.05 m; placement, refit and adaptation included";
        let area = canvas::heading(sheet, "What an object that moves costs the tree", subtitle, &legend)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(px(20))
            .x_label_area_size(px(44))
            .y_label_area_size(px(66))
            .build_cartesian_2d((2_000.0..last).log_scale(), 0.0..top)?;
        plain(&mut chart.configure_mesh()).x_desc("objects").y_desc("ns an object that moves").draw()?;
        for (share, color) in COLORS {
            let rows = || moving().filter(move |row| row.moving == share);
            let update = rows().map(|row| (row.count as f64, each(row, row.update)));
            let write = rows().map(|row| (row.count as f64, each(row, row.write)));
            chart.draw_series(LineSeries::new(update, color.stroke_width(px(2) as u32)))?;
            chart.draw_series(LineSeries::new(write, FAINT.stroke_width(px(1) as u32)))?;
        }
        Ok(())
    })
}
