//! The hybrid: what moves is swept by itself, what stands still in groups.

use glam::{Affine3A, Vec3};
use hecs::{Entity, World};
use tercet::draw::{Detail, Drawable};
use tercet::geom::{View, Viewport};
use tercet::policy::{Hybrid, Policy};
use tercet::query::oracle::Oracle;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Bounds, Scene, SceneConfig};
use tercet::worlds;
use tercet::{Culler, Tradeoff};

use crate::painter::draw;

/// A hall of boxes, some of which walk when they are told to.
struct Hall {
    world: World,
    scene: Scene,
    eye: Culler<Hybrid>,
    queries: SoftwareQueries,
    oracle: Oracle,
    everybody: Vec<Entity>,
    frame: u32,
}

/// What a frame asked.
#[derive(Debug, PartialEq)]
struct Asked {
    awake: u32,
    groups: u32,
    loose: u32,
}

impl Hall {
    fn new() -> Self {
        let mut world = World::new();
        worlds::random(3, 400).spawn(&mut world);
        let mut everybody: Vec<Entity> =
            world.query::<(Entity, &Drawable)>().iter().map(|(entity, _)| entity).collect();
        everybody.sort_unstable();
        let mut eye = Culler::new(Hybrid::default());
        // What was visible is not swept again: what is loose moves, or stands beside it.
        eye.policy_mut().occluder_filtering = true;
        eye.tradeoff = Tradeoff::EXACT;
        let mut scene = Scene::new(SceneConfig::default());
        scene.adapt([&mut eye]);
        let queries = SoftwareQueries::new();
        Self { world, scene, eye, queries, oracle: Oracle::new(), everybody, frame: 0 }
    }

    /// A frame in which every so many-th object walks. Nothing that is visible may be missing.
    fn frame(&mut self, walkers: Option<usize>) -> Asked {
        self.frame += 1;
        let step = Vec3::new(0.02, 0.0, 0.03) * if self.frame.is_multiple_of(40) { -1.0 } else { 1.0 };
        for &entity in self.everybody.iter().step_by(walkers.unwrap_or(usize::MAX)) {
            if walkers.is_none() {
                break;
            }
            let drawable = self.world.query_one_mut::<&mut Drawable>(entity).expect("a drawable");
            drawable.world_from_object = Affine3A::from_translation(step) * drawable.world_from_object;
            let bounds = drawable.mesh.bounds_under(&drawable.world_from_object);
            self.world.insert_one(entity, Bounds(bounds)).expect("alive");
        }
        self.scene.sync(&self.world);
        let angle = 0.01 * self.frame as f32;
        let eye = 30.0 * Vec3::new(angle.cos(), 0.2, angle.sin());
        let view = View::look_at(eye, Vec3::ZERO, 60.0, 0.1, Viewport::new(160, 90)).expect("a view");
        let (world, detail) = (&self.world, Detail::default());
        let truth = self
            .oracle
            .look(&self.scene, &view, |pass, objects| draw(world, &view, detail, pass, objects))
            .expect("the oracle looks");
        self.eye
            .frame(&self.scene, &view, &mut self.queries, |pass, objects| {
                draw(world, &view, detail, pass, objects);
            })
            .expect("a frame");
        let drawn: Vec<usize> = self.eye.visible().iter().map(|object| object.id.slot()).collect();
        let lost = truth.exact.slots().find(|slot| !drawn.contains(slot));
        assert_eq!(lost, None, "frame {}", self.frame);
        let counters = self.eye.policy().counters();
        let count = |key| counters.iter().find(|c| c.key == key).expect("a counter of that name").count;
        Asked { awake: count("awake"), groups: count("groups"), loose: count("loose") }
    }

    fn settle_frames(&self) -> u32 {
        self.scene.tree().config().settle_frames
    }
}

#[test]
fn what_stands_still_goes_by_groups_and_what_moves_by_itself() {
    let mut hall = Hall::new();
    // What has just come is awake.
    let first = hall.frame(None);
    assert!(first.awake > 100 && first.groups == 0 && first.loose == first.awake, "{first:?}");
    for _ in 0..hall.settle_frames() {
        hall.frame(None);
    }
    for _ in 0..5 {
        let asked = hall.frame(None);
        assert!(asked.awake == 0 && asked.groups > 0, "a still hall has no movers: {asked:?}");
    }
    // All move: nothing is asked about in groups.
    for _ in 0..5 {
        let asked = hall.frame(Some(1));
        // What was drawn already is not asked about.
        assert!(
            asked.groups == 0 && asked.loose > 0 && asked.loose < asked.awake && asked.awake > 100,
            "{asked:?}"
        );
    }
    // Some do: they alone are awake, once the others have come to rest.
    let mut asked = hall.frame(Some(10));
    for _ in 0..2 * hall.settle_frames() {
        asked = hall.frame(Some(10));
    }
    assert!(asked.groups > 0 && asked.awake > 5 && asked.awake <= 40, "{asked:?}");
    // They fall asleep, and wake again.
    for _ in 0..4 {
        for _ in 0..hall.settle_frames() + 1 {
            asked = hall.frame(None);
        }
        assert_eq!(asked.awake, 0);
        asked = hall.frame(Some(10));
        assert!(asked.awake > 5, "{asked:?}");
    }
}
