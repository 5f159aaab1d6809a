//! The counterparts of the paper's figures 7 and 8: `kt2005_frame_time.png` and
//! `kt2005_drawn.png`, a panel a scene, and one for the ratios.

use std::path::Path;

use plotters::prelude::*;

use super::Outcome;
use super::rows::seconds;
use super::scenes::Published;
use crate::output::Output;
use support::axis::{nice_top, plain};
use support::canvas::{self, FAINT, GRID, INK, Key, Sheet, px, text};
use support::chart::{self, Curve, axes, panel};
use support::flags::Flags;
use support::lockstep::Measured;
use support::report::FrameRecord;

const SIZE: (u32, u32) = (1400, 1180);
/// Panels side by side, and one below the other.
const GRID_OF: (usize, usize) = (3, 2);

const NEW: RGBColor = RGBColor(31, 119, 180);
const OLD: RGBColor = RGBColor(214, 84, 62);
const BOX_VISIBLE: RGBColor = RGBColor(240, 170, 60);
const EXACT_VISIBLE: RGBColor = RGBColor(44, 160, 90);

/// What a figure shows.
struct Figure {
    title: &'static str,
    unit: &'static str,
    /// Of a frame.
    value: fn(&FrameRecord) -> f64,
    /// Of all frames.
    total: fn(&Measured) -> f64,
    /// The same in the paper.
    paper: fn(&Published) -> f64,
    /// The two totals of a scene in words.
    words: fn(f64, f64) -> String,
    /// Other curves that belong here, where they are known.
    floors: &'static [Floor],
}

/// A curve below which nobody gets.
struct Floor {
    label: &'static str,
    color: RGBColor,
    value: fn(&FrameRecord) -> Option<u32>,
}

const FRAME_TIME: Figure = Figure {
    title: "Frame time, new and old",
    unit: "milliseconds",
    value: |frame| frame.frame_ms,
    total: seconds,
    paper: |published| published.seconds,
    words: |new, old| format!("{new:.1} s new, {old:.1} s old"),
    floors: &[],
};

const DRAWN: Figure = Figure {
    title: "Objects drawn, new and old",
    unit: "objects",
    value: |frame| f64::from(frame.drawn),
    total: |measured| measured.summary.drawn.mean,
    paper: |published| published.drawn,
    words: |new, old| format!("{new:.0} new, {old:.0} old"),
    floors: &[
        Floor {
            label: "box visible (the floor for any box-based method)",
            color: BOX_VISIBLE,
            value: |frame| frame.box_visible,
        },
        Floor { label: "really visible", color: EXACT_VISIBLE, value: |frame| frame.exact_visible },
    ],
};

/// Draws both figures.
pub fn write(output: &Output, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
    FRAME_TIME.save(&output.file("_frame_time.png"), flags, outcomes)?;
    DRAWN.save(&output.file("_drawn.png"), flags, outcomes)
}

impl Figure {
    fn save(&self, path: &Path, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
        let mut keys = vec![
            Key::new(NEW, "new: dual queries, adaptive ternary tree"),
            Key::new(OLD, "old: statistically optimised queries, binary tree"),
        ];
        if flags.oracle {
            keys.extend(self.floors.iter().map(|floor| Key::new(floor.color, floor.label)));
        }
        let (width, height) = flags.size;
        let subtitle = format!(
            "the comparison of 2005, run again · {} frames a scene · software queries · {width} × {height} · seed {}",
            flags.frames, flags.seed
        );
        canvas::save(path, SIZE, |sheet| {
            let below = canvas::heading(sheet, self.title, &subtitle, &keys)?;
            let cells = below.split_evenly(GRID_OF);
            for (cell, outcome) in cells.iter().zip(outcomes) {
                self.curves(cell, outcome)?;
            }
            if let Some(cell) = cells.get(outcomes.len()) {
                self.ratios(cell, outcomes)?;
            }
            Ok(())
        })
    }

    /// A scene, frame by frame.
    fn curves(&self, cell: &Sheet<'_>, outcome: &Outcome) -> anyhow::Result<()> {
        let Outcome { name, new, old, .. } = outcome;
        let totals = (self.words)((self.total)(new), (self.total)(old));
        let area = panel(cell, &format!("{name}: {totals}"))?;
        let floor = |floor: &Floor| {
            let values = new.frames.iter().filter_map(floor.value).map(f64::from).collect();
            Curve { values, color: floor.color, width: 1 }
        };
        let curve = |measured: &Measured, color| {
            let values = measured.frames.iter().map(self.value).collect();
            Curve { values, color, width: 2 }
        };
        let mut curves: Vec<Curve> = self.floors.iter().map(floor).collect();
        curves.extend([curve(old, OLD), curve(new, NEW)]);
        let range = 0.0..chart::top(&curves);
        let mut chart = axes(&area, new.frames.len(), range.clone(), self.unit)?;
        chart::draw(&mut chart, range, &curves)
    }

    /// New over old in all scenes, beside the paper's.
    fn ratios(&self, cell: &Sheet<'_>, outcomes: &[Outcome]) -> anyhow::Result<()> {
        const LABELS: i32 = 250;
        let area = panel(cell, "new / old over the whole flight: here (filled), in the paper (open)")?;
        let ratio = |(new, old): (f64, f64)| if old > 0.0 { new / old } else { 1.0 };
        let rows: Vec<(f64, f64)> = outcomes
            .iter()
            .map(|o| {
                let here = ratio(((self.total)(&o.new), (self.total)(&o.old)));
                (here, ratio(((self.paper)(&o.scene.new), (self.paper)(&o.scene.old))))
            })
            .collect();
        let top = nice_top(rows.iter().fold(1.2, |top: f64, row| top.max(1.05 * row.0)));
        let mut chart = ChartBuilder::on(&area)
            .margin(px(20))
            .margin_top(px(6))
            .x_label_area_size(px(44))
            .y_label_area_size(px(LABELS))
            .build_cartesian_2d(0.0..top, (rows.len() as f64 - 0.5)..-0.5)?;
        plain(&mut chart.configure_mesh())
            .disable_y_mesh()
            .x_desc("new / old; left of 1, the new one is better")
            .x_label_formatter(&|x| format!("{x:.1}"))
            .y_labels(0)
            .draw()?;
        let even = [(1.0, -0.5), (1.0, rows.len() as f64 - 0.5)];
        chart.draw_series(LineSeries::new(even, FAINT.stroke_width(px(1) as u32)))?;
        for (n, (outcome, &(here, paper))) in outcomes.iter().zip(&rows).enumerate() {
            let y = n as f64;
            let line = [(here, y), (paper.min(top), y)];
            chart.draw_series(LineSeries::new(line, GRID.stroke_width(px(3) as u32)))?;
            chart.draw_series([Circle::new((paper.min(top), y), px(6), WHITE.filled())])?;
            chart.draw_series([Circle::new((paper.min(top), y), px(6), INK.stroke_width(px(2) as u32))])?;
            chart.draw_series([Circle::new((here, y), px(6), NEW.filled())])?;
            let (_, pixel) = chart.backend_coord(&(0.0, y));
            let (_, above) = area.get_base_pixel();
            let label = format!("{}  {here:.2}", outcome.name);
            let style = text(13, INK);
            let (wide, high) = area.estimate_text_size(&label, &style)?;
            let left = px(20 + LABELS - 10) - wide as i32;
            area.draw_text(&label, &style, (left, pixel - above - high as i32 / 2))?;
        }
        Ok(())
    }
}
