//! What a view remembers is about something else: another object in the slot of one that is gone, another
//! place after a cut, another origin. Nothing is hidden by it, and no frame is dearer than a first one.

use glam::{Vec3, Vec3A};
use hecs::{Entity, World};
use tercet::geom::{Frustum, View, Viewport};
use tercet::policy::{self, Context, Fate, Policy};
use tercet::query::oracle::Oracle;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Bounds, ObjectId, Scene, SceneConfig};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Culler, FrameStats, Tradeoff};

use crate::boxes::{Place, draw, spawn};

const SCREEN: Viewport = Viewport::new(96, 54);

/// Every policy that makes up its own mind.
fn names() -> impl Iterator<Item = &'static str> {
    policy::NAMES.iter().copied().filter(|name| policy(name).wants_recorded().is_none())
}

/// A policy that decides by what it sees, whatever this machine's times are.
fn policy(name: &str) -> Box<dyn Policy> {
    let mut policy = policy::by_name(name).expect("a policy of that name");
    match name {
        "auto" => policy.set("race", "false").expect("its switch"),
        "nohc" => policy.set("caution", "0").expect("its dial"),
        _ => {}
    }
    policy
}

/// A view of a scene, and how many frames it has seen.
struct Eye {
    culler: Culler<Box<dyn Policy>>,
    queries: SoftwareQueries,
    frames: u32,
}

impl Eye {
    fn new(policy: Box<dyn Policy>) -> Self {
        Self { culler: Culler::new(policy), queries: SoftwareQueries::new(), frames: 0 }
    }

    fn name(&self) -> &'static str {
        self.culler.policy().name()
    }

    /// Draws a frame; nothing that owns a sample is lost.
    fn frame(&mut self, scene: &Scene, world: &World, view: &View) -> FrameStats {
        let Self { culler, queries, frames } = self;
        *frames += 1;
        let stats =
            culler.frame(scene, view, queries, |pass, refs| draw(world, pass, refs)).expect("a frame");
        let truth = Oracle::new().look(scene, view, |pass, refs| draw(world, pass, refs)).expect("a look");
        for object in scene.objects().filter(|object| truth.exact.contains(object.object.id)) {
            let id = object.object.id;
            assert!(self.draws(id), "{} lost {:?} in frame {}", self.name(), object.bounds, self.frames);
        }
        stats
    }

    /// Whether an object was drawn in the last frame.
    fn draws(&self, id: ObjectId) -> bool {
        self.culler.visible().iter().any(|object| object.id == id)
    }

    /// Nodes that the policy has looked at in the last frame.
    fn visits(&self, scene: &Scene, view: &View) -> usize {
        let (frustum, tradeoff) = (Frustum::new(view), Tradeoff::EXACT);
        let (tree, costs) = (scene.tree(), self.culler.costs());
        let cx = Context {
            scene,
            tree,
            view,
            frustum: &frustum,
            frame: self.frames,
            tradeoff: &tradeoff,
            costs,
            past: None,
        };
        let is_seen = |fate| !matches!(fate, Fate::Unknown | Fate::Outside | Fate::NotReached);
        tree.nodes().filter(|node| is_seen(self.culler.policy().fate(&cx, node.id))).count()
    }
}

/// A wall across z = 0, sixty boxes behind it and six before it.
struct Set {
    world: World,
    wall: Entity,
    behind: Vec<Entity>,
}

impl Set {
    fn new() -> Self {
        let mut world = World::new();
        let wall = spawn(&mut world, wall());
        let part = |i: usize, step: f32| (i as f32 * step).fract() * 2.0 - 1.0;
        let at =
            |i| Vec3::new(8.0 * part(i, 0.819_173), 4.0 * part(i, 0.671_044), -9.0 + 6.0 * part(i, 0.5497));
        let behind = (0..60).map(|i| spawn(&mut world, Place::new(at(i), Vec3::splat(0.3)))).collect();
        for i in 0..6 {
            spawn(&mut world, Place::new(Vec3::new(-5.0 + 2.0 * i as f32, 1.0, 2.0), Vec3::splat(0.2)));
        }
        Self { world, wall, behind }
    }

