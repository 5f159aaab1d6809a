//! What is measured of each walk: one line of the table each.

use serde::Serialize;

use super::TreeKind;
use super::walks::Walk;
use support::lockstep::Measured;
use support::report::{FrameRecord, percentile, round};

/// A line of `bh2001.csv`: means a frame, unless it says otherwise. The first frame of a walk, which
/// has nothing to remember, is left out.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Point {
    pub walk: &'static str,
    pub tree: &'static str,
    pub algorithm: &'static str,
    pub p_skip: Option<f32>,
    /// To the speed of the table.
    pub speed: f64,
    /// Metres from frame to frame.
    pub step: f64,
    pub frames: usize,
    pub questions: f64,
    /// The share of A's questions, 0 to 1.
    pub saved: f64,
    pub opened_unasked: f64,
    pub propagated_nodes: f64,
    pub skipped_tests: f64,
    pub pull_ups: f64,
    pub drawn: f64,
    /// Over A's.
    pub drawn_of_a: f64,
    pub median_ms: f64,
    /// Time over A's: the median of the ratios frame by frame.
    pub time_of_a: f64,
    /// After the last frame.
    pub nodes: usize,
    /// A total, the first frame's included; empty without `--oracle`.
    pub false_culls: Option<u64>,
}

impl Point {
    /// Whether it is at the speed and with the `p_skip` of the table.
    pub fn is_of_table(&self) -> bool {
        self.speed == 1.0 && self.has_default_p_skip()
    }

    /// Whether no `p_skip` but the table's was set.
    pub fn has_default_p_skip(&self) -> bool {
        self.p_skip.is_none_or(|p_skip| p_skip == super::P_SKIP[0])
    }
}

/// The points of a walk on a tree.
pub fn of(points: &[Point], walk: Walk, tree: TreeKind) -> impl Iterator<Item = &Point> {
    points.iter().filter(move |point| point.walk == walk.name && point.tree == tree.name)
}

/// D's points at the speed of the table, by `p_skip`.
pub fn by_p_skip(points: &[Point], walk: Walk, tree: TreeKind) -> Vec<(f32, &Point)> {
    let at_table_speed = of(points, walk, tree).filter(|point| point.speed == 1.0);
    let mut all: Vec<(f32, &Point)> = at_table_speed.filter_map(|p| Some((p.p_skip?, p))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// The figures of a lane, beside those of A. What was run is for the caller to fill in.
pub fn measure(lane: &Measured, a: &Measured) -> Point {
    let questions = |of: &Measured| mean(of, |f| f.queries.into());
    let drawn = |of: &Measured| mean(of, |f| f.drawn.into());
    let of_a = |figure: &dyn Fn(&Measured) -> f64| round(figure(lane) / figure(a).max(f64::MIN_POSITIVE));
    let counter = |key: &'static str| mean(lane, |f| count(f, key));
    let times: Vec<f64> = lane.times().skip(1).collect();
    Point {
        frames: times.len(),
        questions: questions(lane),
        saved: round(1.0 - of_a(&questions)),
        opened_unasked: counter("opened_unasked"),
        propagated_nodes: counter("propagated_nodes"),
        skipped_tests: counter("skipped_tests"),
        pull_ups: counter("pull_ups"),
        drawn: drawn(lane),
        drawn_of_a: of_a(&drawn),
        median_ms: percentile(&times, 50.0),
        time_of_a: round(lane.time_over(a.times())),
        nodes: lane.summary.tree.nodes,
        false_culls: lane.summary.false_culls,
        ..Point::default()
    }
}

/// Over all frames but the first.
fn mean(lane: &Measured, of: impl Fn(&FrameRecord) -> f64) -> f64 {
    let later = lane.frames.iter().skip(1);
    round(later.clone().map(of).sum::<f64>() / later.count().max(1) as f64)
}

/// What the policy counted itself in a frame.
fn count(frame: &FrameRecord, key: &str) -> f64 {
    frame.counters.iter().find(|counter| counter.key == key).map_or(0.0, |counter| counter.count.into())
}
