//! `dial_sweep.png`: a panel a dial, with objects drawn and frame time over the base's.

use std::path::Path;

use plotters::prelude::*;

use crate::outcome::Outcome;
use crate::plan::{Plan, Sweep};
use support::axis::plain;
use support::canvas::{self, FAINT, INK, Key, Sheet, px, text};
use support::chart::panel;
use support::flags::Flags;

const WIDTH: u32 = 1500;
/// Of the heading.
const ABOVE: u32 = 106;
const PANEL_HEIGHT: u32 = 300;
const COLUMNS: usize = 3;

/// Of each world: objects drawn, and time.
const COLORS: [(RGBColor, RGBColor); 2] =
    [(RGBColor(31, 119, 180), RGBColor(140, 190, 225)), (RGBColor(204, 82, 40), RGBColor(244, 170, 130))];
const BASE: RGBColor = RGBColor(206, 212, 220);
const NOISE: RGBColor = RGBColor(240, 234, 214);

/// What a curve shows of a tree.
type Value = fn(&Outcome, usize) -> f64;

/// A curve of every panel.
struct Curve<'a> {
    outcome: &'a Outcome,
    value: Value,
    color: RGBColor,
    label: String,
}

/// Draws the figure.
pub fn write(path: &Path, flags: &Flags, plan: &Plan, outcomes: &[Outcome]) -> anyhow::Result<()> {
    let curves: Vec<Curve<'_>> = outcomes.iter().zip(COLORS).flat_map(curves).collect();
    let mut keys: Vec<Key> = curves.iter().map(|curve| Key::new(curve.color, curve.label.clone())).collect();
    keys.extend([
        Key::new(BASE, "the base's value"),
        Key::new(NOISE, "noise: how far the times of equal trees differ"),
    ]);
    let noise = outcomes.iter().map(Outcome::time_noise).fold(0.0, f64::max);
    let rows = plan.sweeps.len().div_ceil(COLUMNS).max(1);
    let (width, height) = flags.size;
    let subtitle = format!(
        "one dial turned at a time, the others as in the base · policy {} · {} frames · {width} × {height} · seed {}",
        flags.policy, flags.frames, flags.seed
    );
    canvas::save(path, (WIDTH, ABOVE + PANEL_HEIGHT * rows as u32), |sheet| {
        let title = "The dials of the tree: objects drawn and frame time, over the base's";
        let below = canvas::heading(sheet, title, &subtitle, &keys)?;
        for (cell, sweep) in below.split_evenly((rows, COLUMNS)).iter().zip(&plan.sweeps) {
            draw(cell, sweep, &curves, noise)?;
        }
        Ok(())
    })
}

/// Time first, so that what is drawn lies over it.
fn curves((outcome, (drawn, time)): (&Outcome, (RGBColor, RGBColor))) -> [Curve<'_>; 2] {
    let curve = |value: Value, color, what| {
        let label = format!("{}: {what}", outcome.name);
        Curve { outcome, value, color, label }
    };
    [curve(Outcome::time_of_base, time, "time"), curve(Outcome::drawn_of_base, drawn, "drawn")]
}

impl Curve<'_> {
    fn at(&self, tree: usize) -> f64 {
        (self.value)(self.outcome, tree)
    }
}

fn draw(cell: &Sheet<'_>, sweep: &Sweep, curves: &[Curve<'_>], noise: f64) -> anyhow::Result<()> {
    let area = panel(cell, sweep.dial)?;
    let all = || curves.iter().flat_map(|curve| sweep.points.iter().map(|point| curve.at(point.tree)));
    // Never so close that noise looks like an effect.
    let bottom = all().fold(0.8, f64::min).min(1.0 - noise) - 0.05;
    let top = all().fold(1.2, f64::max).max(1.0 + noise) + 0.05;
    let last = sweep.points.len() as f64 - 1.0;
    let mut chart = ChartBuilder::on(&area)
        .margin(px(20))
        .margin_top(px(4))
        .x_label_area_size(px(30))
        .y_label_area_size(px(52))
        .build_cartesian_2d(-0.5..last + 0.5, bottom..top)?;
    chart.draw_series([Rectangle::new([(-0.5, 1.0 - noise), (last + 0.5, 1.0 + noise)], NOISE.filled())])?;
    plain(&mut chart.configure_mesh())
        .disable_x_mesh()
        .x_labels(0)
        .y_labels(6)
        .y_label_formatter(&|y| format!("{y:.1}"))
        .draw()?;
    for (n, point) in sweep.points.iter().enumerate() {
        let x = n as f64;
        if point.tree == 0 {
            let line = [(x, bottom), (x, top)];
            chart.draw_series(LineSeries::new(line, BASE.stroke_width(px(7) as u32)))?;
        }
        let style = text(13, if point.tree == 0 { INK } else { FAINT });
        let (left, base) = chart.backend_coord(&(x, bottom));
        let (x0, y0) = area.get_base_pixel();
        let (wide, _) = area.estimate_text_size(&point.value, &style)?;
        area.draw_text(&point.value, &style, (left - x0 - wide as i32 / 2, base - y0 + px(8)))?;
    }
    for curve in curves {
        let points: Vec<_> =
            sweep.points.iter().enumerate().map(|(n, p)| (n as f64, curve.at(p.tree))).collect();
        chart.draw_series(LineSeries::new(points.iter().copied(), curve.color.stroke_width(px(2) as u32)))?;
        chart.draw_series(points.iter().map(|&point| Circle::new(point, px(4), curve.color.filled())))?;
    }
    Ok(())
}
