//! The counterparts of the paper's plots: `bh2001_speed.png` and `bh2001_p_skip.png`, a panel a world
//! and tree.

use plotters::prelude::RGBColor;

use super::points::{self, Point};
use super::walks::{WALKS, Walk};
use super::{SPEEDS, TREES, TreeKind};
use crate::output::Output;
use support::canvas::{self, Key, Sheet};
use support::chart::panel;
use support::flags::Flags;
use support::ticks::{Axes, Line};

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

/// How a share is written.
fn percent(share: &f64) -> String {
    format!("{:.0} %", 100.0 * share)
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
        label: percent,
        least_top: 0.5,
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
    let p_skip = Axes {
        x: "p_skip",
        y: "over A's",
        ticks: p_skips.iter().map(ToString::to_string).collect(),
        label: percent,
        least_top: 0.5,
    };
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
        Line { color, values: of_line.map(|point| point.saved).collect() }
    };
    ALGORITHMS.iter().map(line).collect()
}

fn by_p_skip(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<Line> {
    let all = points::by_p_skip(points, walk, tree);
    let line = |&(_, color, value): &Figure| Line {
        color,
        values: all.iter().map(|(_, point)| value(point)).collect(),
    };
    FIGURES.iter().map(line).collect()
}
