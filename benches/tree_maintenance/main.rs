//! What the tree costs to maintain and to ask, beside what nobody can do without.
//!
//! In one process, in turns, frame by frame: *write* (the app stores its movers' new boxes and
//! velocities), *copy* (of all boxes), *scan* (all boxes against a frustum, sixteen at a time), and
//! the tree with everything on: edits, placement, refit, settling, adaptation. Times are those of
//! the thread alone. Prints a table of ratios of medians; writes it as CSV, and a plot.
//!
//! `cargo bench --bench tree_maintenance [-- --quick] [-- --out DIR]`

#[path = "../../examples/support/canvas.rs"]
mod canvas;
#[path = "../../examples/support/chart.rs"]
#[expect(dead_code, reason = "shared with the examples, which need more of it")]
mod chart;
mod clock;
mod measure;
mod plot;
mod workload;
mod yardstick;

use std::path::PathBuf;

use clap::Parser;
use measure::Row;
use tercet::tree::TreeConfig;

#[derive(Parser)]
struct Flags {
    /// Two small workloads and few frames: does it run at all?
    #[arg(long)]
    quick: bool,
    /// Only so many boxes.
    #[arg(long)]
    count: Option<usize>,
    /// Only this share of movers.
    #[arg(long)]
    moving: Option<f64>,
    /// Where table.csv and plot.png go.
    #[arg(long, default_value = "out/tree_maintenance")]
    out: PathBuf,
    /// What cargo says to every bench.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> anyhow::Result<()> {
    let flags = Flags::parse();
    let counts: &[usize] = if flags.quick { &[2_500, 13_550] } else { &[2_500, 13_550, 100_000, 1_000_000] };
    std::fs::create_dir_all(&flags.out)?;
    let mut csv = csv::Writer::from_path(flags.out.join("table.csv"))?;
    csv.write_record(Row::NAMES)?;
    println!("| {} |\n|{}", Row::NAMES.join(" | "), "---|".repeat(Row::NAMES.len()));
    let mut rows = Vec::new();
    for &count in counts.iter().filter(|&&n| flags.count.is_none_or(|only| only == n)) {
        for moving in [0.0, 0.2, 0.5, 1.0].into_iter().filter(|&m| flags.moving.is_none_or(|only| only == m)) {
            let frames = if flags.quick { 20 } else { (40_000_000 / count).clamp(60, 2000) };
            let mut tc=TreeConfig::default(); if let Ok(v)=std::env::var("UL"){tc.unasked_leaf=v.parse()?;} let row = measure::run(count, moving, frames, tc);
            println!("| {} |", row.cells().join(" | "));
            csv.write_record(row.cells())?;
            rows.push(row);
        }
    }
    csv.flush()?;
    plot::save(&flags.out.join("plot.png"), &rows)
}
