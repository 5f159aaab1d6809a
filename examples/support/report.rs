//! The figures of a run: one record a frame, and what they add up to.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::Context;
use hecs::{Entity, World};
use serde::Serialize;
use tercet::Counter;
use tercet::draw::Drawable;
use tercet::query::QueryBackend;
use tercet::query::software::SoftwareQueries;
use tercet::scene::Bounds;
use tercet::tree::TreeStats;

use super::audits::AuditFigures;
use super::flags::Flags;

/// One frame: one line of `frames.csv`. Times in milliseconds; the oracle's figures are empty
/// without `--oracle`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FrameRecord {
    /// The frame's number, from 0.
    pub frame: u32,
    /// What an app would pay: sync, cull with its draws, adapt. Not the world's own motion, not
    /// the oracle.
    pub frame_ms: f64,
    /// Finding out which objects changed.
    pub sync_ms: f64,
    /// Keeping the tree: placing what moved, refitting, splitting and merging.
    pub tree_ms: f64,
    /// The policy's own thinking.
    pub policy_ms: f64,
    /// The app's draws.
    pub draw_ms: f64,
    /// Asking.
    pub query_ms: f64,
    /// Waiting for answers.
    pub wait_ms: f64,
    /// The app's draws by the device's own clock, of a frame not long ago; empty where there is none.
    pub device_draw_ms: Option<f64>,
    /// Objects handed to the app to draw.
    pub drawn: u32,
    /// Triangles that the app drew.
    pub drawn_triangles: u64,
    /// Objects whose box meets the view frustum.
    pub in_frustum: u32,
    /// Questions asked.
    pub queries: u32,
    /// Boxes in those questions.
    pub query_boxes: u32,
    /// Batches of questions.
    pub waves: u32,
    /// Changes between drawing and asking.
    pub state_changes: u32,
    /// Objects that own a pixel of the finished frame.
    pub exact_visible: Option<u32>,
    /// Objects whose own box would be found visible.
    pub box_visible: Option<u32>,
    /// Objects that own a pixel and were not drawn.
    pub false_culls: Option<u32>,
    /// Pixels that differ from those of the frame drawn whole.
    pub wrong_pixels: Option<u64>,
    /// What the policy counted itself; one column each.
    #[serde(skip)]
    pub counters: Vec<Counter>,
    /// Those of `false_culls`, and of how many samples of the finished frame each is the nearest.
    #[serde(skip)]
    pub lost: Vec<(Entity, u32)>,
    /// Samples that show another object only because of the level of detail, where that is measured.
    #[serde(skip)]
    pub detail_pixels: Option<u64>,
}

/// What does not change from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// The world, in words.
    pub scene: String,
    /// Objects in it.
    pub objects: usize,
    /// Its triangles, each object at full detail.
    pub triangles: u64,
    /// The policy's name.
    pub policy: String,
    /// The query backend's name.
    pub backend: String,
    /// The graphics adapter, where there is one.
    pub adapter: Option<String>,
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// What the world was generated from.
    pub seed: u64,
}

/// The tree after the last frame, and what happened to it, per frame.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct TreeFigures {
    /// Nodes after the last frame.
    pub nodes: usize,
    /// Depth after the last frame.
    pub depth: usize,
    /// Splits a frame.
    pub splits: f64,
    /// Merges a frame.
    pub merges: f64,
    /// Objects that changed node, a frame.
    pub moves: f64,
    /// Splits that undid a merge or the reverse, a frame.
    pub flips: f64,
    /// The tree's time over the frame's time, 0 to 1.
    pub maintenance_share: f64,
}

