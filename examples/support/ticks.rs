//! Charts over a few named places that stand side by side.

use plotters::prelude::*;

use super::axis::{nice_top, plain};
use super::canvas::{Sheet, px};

/// A value a place, the places in order.
pub struct Line {
    /// Its colour.
    pub color: RGBColor,
    /// From the first place on.
    pub values: Vec<f64>,
}

/// What the axes say.
pub struct Axes<'a> {
    /// Below.
    pub x: &'a str,
    /// At the side.
    pub y: &'a str,
    /// The places' names.
    pub ticks: Vec<String>,
    /// How a value is written.
    pub label: fn(&f64) -> String,
    /// The upper end reaches at least so high.
    pub least_top: f64,
}

impl Axes<'_> {
    /// Draws lines from zero on, with a dot a value.
    pub fn draw(&self, area: &Sheet<'_>, lines: &[Line]) -> anyhow::Result<()> {
        let highest = lines.iter().flat_map(|line| &line.values).fold(self.least_top, |top, &y| top.max(y));
        let right = self.ticks.len() as f64 - 0.5;
        let mut chart = ChartBuilder::on(area)
            .margin(px(20))
            .margin_top(px(6))
            .x_label_area_size(px(44))
            .y_label_area_size(px(66))
            .build_cartesian_2d(-0.5..right, 0.0..nice_top(1.05 * highest))?;
        let tick = |x: &f64| {
            let at = (*x >= 0.0 && x.fract() == 0.0).then(|| self.ticks.get(*x as usize)).flatten();
            at.cloned().unwrap_or_default()
        };
        plain(&mut chart.configure_mesh())
            .disable_x_mesh()
            .x_labels(self.ticks.len() + 1)
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&tick)
            .y_label_formatter(&self.label)
            .draw()?;
        for Line { color, values } in lines {
            let points = || values.iter().enumerate().map(|(x, &y)| (x as f64, y));
            chart.draw_series(LineSeries::new(points(), color.stroke_width(px(2) as u32)))?;
            chart.draw_series(points().map(|point| Circle::new(point, px(4), color.filled())))?;
        }
        Ok(())
    }
}
