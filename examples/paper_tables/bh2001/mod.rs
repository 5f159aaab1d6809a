//! Bittner & Havran 2001: how many of the classical algorithm's questions (A) hierarchy updating (B)
//! saves, with visibility propagation (C), and with conservative updating (D); against the speed of
//! the walk, and against `p_skip`.
//!
//! On the paper's binary tree, and on the ternary tree, whose opened nodes are a smaller share of
//! those visited. All of a walk's algorithms run in lockstep.

mod figures;
mod markdown;
mod points;
mod walks;

use tercet::policy::{self, Policy};
use tercet::tree::{Straddlers, TreeConfig};

use crate::output::Output;
use points::Point;
use support::flags::Flags;
use support::lockstep::Lane;
use support::markdown::percent;
use support::report::write_csv;
use walks::{WALKS, Walk};

/// How much of the worlds is built, unless the command line says otherwise.
const SCALE: f32 = 0.1;

/// How fast the eye moves along the same way, to the speed of the table.
const SPEEDS: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];

/// Probabilities that D does not ask about a node that was visible; the first is the table's.
const P_SKIP: [f32; 7] = [0.6, 0.0, 0.2, 0.4, 0.5, 0.8, 0.9];

/// A way of building trees.
#[derive(Clone, Copy)]
pub struct TreeKind {
    /// In words.
    name: &'static str,
    straddlers: Straddlers,
}

const TREES: [TreeKind; 2] = [
    TreeKind { name: "binary", straddlers: Straddlers::StayInParent },
    TreeKind { name: "ternary", straddlers: Straddlers::Leaf },
];

/// Those of all algorithms.
pub const POLICIES: [&str; 4] = ["hierarchy-a", "hierarchy-b", "hierarchy-c", "hierarchy-d"];

/// What asks.
#[derive(Clone, Copy)]
struct Algorithm {
    /// A letter.
    name: &'static str,
    policy: &'static str,
    p_skip: Option<f32>,
}

/// Runs all walks and writes `bh2001.md`, a table and two figures into `--out`.
pub fn run(flags: &Flags) -> anyhow::Result<()> {
    flags.check_table(&POLICIES)?;
    let flags = &flags.with_default_scale(SCALE);
    let output = Output::new(flags, "bh2001", frames(flags))?;
    let mut points = Vec::new();
    for walk in WALKS {
        for tree in TREES {
            for speed in SPEEDS {
                points.extend(walk_at(&output, flags, walk, tree, speed)?);
            }
            let saved: Vec<String> =
                points::of(&points, walk, tree).filter(|p| p.is_of_table()).skip(1).map(saving).collect();
            output.say(&format!("{}, {} tree: {}", walk.name, tree.name, saved.join(", ")));
        }
    }

    write_csv(&output.file(".csv"), &points)?;
    figures::write(&output, flags, &points)?;
    output.finish(&markdown::page(flags, &points)?)
}

/// Walks the way once, all algorithms together.
fn walk_at(
    output: &Output,
    flags: &Flags,
    walk: Walk,
    tree: TreeKind,
    speed: f64,
) -> anyhow::Result<Vec<Point>> {
    let flags = &Flags { frames: walks::frames(flags, speed), ..flags.clone() };
    let algorithms = algorithms(speed);
    let lanes =
        algorithms.iter().map(|algorithm| algorithm.lane(flags, tree)).collect::<anyhow::Result<_>>()?;
    let scenario = walk.build(flags);
    let step = walks::step(&scenario.flight, flags);
    let lanes = output.run(scenario, flags, lanes)?;
    let point = |(algorithm, lane): (&Algorithm, &_)| Point {
        walk: walk.name,
        tree: tree.name,
        algorithm: algorithm.name,
        p_skip: algorithm.p_skip,
        speed,
        step,
        ..points::measure(lane, &lanes[0])
    };
    Ok(algorithms.iter().zip(&lanes).map(point).collect())
}

/// Of all lanes of all walks.
fn frames(flags: &Flags) -> u64 {
    let of_speed = |speed| u64::from(walks::frames(flags, speed)) * algorithms(speed).len() as u64;
    (WALKS.len() * TREES.len()) as u64 * SPEEDS.into_iter().map(of_speed).sum::<u64>()
}

/// A to D, and at the table's speed D with every `p_skip`. A is the first.
fn algorithms(speed: f64) -> Vec<Algorithm> {
    let plain = |name, policy| Algorithm { name, policy, p_skip: None };
    let d = |p_skip| Algorithm { name: "D", policy: "hierarchy-d", p_skip: Some(p_skip) };
    let p_skips = if speed == 1.0 { &P_SKIP[..] } else { &P_SKIP[..1] };
    let asking = [plain("A", "hierarchy-a"), plain("B", "hierarchy-b"), plain("C", "hierarchy-c")];
    asking.into_iter().chain(p_skips.iter().copied().map(d)).collect()
}

impl Algorithm {
    /// One that has seen nothing yet.
    fn lane(&self, flags: &Flags, tree: TreeKind) -> anyhow::Result<Lane> {
        let mut policy = policy::by_name(self.policy)?;
        flags.turn(&mut *policy)?;
        if let Some(p_skip) = self.p_skip {
            policy.set("p_skip", &p_skip.to_string())?;
        }
        Lane::new(flags, policy, tree.config(flags)?)
    }
}

impl TreeKind {
    fn is_binary(self) -> bool {
        self.straddlers == Straddlers::StayInParent
    }

    /// As published: propagation knows nothing of tighter boxes.
    fn config(self, flags: &Flags) -> anyhow::Result<TreeConfig> {
        flags.tree_from(TreeConfig { straddlers: self.straddlers, ..TreeConfig::binary() })
    }
}

/// For the line that is printed when a tree is done.
fn saving(point: &Point) -> String {
    format!("{} saves {}", point.algorithm, percent(point.saved))
}
