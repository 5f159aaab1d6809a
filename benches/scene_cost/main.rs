//! Is only paid for what a scene has? Worlds that lack something, beside worlds or policies that know nothing
//! of it: the median ratio of their frames' times with a 95 % confidence interval, of pairs of frames and of
//! blocks of 32 pairs; and exact counts of a frame of each. On the software backend.
//!
//! ```text
//! cargo bench --bench scene_cost
//! cargo bench --bench scene_cost -- views       # rows with this in their name: only these
//! ```

#[path = "../../tests/support/boxes.rs"]
mod boxes;
#[path = "../gate/interval.rs"]
mod interval;
mod lane;

use std::alloc::System;
use std::env;
use std::time::Instant;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

use interval::Ratio;
use lane::{Extra, Lane, Setup, Upkeep};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// What counts as no slower.
const SAME: f64 = 1.03;
/// Pairs of frames that are not counted: lists grow, and histories begin.
const WARM_UP: usize = 200;
const PAIRS: usize = 1600;
/// Seconds after which no more pairs are run.
const PATIENCE: f32 = 20.0;

/// Two ways of having a frame, of which the first should take no longer.
struct Row {
    name: &'static str,
    one: Setup,
    other: Setup,
}

fn rows() -> Vec<Row> {
    let bare = Setup::default();
    let row = |name, one, other| Row { name, one, other };
    let mut rows = vec![
        row("a world beside itself: how far the clock is to be trusted", bare, bare),
        row(
            "empty: `dual-query` beside `frustum`",
            Setup { objects: 0, ..bare },
            Setup { objects: 0, policy: "frustum", ..bare },
        ),
        row(
            "static only: `update` and `adapt` every frame, beside neither",
            Setup { upkeep: Upkeep::Update, ..bare },
            Setup { upkeep: Upkeep::Nothing, ..bare },
        ),
        row(
            "static only: `sync`, which looks for changes, beside `update`",
            bare,
            Setup { upkeep: Upkeep::Update, ..bare },
        ),
        row(
            "static only: `hybrid`, which sweeps movers apart, beside `hroc`",
            Setup { policy: "hybrid", ..bare },
            Setup { policy: "hroc", ..bare },
        ),
        row(
            "movers only: `hybrid` beside `roc`, which knows no groups",
            Setup { policy: "hybrid", moving: true, ..bare },
            Setup { policy: "roc", moving: true, ..bare },
        ),
        row(
            "nothing hidden: gated `dual-query` beside `frustum`",
            Setup { wall: false, gated: true, ..bare },
            Setup { wall: false, policy: "frustum", ..bare },
        ),
        row("four views, each, beside one view", Setup { views: 4, ..bare }, bare),
        row(
            "one view that looks for cuts, beside one that does not",
            Setup { detects_cuts: true, ..bare },
            bare,
        ),
    ];
    for (extra, name) in Extra::ALL {
        rows.push(row(name, Setup { extra: Some(extra), ..bare }, bare));
    }
    rows
}

fn main() {
    let only: Vec<String> = env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!(
        "| this, beside that | passes | questions | boxes | allocations | µs | pairs | blocks | at most 3 % slower |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    // Threads that hand work to each other take time and memory that are not ours.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    for Row { name, one, other } in rows() {
        if only.is_empty() || only.iter().any(|only| name.contains(only.as_str())) {
            pool.install(|| compare(name, one, other));
        }
    }
}

/// Prints a row of the table.
fn compare(name: &str, one: Setup, other: Setup) {
    let (mut one, mut other) = (Lane::new(one), Lane::new(other));
    let (start, mut pairs, mut frames) = (Instant::now(), Vec::new(), 0);
    let mut allocations = [0, 0];
    let mut counted = |lane: usize, run: &mut dyn FnMut() -> f64| {
        let region = Region::new(ALLOCATOR);
        let taken = run();
        let change = region.change();
        // Of the last frame: lists have grown by then.
        allocations[lane] = change.allocations + change.reallocations;
        taken
    };
    while frames < WARM_UP + PAIRS && start.elapsed().as_secs_f32() < PATIENCE {
        // Each goes first in every other pair.
        let (a, b) = if frames % 2 == 0 {
            let a = counted(0, &mut || one.frame(frames));
            (a, counted(1, &mut || other.frame(frames)))
        } else {
            let b = counted(1, &mut || other.frame(frames));
            (counted(0, &mut || one.frame(frames)), b)
        };
        frames += 1;
        if frames > WARM_UP {
            pairs.push((a, b));
        }
    }
    let both = |of: fn(&Lane) -> u32| format!("{} beside {}", of(&one), of(&other));
    let counts =
        [both(|lane| lane.passes), both(|lane| lane.stats.queries), both(|lane| lane.stats.query_boxes)];
    let [counts_a, counts_b] = allocations;
    let ratio = Ratio::of(&pairs)
        .map_or("too slow here | – | –".to_owned(), |ratio| format!("{ratio} | {}", ratio.verdict(SAME)));
    let median = |of: fn(&(f64, f64)) -> f64| {
        let mut times: Vec<f64> = pairs.iter().map(of).collect();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).map_or(f64::NAN, |time| 1e6 * time)
    };
    let times = format!("{:.1} beside {:.1}", median(|pair| pair.0), median(|pair| pair.1));
    println!("| {name} | {} | {counts_a} beside {counts_b} | {times} | {ratio} |", counts.join(" | "));
}
