//! `tradeoff_error.png` and `tradeoff_draws.png`: a panel a world, a point a setting, and the settings
//! that nothing beats.

use std::ops::Range;
use std::path::Path;

use plotters::prelude::*;

use crate::dials;
use crate::figures::Figures;
use crate::outcome::{BASE, COMBINED, Outcome, PRESET, Row};
use support::axis::plain;
use support::canvas::{self, INK, Key, Sheet, px, text};
use support::chart::panel;
use support::flags::Flags;

const WIDTH: u32 = 1500;
const PANEL_HEIGHT: u32 = 460;
/// Of the heading.
const ABOVE: u32 = 150;

/// Of the groups, as they come.
const COLORS: [RGBColor; 14] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 39, 40),
    RGBColor(44, 160, 44),
    RGBColor(148, 103, 189),
    RGBColor(255, 127, 14),
    RGBColor(23, 170, 190),
    RGBColor(140, 86, 75),
    RGBColor(227, 119, 194),
    RGBColor(150, 150, 20),
    RGBColor(80, 80, 200),
    RGBColor(0, 120, 100),
    RGBColor(60, 60, 60),
    RGBColor(200, 160, 0),
    RGBColor(170, 176, 186),
];
const FRONT: RGBColor = RGBColor(120, 128, 140);

/// Beyond so many times the base's time, a point lies on the border.
const SLOWEST: f64 = 2.0;
/// The least share of wrong samples that is told from none, percent: less than a sample in 100 frames.
const LEAST: f64 = 1e-6;

/// One figure of two.
struct Plot {
    title: &'static str,
    unit: &'static str,
    note: &'static str,
    value: fn(&Figures) -> f64,
    front: fn(&Outcome) -> &[usize],
}

const ERROR: Plot = Plot {
    title: "Wrong samples against time",
    unit: "wrong samples, percent of a mean frame",
    note: "on the lower border: none at all; on the right one: slower still",
    value: |figures| 100.0 * figures.error(),
    front: |outcome| &outcome.error_front,
};

const DRAWS: Plot = Plot {
    title: "Objects drawn in vain against time",
    unit: "drawn beyond the exact set, percent of it",
    note: "an object counts that is drawn and owns no sample; on the right border: slower still",
    value: |figures| 100.0 * figures.extra_ratio(),
    front: |outcome| &outcome.draws_front,
};

/// Draws both figures into a folder.
pub fn write(out: &Path, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
    draw(&out.join("tradeoff_error.png"), flags, outcomes, &ERROR)?;
    draw(&out.join("tradeoff_draws.png"), flags, outcomes, &DRAWS)
}

fn draw(path: &Path, flags: &Flags, outcomes: &[Outcome], plot: &Plot) -> anyhow::Result<()> {
    let columns = outcomes.len().clamp(1, 2);
    let rows = outcomes.len().div_ceil(columns).max(1);
    let (width, height) = flags.size;
    let subtitle = format!(
        "time over the base's · policy {} · software backend · {width} × {height} · seed {} · {}",
        flags.policy, flags.seed, plot.note
    );
    let shown = |group: &str| outcomes.iter().any(|o| o.rows.iter().any(|row| row.group == group));
    let mut keys: Vec<Key> =
        groups().filter(|group| shown(group)).map(|group| Key::new(color(group), group)).collect();
    keys.push(Key::new(FRONT, "nothing beats these in both"));
    canvas::save(path, (WIDTH, ABOVE + PANEL_HEIGHT * rows as u32), |sheet| {
        let below = canvas::heading(sheet, plot.title, &subtitle, &keys)?;
        for (cell, outcome) in below.split_evenly((rows, columns)).iter().zip(outcomes) {
            let base_ms = outcome.base().median_ms;
            let title = format!("{}: {} frames; 1 is {base_ms:.1} ms", outcome.world, outcome.frames);
            let area = panel(cell, &title)?;
            let values: Vec<f64> = outcome.rows.iter().map(|row| (plot.value)(&row.figures)).collect();
            scatter(&area, outcome, plot, log_range(&values))?;
        }
        Ok(())
    })
}

