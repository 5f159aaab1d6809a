//! `hroc_frame_time.png` and `hroc_drawn.png`: a panel a scene.

use super::Outcome;
use super::algorithms::VFC;
use crate::output::Output;
use support::canvas::{self, Key};
use support::chart::{self, Curve, log_axes, panel};
use support::flags::Flags;
use support::report::FrameRecord;

const WIDTH: u32 = 1400;
/// Of the heading.
const ABOVE: u32 = 128;
const PANEL_HEIGHT: u32 = 330;
/// Panels side by side.
const COLUMNS: usize = 2;

/// What a figure shows of each frame.
struct Figure {
    title: &'static str,
    ending: &'static str,
    unit: &'static str,
    value: fn(&FrameRecord) -> f64,
}

const FIGURES: [Figure; 2] = [
    Figure {
        title: "Frame time of raster occlusion, and of what it is compared with",
        ending: "_frame_time.png",
        unit: "milliseconds",
        value: |frame| frame.frame_ms,
    },
    Figure {
        title: "Objects drawn by raster occlusion, and by what it is compared with",
        ending: "_drawn.png",
        unit: "objects",
        value: |frame| frame.drawn.into(),
    },
];

/// Draws both figures.
pub fn write(output: &Output, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
    FIGURES.iter().try_for_each(|figure| figure.save(output, flags, outcomes))
}

impl Figure {
    fn save(&self, output: &Output, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
        let algorithms: Vec<_> = super::algorithms(outcomes).collect();
        let keys: Vec<Key> = algorithms.iter().map(|a| Key::new(a.color, a.name)).collect();
        let (width, height) = flags.size;
        let subtitle = format!(
            "worlds at scale {} · {} frames a scene · {} · {width} × {height} · seed {}",
            flags.scale,
            flags.frames,
            super::adapter(outcomes).unwrap_or("software backend"),
            flags.seed
        );
        let rows = outcomes.len().div_ceil(COLUMNS);
        canvas::save(&output.file(self.ending), (WIDTH, ABOVE + PANEL_HEIGHT * rows as u32), |sheet| {
            let below = canvas::heading(sheet, self.title, &subtitle, &keys)?;
            let cells = below.split_evenly((rows, COLUMNS));
            for (cell, outcome) in cells.iter().zip(outcomes) {
                let area = panel(cell, outcome.scene.name)?;
                let curves = algorithms.iter().zip(&outcome.lanes).map(|(algorithm, lane)| Curve {
                    values: lane.frames.iter().map(self.value).collect(),
                    color: algorithm.color,
                    width: 2,
                });
                let curves: Vec<Curve> = curves.collect();
                let range = chart::log_range(&curves);
                let frames = outcome.lanes[VFC].frames.len();
                let mut chart = log_axes(&area, frames, range.clone(), self.unit)?;
                chart::draw(&mut chart, range, &curves)?;
            }
            Ok(())
        })
    }
}
