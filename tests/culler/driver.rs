//! The driver: errors instead of wrong frames, the lists of what entered and left, and the order
//! of drawing.

use glam::{Affine3A, Vec3};
use hecs::{Entity, World};
use tercet::geom::{Aabb, Proxy, View, Viewport};
use tercet::policy::{self, DrawAll, DualQuery, FrustumOnly, Policy};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;
use tercet::scene::{Bounds, NeverCull, NotOccluder, ObjectRef, Scene, SceneConfig, Traits};
use tercet::tree::TreeConfig;
use tercet::{Culler, Error, FrameStats};

use crate::square;

fn spawn(world: &mut World, mesh: &Mesh, place: Affine3A) -> Entity {
    world.spawn((Bounds(mesh.bounds().transformed(&place)), place))
}

fn at(x: f32, y: f32, z: f32, size: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z)) * Affine3A::from_scale(Vec3::splat(size))
}

fn view() -> View {
    View::look_at(Vec3::Z * 10.0, Vec3::ZERO, 60.0, 0.1, Viewport::new(200, 100)).expect("a view")
}

fn frame<P: Policy>(eye: &mut Culler<P>, scene: &Scene, world: &World, mesh: &Mesh) -> FrameStats {
    let mut queries = SoftwareQueries::new();
    eye.frame(scene, &view(), &mut queries, |pass, objects| draw(world, mesh, pass, objects))
        .expect("a frame")
}

fn draw(world: &World, mesh: &Mesh, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
    for object in objects {
        let place = world.get::<&Affine3A>(object.entity()).expect("an object has a place");
        pass.draw_mesh(mesh, &place);
    }
}

fn entities(objects: impl IntoIterator<Item = ObjectRef>) -> Vec<Entity> {
    let mut all: Vec<_> = objects.into_iter().map(ObjectRef::entity).collect();
    all.sort_unstable();
    all
}

#[test]
fn scene_culler_and_backend_can_be_shared_between_threads() {
    fn check<T: Send + Sync>() {}
    check::<Scene>();
    check::<Culler<DualQuery>>();
    check::<Culler<Box<dyn Policy>>>();
    check::<SoftwareQueries>();
}

/// One scene, four views, each on its own thread: they see what they see alone.
#[test]
fn views_are_culled_in_parallel() {
    let (mesh, mut world) = (square(), World::new());
    for i in 0..200 {
        spawn(&mut world, &mesh, at((i % 20) as f32 - 10.0, (i / 20) as f32 - 5.0, -(i % 7) as f32, 0.8));
    }
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(&world);
    let alone = {
        let mut eye = Culler::new(DualQuery::default());
        frame(&mut eye, &scene, &world, &mesh);
        entities(eye.visible().iter().copied())
    };
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut eye = Culler::new(DualQuery::default());
                frame(&mut eye, &scene, &world, &mesh);
                assert_eq!(entities(eye.visible().iter().copied()), alone);
            });
        }
    });
}

#[test]
fn entered_and_left_follow_the_visible_list() {
    let (mesh, mut world) = (square(), World::new());
    let a = spawn(&mut world, &mesh, at(0.0, 0.0, 0.0, 1.0));
    let b = spawn(&mut world, &mesh, at(3.0, 0.0, 0.0, 1.0));
    let mut scene = Scene::new(SceneConfig::default());
    let mut eye = Culler::new(FrustumOnly::default());
    let mut step = |world: &World| {
        scene.sync(world);
        frame(&mut eye, &scene, world, &mesh);
        let entered = entities(eye.entered().iter().copied());
        (entered, entities(eye.left()), eye.visible().len())
    };
    assert_eq!(step(&world), (vec![a, b], vec![], 2));
    assert_eq!(step(&world), (vec![], vec![], 2));
    world.get::<&mut Bounds>(b).unwrap().0 = Aabb::from_center(Vec3::X * 500.0, Vec3::ONE);
    assert_eq!(step(&world), (vec![], vec![b], 1));
    world.get::<&mut Bounds>(b).unwrap().0 = Aabb::from_center(Vec3::X * 3.0, Vec3::ONE);
    assert_eq!(step(&world), (vec![b], vec![], 2));
    // Another object in the slot of a removed one is a new arrival, and the old one has left.
    world.despawn(a).unwrap();
    let c = spawn(&mut world, &mesh, at(0.0, 0.0, 0.0, 1.0));
    let (entered, left, visible) = step(&world);
    assert_eq!((entered, visible), (vec![c], 2));
    assert_eq!(left.len(), 1);
}