    fn scene(&self) -> Scene {
        // Fine leaves, whatever asking costs on this machine.
        let tree = TreeConfig { unasked_leaf: 2, leaf_size: LeafSize::Fixed, ..TreeConfig::default() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        scene.sync(&self.world);
        scene
    }

    /// Another box instead of this one, of the same entity index.
    fn replace(&mut self, old: Entity, place: Place) -> Entity {
        self.world.despawn(old).expect("alive");
        let new = spawn(&mut self.world, place);
        assert!(new != old && new.id() == old.id(), "hecs gives the index out again");
        new
    }
}

fn wall() -> Place {
    Place::new(Vec3::ZERO, Vec3::new(14.0, 8.0, 0.2))
}

/// From before the wall.
fn before() -> View {
    View::look_at(Vec3::new(0.0, 0.5, 12.0), Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view")
}

/// From the other side.
fn beyond() -> View {
    View::look_at(Vec3::new(1.0, 0.5, -22.0), Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view")
}

fn id_of(scene: &Scene, entity: Entity) -> ObjectId {
    scene.objects().find(|o| o.object.entity() == entity).expect("it is in the scene").object.id
}

/// Hidden for ten frames; then, between two frames, gone, and another object in its slot stands before the
/// wall. The slot's next owners stand behind again, and where the first one was.
#[test]
fn another_object_in_a_slot_is_not_hidden_by_the_answer_to_the_first() {
    for name in names() {
        let mut set = Set::new();
        let (mut scene, mut eye, view) = (set.scene(), Eye::new(policy(name)), before());
        let culls = !matches!(name, "none" | "frustum");
        let mut entity = set.behind[7];
        let behind = set.world.get::<&Place>(entity).expect("it has one").0;
        for round in 0..6 {
            for _ in 0..10 {
                eye.frame(&scene, &set.world, &view);
                scene.adapt([&mut eye.culler]);
                scene.sync(&set.world);
            }
            let (old, is_before) = (id_of(&scene, entity), round % 2 == 0);
            assert!(!is_before || !culls || !eye.draws(old), "{name}: it was hidden");
            let place = if is_before {
                Place::new(Vec3::new(0.3, 0.2, 3.0), Vec3::splat(0.4))
            } else {
                Place(behind)
            };
            entity = set.replace(entity, place);
            let report = scene.sync(&set.world);
            let new = id_of(&scene, entity);
            assert!(new.slot() == old.slot() && new != old, "the same slot, {report:?}");
            eye.frame(&scene, &set.world, &view);
            assert!(!is_before || eye.draws(new), "{name}: it stands before the wall");
            assert!(!eye.draws(old), "a handle of what is gone is handed out by nobody");
        }
    }
}

/// The wall itself is replaced by one that hides nothing: what it hid is visible in the same frame. Then
/// it is there again.
#[test]
fn what_a_removed_object_hid_is_seen_at_once() {
    for name in names() {
        let mut set = Set::new();
        let (mut scene, mut eye, view) = (set.scene(), Eye::new(policy(name)), before());
        let culls = !matches!(name, "none" | "frustum");
        for _ in 0..4 {
            for _ in 0..24 {
                eye.frame(&scene, &set.world, &view);
                scene.adapt([&mut eye.culler]);
                scene.sync(&set.world);
            }
            let drawn = set.behind.iter().filter(|&&e| eye.draws(id_of(&scene, e))).count();
            assert!(!culls || drawn < 30, "{name}: the wall hides them, {drawn} were drawn");
            let away = Place::new(Vec3::new(0.0, 0.0, 300.0), Vec3::ONE);
            let stand_in = set.replace(set.wall, away);
            scene.sync(&set.world);
            eye.frame(&scene, &set.world, &view);
            let drawn = set.behind.iter().filter(|&&e| eye.draws(id_of(&scene, e))).count();
            assert!(drawn > 45, "{name}: they are seen, {drawn} were drawn");
            set.wall = set.replace(stand_in, wall());
            scene.sync(&set.world);
        }
    }
}

/// What a frame cost, in counts.
#[derive(Clone, Copy, Debug)]
struct Price {
    nodes: usize,
    questions: u32,
    boxes: u32,
    waves: u32,
    drawn: u32,
}

impl Price {
    fn of(eye: &mut Eye, scene: &Scene, world: &World, view: &View) -> Self {
        let stats = eye.frame(scene, world, view);
        let FrameStats { queries, query_boxes, waves, drawn, .. } = stats;
        Self { nodes: eye.visits(scene, view), questions: queries, boxes: query_boxes, waves, drawn }
    }

    /// What a first frame costs, at most.
    ///
    /// CHC++ keeps what it has learned of worlds in general: it may put its nodes into other multiqueries, in
    /// each of which a node is asked about at most thrice.
    fn of_first(name: &'static str, scene: &Scene, world: &World, view: &View) -> Self {
        let first = Self::of(&mut Eye::new(policy(name)), scene, world, view);
        match name {
            "chc++" => Self { questions: first.nodes as u32, boxes: 3 * first.boxes, ..first },
            _ => first,
        }
    }

    fn at_most(self, most: Self) -> bool {
        self.nodes <= most.nodes
            && self.questions <= most.questions
            && self.boxes <= most.boxes
            && self.waves <= most.waves
            && self.drawn <= most.drawn
    }
}

/// A frame after a cut looks at no more nodes than a first one of the same tree, asks no more, waits no
/// more often and draws no more. Then comes a jump that nobody announced, which loses nothing either.
#[test]
fn a_frame_after_a_cut_is_as_dear_as_a_first_one() {
    for name in names() {
        let set = Set::new();
        let (mut scene, mut eye) = (set.scene(), Eye::new(policy(name)));
        for _ in 0..12 {
            eye.frame(&scene, &set.world, &before());
            scene.adapt([&mut eye.culler]);
            scene.update();
        }
        let most = Price::of_first(name, &scene, &set.world, &beyond());
        eye.culler.cut();
        let after = Price::of(&mut eye, &scene, &set.world, &beyond());
        assert!(after.at_most(most), "{name}: {after:?} after a cut, at most {most:?} in a first frame");
        assert!(after.nodes > 0 && (after.questions > 0) != matches!(name, "none" | "frustum"));
        eye.frame(&scene, &set.world, &before());
    }
}

/// Another origin, for the scene and for what the app says of it: nothing is lost, the first frame there is
/// as dear as a first one, objects are the same ones, and what was hidden is hidden again.
#[test]
fn histories_begin_anew_at_another_origin() {
    for name in names() {
        let mut set = Set::new();
        let (mut scene, mut eye) = (set.scene(), Eye::new(policy(name)));
        let (mut settled, mut last) = (None, Vec::new());
        for origin in [Vec3::ZERO, Vec3::splat(64.0), Vec3::new(4096.0, -512.0, 8.0), Vec3::ZERO] {
            let shift = scene.origin().as_vec3() - origin;
            scene.rebase(origin.as_dvec3());
            for (bounds, place) in set.world.query_mut::<(&mut Bounds, &mut Place)>() {
                place.0.translation += Vec3A::from(shift);
                *bounds = place.bounds();
            }
            scene.sync(&set.world);
            let view = View::look_at(Vec3::new(0.0, 0.5, 12.0) - origin, -origin, 60.0, 0.1, SCREEN)
                .expect("a view");
            let first = Price::of_first(name, &scene, &set.world, &view);
            let after = Price::of(&mut eye, &scene, &set.world, &view);
            assert!(after.at_most(first), "{name}: {after:?} after it, {first:?} in a first frame");
            assert!(
                !eye.culler.entered().iter().any(|o| last.contains(&o.id)),
                "{name}: they were seen before"
            );
            for _ in 0..10 {
                eye.frame(&scene, &set.world, &view);
                scene.adapt([&mut eye.culler]);
                scene.update();
            }
            let drawn = eye.culler.visible().len();
            let before = *settled.get_or_insert(drawn);
            assert!(drawn <= before + before / 4 + 2, "{name}: {drawn} are drawn here, {before} before");
            last = eye.culler.visible().iter().map(|object| object.id).collect();
        }
    }
}
