//! `chcpp_shading.png`: a frame's time, and its ratio to the view frustum's, by look-ups.

use super::{COMPARED, LOOK_UPS, Shaded};
use crate::chcpp::algorithms::ALGORITHMS;
use crate::output::Output;
use support::canvas::{self, Key, Sheet};
use support::chart::{decimals, panel};
use support::flags::Flags;
use support::lockstep::Measured;
use support::stage::Gpu;
use support::ticks::{Axes, Line};

const SIZE: (u32, u32) = (1200, 480);

/// What a panel shows of a lane.
type Value<'a> = &'a dyn Fn(&Shaded, &Measured) -> f64;

/// Draws it.
pub fn write(output: &Output, flags: &Flags, gpu: &Gpu, all: &[Shaded]) -> anyhow::Result<()> {
    let (width, height) = flags.size;
    let subtitle = format!(
        "city at scale {} · {} frames · {} · {width} × {height} · seed {}",
        flags.scale,
        flags.frames,
        gpu.adapter(),
        flags.seed
    );
    let keys: Vec<Key> =
        COMPARED.iter().map(|&n| Key::new(ALGORITHMS[n].color, ALGORITHMS[n].name)).collect();
    let title = "Shader complexity: texture look-ups a fragment";
    canvas::save(&output.file("_shading.png"), SIZE, |sheet| {
        let below = canvas::heading(sheet, title, &subtitle, &keys)?;
        let cells = below.split_evenly((1, 2));
        draw(&cells[0], "frame time", "milliseconds, median", all, &|_, lane| lane.summary.frame_ms.median)?;
        draw(&cells[1], "of the view frustum's", "ratio, median", all, &Shaded::over_vfc)
    })
}

/// A line an algorithm, over the numbers of look-ups side by side.
fn draw(cell: &Sheet<'_>, title: &str, unit: &str, all: &[Shaded], value: Value<'_>) -> anyhow::Result<()> {
    let line = |(nth, &n): (usize, &usize)| Line {
        color: ALGORITHMS[n].color,
        values: all.iter().map(|shaded| value(shaded, &shaded.lanes[nth])).collect(),
    };
    let lines: Vec<Line> = COMPARED.iter().enumerate().map(line).collect();
    let axes = Axes {
        x: "look-ups a fragment",
        y: unit,
        ticks: LOOK_UPS.iter().map(ToString::to_string).collect(),
        label: decimals,
        least_top: 0.0,
    };
    axes.draw(&panel(cell, title)?, &lines)
}
