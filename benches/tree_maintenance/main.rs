//! What the tree costs to maintain and to ask, beside what nobody can do without.
//!
//! In one process, in turns, frame by frame: *write* (the app stores its movers' new boxes and
//! velocities), *copy* (of all boxes), *scan* (all boxes against a frustum, sixteen at a time),
//! *reads* (half a line of memory for each mover, in no order), and the tree with everything on:
//! edits, placement, refit, settling, adaptation. Times are those of the thread alone. Prints
//! tables of ratios of medians, by number, by manner of moving, of the mirror of a world, and of
//! two threads by the wall's clock; writes them as CSV, and plots.
//!
//! `cargo bench --bench tree_maintenance [-- --quick] [-- --count N] [-- --moving SHARE]
//! [-- --frames N] [-- --part number|manner|sync|threads] [-- --out DIR]`

#[path = "../../examples/support/axis.rs"]
mod axis;
#[path = "../../examples/support/canvas.rs"]
mod canvas;
mod clock;
mod measure;
mod plot;
mod sync;
mod table;
mod threads;
mod workload;
mod yardstick;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Parser;
use measure::{Asking, Case, Row};
use table::Table;
use workload::Manner;

#[derive(Parser)]
struct Flags {
    /// Small workloads and few frames: does it run at all?
    #[arg(long)]
    quick: bool,
    /// Only worlds of so many boxes.
    #[arg(long)]
    count: Option<usize>,
    /// Only this share of the boxes moves.
    #[arg(long)]
    moving: Option<f64>,
    /// Frames of each world, instead of as many as its number of boxes suggests.
    #[arg(long)]
    frames: Option<NonZeroUsize>,
    /// Only this table.
    #[arg(long)]
    part: Option<Part>,
    /// Where the tables and plots go.
    #[arg(long, default_value = "out/tree_maintenance")]
    out: PathBuf,
    /// What cargo says to every bench.
    #[arg(long, hide = true)]
    bench: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Part {
    Number,
    Manner,
    Sync,
    Threads,
}

fn main() -> anyhow::Result<()> {
    let flags = Flags::parse();
    std::fs::create_dir_all(&flags.out)?;
    // Times are the thread's own: nobody may help it.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    alone.install(|| measure_all(&flags))
}

fn measure_all(flags: &Flags) -> anyhow::Result<()> {
    let counts = match flags.count {
        Some(count) => vec![count],
        None if flags.quick => vec![2_500, 13_550],
        None => vec![2_500, 13_550, 100_000, 1_000_000],
    };
    let measured = |name: &str, count: usize, moving, manner, asking| {
        // Queries come every eighth frame and empty the caches: a tenth of the frames is whole rounds of
        // eight, or what is said of ageing compares frames after queries with others.
        let usual = if flags.quick { 20 } else { (40_000_000 / count).clamp(160, 2000) };
        let frames = flags.frames.map_or(usual, NonZeroUsize::get);
        let runs = if flags.quick { 1 } else { (3_000_000 / count).clamp(1, 3) };
        measure::run(Case { name: name.to_owned(), count, moving, manner, asking, frames, runs })
    };

    let wanted = |part| flags.part.is_none_or(|only| only == part);
    let large = || counts.iter().copied().filter(|&count| count >= 100_000 || flags.quick);

    if wanted(Part::Number) {
        let mut table = Table::new(&flags.out.join("table.csv"), &table::BY_NUMBER)?;
        let mut rows: Vec<Row> = Vec::new();
        for &count in &counts {
            for moving in flags.moving.map_or(vec![0.0, 0.2, 0.5, 1.0], |share| vec![share]) {
                let row = measured("usual", count, moving, Manner::USUAL, Asking::Nobody);
                table.add(table::by_number(&row))?;
                rows.push(row);
            }
        }
        plot::by_number(&flags.out.join("plot.png"), &rows)?;
    }
    if wanted(Part::Manner) {
        let mut table = Table::new(&flags.out.join("manners.csv"), &table::BY_MANNER)?;
        let mut rows: Vec<Row> = Vec::new();
        let usual = Manner::USUAL;
        for (name, manner, asking) in [
            ("usual", usual, Asking::Nobody),
            ("slow: 0.01 m", Manner { step: 0.01, ..usual }, Asking::Nobody),
            ("fast: 0.5 m", Manner { step: 0.5, ..usual }, Asking::Nobody),
            ("gathered", Manner { gathered: true, ..usual }, Asking::Nobody),
            ("large: 0.5 to 5 m", Manner { extent: 5.0, ..usual }, Asking::Nobody),
            ("fine leaves", usual, Asking::Once),
            ("fine, adapting", usual, Asking::EachFrame),
        ] {
            let row = measured(name, counts[counts.len().min(2) - 1], 0.5, manner, asking);
            table.add(table::by_manner(&row))?;
            rows.push(row);
        }
        plot::by_manner(&flags.out.join("manners.png"), &rows)?;
    }
    if wanted(Part::Sync) {
        let mut table = Table::new(&flags.out.join("sync.csv"), &sync::NAMES)?;
        for count in large() {
            table.add(sync::cells(count))?;
        }
    }
    if wanted(Part::Threads) {
        let mut table = Table::new(&flags.out.join("threads.csv"), &threads::NAMES)?;
        for (count, moving) in large().flat_map(|count| [(count, 0.2), (count, 1.0)]) {
            table.add(threads::cells(count, moving)?)?;
        }
    }
    Ok(())
}
