//! `chcpp_frame_time.png` and `chcpp_questions.png`: two panels a scene each, on logarithmic axes.

use super::Outcome;
use super::algorithms::{ALGORITHMS, CHC, DUAL, NOHC, OPT, PLUS_PLUS, VFC};
use crate::output::Output;
use support::canvas::{self, Key, Sheet};
use support::chart::{self, Curve, log_axes, panel};
use support::flags::Flags;
use support::report::FrameRecord;

const WIDTH: u32 = 1400;
/// Of the heading.
const ABOVE: u32 = 106;
const PANEL_HEIGHT: u32 = 330;

/// What a figure shows: two panels of each scene.
struct Figure {
    title: &'static str,
    panels: [Panel; 2],
}

/// Some algorithms, and a figure of each of their frames.
struct Panel {
    title: &'static str,
    unit: &'static str,
    value: fn(&FrameRecord) -> f64,
    /// Indices of the algorithms; the last is drawn on top.
    algorithms: &'static [usize],
}

const METHODS: &[usize] = &[VFC, NOHC, DUAL, OPT, CHC, PLUS_PLUS];
/// From CHC to CHC++.
const ABLATION: &[usize] = &[1, 3, 4, 5, 6, 7];

const FRAME_TIME: Figure = Figure {
    title: "Frame time of CHC++, of what it is compared with, and of what it is made of",
    panels: [
        Panel { title: "methods", unit: "milliseconds", value: |f| f.frame_ms, algorithms: METHODS },
        Panel { title: "ablation", unit: "milliseconds", value: |f| f.frame_ms, algorithms: ABLATION },
    ],
};

const QUESTIONS: Figure = Figure {
    title: "What CHC++ saves of CHC: questions, and changes between drawing and asking",
    panels: [
        Panel { title: "questions", unit: "a frame", value: |f| f.queries.into(), algorithms: ABLATION },
        Panel {
            title: "state changes",
            unit: "a frame",
            value: |f| f.state_changes.into(),
            algorithms: ABLATION,
        },
    ],
};

/// Draws both figures.
pub fn write(output: &Output, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
    for (figure, ending) in [(FRAME_TIME, "_frame_time.png"), (QUESTIONS, "_questions.png")] {
        figure.save(output, ending, flags, outcomes)?;
    }
    Ok(())
}

impl Figure {
    fn save(&self, output: &Output, ending: &str, flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<()> {
        let shown = |n: usize| self.panels.iter().any(|panel| panel.algorithms.contains(&n));
        let keys: Vec<Key> = ALGORITHMS
            .iter()
            .enumerate()
            .filter(|&(n, _)| shown(n))
            .map(|(_, algorithm)| Key::new(algorithm.color, algorithm.name))
            .collect();
        let (width, height) = flags.size;
        let subtitle = format!(
            "city at scale {} · {} frames a scene · software queries · {width} × {height} · seed {}",
            flags.scale, flags.frames, flags.seed
        );
        let size = (WIDTH, ABOVE + PANEL_HEIGHT * outcomes.len() as u32);
        canvas::save(&output.file(ending), size, |sheet| {
            let below = canvas::heading(sheet, self.title, &subtitle, &keys)?;
            let cells = below.split_evenly((outcomes.len(), self.panels.len()));
            let panels = outcomes.iter().flat_map(|o| self.panels.iter().map(move |panel| (o, panel)));
            for (cell, (outcome, panel)) in cells.iter().zip(panels) {
                panel.draw(cell, outcome)?;
            }
            Ok(())
        })
    }
}

impl Panel {
    fn draw(&self, cell: &Sheet<'_>, outcome: &Outcome) -> anyhow::Result<()> {
        let area = panel(cell, &format!("{}: {}", outcome.name, self.title))?;
        let curve = |&n: &usize| {
            let values = outcome.lanes[n].frames.iter().map(self.value).collect();
            Curve { values, color: ALGORITHMS[n].color, width: 2 }
        };
        let curves: Vec<Curve> = self.algorithms.iter().map(curve).collect();
        let range = chart::log_range(&curves);
        let frames = outcome.lanes[VFC].frames.len();
        let mut chart = log_axes(&area, frames, range.clone(), self.unit)?;
        chart::draw(&mut chart, range, &curves)
    }
}
