//! The figures as tables: a row a scene and algorithm, and a row a frame.

use serde::Serialize;

use super::Outcome;
use super::scenes::Published;
use support::lockstep::Measured;
use support::report::round;

/// The algorithms, as the files call them.
pub const NEW: &str = "new";
/// See [`NEW`].
pub const OLD: &str = "old";

/// A line of `kt2005.csv`: means a frame, unless it says otherwise. The oracle's figures are empty
/// without `--oracle`.
#[derive(Debug, Serialize)]
pub struct Row<'a> {
    scene: &'a str,
    algorithm: &'static str,
    policy: &'a str,
    objects: usize,
    triangles: u64,
    frames: usize,
    /// The whole flight.
    seconds: f64,
    median_ms: f64,
    tree_ms: f64,
    /// The tree's time over all time, 0 to 1.
    maintenance_share: f64,
    drawn: f64,
    drawn_triangles: f64,
    in_frustum: f64,
    queries: f64,
    waves: f64,
    state_changes: f64,
    /// After the last frame.
    nodes: usize,
    exact_visible: Option<f64>,
    box_visible: Option<f64>,
    /// A total.
    false_culls: Option<u64>,
    wrong_pixels: Option<f64>,
    paper_seconds: f64,
    paper_drawn: f64,
    paper_queries: f64,
}

/// Both rows of a scene.
pub fn rows(outcome: &Outcome) -> [Row<'_>; 2] {
    let Outcome { scene, name, new, old } = outcome;
    [row(name, NEW, new, scene.new), row(name, OLD, old, scene.old)]
}

/// Both runs of a scene, with their names.
pub fn runs(outcome: &Outcome) -> [(&str, &str, &Measured); 2] {
    let Outcome { name, new, old, .. } = outcome;
    [(name, NEW, new), (name, OLD, old)]
}

/// The time of the whole flight.
pub fn seconds(measured: &Measured) -> f64 {
    round(measured.frames.iter().map(|frame| frame.frame_ms).sum::<f64>() * 1e-3)
}

fn row<'a>(scene: &'a str, algorithm: &'static str, measured: &'a Measured, paper: Published) -> Row<'a> {
    let s = &measured.summary;
    Row {
        scene,
        algorithm,
        policy: &s.policy,
        objects: s.objects,
        triangles: s.triangles,
        frames: s.frames,
        seconds: seconds(measured),
        median_ms: s.frame_ms.median,
        tree_ms: s.stage_ms.tree,
        maintenance_share: s.tree.maintenance_share,
        drawn: s.drawn.mean,
        drawn_triangles: s.drawn_triangles.mean,
        in_frustum: s.in_frustum.mean,
        queries: s.queries.mean,
        waves: s.waves.mean,
        state_changes: s.state_changes.mean,
        nodes: s.tree.nodes,
        exact_visible: s.exact_visible.map(|m| m.mean),
        box_visible: s.box_visible.map(|m| m.mean),
        false_culls: s.false_culls,
        wrong_pixels: s.wrong_pixels.map(|m| m.mean),
        paper_seconds: paper.seconds,
        paper_drawn: paper.drawn,
        paper_queries: paper.queries,
    }
}
