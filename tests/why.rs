//! Explanations hold: whatever [`Culler::why`] and [`Culler::fates`] say is compared with what was
//! drawn, with the geometry, and with what the backend was asked and answered in that very frame.

#[path = "support/stage.rs"]
mod stage;

use std::collections::HashMap;

use glam::{Affine3A, Vec3};
use stage::Stage;
use tercet::draw::Drawable;
use tercet::geom::{Aabb, Frustum, Proxy, Question, View, Viewport};
use tercet::policy::{self, Action, Context, DualQuery, Fate, Policy, Samples};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig, SceneObject, Traits};
use tercet::tree::{NodeId, Straddlers, TightBoxes, TreeConfig, Votes};
use tercet::worlds::{self, Pathology};
use tercet::{Culler, Error, FrameStats, Why};

const SCREEN: Viewport = Viewport::new(160, 90);

/// Answers exactly, and keeps what it was asked in the frame and what it said.
#[derive(Default)]
struct Listening {
    queries: SoftwareQueries,
    asked: HashMap<Ticket, Vec<Proxy>>,
    /// Each box that an answer spoke for; samples, where they were counted.
    said: Vec<(Proxy, bool, Option<Samples>)>,
}

impl QueryBackend for Listening {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "listening"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.asked.clear();
        self.said.clear();
        self.queries.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.queries.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.asked.insert(ticket, boxes.to_vec());
        self.queries.ask(ticket, boxes, want)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.queries.draw_objects(objects, record)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        // It says nothing of any node.
        self.asked.insert(ticket, vec![]);
        self.queries.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.queries.answers(wait, |ticket, answer| {
            let samples = match answer {
                Answer::Dual { visible, total } => Some(Samples { visible, total }),
                _ => None,
            };
            let (boxes, visible) = (&self.asked[&ticket], answer.is_visible(0));
            // Of several boxes, it says nothing unless all are hidden.
            if boxes.len() == 1 || !visible {
                self.said.extend(boxes.iter().map(|&proxy| (proxy, visible, samples)));
            }
            deliver(ticket, answer);
        })
    }

    fn end(&mut self) -> Result<(), Error> {
        self.queries.end()
    }
}

/// One view of a scene, and its last frame.
struct Watch<P> {
    scene: Scene,
    eye: Culler<P>,
    queries: Listening,
    view: View,
}

