//! `bh2001.md`: the tables, to be read.

use super::points::{self, Point};
use super::walks::{WALKS, Walk};
use super::{SPEEDS, TREES, TreeKind};
use support::flags::Flags;
use support::markdown::{command, known, percent, setting, table};
use support::table::count;

/// The whole page.
pub fn page(flags: &Flags, points: &[Point]) -> anyhow::Result<String> {
    Ok(format!(
        "# Questions saved by coherence (Bittner and Havran 2001), measured again\n\n{}\n\n{COLUMNS}\n\n{}\n\
         ## Against the speed of the walk\n\n{}\n{}\n\
         ## Against `p_skip`\n\n{P_SKIP}\n\n{}\n{NOTES}{}",
        introduction(flags)?,
        all_trees(|walk, tree| algorithms(points, walk, tree), &ALGORITHMS),
        speeds_said(points),
        speeds(points),
        all_trees(|walk, tree| p_skips(points, walk, tree), &P_SKIPS),
        lost(points)
    ))
}

const COLUMNS: &str = "\
*Saved* is the share of A's questions; the paper's two scenes stand beside our two worlds. The figures are \
means a frame, but for the first frame of a walk, which has nothing to remember. *Opened unasked* are the \
nodes that were opened in the frame before, *propagated* those that their neighbours speak for, *skipped* \
those that were visible and are taken as such, *pulled up* those that all their children make one.";

const P_SKIP: &str = "\
The probability that D does not ask about a node at which the walk of the frame before ended, and which was \
visible there or in part. The paper's best are 0.5 and 0.6. What was hidden is asked about in any case.";

const NOTES: &str = "\
- Trees: cells halved along their longest side, questions about cells. In the binary tree straddlers stay in \
inner nodes; in the ternary tree they are a third child, so that opened nodes, which B does not ask about, \
are at most a third of those visited. Of those asked about they can be more: nobody asks about a child \
without objects.
- The paper's scenes are not ours: its first figure stands beside the plant, its second beside the city. \
Few cells of ours are hidden as a whole, so propagation, which needs such cells to prove anything, adds \
little to B.
- Times are those of this machine, which draws and answers on the CPU. Counts do not depend on it.
";

fn introduction(flags: &Flags) -> anyhow::Result<String> {
    Ok(format!(
        "`{}`\n\nScale {}, {}. A is the classical algorithm, which asks about every node on its way; B leaves \
         out the nodes opened in the frame before; C asks the neighbours first (`p_vp` 0.5); D takes what was \
         visible as such with probability `p_skip` (0.6). All walk the same way at the same time, in {} steps.",
        command("paper_tables"),
        flags.scale,
        setting(flags)?,
        flags.frames
    ))
}

/// A table with some rows of each walk and tree.
fn all_trees(rows: impl Fn(Walk, TreeKind) -> Vec<Vec<String>>, header: &[&str]) -> String {
    let both = WALKS.into_iter().flat_map(|walk| TREES.into_iter().map(move |tree| (walk, tree)));
    table(header, both.flat_map(|(walk, tree)| rows(walk, tree)))
}

const ALGORITHMS: [&str; 13] = [
    "world",
    "tree",
    "algorithm",
    "questions",
    "saved",
    "paper",
    "opened unasked",
    "propagated",
    "skipped",
    "pulled up",
    "drawn",
    "median ms",
    "wrongly culled",
];

/// The main table.
fn algorithms(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<Vec<String>> {
    // Of B, C and D, on binary trees.
    let papers = [None].into_iter().chain(walk.published.map(|share| tree.is_binary().then_some(share)));
    let of_table = points::of(points, walk, tree).filter(|point| point.is_of_table());
    let row = |(point, paper): (&Point, Option<f64>)| {
        vec![
            walk.name.to_owned(),
            tree.name.to_owned(),
            point.algorithm.to_owned(),
            count(point.questions),
            known((point.algorithm != "A").then(|| format!("**{}**", percent(point.saved)))),
            known(paper.map(|share| format!("{:.0} %", 100.0 * share))),
            count(point.opened_unasked),
            count(point.propagated_nodes),
            count(point.skipped_tests),
            count(point.pull_ups),
            count(point.drawn),
            format!("{:.1}", point.median_ms),
            known(point.false_culls.map(|n| n.to_string())),
        ]
    };
    of_table.zip(papers).map(row).collect()
}

/// How fast speed 1 is.
fn speeds_said(points: &[Point]) -> String {
    let step = |walk: &Walk| {
        let point = points.iter().find(|point| point.walk == walk.name && point.speed == 1.0);
        format!("{:.2} m in the {}", point.map_or(0.0, |point| point.step), walk.name)
    };
    let steps: Vec<String> = WALKS.iter().map(step).collect();
    format!(
        "The same way in more or fewer frames. At speed 1 the eye moves {} from frame to frame. The share of \
         A's questions that is saved:\n",
        steps.join(", ")
    )
}

/// A row a walk, tree and algorithm; a column a speed.
fn speeds(points: &[Point]) -> String {
    let speeds: Vec<String> = SPEEDS.iter().map(|speed| format!("{speed}")).collect();
    let header: Vec<&str> =
        ["world", "tree", "algorithm"].into_iter().chain(speeds.iter().map(String::as_str)).collect();
    let rows = |walk: Walk, tree: TreeKind| {
        let row = |algorithm: &str| {
            let of_row = points::of(points, walk, tree)
                .filter(|point| point.algorithm == algorithm && point.has_default_p_skip());
            let names = [walk.name, tree.name, algorithm].map(str::to_owned);
            names.into_iter().chain(of_row.map(|point| percent(point.saved))).collect()
        };
        ["B", "C", "D"].map(row).to_vec()
    };
    all_trees(rows, &header)
}

const P_SKIPS: [&str; 7] = ["world", "tree", "`p_skip`", "questions", "saved", "drawn, of A", "time, of A"];

/// A row a `p_skip`.
fn p_skips(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<Vec<String>> {
    let row = |(p_skip, point): (f32, &Point)| {
        vec![
            walk.name.to_owned(),
            tree.name.to_owned(),
            p_skip.to_string(),
            count(point.questions),
            percent(point.saved),
            format!("{:.2}", point.drawn_of_a),
            format!("{:.2}", point.time_of_a),
        ]
    };
    points::by_p_skip(points, walk, tree).into_iter().map(row).collect()
}

fn lost(points: &[Point]) -> String {
    match points.iter().map(|point| point.false_culls).sum::<Option<u64>>() {
        Some(lost) => format!("- Objects wrongly culled in all walks: {lost}.\n"),
        None => "- Whether an object was wrongly culled is known with `--oracle`.\n".to_owned(),
    }
}
