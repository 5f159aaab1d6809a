//! The run as curves: `frame_time.png` and `drawn_objects.png`.

use std::path::Path;

use plotters::prelude::*;

use super::axis::nice_top;
use super::canvas::{self, FAINT, INK, Key, px, text};
use super::chart::{axes, log_axes};
use super::report::{FrameRecord, Summary, percentile};

const SIZE: (u32, u32) = (1200, 620);

/// A stage of the frame: its name, its colour, and its time in milliseconds.
type Stage = (&'static str, RGBColor, fn(&FrameRecord) -> f64);

/// The stages of a frame, in the order in which they are stacked.
const STAGES: [Stage; 6] = [
    ("draw", RGBColor(76, 120, 168), |f| f.draw_ms),
    ("query", RGBColor(114, 183, 178), |f| f.query_ms),
    ("wait", RGBColor(238, 202, 59), |f| f.wait_ms),
    ("policy", RGBColor(178, 121, 162), |f| f.policy_ms),
    ("tree", RGBColor(245, 133, 24), |f| f.tree_ms),
    ("sync", RGBColor(228, 87, 86), |f| f.sync_ms),
];

const DRAWN: RGBColor = RGBColor(31, 119, 180);
const IN_FRUSTUM: RGBColor = RGBColor(150, 158, 168);
const BOX_VISIBLE: RGBColor = RGBColor(240, 150, 40);
const EXACT_VISIBLE: RGBColor = RGBColor(44, 160, 90);

/// Draws both plots into a folder that exists.
pub fn write(out: &Path, summary: &Summary, frames: &[FrameRecord]) -> anyhow::Result<()> {
    frame_time(&out.join("frame_time.png"), summary, frames)?;
    drawn_objects(&out.join("drawn_objects.png"), summary, frames)
}

/// Where each frame's time went, as stacked areas.
fn frame_time(path: &Path, summary: &Summary, frames: &[FrameRecord]) -> anyhow::Result<()> {
    let times: Vec<f64> = frames.iter().map(|f| f.frame_ms).collect();
    // A single slow frame (the first one builds the tree) must not flatten all the others.
    let top = nice_top(1.25 * percentile(&times, 98.0));
    let slow: Vec<&FrameRecord> = frames.iter().filter(|f| f.frame_ms > top).collect();
    let keys: Vec<Key> = STAGES.iter().rev().map(|&(label, color, _)| Key::new(color, label)).collect();
    canvas::save(path, SIZE, |sheet| {
        let s = &summary.frame_ms;
        let title = format!("Frame time: median {:.2} ms, 99th percentile {:.2} ms", s.median, s.p99);
        let area = canvas::heading(sheet, &title, &subtitle(summary), &keys)?;
        let mut chart = axes(&area, frames.len(), 0.0..top, "milliseconds")?;
        let mut below = vec![0.0; frames.len()];
        for (_, color, stage) in STAGES {
            let above: Vec<f64> = below.iter().zip(frames).map(|(b, f)| b + stage(f)).collect();
            let clipped = |(i, y): (usize, &f64)| (i as f64, y.min(top));
            let outline: Vec<_> = (above.iter().enumerate().map(clipped))
                .chain(below.iter().enumerate().rev().map(clipped))
                .collect();
            chart.draw_series([Polygon::new(outline, color)])?;
            below = above;
        }
        let total = frames.iter().map(|f| (f64::from(f.frame), f.frame_ms.min(top)));
        chart.draw_series(LineSeries::new(total, INK.stroke_width(px(1) as u32)))?;
        if let Some(first) = slow.first() {
            let others = match slow.len() {
                1 => String::new(),
                n => format!(" and {} more", n - 1),
            };
            let note = format!("above the scale: frame {} ({:.1} ms){others}", first.frame, first.frame_ms);
            let place = (f64::from(first.frame) + 0.012 * frames.len() as f64, top * 0.985);
            chart.draw_series([Text::new(note, place, text(13, FAINT))])?;
        }
        Ok(())
    })
}

/// How many objects were drawn, between the two bounds that matter: what the frustum leaves,
/// and what is really seen.
fn drawn_objects(path: &Path, summary: &Summary, frames: &[FrameRecord]) -> anyhow::Result<()> {
    type Curve = (&'static str, RGBColor, u32, fn(&FrameRecord) -> Option<u32>);
    let curves: [Curve; 4] = [
        ("inside the view frustum", IN_FRUSTUM, 2, |f| Some(f.in_frustum)),
        ("drawn", DRAWN, 3, |f| Some(f.drawn)),
        ("box visible (the floor for any box-based method)", BOX_VISIBLE, 2, |f| f.box_visible),
        ("really visible", EXACT_VISIBLE, 2, |f| f.exact_visible),
    ];
    let known: Vec<Curve> =
        curves.into_iter().filter(|(.., value)| frames.iter().all(|f| value(f).is_some())).collect();
    let keys: Vec<Key> = known.iter().map(|&(label, color, ..)| Key::new(color, label)).collect();
    canvas::save(path, (SIZE.0, SIZE.1 + 280), |sheet| {
        let title = format!(
            "Objects drawn: {:.0} of the {:.0} in the frustum, of {} in the world (means)",
            summary.drawn.mean, summary.in_frustum.mean, summary.objects
        );
        let area = canvas::heading(sheet, &title, &subtitle(summary), &keys)?;
        let most = frames.iter().map(|f| f.in_frustum.max(f.drawn)).max().unwrap_or(0);
        let top = nice_top(1.05 * f64::from(most));
        let counts = |frame| known.iter().filter_map(move |(.., value)| value(frame));
        let least = frames.iter().flat_map(counts).min().unwrap_or(0).max(1);
        let bottom = 10f64.powi(least.ilog10() as i32);
        // The frustum's curve is often fifty times higher than the others, which then look alike:
        // the lower plot shows ratios.
        let (upper, lower) = area.split_vertically(px(390));
        let mut linear = axes(&upper, frames.len(), 0.0..top, "objects")?;
        let range = bottom..top.max(2.0 * bottom);
        let mut ratios = log_axes(&lower, frames.len(), range, "objects, logarithmic")?;
        for (_, color, width, value) in &known {
            let style = color.stroke_width(px(1) as u32 * width);
            let points: Vec<_> =
                frames.iter().filter_map(|f| Some((f64::from(f.frame), f64::from(value(f)?)))).collect();
            linear.draw_series(LineSeries::new(points.iter().copied(), style))?;
            ratios.draw_series(LineSeries::new(points.iter().map(|&(x, y)| (x, y.max(1.0))), style))?;
        }
        Ok(())
    })
}

/// The one line that says what was run.
fn subtitle(summary: &Summary) -> String {
    let [width, height] = summary.viewport;
    format!(
        "{} · policy {} · {} queries · {width} × {height} · seed {}",
        summary.scene, summary.policy, summary.backend, summary.seed
    )
}
