//! The plot: ratios of every tree, side by side, on a scale of powers of ten.

use std::path::Path;

use plotters::prelude::*;

use crate::axis::plain;
use crate::canvas::{self, FAINT, Key, px, text};
use crate::{NAMES, Row};

const COLORS: [RGBColor; 5] = [
    RGBColor(66, 133, 190),
    RGBColor(214, 120, 50),
    RGBColor(90, 150, 80),
    RGBColor(150, 110, 170),
    RGBColor(150, 140, 120),
];

/// Draws a group of bars for each number of boxes and each ratio, a bar a tree.
pub fn ratios(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let trees = COLORS.len();
    let groups: Vec<(String, Vec<f64>)> = rows
        .chunks(trees)
        .flat_map(|rows| {
            (0..4).map(|i| {
                let name = format!("{}, {} boxes", NAMES[2 + i], rows[0].count);
                (name, rows.iter().map(|row| row.ratios()[i]).collect())
            })
        })
        .collect();
    let legend: Vec<Key> = rows
        .iter()
        .take(trees)
        .zip(COLORS)
        .map(|(row, color)| Key::new(color, row.name.to_owned()))
        .collect();
    let (low, high) = (0.05, 5000.0);
    canvas::save(path, (100 + 140 * groups.len() as u32, 560), |sheet| {
        let subtitle =
            "Half of the boxes move; over writing them, and over a scan of all boxes; less is better";
        let area = canvas::heading(sheet, "Trees beside each other", subtitle, &legend)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(px(20))
            .x_label_area_size(px(44))
            .y_label_area_size(px(66))
            .build_cartesian_2d(0.0..groups.len() as f64, (low..high).log_scale())?;
        let name = |x: &f64| {
            let middle = x.fract() == 0.5;
            groups.get(*x as usize).filter(|_| middle).map_or(String::new(), |group| group.0.clone())
        };
        plain(&mut chart.configure_mesh())
            .label_style(text(10, FAINT))
            .disable_x_mesh()
            .x_labels(2 * groups.len() + 1)
            .x_label_formatter(&name)
            .y_desc("times as long")
            .draw()?;
        let width = 0.8 / trees as f64;
        for (g, (_, ratios)) in groups.iter().enumerate() {
            for (i, (&ratio, color)) in ratios.iter().zip(COLORS).enumerate() {
                let x = g as f64 + 0.1 + i as f64 * width;
                chart.draw_series([Rectangle::new([(x, low), (x + width, ratio)], color.filled())])?;
            }
        }
        Ok(())
    })
}
