//! The last frames, as curves.

use std::collections::VecDeque;

use eframe::egui::{Color32, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints};

use crate::report::FrameRecord;

/// A curve: its name, and what it shows of a frame.
type Curve = (&'static str, fn(&FrameRecord) -> f64);

const PLOTS: [(&str, &[Curve]); 4] = [
    ("milliseconds", &[("frame", |f| f.frame_ms), ("tree", |f| f.tree_ms), ("waiting", |f| f.wait_ms)]),
    ("objects", &[("drawn", |f| f.drawn.into()), ("in frustum", |f| f.in_frustum.into())]),
    ("questions", &[("questions", |f| f.queries.into())]),
    ("waves", &[("waves", |f| f.waves.into())]),
];

const COLORS: [Color32; 3] =
    [Color32::from_rgb(86, 156, 236), Color32::from_rgb(240, 160, 70), Color32::from_rgb(130, 200, 120)];

/// Draws the plots side by side.
pub fn show(ui: &mut Ui, records: &VecDeque<FrameRecord>) {
    let height = ui.available_height();
    ui.columns(PLOTS.len(), |columns| {
        for (ui, (title, curves)) in columns.iter_mut().zip(PLOTS) {
            let unit = if title == "milliseconds" { " ms" } else { "" };
            Plot::new(title)
                .legend(Legend::default())
                .height(height)
                .include_y(0.0)
                .show_x(false)
                .allow_drag(false)
                .allow_zoom(false)
                .allow_scroll(false)
                .allow_boxed_zoom(false)
                .show(ui, |plot| {
                    for ((name, value), color) in curves.iter().zip(COLORS) {
                        let points: PlotPoints<'_> =
                            records.iter().map(|f| [f64::from(f.frame), value(f)]).collect();
                        let last = records.back().map_or(0.0, value);
                        plot.line(Line::new(format!("{name} {}{unit}", brief(last)), points).color(color));
                    }
                });
        }
    });
}

/// Three digits, or so.
fn brief(value: f64) -> String {
    if value < 100.0 && value.fract() != 0.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}