impl<P: Policy> Watch<P> {
    fn new(tree: TreeConfig, policy: P) -> Self {
        let view = View::look_at(Vec3::Z * 10.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let mut eye = Culler::new(policy);
        // Leaves are fine from the start.
        scene.adapt([&mut eye]);
        Self { scene, eye, queries: Listening::default(), view }
    }

    /// Draws a frame of a stage's world.
    fn frame(&mut self, stage: &Stage, view: View) -> FrameStats {
        self.view = view;
        self.scene.sync(&stage.world);
        if self.eye.policy().wants_recorded().is_some() {
            let every_third: Vec<ObjectId> = self.scene.objects().map(|o| o.object.id).step_by(3).collect();
            self.eye.policy_mut().give_recorded(&every_third);
        }
        let (view, detail, world) = (&self.view, stage.detail, &stage.world);
        let draw = |pass: &mut SoftwarePass, objects: &[ObjectRef]| {
            for object in objects {
                let d = world.get::<&Drawable>(object.entity()).expect("an object has a mesh");
                pass.draw_level(
                    &d.mesh,
                    detail.level(&d.mesh, &d.world_from_object, view),
                    &d.world_from_object,
                );
            }
        };
        self.eye.frame(&self.scene, view, &mut self.queries, draw).expect("a frame")
    }

    fn why(&self, object: ObjectId) -> Why {
        self.eye.why(&self.scene, &self.view, object)
    }

    /// Why an object was drawn or culled, if what is said of it can be checked and is true.
    fn checked(&self, object: &SceneObject) -> Result<Why, String> {
        let why = self.why(object.object.id);
        let question = |aabb: &Aabb| Question::new(aabb, &self.view);
        let said = |aabb: &Aabb, visible: bool, samples: Option<Samples>| {
            let Question::Ask(proxy) = question(aabb) else { return false };
            let is_it = |s: &(Proxy, bool, Option<Samples>)| {
                s.0 == proxy && s.1 == visible && (samples.is_none() || samples == s.2)
            };
            self.queries.said.iter().any(is_it)
        };
        let is_true = match (why, why.node()) {
            (Why::Always { bad }, _) => object.bounds.is_none() && bad == object.bad,
            (Why::Outside, _) => {
                object.bounds.is_some_and(|bounds| !Frustum::new(&self.view).intersects(&bounds))
            }
            (Why::NoSample(_), Some(node)) => question(&node.bounds) == Question::Outside,
            (Why::Hidden(_) | Why::HiddenNow(_), Some(node)) => said(&node.bounds, false, None),
            (Why::Visible { samples, .. }, Some(node)) => said(&node.bounds, true, samples),
            (Why::Near(_), Some(node)) => question(&node.bounds) == Question::Visible,
            (Why::Remembered { within, .. }, Some(_)) => within != Some(0),
            (Why::Unasked, _) => matches!(self.eye.policy().name(), "none" | "frustum"),
            (Why::Swept { .. }, _) => {
                matches!(self.eye.policy().name(), "roc" | "hroc" | "hi-z" | "hybrid" | "auto")
            }
            (Why::Given { .. }, _) => matches!(self.eye.policy().name(), "opt" | "exact"),
            _ => false,
        };
        let holds = |aabb: &Aabb| object.bounds.is_some_and(|bounds| aabb.contains(&bounds));
        let drawn = self.eye.visible().iter().any(|o| o.id == object.object.id);
        if is_true && why.is_drawn() == drawn && why.node().is_none_or(|node| holds(&node.bounds)) {
            Ok(why)
        } else {
            Err(format!("{}: {object:?}, drawn: {drawn}, but {why:?}", self.eye.policy().name()))
        }
    }
}

/// Every policy, some of them with other dials. Explanations are about a node's own box, tight volumes
/// about others: those stay off.
fn policies() -> Vec<Box<dyn Policy>> {
    let mut all = Vec::new();
    for &name in policy::NAMES {
        let mut policy = policy::by_name(name).expect("its name");
        match name {
            "chc++" => policy.set("tight", "false").expect("its switch"),
            // What it does is not left to this machine's times.
            "auto" => policy.set("race", "false").expect("its switch"),
            _ => {}
        }
        all.push(policy);
    }
    for (name, key, value) in [
        ("chc", "n_av", "0"),
        ("dual-query", "order", "visible-first"),
        ("dual-query", "n_skip", "5"),
        ("statistical", "n_skip", "0"),
        ("hroc", "occluder_filtering", "true"),
    ] {
        let mut policy = policy::by_name(name).expect("its name");
        policy.set(key, value).expect("its dial");
        all.push(policy);
    }
    all
}

fn trees() -> [TreeConfig; 3] {
    let stable = TreeConfig::stable();
    [
        TreeConfig { straddlers: Straddlers::StayInParent, ..stable.clone() },
        TreeConfig { tight_boxes: TightBoxes::Never, ..TreeConfig::paper() },
        stable,
    ]
}

fn kind(why: &Why) -> &'static str {
    match why {
        Why::Gone | Why::Unknown { .. } => "unknown",
        Why::Always { .. } => "always",
        Why::Unasked => "unasked",
        Why::Given { .. } => "given",
        Why::Swept { .. } => "swept",
        Why::Outside => "outside",
        Why::NoSample(_) => "no sample",
        Why::Hidden(_) => "hidden",
        Why::Visible { samples: None, .. } => "visible",
        Why::Visible { samples: Some(_), .. } => "counted",
        Why::Remembered { .. } => "remembered",
        Why::HiddenNow(_) => "hidden now",
        Why::Near(_) => "near",
    }
}

