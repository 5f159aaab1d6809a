//! A world of boxes, each drawn as its own twelve triangles and nothing else, so that no transform
//! rounds; and what every policy makes of it, against the oracle.

use glam::{Affine3A, Vec3};
use tercet::Culler;
use tercet::geom::{Aabb, View};
use tercet::policy::{self, Policy, Recording, StopAndWait};
use tercet::query::oracle::{Oracle, Truth};
use tercet::query::software::{SimdLevel, SoftwarePass, SoftwareQueries};
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig, Traits};
use tercet::tree::{Straddlers, TreeConfig};

/// What a policy did over some frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Objects in the frustum that owned no sample.
    pub(crate) hidden: usize,
    /// Those of them that were not drawn.
    pub(crate) culled: usize,
    /// Objects that owned a sample.
    pub(crate) visible: usize,
}

/// An object: where it is drawn, and the bounds that the scene is told.
pub(crate) struct Placed {
    pub(crate) drawn: Aabb,
    pub(crate) told: Aabb,
}

impl Placed {
    pub(crate) fn honest(drawn: Aabb) -> Self {
        Self { drawn, told: drawn }
    }
}

/// Flies through the views with every policy, on trees of both kinds and with the instructions in
/// turn. Nothing that owns a sample is lost, what is bad is drawn always, and the tree stays valid;
/// policies that ask cull something hidden, if `culls`.
pub(crate) fn fly(world: &[Placed], views: &[View], culls: bool) {
    for (i, &name) in policy::NAMES.iter().enumerate() {
        let straddlers = [Straddlers::Split, Straddlers::StayInParent, Straddlers::Leaf][i % 3];
        let tree = TreeConfig { straddlers, bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::default() };
        let mut flight = Flight::new(world, tree, name, SimdLevel::ALL[i % SimdLevel::ALL.len()]);
        let mut all = Outcome::default();
        // Again and again, so that there is a history: who draws first what was visible knows in the third
        // frame what is hidden.
        for view in views.iter().chain(views).chain(views) {
            let outcome = flight.frame(view);
            all.hidden += outcome.hidden;
            all.culled += outcome.culled;
            all.visible += outcome.visible;
        }
        assert!(all.visible > 0, "{name}: there is something to be lost: {all:?}");
        let asks = !matches!(name, "none" | "frustum");
        assert!(!culls || !asks || all.culled > 0, "{name} culled nothing that is hidden: {all:?}");
    }
}

/// A scene and a view's culler.
pub(crate) struct Flight {
    pub(crate) scene: Scene,
    pub(crate) objects: Vec<(ObjectId, Mesh)>,
    eye: Culler<Box<dyn Policy>>,
    queries: SoftwareQueries,
    reference: Culler<StopAndWait>,
    reference_queries: SoftwareQueries,
    oracle: Oracle,
}

impl Flight {
    pub(crate) fn new(world: &[Placed], tree: TreeConfig, policy: &str, level: SimdLevel) -> Self {
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let objects =
            world.iter().map(|p| (scene.insert(p.told, Traits::default()), solid(&p.drawn))).collect();
        scene.update();
        let mut policy = policy::by_name(policy).expect("a policy of that name");
        if policy.name() == "auto" {
            // Whether it asks is not left to this machine's times.
            policy.set("race", "false").expect("its switch");
        }
        Self {
            scene,
            objects,
            eye: Culler::new(policy),
            queries: SoftwareQueries::with_level(level),
            reference: Culler::new(StopAndWait::default()),
            reference_queries: SoftwareQueries::new(),
            oracle: Oracle::new(),
        }
    }