#[test]
fn what_hides_nothing_is_drawn_last_and_what_is_never_culled_always() {
    let (mesh, mut world) = (square(), World::new());
    let glass = spawn(&mut world, &mesh, at(0.0, 0.0, 5.0, 8.0));
    world.insert_one(glass, NotOccluder).unwrap();
    let behind = spawn(&mut world, &mesh, at(0.0, 0.0, 0.0, 1.0));
    let sky = spawn(&mut world, &mesh, at(0.0, 0.0, 900.0, 1.0));
    world.insert_one(sky, NeverCull).unwrap();
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(&world);
    for name in ["dual-query", "statistical", "chc", "chc++", "stop-and-wait", "frustum", "none"] {
        let mut eye = Culler::new(policy::by_name(name).unwrap());
        for _ in 0..3 {
            frame(&mut eye, &scene, &world, &mesh);
            let order: Vec<_> = eye.visible().iter().map(|o| o.entity()).collect();
            assert_eq!(order.len(), 3, "{name}: glass hides nothing, and the sky is never culled");
            assert_eq!(order[2], glass, "{name}: glass comes last");
            assert!(order.contains(&behind) && order.contains(&sky));
        }
    }
}

#[test]
fn an_edited_scene_must_be_updated_first() {
    let mut scene = Scene::new(SceneConfig::default());
    scene.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
    let mut eye = Culler::new(DrawAll::default());
    let result = eye.frame(&scene, &view(), &mut SoftwareQueries::new(), |_, _| {});
    assert!(matches!(result, Err(Error::PendingEdits(1))));
    scene.update();
    let stats = eye.frame(&scene, &view(), &mut SoftwareQueries::new(), |_, _| {}).unwrap();
    assert_eq!(stats.drawn, 1);
}

/// A backend that loses every answer, or delivers each twice, or cannot wait.
struct Broken {
    inner: SoftwareQueries,
    blocks: bool,
    fault: Fault,
    asked: Vec<Ticket>,
}

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    /// Says that it lost them.
    Unknown,
    /// Says nothing.
    Silent,
    /// Delivers each answer twice, and one to a question that was never asked.
    Twice,
}

impl Broken {
    fn new(blocks: bool, fault: Fault) -> Self {
        Self { inner: SoftwareQueries::new(), blocks, fault, asked: Vec::new() }
    }
}

impl QueryBackend for Broken {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "broken"
    }

    fn can_block(&self) -> bool {
        self.blocks
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.asked.clear();
        self.inner.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.inner.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        assert!(!self.asked.contains(&ticket), "a ticket is unique within its frame");
        self.asked.push(ticket);
        self.inner.ask(ticket, boxes, want)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_objects(objects, record)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.inner.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        let fault = self.fault;
        self.inner.answers(wait, |ticket, answer| match fault {
            Fault::Unknown => deliver(ticket, Answer::Unknown),
            Fault::Silent => {}
            Fault::Twice => {
                deliver(ticket, answer);
                deliver(ticket, answer);
                deliver(Ticket(1_000_000), answer);
            }
        })
    }

    fn end(&mut self) -> Result<(), Error> {
        self.inner.end()
    }
}

#[test]
fn a_policy_that_must_wait_is_refused_where_nobody_can() {
    let mut scene = Scene::new(SceneConfig::default());
    scene.update();
    let mut queries = Broken::new(false, Fault::Unknown);
    let mut eye = Culler::new(DualQuery::default());
    let error = eye.frame(&scene, &view(), &mut queries, |_, _| {}).unwrap_err();
    assert!(matches!(error, Error::CannotBlock { policy: "dual-query", backend: "broken" }), "{error}");
    let mut eye = Culler::new(FrustumOnly::default());
    eye.frame(&scene, &view(), &mut queries, |_, _| {}).expect("it asks nothing");
}