#[test]
fn every_explanation_is_true() {
    let mut kinds: HashMap<&str, usize> = HashMap::new();
    for policy in 0..policies().len() {
        for seed in 0..9u64 {
            let mut watch = Watch::new(trees()[seed as usize % 3].clone(), policies().swap_remove(policy));
            let model = match seed {
                7 => worlds::pathological(Pathology::ALL[policy % Pathology::ALL.len()]),
                _ => worlds::random(seed, 120),
            };
            let mut stage = Stage::new(model, seed, SCREEN, true);
            for number in 0..14 {
                let view = stage.next(number);
                watch.frame(&stage, view);
                for object in watch.scene.objects() {
                    let why = watch.checked(&object).unwrap_or_else(|wrong| panic!("seed {seed}: {wrong}"));
                    *kinds.entry(kind(&why)).or_default() += 1;
                }
                let asked = watch.eye.fates(&watch.scene, &watch.view).filter(|(_, fate)| fate.was_asked());
                assert_eq!(asked.count(), watch.queries.said.len(), "each question was about a node");
                watch.scene.adapt([&mut watch.eye]);
            }
        }
    }
    let all = ["always", "unasked", "given", "swept", "outside", "no sample", "hidden", "visible", "counted"];
    for kind in all.into_iter().chain(["remembered", "hidden now", "near"]) {
        assert!(kinds.get(kind).is_some_and(|&n| n > 10), "{kind} hardly occurred: {kinds:?}");
    }
    assert_eq!(kinds.get("unknown"), None);
}

/// Adapting the tree to a frame splits and merges the nodes that its answers were about.
#[test]
fn explanations_outlive_the_adaptation_of_the_tree() {
    let (mut objects, mut unknown) = (0, 0);
    let restless = TreeConfig { bulk_leaf: 1, cooldown: 0, o_merge: 8, ..TreeConfig::paper() };
    for seed in 0..6 {
        let mut watch = Watch::new(restless.clone(), DualQuery::default());
        let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
        for number in 0..14 {
            let view = stage.next(number);
            watch.frame(&stage, view);
            watch.scene.adapt([&mut watch.eye]);
            for object in watch.scene.objects() {
                let drawn = watch.eye.visible().iter().any(|o| o.id == object.object.id);
                match watch.why(object.object.id) {
                    why if why == Why::Unknown { drawn } => unknown += 1,
                    // Of a leaf this policy always knows it.
                    Why::Remembered { node, within: None } => assert!(!watch.scene.tree().is_leaf(node.id)),
                    _ => drop(watch.checked(&object).unwrap_or_else(|wrong| panic!("seed {seed}: {wrong}"))),
                }
                objects += 1;
            }
        }
    }
    assert!(unknown > 0 && unknown * 20 < objects, "{unknown} of {objects}");
}

/// Nothing moves: what is said of the frames to come is true.
#[test]
fn terms_are_kept() {
    for (name, dial) in
        [("statistical", "n_skip"), ("dual-query", "n_skip"), ("chc", "n_av"), ("chc++", "n_av")]
    {
        let mut policy = policy::by_name(name).expect("its name");
        policy.set(dial, "8").expect("its dial");
        let mut watch = Watch::new(TreeConfig::stable(), policy);
        let mut stage = Stage::new(worlds::random(3, 80), 3, SCREEN, false);
        let view = stage.next(0);
        let (mut terms, mut kept) = (HashMap::new(), 0);
        for _ in 0..40 {
            watch.frame(&stage, view.clone());
            for object in watch.scene.objects() {
                let id = object.object.id;
                let Why::Remembered { within: Some(within), .. } = watch.why(id) else {
                    kept += u32::from(terms.remove(&id) == Some(1));
                    continue;
                };
                let before = terms.insert(id, within);
                assert!(before.is_none_or(|before| before == within + 1), "{before:?}, then {within}");
            }
        }
        assert!(kept > 20, "{name}: {kept}");
    }
}