    /// The exact visible set, and what the policy made of the frame.
    pub(crate) fn frame(&mut self, view: &View) -> Outcome {
        let truth = self.truth(view);
        let Self { scene, objects, eye, queries, reference, reference_queries, .. } = self;
        scene.tree().validate().expect("a valid tree");
        let draw = |pass: &mut SoftwarePass, refs: &[ObjectRef]| draw(objects, pass, refs);
        match eye.policy().wants_recorded() {
            None => {}
            Some(Recording::ExactSet) => {
                let ids: Vec<ObjectId> =
                    objects.iter().map(|(id, _)| *id).filter(|&id| truth.exact.contains(id)).collect();
                eye.policy_mut().give_recorded(&ids);
            }
            Some(Recording::StopAndWait) => {
                reference.frame(scene, view, reference_queries, draw).expect("the reference draws");
                let ids: Vec<ObjectId> = reference.visible().iter().map(|o| o.id).collect();
                eye.policy_mut().give_recorded(&ids);
            }
        }
        eye.frame(scene, view, queries, draw).expect("a frame");
        let mut drawn = vec![false; scene.slot_bound()];
        eye.visible().iter().for_each(|o| drawn[o.id.slot()] = true);
        let mut outcome = Outcome::default();
        for (id, mesh) in objects.iter() {
            let (is_drawn, shows) = (drawn[id.slot()], truth.exact.contains(*id));
            assert!(is_drawn || !shows, "{} lost {:?} in {view:?}", eye.policy().name(), mesh.bounds());
            let object = scene.object(*id).expect("it is there");
            assert!(is_drawn || !object.bad, "{}: what is bad is drawn always", eye.policy().name());
            outcome.visible += usize::from(shows);
            if !shows && object.bounds.is_some() && truth.in_frustum.contains(*id) {
                outcome.hidden += 1;
                outcome.culled += usize::from(!is_drawn);
            }
        }
        scene.adapt([&mut *eye]);
        scene.tree().validate().expect("a valid tree after adapting");
        outcome
    }

    pub(crate) fn truth(&mut self, view: &View) -> Truth {
        let Self { scene, objects, oracle, .. } = self;
        oracle.look(scene, view, |pass, refs| draw(objects, pass, refs)).expect("the oracle looks")
    }
}

fn draw(objects: &[(ObjectId, Mesh)], pass: &mut SoftwarePass, refs: &[ObjectRef]) {
    for object in refs {
        // Objects are never removed here: slots are given out in order.
        pass.draw_mesh(&objects[object.id.slot()].1, &Affine3A::IDENTITY);
    }
}

/// The twelve triangles of a box.
pub(crate) fn solid(aabb: &Aabb) -> Mesh {
    const FACES: [u32; 36] = [
        0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3,
        7, 5,
    ];
    let corners: [Vec3; 8] = aabb.corners();
    Mesh::new("box", corners.to_vec(), FACES.to_vec()).expect("a box is a mesh")
}

/// A wall in the plane z = 0 and sixty boxes behind it, hidden from the side of +z, ten of them on the
/// axis; and some before it. In units of `scale` metres.
pub(crate) fn wall_and_crowd(scale: f32) -> Vec<Aabb> {
    let cube = |x: f32, y: f32, z: f32, half: f32| {
        Aabb::from_center(Vec3::new(x, y, z) * scale, Vec3::splat(half * scale))
    };
    let wall = Aabb::new(Vec3::new(-20.0, -20.0, -0.25) * scale, Vec3::new(20.0, 20.0, 0.25) * scale);
    let behind = (0..50).map(|i| {
        let part = |step: f32| (i as f32 * step).fract() * 2.0 - 1.0;
        cube(
            8.0 * part(0.819_173),
            8.0 * part(0.671_044),
            -20.0 + 16.0 * part(0.549_7),
            0.1 + 0.02 * i as f32,
        )
    });
    let along = (0..10).map(|i| cube(0.0, 0.0, -3.0 - 3.0 * i as f32, 0.5));
    let before = (0..6).map(|i| cube(-5.0 + 2.0 * i as f32, 1.0, 2.0, 0.3));
    std::iter::once(wall).chain(behind).chain(along).chain(before).collect()
}
