//! The figures as tables: a row a scene and algorithm.

use serde::Serialize;

use super::Outcome;
use super::algorithms;
use support::lockstep::Measured;
use support::report::round;

/// A line of `hroc.csv`: means a frame, unless it says otherwise.
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
    /// Time over REF's: the median of the ratios frame by frame.
    time_over_ref: f64,
    /// In the paper.
    published_time_over_ref: Option<f64>,
    drawn: f64,
    drawn_triangles: f64,
    in_frustum: f64,
    /// Of the objects that REF leaves out, the share left out.
    culled: f64,
    /// In the paper.
    published_culled: Option<f64>,
    /// The same of objects inside the frustum.
    culled_of_hidden: f64,
    /// Triangles drawn over REF's.
    overdraw: f64,
    queries: f64,
    /// A total; empty without `--oracle`.
    false_culls: Option<u64>,
}

/// All runs of a scene, with the algorithms' names.
pub fn runs(outcome: &Outcome) -> impl Iterator<Item = (&str, &str, &Measured)> {
    algorithms::all().zip(&outcome.lanes).map(|(algorithm, lane)| (outcome.scene.name, algorithm.name, lane))
}

/// The rows of a scene.
pub fn rows(outcome: &Outcome) -> impl Iterator<Item = Row<'_>> {
    algorithms::all().zip(&outcome.lanes).enumerate().map(|(n, (algorithm, lane))| {
        let s = &lane.summary;
        let published = outcome.scene.published;
        Row {
            scene: outcome.scene.name,
            algorithm: algorithm.name,
            policy: &s.policy,
            objects: s.objects,
            triangles: s.triangles,
            frames: s.frames,
            median_ms: s.frame_ms.median,
            mean_ms: s.frame_ms.mean,
            p99_ms: s.frame_ms.p99,
            time_over_ref: round(outcome.time_over_ref(n)),
            published_time_over_ref: published.and_then(|p| p.time_over_ref(n)).map(round),
            drawn: s.drawn.mean,
            drawn_triangles: s.drawn_triangles.mean,
            in_frustum: s.in_frustum.mean,
            culled: round(outcome.culled(n)),
            published_culled: published.and_then(|p| p.culled(n)),
            culled_of_hidden: round(outcome.culled_of_hidden(n)),
            overdraw: round(outcome.overdraw(n)),
            queries: s.queries.mean,
            false_culls: s.false_culls,
        }
    })
}