/// `summary.json`. The order of the fields is the order of the keys.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// See [`Setting`].
    pub scene: String,
    /// See [`Setting`].
    pub objects: usize,
    /// See [`Setting`].
    pub triangles: u64,
    /// See [`Setting`].
    pub policy: String,
    /// See [`Setting`].
    pub backend: String,
    /// See [`Setting`].
    pub adapter: Option<String>,
    /// See [`Setting`].
    pub viewport: [u32; 2],
    /// How many frames were measured.
    pub frames: usize,
    /// See [`Setting`].
    pub seed: u64,
    /// See [`FrameRecord::frame_ms`].
    pub frame_ms: Spread,
    /// What the frame's time is made of.
    pub stage_ms: Stages,
    /// See [`FrameRecord::drawn`].
    pub drawn: MeanMax,
    /// See [`FrameRecord::drawn_triangles`].
    pub drawn_triangles: Mean,
    /// See [`FrameRecord::in_frustum`].
    pub in_frustum: Mean,
    /// See [`FrameRecord::queries`].
    pub queries: MeanMax,
    /// See [`FrameRecord::query_boxes`].
    pub query_boxes: Mean,
    /// See [`FrameRecord::waves`].
    pub waves: Mean,
    /// See [`FrameRecord::state_changes`].
    pub state_changes: Mean,
    /// See [`FrameRecord::counters`], by key; empty for a policy that counts nothing itself.
    pub counters: BTreeMap<&'static str, MeanMax>,
    /// The tree.
    pub tree: TreeFigures,
    /// See [`FrameRecord::exact_visible`].
    pub exact_visible: Option<Mean>,
    /// See [`FrameRecord::box_visible`].
    pub box_visible: Option<Mean>,
    /// See [`FrameRecord::false_culls`]; the total of all frames.
    pub false_culls: Option<u64>,
    /// See [`FrameRecord::wrong_pixels`].
    pub wrong_pixels: Option<MeanMax>,
    /// What `--audit` found.
    pub audit: Option<AuditFigures>,
}

/// How a figure is spread over the frames.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// Half of the frames have no more.
    pub median: f64,
    /// The sum over the number.
    pub mean: f64,
    /// 99 of 100 frames have no more.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

/// Mean milliseconds a frame, stage by stage; see [`FrameRecord`].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stages {
    /// Finding out what changed.
    pub sync: f64,
    /// Keeping the tree.
    pub tree: f64,
    /// Thinking.
    pub policy: f64,
    /// Drawing.
    pub draw: f64,
    /// Asking.
    pub query: f64,
    /// Waiting.
    pub wait: f64,
}

/// A mean over the frames.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Mean {
    /// The sum over the number.
    pub mean: f64,
}

/// A mean and the greatest value.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeanMax {
    /// The sum over the number.
    pub mean: f64,
    /// The greatest.
    pub max: f64,
}

impl Setting {
    /// The setting of a run over a world that has been spawned.
    pub fn new(flags: &Flags, scene: &str, policy: &str, world: &World) -> Self {
        Self {
            scene: scene.to_owned(),
            objects: world.query::<&Bounds>().iter().count(),
            triangles: world.query::<&Drawable>().iter().map(|d| d.mesh.triangle_count() as u64).sum(),
            policy: policy.to_owned(),
            backend: SoftwareQueries::new().name().to_owned(),
            adapter: None,
            viewport: [flags.size.0, flags.size.1],
            seed: flags.seed,
        }
    }
}

impl TreeFigures {
    /// The figures of `frames` frames from the counters after the first frame, which builds the
    /// tree and is not counted among the events, and after the last.
    pub fn new(built: &TreeStats, now: &TreeStats, frames: usize) -> Self {
        let frames = (frames as f64 - 1.0).max(1.0);
        let each = |before: u64, after: u64| round((after - before) as f64 / frames);
        Self {
            nodes: now.nodes,
            depth: now.depth,
            splits: each(built.splits, now.splits),
            merges: each(built.merges, now.merges),
            moves: each(built.moves, now.moves),
            flips: each(built.flips, now.flips),
            maintenance_share: 0.0,
        }
    }
}

