//! A run: counts frames, shows how long it will take, measures, and writes everything at the end.
//! None of it happens inside the times that are reported.

use std::fs;
use std::time::{Duration, Instant};

use anyhow::Context;
use hecs::World;
use indicatif::{ProgressBar, ProgressStyle};
use tercet::Culler;
use tercet::geom::{Frustum, View};
use tercet::policy::Policy;
use tercet::scene::{Scene, SyncReport};
use tercet::tree::TreeStats;

use super::audits::Audits;
use super::flags::Flags;
use super::painter::Painter;
use super::reference::Reference;
use super::report::{self, FrameRecord, Setting, Summary, TreeFigures};
use super::stage::{Drawn, Stage};
use super::{last_frame, plots, table, top_view};

/// A culler whose policy was chosen by name.
pub type Eye = Culler<Box<dyn Policy>>;

/// What was measured so far.
pub struct Run {
    flags: Flags,
    painter: Painter,
    setting: Setting,
    bar: ProgressBar,
    started: Instant,
    records: Vec<FrameRecord>,
    reference: Reference,
    audits: Option<Audits>,
    view: Option<View>,
    /// The tree's counters after the first frame, which builds it.
    tree_built: TreeStats,
}

/// One frame, as the example's loop hands it over.
pub struct Frame<'a> {
    /// The scene after its adaptation.
    pub scene: &'a Scene,
    /// The view that was drawn.
    pub view: &'a View,
    /// The culler that drew it.
    pub eye: &'a Eye,
    /// What [`Scene::sync`] returned.
    pub synced: SyncReport,
    /// What was done to draw it.
    pub drawn: Drawn,
    /// What [`Scene::adapt`] returned.
    pub adapted: Duration,
}

impl Frame<'_> {
    /// Its figures, but for those of the oracle.
    pub fn record(&self, number: u32) -> FrameRecord {
        let Frame { scene, view, synced, drawn: Drawn { stats, triangles }, .. } = self;
        let ms = |time: Duration| report::round(time.as_secs_f64() * 1e3);
        let tree = synced.tree_time + self.adapted;
        let cull = stats.policy + stats.draw + stats.query + stats.wait;
        let frustum = Frustum::new(view);
        let inside = |bounds: Option<tercet::geom::Aabb>| bounds.is_none_or(|b| frustum.intersects(&b));
        FrameRecord {
            frame: number,
            frame_ms: ms(synced.sync_time + tree + cull),
            sync_ms: ms(synced.sync_time),
            tree_ms: ms(tree),
            policy_ms: ms(stats.policy),
            draw_ms: ms(stats.draw),
            query_ms: ms(stats.query),
            wait_ms: ms(stats.wait),
            device_draw_ms: (!stats.device_draw.is_zero()).then(|| ms(stats.device_draw)),
            drawn: stats.drawn,
            drawn_triangles: *triangles,
            in_frustum: scene.objects().filter(|o| inside(o.bounds)).count() as u32,
            queries: stats.queries,
            query_boxes: stats.query_boxes,
            waves: stats.waves,
            state_changes: stats.state_changes,
            counters: self.eye.policy().counters(),
            ..Default::default()
        }
    }
}

impl Run {
    /// Prepares to measure `flags.frames` frames of a world that has been spawned.
    pub fn new(flags: &Flags, stage: &Stage, scene_name: &str, world: &World) -> anyhow::Result<Self> {
        let setting = Setting {
            backend: stage.backend().to_owned(),
            adapter: stage.adapter(),
            ..Setting::new(flags, scene_name, &flags.policy, world)
        };
        // Now, not after a long run: where would its figures go?
        let out = flags.out();
        fs::create_dir_all(&out).with_context(|| format!("cannot make the folder {}", out.display()))?;
        println!(
            "{scene_name}: {} objects, {} triangles; policy {}, {} frames on {}",
            table::count(setting.objects as f64),
            table::count(setting.triangles as f64),
            flags.policy,
            flags.frames,
            setting.adapter.as_deref().unwrap_or("the CPU")
        );
        let painter = Painter { detail: flags.detail()? };
        let style = "{bar:40} frame {pos} of {len}, {elapsed} so far, {eta} left";
        Ok(Self {
            painter,
            setting,
            bar: ProgressBar::new(flags.frames.into()).with_style(ProgressStyle::with_template(style)?),
            started: Instant::now(),
            records: Vec::new(),
            reference: Reference::new(painter, flags.oracle),
            audits: flags.audit.map(|every| Audits::new(every, painter)),
            view: None,
            tree_built: TreeStats::default(),
            flags: flags.clone(),
        })
    }

    /// The next frame's number; None when the run is over.
    pub fn advance(&mut self) -> Option<u32> {
        let done = self.records.len() as u32;
        (done < self.flags.frames).then_some(done)
    }

    /// Looks at the frame beside the one that is measured: for `--oracle`, and for policies that
    /// draw what a reference found. To be called between sync and frame.
    pub fn look(&mut self, scene: &Scene, world: &World, view: &View, eye: &mut Eye) -> anyhow::Result<()> {
        self.reference.look(scene, world, view, eye)
    }

    /// Checks the frame that was just drawn, if it is due, and prints what it lost: for `--audit`. To be
    /// called between frame and adapt.
    pub fn audit(&mut self, scene: &Scene, world: &World, view: &View, eye: &Eye) -> anyhow::Result<()> {
        let Some(audits) = &mut self.audits else { return Ok(()) };
        let lines = audits.check(scene, world, view, eye)?;
        if !lines.is_empty() {
            self.bar.suspend(|| lines.iter().for_each(|line| println!("{line}")));
        }
        Ok(())
    }

    /// Takes a frame's figures.
    pub fn record(&mut self, world: &World, frame: Frame<'_>) -> anyhow::Result<()> {
        let mut record = frame.record(self.records.len() as u32);
        self.reference.judge(world, frame.view, frame.eye, &mut record)?;
        if self.records.is_empty() {
            self.tree_built = frame.scene.tree().stats();
        }
        self.records.push(record);
        self.view = Some(frame.view.clone());
        self.bar.inc(1);
        Ok(())
    }

    /// Writes figures, plots and pictures, and prints the table.
    ///
    /// # Errors
    /// When the run is not complete, or a file cannot be written.
    pub fn finish(self, scene: &Scene, world: &World, eye: &Eye) -> anyhow::Result<Summary> {
        self.bar.finish_and_clear();
        let view = self.view.as_ref().context("the run is not complete: no frame was measured")?;
        let taken = self.started.elapsed();
        let out = self.flags.out();
        let tree = TreeFigures::new(&self.tree_built, &scene.tree().stats(), self.records.len());
        let audit = self.audits.as_ref().map(Audits::figures);
        let summary = Summary { audit, ..Summary::new(self.setting.clone(), tree, &self.records) };
        report::write(&out, &summary, &self.records)?;
        plots::write(&out, &summary, &self.records)?;
        top_view::write(&out, &summary, scene, view, eye)?;
        last_frame::write(&out, scene, world, view, &self.painter)?;
        println!("{}", table::table(&summary));
        if let Some(why) = eye.policy().explanation() {
            println!("{why}");
        }
        println!(
            "{} frames in {:.1} s; figures and pictures are in {}",
            summary.frames,
            taken.as_secs_f64(),
            out.display()
        );
        Ok(summary)
    }
}