/// A wall before a ball: one line each, for people.
#[test]
fn explanations_read_well() {
    let tree = TreeConfig { bulk_leaf: 1, ..TreeConfig::stable() };
    let mut watch = Watch::new(tree, DualQuery::default());
    let view = watch.view.clone();
    let mut put = |x: f32, z: f32, half: Vec3, traits: Traits| {
        watch.scene.insert(Aabb::from_center(Vec3::new(x, 0.0, z), half), traits)
    };
    let wall = put(0.0, 0.0, Vec3::new(4.0, 4.0, 0.1), Traits::default());
    let ball = put(0.0, -5.0, Vec3::ONE, Traits::default());
    // Enough of them for nodes of their own.
    for i in 0..12 {
        put(0.1 * i as f32, -20.0 - 3.0 * i as f32, Vec3::ONE, Traits::default());
    }
    let far_left = put(-300.0, 0.0, Vec3::ONE, Traits::default());
    let sky = put(0.0, 0.0, Vec3::ONE, Traits { never_cull: true, ..Traits::default() });
    let bad = put(f32::NAN, 0.0, Vec3::ONE, Traits::default());
    watch.scene.update();
    assert_eq!(watch.why(wall), Why::Unknown { drawn: false }, "there was no frame yet");
    let square = wall_mesh();
    watch
        .eye
        .frame(&watch.scene, &view, &mut watch.queries, |pass, objects| {
            if objects.iter().any(|o| o.id == wall) {
                pass.draw_mesh(&square, &Affine3A::IDENTITY);
            }
        })
        .expect("a frame");
    let line = |object: ObjectId| watch.why(object).to_string();
    let lines = [wall, ball, far_left, sky, bad].map(line);
    assert!(lines[0].starts_with("drawn: of its node ") && lines[0].ends_with("samples visible"));
    assert!(lines[1].starts_with("culled: nothing of its node ") && lines[1].contains(" × 2.00 × "));
    assert_eq!(lines[2], "culled: it is outside the view");
    assert_eq!(lines[3], "drawn always, as the app wishes");
    assert_eq!(lines[4], "drawn always, until its box is a good one");

    let mut another = Scene::new(SceneConfig::default());
    let stranger = another.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
    another.update();
    assert_eq!(watch.eye.why(&another, &view, stranger), Why::Unknown { drawn: false });
    assert!(watch.eye.fates(&another, &view).all(|(_, fate)| fate == Fate::Unknown));
    watch.scene.remove(wall);
    watch.scene.update();
    assert_eq!(watch.why(wall), Why::Gone);
}

fn wall_mesh() -> Mesh {
    let corners = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    Mesh::new("wall", corners, vec![0, 1, 2, 0, 2, 3]).expect("a sound mesh")
}

/// A policy that culls as it should, and tells tales.
struct Lying {
    policy: DualQuery,
    tale: fn(Fate) -> Fate,
}

impl Policy for Lying {
    fn name(&self) -> &'static str {
        "lying"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.policy.begin(cx);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        self.policy.next(cx)
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        self.policy.answer(cx, ticket, answer);
    }

    fn vote(&mut self, votes: &mut Votes) {
        self.policy.vote(votes);
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        (self.tale)(self.policy.fate(cx, node))
    }
}

/// Each of these is found out, or the suite proves nothing.
#[test]
fn untrue_explanations_are_found_out() {
    let tales: [fn(Fate) -> Fate; 5] = [
        |fate| if fate == Fate::Hidden { Fate::Outside } else { fate },
        |fate| if let Fate::Remembered { .. } = fate { Fate::Visible { samples: None } } else { fate },
        |fate| if let Fate::Visible { .. } = fate { Fate::Near } else { fate },
        |fate| if fate == Fate::Near { Fate::Visible { samples: None } } else { fate },
        |fate| match fate {
            Fate::Visible { samples: Some(Samples { visible, total }) } => {
                Fate::Visible { samples: Some(Samples { visible: visible - 1, total }) }
            }
            fate => fate,
        },
    ];
    for (number, tale) in tales.into_iter().enumerate() {
        let policy = Lying { policy: DualQuery::default(), tale };
        let mut watch = Watch::new(TreeConfig::stable(), policy);
        let mut stage = Stage::new(worlds::random(0, 120), 0, SCREEN, true);
        let mut untrue = 0;
        for frame in 0..14 {
            let view = stage.next(frame);
            watch.frame(&stage, view);
            untrue += watch.scene.objects().filter(|object| watch.checked(object).is_err()).count();
        }
        assert!(untrue > 0, "tale {number}");
    }
}