impl Summary {
    /// Adds up the frames. `tree` may leave its share of the frame's time out: it is filled in.
    ///
    /// # Panics
    /// Without a frame.
    pub fn new(setting: Setting, mut tree: TreeFigures, frames: &[FrameRecord]) -> Self {
        let each = |f: fn(&FrameRecord) -> f64| frames.iter().map(f).collect::<Vec<_>>();
        let total_ms = mean(&each(|f| f.frame_ms));
        let tree_ms = mean(&each(|f| f.tree_ms));
        tree.maintenance_share = if total_ms > 0.0 { round(tree_ms / total_ms) } else { 0.0 };
        // The oracle looked at every frame or at none.
        let oracle = |f: fn(&FrameRecord) -> Option<f64>| {
            frames.iter().map(f).collect::<Option<Vec<_>>>().map(|values| mean_max(&values))
        };
        Self {
            scene: setting.scene,
            objects: setting.objects,
            triangles: setting.triangles,
            policy: setting.policy,
            backend: setting.backend,
            adapter: setting.adapter,
            viewport: setting.viewport,
            frames: frames.len(),
            seed: setting.seed,
            frame_ms: spread(&each(|f| f.frame_ms)),
            stage_ms: Stages {
                sync: mean(&each(|f| f.sync_ms)),
                tree: tree_ms,
                policy: mean(&each(|f| f.policy_ms)),
                draw: mean(&each(|f| f.draw_ms)),
                query: mean(&each(|f| f.query_ms)),
                wait: mean(&each(|f| f.wait_ms)),
            },
            drawn: mean_max(&each(|f| f.drawn.into())),
            drawn_triangles: Mean { mean: mean(&each(|f| f.drawn_triangles as f64)) },
            in_frustum: Mean { mean: mean(&each(|f| f.in_frustum.into())) },
            queries: mean_max(&each(|f| f.queries.into())),
            query_boxes: Mean { mean: mean(&each(|f| f.query_boxes.into())) },
            waves: Mean { mean: mean(&each(|f| f.waves.into())) },
            state_changes: Mean { mean: mean(&each(|f| f.state_changes.into())) },
            counters: counters(frames),
            tree,
            exact_visible: oracle(|f| f.exact_visible.map(f64::from)).map(|m| Mean { mean: m.mean }),
            box_visible: oracle(|f| f.box_visible.map(f64::from)).map(|m| Mean { mean: m.mean }),
            false_culls: frames.iter().map(|f| f.false_culls.map(u64::from)).sum(),
            wrong_pixels: oracle(|f| f.wrong_pixels.map(|pixels| pixels as f64)),
            audit: None,
        }
    }
}

/// Writes `frames.csv` and `summary.json` into a folder that exists.
pub fn write(out: &Path, summary: &Summary, frames: &[FrameRecord]) -> anyhow::Result<()> {
    write_frames(&out.join("frames.csv"), frames)?;
    let path = out.join("summary.json");
    let json = serde_json::to_string_pretty(summary)? + "\n";
    fs::write(&path, json).with_context(|| format!("cannot write {}", path.display()))
}

/// Writes a line a frame: the record's fields, then the policy's own counters.
fn write_frames(path: &Path, frames: &[FrameRecord]) -> anyhow::Result<()> {
    let mut fields = csv::Writer::from_writer(Vec::new());
    for frame in frames {
        fields.serialize(frame)?;
    }
    let fields = fields.into_inner()?;
    let lines = csv::ReaderBuilder::new().has_headers(false).from_reader(&*fields).into_records();
    let mut csv = csv::Writer::from_path(path).with_context(|| format!("cannot write {}", path.display()))?;
    // The first line holds the names.
    let frames = frames.iter().take(1).map(|f| (f, true)).chain(frames.iter().map(|f| (f, false)));
    for (line, (frame, is_header)) in lines.zip(frames) {
        let mut line = line?;
        for counter in &frame.counters {
            line.push_field(&if is_header { counter.key.to_owned() } else { counter.count.to_string() });
        }
        csv.write_record(&line)?;
    }
    Ok(csv.flush()?)
}

/// Writes a table with a line a row, under a line of the fields' names.
pub fn write_csv<Row: Serialize>(path: &Path, rows: impl IntoIterator<Item = Row>) -> anyhow::Result<()> {
    let mut csv = csv::Writer::from_path(path).with_context(|| format!("cannot write {}", path.display()))?;
    for row in rows {
        csv.serialize(row)?;
    }
    Ok(csv.flush()?)
}

