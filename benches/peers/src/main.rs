//! The tree of tercet beside other crates' trees: the same boxes, moves and frustums, in turns in
//! one process, and the same objects found, which is checked. Prints a table, and writes it beside a
//! plot under `out/peers`.
//!
//! `cargo run --release --manifest-path benches/peers/Cargo.toml [-- --quick]`

mod plot;
mod trees;

#[path = "../../../examples/support/axis.rs"]
#[expect(dead_code, reason = "shared with the examples, which need more of it")]
mod axis;
#[path = "../../../examples/support/canvas.rs"]
mod canvas;

#[path = "../../tree_maintenance/clock.rs"]
mod clock;
#[path = "../../tree_maintenance/workload.rs"]
mod workload;
#[path = "../../tree_maintenance/yardstick.rs"]
#[expect(dead_code, reason = "shared with the bench of the tree, which needs more of it")]
mod yardstick;

use std::path::Path;

use clock::{median, seconds};
use trees::Peer;
use workload::{Manner, Workload};
use yardstick::Scan;

/// The columns of the table.
const NAMES: [&str; 6] = ["boxes", "tree", "update / write", "wide / scan", "mid / scan", "near / scan"];

fn main() -> anyhow::Result<()> {
    let out = Path::new("out/peers");
    std::fs::create_dir_all(out)?;
    let mut csv = csv::Writer::from_path(out.join("table.csv"))?;
    csv.write_record(NAMES)?;
    let quick = std::env::args().any(|argument| argument == "--quick");
    let counts: &[usize] = if quick { &[2_500] } else { &[13_550, 100_000, 1_000_000] };
    println!("| {} |\n|{}", NAMES.join(" | "), "---|".repeat(NAMES.len()));
    let mut rows = Vec::new();
    for &count in counts {
        let frames = if quick || count >= 1_000_000 { 10 } else { 40 };
        let mut all = Vec::new();
        for row in [
            run::<trees::tercet::Tercet>("tercet", count, frames),
            run::<trees::parry::Parry>("parry3d", count, frames),
            run::<trees::obvhs::Obvhs>("obvhs", count, frames),
            run::<trees::bvh::Bvh>("bvh", count, frames.min(5)),
            run::<trees::rstar::Rstar>("rstar", count, frames.min(5)),
        ] {
            let cells = row.cells();
            println!("| {} |", cells.join(" | "));
            csv.write_record(&cells)?;
            all.push(row.checksum);
            rows.push(row);
        }
        // Trees that ran for fewer frames stand elsewhere: they are compared at their last common one.
        assert!(all.iter().all(|sum| sum == &all[0]), "every tree finds the same objects: {all:?}");
    }
    csv.flush()?;
    plot::ratios(&out.join("plot.png"), &rows)
}

/// One tree: ratios of medians, and what it found in the fifth frame.
struct Row {
    name: &'static str,
    count: usize,
    update: f64,
    query: [f64; 3],
    checksum: [(usize, u64); 3],
}

impl Row {
    fn cells(&self) -> [String; 6] {
        let [wide, mid, near] = self.query.map(|ratio| format!("{ratio:.2}"));
        [self.count.to_string(), self.name.to_owned(), format!("{:.1}", self.update), wide, mid, near]
    }

    /// The ratios, in the order of the columns.
    fn ratios(&self) -> [f64; 4] {
        [self.update, self.query[0], self.query[1], self.query[2]]
    }
}

/// Half of the boxes move.
fn run<P: Peer>(name: &'static str, count: usize, frames: usize) -> Row {
    let mut load = Workload::new(count, 0.5, Manner::USUAL);
    let views = load.views().map(|(_, view)| view);
    let mut tree = P::new(&load.boxes);
    let (mut writes, mut updates) = (Vec::new(), Vec::new());
    let (mut scans, mut queries) = ([const { Vec::new() }; 3], [const { Vec::new() }; 3]);
    let mut checksum = [(0, 0); 3];
    let mut found = Vec::new();
    for frame in 0..frames {
        writes.push(seconds(1, || load.step()));
        updates.push(seconds(1, || tree.update(load.moved())));
        for (i, view) in views.iter().enumerate() {
            let mut scan = Scan::new(&load.boxes);
            scans[i].push(seconds(2, || scan.run(view)));
            queries[i].push(seconds(2, || {
                found.clear();
                tree.query(view, &mut found);
            }));
            if frame == 4 {
                checksum[i] = sum(&found);
            }
        }
    }
    let ratio = |a: &[f64], b: &[f64]| median(a) / median(b);
    Row {
        name,
        count,
        update: ratio(&updates, &writes),
        query: [0, 1, 2].map(|i| ratio(&queries[i], &scans[i])),
        checksum,
    }
}

/// Tells sets of objects apart, in whatever order they were found.
fn sum(found: &[u32]) -> (usize, u64) {
    let mixed =
        found.iter().map(|&n| (u64::from(n) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(n % 61));
    (found.len(), mixed.fold(0, u64::wrapping_add))
}
