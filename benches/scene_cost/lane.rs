//! A world of boxes, and views of it.

use std::time::Instant;

use glam::{Vec3, Vec3A};
use hecs::World;
use tercet::geom::{View, Viewport};
use tercet::policy::{self, Gated, Policy};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Batch, Bounds, Mobility, NeverCull, NotOccluder, Scene, SceneConfig, Slack};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Culler, FrameStats};

use crate::boxes::{self, Place};

const SCREEN: Viewport = Viewport::new(320, 180);
/// Frames until the camera, and what moves, is where it was.
const PERIOD: usize = 64;
/// Of what stands side by side.
const COLUMNS: usize = 100;

/// What a world has, and who looks at it.
#[derive(Clone, Copy)]
pub struct Setup {
    /// Boxes, the wall apart.
    pub objects: usize,
    /// A wall that hides most of them; without, they stand side by side.
    pub wall: bool,
    /// Whether all of them move.
    pub moving: bool,
    /// Who has what the others have not.
    pub extra: Option<Extra>,
    pub views: usize,
    pub policy: &'static str,
    /// Whether the policy stands behind a gate.
    pub gated: bool,
    pub detects_cuts: bool,
    /// What is done every frame besides culling.
    pub upkeep: Upkeep,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Upkeep {
    /// The scene looks for what has changed in the app's world, and the tree follows the votes.
    Sync,
    /// The app says that nothing has changed; the tree follows the votes.
    Update,
    /// None.
    Nothing,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            objects: 4000,
            wall: true,
            moving: false,
            extra: None,
            views: 1,
            policy: "dual-query",
            gated: false,
            detects_cuts: false,
            upkeep: Upkeep::Sync,
        }
    }
}

/// An optional component, of one object far behind the wall, or of all.
#[derive(Clone, Copy)]
pub enum Extra {
    OneNeverCull,
    OneNotOccluder,
    OneSlack,
    OneBatch,
    AllStatic,
    AllBatch,
}

impl Extra {
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::OneNeverCull, "one object of all has `NeverCull`, beside none"),
        (Self::OneNotOccluder, "one object of all has `NotOccluder`, beside none"),
        (Self::OneSlack, "one object of all has `Slack`, beside none"),
        (Self::OneBatch, "one object of all has `Batch`, beside none"),
        (Self::AllStatic, "all objects have `Mobility`, beside none"),
        (Self::AllBatch, "all objects have `Batch`, beside none"),
    ];

    fn dress(self, world: &mut World, entities: &[hecs::Entity]) {
        let first = entities[0];
        let done = match self {
            Self::OneNeverCull => world.insert_one(first, NeverCull),
            Self::OneNotOccluder => world.insert_one(first, NotOccluder),
            Self::OneSlack => world.insert_one(first, Slack(0.01)),
            Self::OneBatch => world.insert_one(first, Batch(1)),
            Self::AllStatic => entities.iter().try_for_each(|&e| world.insert_one(e, Mobility::Static)),
            Self::AllBatch => entities.iter().try_for_each(|&e| world.insert_one(e, Batch(1))),
        };
        done.expect("they were just spawned");
    }
}

/// A world with its scene, and its views.
pub struct Lane {
    setup: Setup,
    world: World,
    scene: Scene,
    eyes: Vec<(Culler<Box<dyn Policy>>, SoftwareQueries)>,
    /// Passes of the last frame of the last view.
    pub passes: u32,
    /// Its other counts.
    pub stats: FrameStats,
}

impl Lane {
    pub fn new(setup: Setup) -> Self {
        let mut world = World::new();
        let part = |i: usize, step: f32| (i as f32 * step).fract() * 2.0 - 1.0;
        let places = (0..setup.objects).map(|i| match setup.wall {
            true => {
                let at = Vec3::new(part(i, 0.819_173), part(i, 0.671_044), part(i, 0.5497));
                Place::new(at * Vec3::new(30.0, 12.0, 30.0) - Vec3::Z * 34.0, Vec3::splat(0.3))
            }
            false => {
                let (column, row) = ((i % COLUMNS) as f32, (i / COLUMNS) as f32);
                Place::new(Vec3::new(column - 0.5 * COLUMNS as f32, row - 20.0, 0.0) * 0.4, Vec3::splat(0.1))
            }
        });
        let entities: Vec<_> = places.map(|place| boxes::spawn(&mut world, place)).collect();
        if setup.wall && setup.objects > 0 {
            boxes::spawn(&mut world, Place::new(Vec3::ZERO, Vec3::new(25.0, 10.0, 0.2)));
        }
        if let Some(extra) = setup.extra {
            extra.dress(&mut world, &entities);
        }
        // What asking costs on this machine is to decide nothing.
        let tree = TreeConfig { leaf_size: LeafSize::Fixed, ..TreeConfig::default() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let eye = || {
            let mut policy = policy::by_name(setup.policy).expect("a policy of that name");
            if setup.policy == "dual-query" {
                policy.set("n_skip", "0").expect("its dial");
            }
            let policy: Box<dyn Policy> = if setup.gated { Box::new(Gated::new(policy)) } else { policy };
            let mut eye = Culler::new(policy);
            eye.detects_cuts = setup.detects_cuts;
            (eye, SoftwareQueries::new())
        };
        let mut eyes: Vec<_> = (0..setup.views).map(|_| eye()).collect();
        // The tree knows from the start whether anybody asks about its nodes.
        scene.adapt(eyes.iter_mut().map(|(eye, _)| eye));
        scene.sync(&world);
        Self { setup, world, scene, eyes, passes: 0, stats: FrameStats::default() }
    }

    /// Seconds of a frame, for each view.
    pub fn frame(&mut self, number: usize) -> f64 {
        let phase = std::f32::consts::TAU * (number % PERIOD) as f32 / PERIOD as f32;
        if self.setup.moving {
            let step = 0.05 * phase.cos();
            for (bounds, place) in self.world.query_mut::<(&mut Bounds, &mut Place)>() {
                place.0.translation += Vec3A::Y * step;
                *bounds = place.bounds();
            }
        }
        let eye = Vec3::new(2.0 * phase.sin(), 1.0, 24.0);
        let view = View::look_at(eye, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
        let Self { setup, world, scene, eyes, passes, stats } = self;
        let start = Instant::now();
        match setup.upkeep {
            Upkeep::Sync => drop(scene.sync(world)),
            Upkeep::Update => drop(scene.update()),
            Upkeep::Nothing => {}
        }
        for (eye, queries) in &mut *eyes {
            *passes = 0;
            let draw = |pass: &mut _, objects: &[_]| {
                *passes += 1;
                boxes::draw(world, pass, objects);
            };
            *stats = eye.frame(scene, &view, queries, draw).expect("a frame");
        }
        if setup.upkeep != Upkeep::Nothing {
            scene.adapt(eyes.iter_mut().map(|(eye, _)| eye));
        }
        start.elapsed().as_secs_f64() / setup.views as f64
    }
}