/// Percentile by nearest rank; `percent` in 0 to 100.
pub fn percentile(values: &[f64], percent: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (percent / 100.0 * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

/// Mean and maximum of each counter of the policy's own.
fn counters(frames: &[FrameRecord]) -> BTreeMap<&'static str, MeanMax> {
    let mut counts: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    for counter in frames.iter().flat_map(|f| &f.counters) {
        counts.entry(counter.key).or_default().push(counter.count.into());
    }
    counts.into_iter().map(|(key, values)| (key, mean_max(&values))).collect()
}

fn spread(values: &[f64]) -> Spread {
    let at = |percent| round(percentile(values, percent));
    Spread { min: at(0.0), median: at(50.0), mean: mean(values), p99: at(99.0), max: at(100.0) }
}

fn mean_max(values: &[f64]) -> MeanMax {
    MeanMax { mean: mean(values), max: round(percentile(values, 100.0)) }
}

fn mean(values: &[f64]) -> f64 {
    round(values.iter().sum::<f64>() / values.len() as f64)
}

/// Four digits after the point: a tenth of a microsecond.
pub fn round(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_members_by_nearest_rank() {
        let values: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!(percentile(&values, 0.0), 1.0);
        assert_eq!(percentile(&values, 50.0), 100.0);
        assert_eq!(percentile(&values, 99.0), 198.0);
        assert_eq!(percentile(&values, 100.0), 200.0);
        assert_eq!(percentile(&[7.0], 99.0), 7.0);
    }

    #[test]
    fn the_keys_and_their_order_are_the_contract() {
        let frames = [FrameRecord { frame_ms: 2.0, tree_ms: 0.5, ..Default::default() }];
        let summary = Summary::new(Setting::default(), TreeFigures::default(), &frames);
        let json = serde_json::to_string(&summary).expect("a summary is plain data");
        let expected = concat!(
            r#"{"scene":"","objects":0,"triangles":0,"policy":"","backend":"","adapter":null,"#,
            r#""viewport":[0,0],"frames":1,"seed":0,"#,
            r#""frame_ms":{"min":2.0,"median":2.0,"mean":2.0,"p99":2.0,"max":2.0},"#,
            r#""stage_ms":{"sync":0.0,"tree":0.5,"policy":0.0,"draw":0.0,"query":0.0,"wait":0.0},"#,
            r#""drawn":{"mean":0.0,"max":0.0},"drawn_triangles":{"mean":0.0},"in_frustum":{"mean":0.0},"#,
            r#""queries":{"mean":0.0,"max":0.0},"query_boxes":{"mean":0.0},"waves":{"mean":0.0},"#,
            r#""state_changes":{"mean":0.0},"counters":{},"#,
            r#""tree":{"nodes":0,"depth":0,"splits":0.0,"merges":0.0,"moves":0.0,"flips":0.0,"#,
            r#""maintenance_share":0.25},"#,
            r#""exact_visible":null,"box_visible":null,"false_culls":null,"wrong_pixels":null,"audit":null}"#,
        );
        assert_eq!(json, expected);
    }

    #[test]
    fn what_a_policy_counts_has_its_own_keys_and_columns() {
        let frame = |count| FrameRecord {
            counters: vec![Counter { key: "pull_ups", count }, Counter { key: "batches", count: 1 }],
            ..Default::default()
        };
        let frames = [frame(2), frame(4)];
        let summary = Summary::new(Setting::default(), TreeFigures::default(), &frames);
        let json = serde_json::to_string(&summary.counters).expect("a summary is plain data");
        assert_eq!(json, r#"{"batches":{"mean":1.0,"max":1.0},"pull_ups":{"mean":3.0,"max":4.0}}"#);
        let path = std::env::temp_dir().join(format!("tercet-frames-{}.csv", std::process::id()));
        write_frames(&path, &frames).expect("a file in the folder for such files");
        let csv = fs::read_to_string(&path).expect("it was written");
        fs::remove_file(&path).expect("it is there");
        let lines: Vec<&str> = csv.lines().collect();
        assert!(lines[0].ends_with(",wrong_pixels,pull_ups,batches"), "{csv}");
        assert!(lines[1].ends_with(",2,1") && lines[2].ends_with(",4,1"), "{csv}");
    }

    #[test]
    fn false_culls_are_a_total() {
        let frame = |n| FrameRecord { false_culls: Some(n), ..Default::default() };
        let summary = Summary::new(Setting::default(), TreeFigures::default(), &[frame(2), frame(3)]);
        assert_eq!(summary.false_culls, Some(5));
    }
}