/// What a logarithmic axis must hold, and half a decade below, so that little is told from nothing.
fn log_range(values: &[f64]) -> Range<f64> {
    let some = || values.iter().copied().filter(|&y| y >= LEAST);
    let least = some().fold(f64::INFINITY, f64::min).min(1.0);
    let most = some().fold(0.0, f64::max).max(10.0 * least);
    10f64.powf(least.log10().floor() - 0.5)..10f64.powf(most.log10() + 0.2)
}

fn scatter(area: &Sheet<'_>, outcome: &Outcome, plot: &Plot, range: Range<f64>) -> anyhow::Result<()> {
    let times = || outcome.rows.iter().map(|row| row.figures.time_ratio.min(SLOWEST));
    let (fastest, slowest) = (times().fold(1.0, f64::min), times().fold(1.0, f64::max));
    let margin = 0.05 * (slowest - fastest).max(0.2);
    let mut chart = ChartBuilder::on(area)
        .margin(px(20))
        .margin_top(px(6))
        .x_label_area_size(px(44))
        .y_label_area_size(px(76))
        .build_cartesian_2d(fastest - margin..slowest + 3.0 * margin, range.clone().log_scale())?;
    plain(&mut chart.configure_mesh())
        .x_desc("time over the base's")
        .y_desc(plot.unit)
        .x_label_formatter(&|x| format!("{x:.2}"))
        .y_label_formatter(&|y| format!("{}", (y * 1e9).round() / 1e9))
        .draw()?;
    let point = |row: &Row| {
        let y = (plot.value)(&row.figures).clamp(range.start, range.end);
        (row.figures.time_ratio.min(SLOWEST), y)
    };
    let front: Vec<&Row> = (plot.front)(outcome).iter().map(|&n| &outcome.rows[n]).collect();
    let corners = front.windows(2).flat_map(|pair| {
        let (a, b) = (point(pair[0]), point(pair[1]));
        [a, (b.0, a.1), b]
    });
    chart.draw_series(LineSeries::new(corners, FRONT.stroke_width(px(2) as u32)))?;
    // The base last: it is what all others are compared with.
    let rows = outcome.rows.iter().rev();
    chart.draw_series(rows.map(|row| Circle::new(point(row), px(4), color(row.group).filled())))?;
    let mut taken: Option<(i32, i32)> = None;
    for row in front {
        let (x, y) = chart.backend_coord(&point(row));
        let (x0, y0) = area.get_base_pixel();
        let (text, style) = (brief(&row.label()), text(12, INK));
        let (wide, high) = area.estimate_text_size(&text, &style)?;
        let (wide, high) = (wide as i32, high as i32 + px(2));
        let (room, _) = area.dim_in_pixel();
        let at = ((x - x0 + px(6)).min(room as i32 - wide - px(4)), y - y0 - px(14));
        // The curve falls: what came before ends to the left, or above.
        if taken.is_none_or(|(end, above)| at.0 > end || at.1 - above > high) {
            area.draw_text(&text, &style, at)?;
            taken = Some((at.0 + wide, at.1));
        }
    }
    Ok(())
}

/// A setting's first two dials, and how many more there are.
fn brief(label: &str) -> String {
    let words: Vec<&str> = label.split(' ').collect();
    match words.len() {
        0..=3 => label.to_owned(),
        dials => format!("{} and {} more", words[..2].join(" "), dials - 2),
    }
}

/// The groups, in the order of the legend.
fn groups() -> impl Iterator<Item = &'static str> {
    [BASE].into_iter().chain(dials::names()).chain([PRESET, COMBINED])
}

fn color(group: &str) -> RGBColor {
    // The base stands out by being black, combinations by being faint.
    match group {
        BASE => RGBColor(0, 0, 0),
        COMBINED => COLORS[13],
        PRESET => COLORS[12],
        dial => COLORS[dials::names().position(|name| name == dial).unwrap_or(0) % 12],
    }
}
