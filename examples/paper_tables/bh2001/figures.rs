//! The counterparts of the paper's plots: `bh2001_speed.png` and `bh2001_p_skip.png`, a panel a world
//! and tree.

use plotters::prelude::*;

use super::points::{self, Point};
use super::walks::{WALKS, Walk};
use super::{SPEEDS, TREES, TreeKind};
use crate::output::Output;
use support::axis::{nice_top, plain};
use support::canvas::{self, Key, Sheet, px};
use support::chart::panel;
use support::flags::Flags;

const SIZE: (u32, u32) = (1200, 820);

/// Of A, B, C and D, but that nothing is compared with itself.
const ALGORITHMS: [(&str, RGBColor); 3] =
    [("B", RGBColor(240, 150, 40)), ("C", RGBColor(44, 160, 90)), ("D", RGBColor(31, 119, 180))];

/// A figure of D over A's: its name, its colour, and what it shows of a point.
type Figure = (&'static str, RGBColor, fn(&Point) -> f64);

const FIGURES: [Figure; 3] = [
    ("questions", RGBColor(31, 119, 180), |p| 1.0 - p.saved),
    ("objects drawn", RGBColor(240, 150, 40), |p| p.drawn_of_a),
    ("time", RGBColor(214, 84, 62), |p| p.time_of_a),
];

/// Points that belong together, x by x.
struct Line {
    color: RGBColor,
    points: Vec<(f64, f64)>,
}

/// What the axes of a figure say.
struct Axes<'a> {
    x: &'a str,
    y: &'a str,
    /// The names of x = 0, 1, …
    ticks: Vec<String>,
}

/// Draws both figures.
pub fn write(output: &Output, flags: &Flags, points: &[Point]) -> anyhow::Result<()> {
    let (width, height) = flags.size;
    let subtitle = format!(
        "scale {} · {} steps at speed 1 · software queries · {width} × {height} · seed {}",
        flags.scale, flags.frames, flags.seed
    );
    let speed = Axes {
        x: "speed of the walk",
        y: "saved, of A's questions",
        ticks: SPEEDS.iter().map(ToString::to_string).collect(),
    };
    let keys: Vec<Key> = ALGORITHMS
        .iter()
        .map(|&(name, color)| Key::new(color, format!("hierarchy-{}", name.to_lowercase())))
        .collect();
    let title = "Questions saved by coherence, against the speed of the walk";
    canvas::save(&output.file("_speed.png"), SIZE, |sheet| {
        let below = canvas::heading(sheet, title, &subtitle, &keys)?;
        panels(&below, &speed, |walk, tree| by_speed(points, walk, tree))
    })?;

    let mut p_skips = super::P_SKIP;
    p_skips.sort_by(f32::total_cmp);
    let p_skip =
        Axes { x: "p_skip", y: "over A's", ticks: p_skips.iter().map(ToString::to_string).collect() };
    let keys: Vec<Key> = FIGURES.iter().map(|&(label, color, _)| Key::new(color, label)).collect();
    let title = "hierarchy-d over hierarchy-a, against the probability that what was visible goes unasked";
    canvas::save(&output.file("_p_skip.png"), SIZE, |sheet| {
        let below = canvas::heading(sheet, title, &subtitle, &keys)?;
        panels(&below, &p_skip, |walk, tree| by_p_skip(points, walk, tree))
    })
}

/// A panel a walk and tree.
fn panels(
    below: &Sheet<'_>,
    axes: &Axes<'_>,
    lines: impl Fn(Walk, TreeKind) -> Vec<Line>,
) -> anyhow::Result<()> {
    let both = WALKS.into_iter().flat_map(|walk| TREES.into_iter().map(move |tree| (walk, tree)));
    for (cell, (walk, tree)) in below.split_evenly((WALKS.len(), TREES.len())).iter().zip(both) {
        let area = panel(cell, &format!("{}, {} tree", walk.name, tree.name))?;
        axes.draw(&area, &lines(walk, tree))?;
    }
    Ok(())
}

fn by_speed(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<Line> {
    let line = |&(algorithm, color): &(&str, RGBColor)| {
        let of_line = points::of(points, walk, tree)
            .filter(|point| point.algorithm == algorithm && point.has_default_p_skip());
        Line { color, points: of_line.enumerate().map(|(x, point)| (x as f64, point.saved)).collect() }
    };
    ALGORITHMS.iter().map(line).collect()
}

fn by_p_skip(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<Line> {
    let all = points::by_p_skip(points, walk, tree);
    let line = |&(_, color, value): &Figure| Line {
        color,
        points: all.iter().enumerate().map(|(x, (_, point))| (x as f64, value(point))).collect(),
    };
    FIGURES.iter().map(line).collect()
}

impl Axes<'_> {
    fn draw(&self, area: &Sheet<'_>, lines: &[Line]) -> anyhow::Result<()> {
        let highest =
            lines.iter().flat_map(|line| &line.points).fold(0.5, |top: f64, point| top.max(point.1));
        let right = self.ticks.len() as f64 - 0.5;
        let mut chart = ChartBuilder::on(area)
            .margin(px(20))
            .margin_top(px(6))
            .x_label_area_size(px(44))
            .y_label_area_size(px(66))
            .build_cartesian_2d(-0.5..right, 0.0..nice_top(1.05 * highest))?;
        let tick = |x: &f64| {
            let at = (x.fract() == 0.0).then(|| self.ticks.get(*x as usize)).flatten();
            at.filter(|_| *x >= 0.0).cloned().unwrap_or_default()
        };
        plain(&mut chart.configure_mesh())
            .disable_x_mesh()
            .x_labels(self.ticks.len() + 1)
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&tick)
            .y_label_formatter(&|y| format!("{:.0} %", 100.0 * y))
            .draw()?;
        for Line { color, points } in lines {
            chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(px(2) as u32)))?;
            chart.draw_series(points.iter().map(|&point| Circle::new(point, px(4), color.filled())))?;
        }
        Ok(())
    }
}
