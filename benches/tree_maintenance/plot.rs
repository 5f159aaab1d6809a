//! The plots: nanoseconds an object that moves, over the number of objects, and by manner.

use std::path::Path;

use plotters::prelude::*;

use crate::axis::{nice_top, plain};
use crate::canvas::{self, FAINT, Key, px};
use crate::measure::Row;

const COLORS: [(f64, RGBColor); 3] =
    [(0.2, RGBColor(66, 133, 190)), (0.5, RGBColor(214, 120, 50)), (1.0, RGBColor(90, 150, 80))];

/// Draws a curve for each share of movers, and what writing alone costs.
pub fn by_number(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let each = |row: &Row, seconds: f64| seconds * 1e9 / (row.case.count as f64 * row.case.moving);
    let moving = || rows.iter().filter(|row| row.case.moving > 0.0);
    let top = nice_top(moving().map(|row| each(row, row.update)).fold(0.0, f64::max));
    let last = rows.iter().map(|row| row.case.count).max().unwrap_or(10_000) as f64;
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
            let rows = || moving().filter(move |row| row.case.moving == share);
            let update = rows().map(|row| (row.case.count as f64, each(row, row.update)));
            let write = rows().map(|row| (row.case.count as f64, each(row, row.write)));
            chart.draw_series(LineSeries::new(update, color.stroke_width(px(2) as u32)))?;
            chart.draw_series(LineSeries::new(write, FAINT.stroke_width(px(1) as u32)))?;
        }
        Ok(())
    })
}

/// Draws a bar for each manner of moving.
pub fn by_manner(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let each = |row: &Row, seconds: f64| seconds * 1e9 / (row.case.count as f64 * row.case.moving);
    let top = nice_top(rows.iter().map(|row| each(row, row.update)).fold(0.0, f64::max));
    let bars = COLORS[1].1;
    let legend =
        [Key::new(bars, "the tree".to_owned()), Key::new(FAINT, "merely writing the boxes".to_owned())];
    canvas::save(path, (900, 520), |sheet| {
        let subtitle = "Half of the boxes move; placement, refit and adaptation included";
        let area = canvas::heading(sheet, "What an object that moves costs the tree", subtitle, &legend)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(px(20))
            .x_label_area_size(px(44))
            .y_label_area_size(px(66))
            .build_cartesian_2d(0.0..rows.len() as f64, 0.0..top)?;
        let name = |x: &f64| {
            let middle = x.fract() == 0.5;
            rows.get(*x as usize).filter(|_| middle).map_or(String::new(), |row| row.case.name.clone())
        };
        plain(&mut chart.configure_mesh())
            .disable_x_mesh()
            .x_labels(2 * rows.len() + 1)
            .x_label_formatter(&name)
            .y_desc("ns an object that moves")
            .draw()?;
        for (i, row) in rows.iter().enumerate() {
            for (seconds, width, color) in [(row.update, 0.3, bars), (row.write, 0.38, FAINT)] {
                let x = i as f64 + 0.5;
                let corners = [(x - width, 0.0), (x + width, each(row, seconds))];
                chart.draw_series([Rectangle::new(corners, color.filled())])?;
            }
        }
        Ok(())
    })
}
