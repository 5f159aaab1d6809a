//! The figures as tables: `dial_sweep.csv` and `dial_sweep.md`.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use crate::outcome::Outcome;
use crate::plan::{Plan, Point};
use support::flags::Flags;
use support::markdown::{command, known, percent, ratio, table};
use support::report::{round, write_csv};
use support::table::count;

/// A line of `dial_sweep.csv`: means a frame, unless it says otherwise. The oracle's figures are
/// empty without `--oracle`.
#[derive(Debug, Serialize)]
struct Row<'a> {
    world: &'a str,
    dial: &'a str,
    value: &'a str,
    /// Whether it is the base's value.
    base: bool,
    drawn: f64,
    box_visible: Option<f64>,
    /// A total.
    false_culls: Option<u64>,
    drawn_triangles: f64,
    median_ms: f64,
    mean_ms: f64,
    tree_ms: f64,
    /// The tree's time over all time, 0 to 1.
    maintenance_share: f64,
    queries: f64,
    waves: f64,
    /// After the last frame.
    nodes: usize,
    splits: f64,
    merges: f64,
    flips: f64,
    /// Drawn over the base's.
    drawn_ratio: f64,
    /// Time over the base's: the median of the ratios frame by frame.
    time_ratio: f64,
}

/// Writes both files into a folder that exists.
pub fn write(out: &Path, flags: &Flags, plan: &Plan, outcomes: &[Outcome]) -> anyhow::Result<()> {
    let rows = outcomes.iter().flat_map(|outcome| {
        plan.sweeps.iter().flat_map(move |sweep| sweep.points.iter().map(|p| row(outcome, sweep.dial, p)))
    });
    write_csv(&out.join("dial_sweep.csv"), rows)?;
    let path = out.join("dial_sweep.md");
    fs::write(&path, page(flags, plan, outcomes)).with_context(|| format!("cannot write {}", path.display()))
}

fn row<'a>(outcome: &'a Outcome, dial: &'a str, point: &'a Point) -> Row<'a> {
    let s = outcome.summary(point.tree);
    Row {
        world: &outcome.name,
        dial,
        value: &point.value,
        base: point.tree == 0,
        drawn: s.drawn.mean,
        box_visible: s.box_visible.map(|m| m.mean),
        false_culls: s.false_culls,
        drawn_triangles: s.drawn_triangles.mean,
        median_ms: s.frame_ms.median,
        mean_ms: s.frame_ms.mean,
        tree_ms: s.stage_ms.tree,
        maintenance_share: s.tree.maintenance_share,
        queries: s.queries.mean,
        waves: s.waves.mean,
        nodes: s.tree.nodes,
        splits: s.tree.splits,
        merges: s.tree.merges,
        flips: s.tree.flips,
        drawn_ratio: round(outcome.drawn_of_base(point.tree)),
        time_ratio: round(outcome.time_of_base(point.tree)),
    }
}

fn page(flags: &Flags, plan: &Plan, outcomes: &[Outcome]) -> String {
    let (width, height) = flags.size;
    let mut page = format!(
        "# The dials of the tree\n\n`{}`\n\n\
         One dial is turned at a time; the others keep the base's values. The base's rows are bold. Policy {}, \
         software backend, {} frames, {width} × {height}. All trees fly through the same world at the same time, \
         frame by frame, in an order that changes. Times are this \
         machine's; counts hardly depend on it: only `n_skip=auto` and `leaf_size=costs` weigh the times seen.\n\nThe base: {}.\n\n\
         *Drawn*, *queries*, *waves* and *split + merged* (with those undone soon after, the *flips*) are means a \
         frame; *nodes* is the number after the last one. *Tree's share* is the time for keeping the tree over all \
         time. *Of base* is a figure over the base's; for times, the median of the ratios frame by frame.\n",
        command("dial_sweep"),
        flags.policy,
        flags.frames,
        base(plan),
    );
    for outcome in outcomes {
        let _ = write!(page, "\n## {}\n\n{}{}", outcome.name, noise(outcome), world(plan, outcome));
    }
    page
}

/// The base's dials in words.
fn base(plan: &Plan) -> String {
    let dials = plan.trees[0].dials();
    dials.iter().map(|dial| format!("`{}={}`", dial.key, dial.value)).collect::<Vec<_>>().join(", ")
}

/// How far to trust the figures.
fn noise(outcome: &Outcome) -> String {
    let lost = outcome.false_culls().map(|n| format!(" Objects wrongly culled, all trees together: {n}."));
    format!(
        "The base ran {} times. Its copies differed by up to {} in time and {} in objects drawn: smaller effects \
         are noise.{}\n\n",
        Plan::COPIES,
        percent(outcome.time_noise()),
        percent(outcome.drawn_noise()),
        lost.unwrap_or_default()
    )
}

fn world(plan: &Plan, outcome: &Outcome) -> String {
    const HEADER: [&str; 12] = [
        "dial",
        "value",
        "drawn",
        "of base",
        "of box visible",
        "median ms",
        "of base",
        "queries",
        "waves",
        "nodes",
        "split + merged (flips)",
        "tree's share",
    ];
    let rows = plan.sweeps.iter().flat_map(|sweep| {
        sweep.points.iter().map(|point| {
            let mut cells = vec![sweep.dial.to_owned(), point.value.clone()];
            cells.extend(figures(outcome, point.tree));
            if point.tree == 0 {
                cells.iter_mut().for_each(|cell| *cell = format!("**{cell}**"));
            }
            cells
        })
    });
    table(&HEADER, rows)
}

fn figures(outcome: &Outcome, tree: usize) -> [String; 10] {
    let s = outcome.summary(tree);
    [
        count(s.drawn.mean),
        format!("{:.2}", outcome.drawn_of_base(tree)),
        known(s.box_visible.map(|m| ratio(s.drawn.mean, m.mean))),
        format!("{:.1}", s.frame_ms.median),
        format!("{:.2}", outcome.time_of_base(tree)),
        count(s.queries.mean),
        format!("{:.1}", s.waves.mean),
        count(s.tree.nodes as f64),
        format!("{:.1} ({:.1})", s.tree.splits + s.tree.merges, s.tree.flips),
        percent(s.tree.maintenance_share),
    ]
}
