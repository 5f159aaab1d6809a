//! `chcpp_shading.csv`: a row a number of look-ups and algorithm.

use serde::Serialize;

use super::Shaded;
use support::report::round;

/// Means a frame, unless it says otherwise.
#[derive(Debug, Serialize)]
pub struct Row<'a> {
    look_ups: u32,
    algorithm: &'static str,
    policy: &'a str,
    adapter: Option<&'a str>,
    frames: usize,
    /// From sync to the device's last command.
    median_ms: f64,
    mean_ms: f64,
    p99_ms: f64,
    /// The app's draws by the device's own clock: a median.
    device_draw_ms: Option<f64>,
    /// Time over VFC's: the median of the ratios frame by frame.
    time_over_vfc: f64,
    drawn: f64,
    drawn_triangles: f64,
    in_frustum: f64,
    queries: f64,
    waits: f64,
    /// A total; empty without `--oracle`.
    false_culls: Option<u64>,
}

/// The rows of a number of look-ups.
pub fn rows(shaded: &Shaded) -> impl Iterator<Item = Row<'_>> {
    shaded.by_algorithm().map(|(algorithm, lane)| {
        let s = &lane.summary;
        Row {
            look_ups: shaded.look_ups,
            algorithm: algorithm.name,
            policy: &s.policy,
            adapter: s.adapter.as_deref(),
            frames: s.frames,
            median_ms: s.frame_ms.median,
            mean_ms: s.frame_ms.mean,
            p99_ms: s.frame_ms.p99,
            device_draw_ms: lane.device_draw_ms().map(round),
            time_over_vfc: round(shaded.over_vfc(lane)),
            drawn: s.drawn.mean,
            drawn_triangles: s.drawn_triangles.mean,
            in_frustum: s.in_frustum.mean,
            queries: s.queries.mean,
            waits: s.waves.mean,
            false_culls: s.false_culls,
        }
    })
}
