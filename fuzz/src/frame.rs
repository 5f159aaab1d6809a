//! Bytes as a small world and its frames: no object that owns a sample is lost, whatever the
//! policy.

use arbitrary::Unstructured;
use glam::{Affine3A, Vec3};
use tercet::geom::Aabb;
use tercet::policy::{self, Policy, Recording, StopAndWait};
use tercet::query::oracle::Oracle;
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig, Traits};
use tercet::tree::TreeConfig;
use tercet::{Culler, Tradeoff};

use super::numbers::{any_box, below, sound_box, sound_view};

const MOST_OBJECTS: usize = 48;
const MOST_FRAMES: usize = 6;

/// Decodes a world, flies through it and compares each frame with the oracle's.
pub fn run(bytes: &[u8]) {
    let mut u = Unstructured::new(bytes);
    let name = policy::NAMES[below(&mut u, policy::NAMES.len())];
    let tree =
        TreeConfig { bulk_leaf: 1 + below(&mut u, 4) as u32, unasked_leaf: 2, ..TreeConfig::default() };
    let mut flight = Flight {
        scene: Scene::new(SceneConfig { tree, ..SceneConfig::default() }),
        objects: Vec::new(),
        eye: Culler::new(policy::by_name(name).expect("a policy of that name")),
        queries: SoftwareQueries::new(),
        reference: Culler::new(StopAndWait::default()),
        reference_queries: SoftwareQueries::new(),
        oracle: Oracle::new(),
    };
    flight.eye.tradeoff = Tradeoff::EXACT;
    for _ in 0..1 + below(&mut u, MOST_OBJECTS) {
        flight.insert(&mut u);
    }
    for _ in 0..MOST_FRAMES {
        if u.is_empty() {
            break;
        }
        flight.frame(&mut u);
    }
}

/// An object is drawn as the twelve triangles of its own box: exactly what it was given as.
struct Object {
    id: ObjectId,
    mesh: Mesh,
}

struct Flight {
    scene: Scene,
    objects: Vec<Object>,
    eye: Culler<Box<dyn Policy>>,
    queries: SoftwareQueries,
    reference: Culler<StopAndWait>,
    reference_queries: SoftwareQueries,
    oracle: Oracle,
}

impl Flight {
    fn insert(&mut self, u: &mut Unstructured<'_>) {
        let traits = Traits { not_occluder: below(u, 8) == 0, ..Traits::default() };
        let aabb = sound_box(u);
        let id = self.scene.insert(aabb, traits);
        self.objects.push(Object { id, mesh: solid(&aabb) });
    }

    fn change(&mut self, u: &mut Unstructured<'_>) {
        for _ in 0..below(u, 4) {
            let i = below(u, self.objects.len());
            let aabb = sound_box(u);
            self.objects[i].mesh = solid(&aabb);
            // Some are not told the truth: bounds that are bad must not lose them.
            let told = if below(u, 6) == 0 { any_box(u) } else { aabb };
            let bounds = if told.is_valid() { aabb } else { told };
            assert!(self.scene.set_bounds(self.objects[i].id, bounds));
        }
    }

    fn frame(&mut self, u: &mut Unstructured<'_>) {
        self.change(u);
        self.scene.update();
        if let Err(why) = self.scene.tree().validate() {
            panic!("{why}");
        }
        let Some(view) = sound_view(u, 64) else { return };
        let Self { scene, objects, eye, queries, reference, reference_queries, oracle } = self;
        let draw = |pass: &mut SoftwarePass, refs: &[ObjectRef]| {
            for object in refs {
                let drawn = &objects[object.id.slot()];
                assert_eq!(drawn.id, object.id);
                pass.draw_mesh(&drawn.mesh, &Affine3A::IDENTITY);
            }
        };
        let truth = oracle.look(scene, &view, draw).expect("the oracle looks");
        match eye.policy().wants_recorded() {
            None => {}
            Some(Recording::ExactSet) => {
                let ids = objects.iter().map(|o| o.id).filter(|&id| truth.exact.contains(id));
                eye.policy_mut().give_recorded(&ids.collect::<Vec<_>>());
            }
            Some(Recording::StopAndWait) => {
                reference.frame(scene, &view, reference_queries, draw).expect("the reference draws");
                let ids: Vec<ObjectId> = reference.visible().iter().map(|o| o.id).collect();
                eye.policy_mut().give_recorded(&ids);
            }
        }
        eye.frame(scene, &view, queries, draw).expect("a frame");
        for object in objects.iter() {
            let drawn = eye.visible().iter().any(|o| o.id == object.id);
            assert!(
                drawn || !truth.exact.contains(object.id),
                "{} lost {:?}",
                eye.policy().name(),
                object.id
            );
            let bounds = scene.object(object.id).expect("it is there").bounds;
            assert!(drawn || bounds.is_some(), "what is bad is drawn always");
        }
        scene.adapt([&mut *eye]);
    }
}

/// The twelve triangles of a box.
fn solid(aabb: &Aabb) -> Mesh {
    const FACES: [u32; 36] = [
        0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3,
        7, 5,
    ];
    let corners: [Vec3; 8] = aabb.corners();
    Mesh::new("box", corners.to_vec(), FACES.to_vec()).expect("a box is a mesh")
}