#[test]
fn what_an_answer_was_lost_for_is_drawn() {
    let (mesh, mut world) = (square(), World::new());
    spawn(&mut world, &mesh, at(0.0, 0.0, 5.0, 20.0));
    for i in 0..50 {
        spawn(&mut world, &mesh, at((i % 10) as f32 * 0.5, (i / 10) as f32 * 0.5, -20.0, 0.2));
    }
    // Nothing adapts here: the leaves are to be fine before the first question.
    let tree = TreeConfig { unasked_leaf: 2, ..TreeConfig::default() };
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    scene.sync(&world);
    let hierarchies = ["hierarchy-a", "hierarchy-b", "hierarchy-c", "hierarchy-d"];
    for name in ["dual-query", "statistical", "chc", "chc++", "stop-and-wait"].into_iter().chain(hierarchies)
    {
        for (fault, drawn) in [(Fault::Unknown, 51), (Fault::Silent, 51), (Fault::Twice, 1)] {
            let mut queries = Broken::new(true, fault);
            let mut eye = Culler::new(policy::by_name(name).unwrap());
            for _ in 0..3 {
                let stats = eye
                    .frame(&scene, &view(), &mut queries, |pass, objects| draw(&world, &mesh, pass, objects))
                    .unwrap();
                assert_eq!(stats.drawn, drawn, "{name}: the wall hides fifty, where answers arrive");
            }
        }
    }
}

/// A zero in a public field must not switch drawing off.
#[test]
fn no_questions_in_flight_still_means_one() {
    let (mesh, mut world) = (square(), World::new());
    spawn(&mut world, &mesh, at(0.0, 0.0, 0.0, 1.0));
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(&world);
    let mut statistical = policy::Statistical::default();
    statistical.in_flight = 0;
    let mut eye = Culler::new(statistical);
    assert_eq!(frame(&mut eye, &scene, &world, &mesh).drawn, 1);
}

/// A view that nobody adapts to keeps the votes of one frame, not of all.
#[test]
fn votes_do_not_pile_up() {
    let (mesh, mut world) = (square(), World::new());
    for i in 0..30 {
        spawn(&mut world, &mesh, at(i as f32 * 0.6 - 9.0, 0.0, 0.0, 0.25));
    }
    let mut scene = Scene::new(SceneConfig::default());
    scene.sync(&world);
    let mut eye = Culler::new(DualQuery::default());
    frame(&mut eye, &scene, &world, &mesh);
    let once = tercet::Voter::votes(&eye).votes.len();
    assert!(once > 0);
    for _ in 0..10 {
        frame(&mut eye, &scene, &world, &mesh);
    }
    assert!(tercet::Voter::votes(&eye).votes.len() <= 2 * once);
}

/// A history is about one scene: shown another, a culler begins anew.
#[test]
fn a_culler_may_change_its_scene() {
    let (mesh, mut world) = (square(), World::new());
    spawn(&mut world, &mesh, at(0.0, 0.0, 0.0, 1.0));
    let mut first = Scene::new(SceneConfig::default());
    first.sync(&world);
    let mut eye = Culler::new(DualQuery::default());
    frame(&mut eye, &first, &world, &mesh);
    for i in 0..40 {
        spawn(&mut world, &mesh, at(i as f32 * 0.1 - 2.0, 0.5, -(i as f32), 1.0));
    }
    let mut second = Scene::new(SceneConfig::default());
    second.sync(&world);
    assert!(frame(&mut eye, &second, &world, &mesh).drawn > 1);
    assert_eq!(frame(&mut eye, &first, &world, &mesh).drawn, 1);
}

#[test]
fn unknown_names_are_answered_with_those_that_exist() {
    let error = policy::by_name("dual").err().expect("no such policy").to_string();
    assert!(policy::NAMES.iter().all(|name| error.contains(name)), "{error}");
    for &name in policy::NAMES {
        let mut policy = policy::by_name(name).unwrap();
        assert_eq!(policy.name(), name);
        let dials = policy.dials();
        for dial in &dials {
            policy.set(dial.key, &dial.value).expect("a dial takes its own value");
        }
        let error = policy.set("no_such_dial", "1").unwrap_err().to_string();
        assert!(dials.iter().all(|d| error.contains(d.key)), "{error}");
    }
    let mut tree = TreeConfig::default();
    for dial in tree.clone().dials() {
        tree.set(dial.key, &dial.value).expect("a dial takes its own value");
        tree.set(dial.key, "nonsense").expect_err("and no nonsense");
    }
    assert_eq!(tree, TreeConfig::default());
}
