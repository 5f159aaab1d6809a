//! The figures as tables: a row a scene and algorithm.

use serde::Serialize;

use super::Outcome;
use super::algorithms::{ALGORITHMS, OPT};
use support::lockstep::Measured;
use support::report::round;

/// A line of `chcpp.csv`: means a frame, unless it says otherwise. The oracle's figures are empty
/// without `--oracle`, and what a policy does not count itself is.
#[derive(Debug, Serialize)]
pub struct Row<'a> {
    scene: &'static str,
    algorithm: &'static str,
    policy: &'a str,
    objects: usize,
    triangles: u64,
    frames: usize,
    median_ms: f64,
    mean_ms: f64,
    p99_ms: f64,
    /// Time over OPT's: the median of the ratios frame by frame.
    time_over_opt: f64,
    drawn: f64,
    drawn_triangles: f64,
    in_frustum: f64,
    queries: f64,
    query_boxes: f64,
    state_changes: f64,
    /// Times that a frame waits for answers.
    waits: f64,
    batches: Option<f64>,
    multiqueries: Option<f64>,
    failed_multiqueries: Option<f64>,
    pull_ups: Option<f64>,
    skipped_tests: Option<f64>,
    /// After the last frame.
    nodes: usize,
    exact_visible: Option<f64>,
    box_visible: Option<f64>,
    /// A total.
    false_culls: Option<u64>,
}

/// All runs of a scene, with the algorithms' names.
pub fn runs(outcome: &Outcome) -> impl Iterator<Item = (&str, &str, &Measured)> {
    ALGORITHMS.iter().zip(&outcome.lanes).map(|(algorithm, lane)| (outcome.name, algorithm.name, lane))
}

/// The rows of a scene.
pub fn rows(outcome: &Outcome) -> impl Iterator<Item = Row<'_>> {
    ALGORITHMS.iter().zip(&outcome.lanes).map(|(algorithm, lane)| {
        let s = &lane.summary;
        Row {
            scene: outcome.name,
            algorithm: algorithm.name,
            policy: &s.policy,
            objects: s.objects,
            triangles: s.triangles,
            frames: s.frames,
            median_ms: s.frame_ms.median,
            mean_ms: s.frame_ms.mean,
            p99_ms: s.frame_ms.p99,
            time_over_opt: round(lane.time_over(outcome.lanes[OPT].times())),
            drawn: s.drawn.mean,
            drawn_triangles: s.drawn_triangles.mean,
            in_frustum: s.in_frustum.mean,
            queries: s.queries.mean,
            query_boxes: s.query_boxes.mean,
            state_changes: s.state_changes.mean,
            waits: s.waves.mean,
            batches: lane.counter("batches"),
            multiqueries: lane.counter("multiqueries"),
            failed_multiqueries: lane.counter("failed_multiqueries"),
            pull_ups: lane.counter("pull_ups"),
            skipped_tests: lane.counter("skipped_tests"),
            nodes: s.tree.nodes,
            exact_visible: s.exact_visible.map(|m| m.mean),
            box_visible: s.box_visible.map(|m| m.mean),
            false_culls: s.false_culls,
        }
    })
}
