//! `chcpp_shading.png`: a frame's time, and its ratio to the view frustum's, by look-ups.

use plotters::prelude::*;

use super::{COMPARED, LOOK_UPS, Shaded};
use crate::chcpp::algorithms::ALGORITHMS;
use crate::output::Output;
use support::axis::{nice_top, plain};
use support::canvas::{self, Key, Sheet, px};
use support::chart::panel;
use support::flags::Flags;
use support::lockstep::Measured;
use support::stage::Gpu;

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
    let area = panel(cell, title)?;
    let values = all.iter().flat_map(|shaded| shaded.lanes.iter().map(move |lane| value(shaded, lane)));
    let highest = values.fold(0.0, f64::max);
    let right = LOOK_UPS.len() as f64 - 0.5;
    let mut chart = ChartBuilder::on(&area)
        .margin(px(20))
        .margin_top(px(6))
        .x_label_area_size(px(44))
        .y_label_area_size(px(66))
        .build_cartesian_2d(-0.5..right, 0.0..nice_top(1.05 * highest))?;
    let tick = |x: &f64| {
        let at = (*x >= 0.0 && x.fract() == 0.0).then(|| LOOK_UPS.get(*x as usize)).flatten();
        at.map(ToString::to_string).unwrap_or_default()
    };
    plain(&mut chart.configure_mesh())
        .disable_x_mesh()
        .x_labels(LOOK_UPS.len() + 1)
        .x_desc("look-ups a fragment")
        .y_desc(unit)
        .x_label_formatter(&tick)
        .draw()?;
    for (nth, &n) in COMPARED.iter().enumerate() {
        let color = ALGORITHMS[n].color;
        let point = |(x, shaded): (usize, &Shaded)| (x as f64, value(shaded, &shaded.lanes[nth]));
        let points: Vec<(f64, f64)> = all.iter().enumerate().map(point).collect();
        chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(px(2) as u32)))?;
        chart.draw_series(points.iter().map(|&point| Circle::new(point, px(4), color.filled())))?;
    }
    Ok(())
}
