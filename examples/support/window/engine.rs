//! The engine behind the window: everything that a frame needs, and what the user may change.

use std::collections::VecDeque;

use tercet::draw::Detail;
use tercet::geom::{Aabb, View, Viewport};
use tercet::scene::{Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::worlds::Pose;

use crate::audits::Audits;
use crate::flags::Flags;
use crate::painter::Painter;
use crate::reference::Reference;
use crate::report::FrameRecord;
use crate::run::{Eye, Frame};
use crate::scenario::Scenario;
use crate::stage::{Gpu, Stage};

/// Frames that the plots go back.
const REMEMBERED: usize = 300;

/// A scene with one eye on it.
pub struct Engine {
    /// The app's world.
    pub scenario: Scenario,
    /// What is where.
    pub scene: Scene,
    /// What the culling camera sees.
    pub eye: Eye,
    /// The backend in use.
    pub stage: Stage,
    /// How finely things are drawn.
    pub detail: Detail,
    /// The dials of the tree, as the scene was made with.
    pub tree: TreeConfig,
    /// The last frames, oldest first.
    pub records: VecDeque<FrameRecord>,
    /// The view that was culled for in the last frame.
    pub culled: Option<View>,
    /// Where the culling camera was left, while the user flies on without it.
    pub frozen: Option<Pose>,
    /// Whether the world stands still.
    pub paused: bool,
    /// Whether it is to be known what moves.
    pub watches_movers: bool,
    /// By slot: where objects were in the frame before, if that is to be known.
    places: Vec<Option<Aabb>>,
    reference: Reference,
    audits: Option<Audits>,
    gpu: Gpu,
    flags: Flags,
    frames: u32,
}

impl Engine {
    /// A scenario on a backend.
    pub fn new(flags: &Flags, scenario: Scenario, mut stage: Stage, gpu: Gpu) -> anyhow::Result<Self> {
        shown_here(&mut stage);
        let (detail, tree) = (flags.detail()?, flags.tree()?);
        Ok(Self {
            scene: Scene::new(SceneConfig { tree: tree.clone(), ..Default::default() }),
            eye: flags.eye()?,
            stage,
            reference: Reference::new(Painter { detail }, false),
            audits: flags.audit.map(|every| Audits::new(every, Painter { detail })),
            records: VecDeque::with_capacity(REMEMBERED),
            culled: None,
            frozen: None,
            paused: false,
            watches_movers: false,
            places: Vec::new(),
            frames: 0,
            scenario,
            detail,
            tree,
            gpu,
            flags: flags.clone(),
        })
    }

    /// Changes the backend. What was learnt about the scene stays: it is the culler's.
    pub fn use_gpu(&mut self, on_gpu: bool) -> anyhow::Result<()> {
        self.stage = match on_gpu {
            true => Stage::on(self.gpu.clone(), self.detail)?,
            false => Stage::software(self.detail),
        };
        shown_here(&mut self.stage);
        self.audit_anew();
        Ok(())
    }

    /// Culls with another policy, which has seen nothing yet. The dials of the command line are set
    /// on it as far as it has them.
    pub fn use_policy(&mut self, name: &str) -> anyhow::Result<()> {
        let flags = Flags { policy: name.to_owned(), ..self.flags.clone() };
        self.eye = flags.eye()?;
        self.audit_anew();
        Ok(())
    }

    /// Builds the tree anew, with other dials.
    pub fn use_tree(&mut self, tree: TreeConfig) {
        self.scene = Scene::new(SceneConfig { tree: tree.clone(), ..Default::default() });
        self.tree = tree;
        self.places.clear();
        self.audit_anew();
    }

    /// Draws everything as finely as this from now on.
    pub fn use_detail(&mut self, detail: Detail) {
        self.detail = detail;
        self.reference.painter = Painter { detail };
        self.stage.set_detail(detail);
        self.audit_anew();
    }

    /// Checks every n-th frame from now on, or none.
    pub fn audit(&mut self, every: Option<u32>) {
        let painter = Painter { detail: self.detail };
        self.audits = every.map(|every| Audits::new(every, painter));
    }

    /// Forgets what the checked frames said: those to come are others.
    pub fn audit_anew(&mut self) {
        self.audit(self.audits.as_ref().map(Audits::every));
    }

    /// What checks frames, if they are checked.
    pub fn audits(&self) -> Option<&Audits> {
        self.audits.as_ref()
    }

    /// Leaves the culling camera where it is, or lets it go with the user's again.
    pub fn freeze(&mut self, at: Pose) {
        self.frozen = if self.frozen.is_some() { None } else { Some(at) };
    }

    /// One frame: the world moves on, and is culled for the camera, or for where it was frozen.
    pub fn frame(&mut self, camera: Pose, viewport: Viewport) -> anyhow::Result<()> {
        if !self.paused {
            self.scenario.step();
        }
        let view = self.scenario.look(self.frozen.unwrap_or(camera), viewport)?;
        let Self { scene, eye, stage, scenario, .. } = self;
        self.places.clear();
        if self.watches_movers {
            self.places.resize(scene.slot_bound(), None);
            scene.objects().for_each(|o| self.places[o.object.id.slot()] = o.bounds);
        }
        let synced = scene.sync(&scenario.world);
        self.reference.look(scene, &scenario.world, &view, eye)?;
        let drawn = stage.frame(eye, scene, &scenario.world, &view)?;
        if let Some(audits) = &mut self.audits {
            let lines = audits.check(scene, &scenario.world, &view, eye)?;
            lines.iter().for_each(|line| println!("{line}"));
        }
        let adapted = scene.adapt([&mut *eye]);
        let frame = Frame { scene, view: &view, eye, synced, drawn, adapted };
        if self.records.len() == REMEMBERED {
            self.records.pop_front();
        }
        self.records.push_back(frame.record(self.frames));
        self.frames = self.frames.wrapping_add(1);
        self.culled = Some(view);
        Ok(())
    }

    /// The boxes of what moved in the last frame: what is awake. Empty unless movers are watched.
    pub fn moved(&self) -> impl Iterator<Item = Aabb> {
        let place = |slot: usize| self.places.get(slot).copied().flatten();
        self.scene.objects().filter_map(move |o| {
            let bounds = o.bounds?;
            place(o.object.id.slot()).is_some_and(|before| before != bounds).then_some(bounds)
        })
    }

    /// Everything that has a place.
    pub fn bounds(&self) -> Aabb {
        self.scene.objects().filter_map(|o| o.bounds).fold(Aabb::EMPTY, |all, b| all.union(&b))
    }

    /// The device that the window draws with.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }
}

/// The window draws with its own device what the CPU has culled.
fn shown_here(stage: &mut Stage) {
    if let Stage::Software(stage) = stage {
        stage.shown_by_another();
    }
}
