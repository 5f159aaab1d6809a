//! The exact visible set against drawing each object by itself.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};
use rand::RngExt;
use tercet::geom::{Aabb, View, Viewport};
use tercet::query::QueryBackend;
use tercet::query::oracle::{Oracle, Truth};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig, Traits};

use crate::support::{depth, dice, pool, soup};

/// A scene without a world: a mesh for each object.
struct Things {
    scene: Scene,
    meshes: HashMap<ObjectId, Mesh>,
}

impl Things {
    fn new() -> Self {
        Self { scene: Scene::new(SceneConfig::default()), meshes: HashMap::new() }
    }

    fn add(&mut self, triangles: &[[Vec3; 3]], not_occluder: bool) -> ObjectId {
        let mesh = soup(triangles);
        let id = self.scene.insert(mesh.bounds(), Traits { not_occluder, ..Traits::default() });
        self.scene.update();
        self.meshes.insert(id, mesh);
        id
    }

    fn draw(&self, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
        for object in objects {
            pass.draw_mesh(&self.meshes[&object.id], &Affine3A::IDENTITY);
        }
    }

    fn look(&self, oracle: &mut Oracle, view: &View) -> Truth {
        oracle.look(&self.scene, view, |pass, objects| self.draw(pass, objects)).expect("a look")
    }

    /// The frame of some of the objects.
    fn frame(&self, view: &View, shown: impl Fn(ObjectId) -> bool) -> SoftwareQueries {
        let objects: Vec<_> =
            self.scene.objects().map(|o| o.object).filter(|object| shown(object.id)).collect();
        let mut queries = SoftwareQueries::new();
        queries.begin(view).expect("begin");
        queries.draw(|pass| self.draw(pass, &objects)).expect("draw");
        queries
    }
}

fn view() -> View {
    View::look_at(Vec3::new(0.0, 0.0, 20.0), Vec3::ZERO, 60.0, 0.1, Viewport::new(200, 150)).expect("a view")
}

/// Random objects, some of them walls and some that hide nothing.
fn crowd(seed: u64) -> Things {
    let mut dice = dice(seed);
    let mut things = Things::new();
    for i in 0..150 {
        let mut v =
            |r: f32| Vec3::new(dice.random_range(-r..r), dice.random_range(-r..r), dice.random_range(-r..r));
        let at = v(12.0);
        let size = if i % 10 == 0 { 8.0 } else { 0.8 };
        let all: Vec<_> = (0..12).map(|_| [v(size), v(size), v(size)].map(|p| at + p)).collect();
        things.add(&all, i % 7 == 3);
    }
    things
}

#[test]
fn the_exact_set_is_that_of_objects_drawn_alone() {
    for seed in 0..4 {
        let (things, view) = (crowd(seed), view());
        let truth = things.look(&mut Oracle::new(), &view);
        let hides = |id| !things.scene.object(id).expect("an object").traits.not_occluder;
        let full = depth(&things.frame(&view, hides));
        let (mut visible, mut hidden) = (0, 0);
        for object in things.scene.objects() {
            let id = object.object.id;
            let alone = depth(&things.frame(&view, |other| other == id));
            let want = alone.iter().zip(&full).any(|(&own, &all)| own > 0.0 && own >= all);
            assert_eq!(truth.exact.contains(id), want, "seed {seed}, {object:?}");
            visible += usize::from(want);
            hidden += usize::from(!want);
            if want {
                assert!(truth.box_visible.contains(id), "seed {seed}: the box of {object:?} is hidden");
                assert!(truth.in_frustum.contains(id));
            }
        }
        assert!(visible > 20 && hidden > 20, "seed {seed}: {visible} visible, {hidden} hidden");
    }
}

#[test]
fn the_image_is_the_same_for_any_number_of_threads() {
    let (things, view) = (crowd(9), view());
    let look = |threads: usize| {
        pool(threads).install(|| {
            let mut oracle = Oracle::new();
            let truth = things.look(&mut oracle, &view);
            (truth, oracle.image().call.clone(), oracle.image().triangle.clone())
        })
    };
    let one = look(1);
    assert!(look(2) == one && look(4) == one);
}

/// Each pixel's surface, drawn alone, has the pixel's own nearness.
#[test]
fn surfaces_are_what_the_pixels_show() {
    let (things, view) = (crowd(2), view());
    let mut oracle = Oracle::new();
    things.look(&mut oracle, &view);
    let all = depth(&things.frame(&view, |_| true));
    let mut shown = 0;
    for (i, &nearness) in all.iter().enumerate().step_by(13) {
        let (x, y) = (i as u32 % 200, i as u32 / 200);
        let Some(surface) = oracle.surface(x, y) else {
            assert_eq!(nearness, 0.0, "pixel ({x}, {y}) has no surface");
            continue;
        };
        assert_eq!(surface.nearness, nearness);
        let mut alone = SoftwareQueries::new();
        alone.begin(&view).expect("begin");
        let mesh = soup(&[surface.corners]);
        alone.draw(|pass| pass.draw_mesh(&mesh, &Affine3A::IDENTITY)).expect("draw");
        assert_eq!(alone.depth().at(x, y), nearness);
        let inside = things.meshes[&surface.object.id].bounds();
        assert!(surface.corners.iter().all(|&c| inside.contains_point(c)));
        shown += 1;
    }
    assert!(shown > 200, "{shown} surfaces");
}

/// Leaving out what is hidden changes no pixel, leaving out what is visible does.
#[test]
fn wrong_pixels_are_counted() {
    let (things, view) = (crowd(5), view());
    let mut oracle = Oracle::new();
    let truth = things.look(&mut oracle, &view);
    let right = things.frame(&view, |id| truth.exact.contains(id));
    assert_eq!(oracle.wrong_pixels(&right), 0);
    let mut noticed = 0;
    for object in things.scene.objects().filter(|o| truth.exact.contains(o.object.id)) {
        let id = object.object.id;
        let wrong = things.frame(&view, |other| other != id && truth.exact.contains(other));
        noticed += usize::from(oracle.wrong_pixels(&wrong) > 0);
    }
    assert!(noticed > truth.exact.len() / 2, "{noticed} of {} are missed", truth.exact.len());
}

#[test]
fn glass_hides_nothing_and_is_hidden() {
    let quad = |z: f32, r: f32| {
        let [a, b, c, d] = [(-r, -r), (r, -r), (r, r), (-r, r)].map(|(x, y)| Vec3::new(x, y, z));
        [[a, b, c], [a, c, d]]
    };
    let mut things = Things::new();
    let before = things.add(&quad(2.0, 30.0), true);
    let wall = things.add(&quad(0.0, 30.0), false);
    let same = things.add(&quad(0.0, 5.0), false);
    let behind = things.add(&quad(-2.0, 5.0), true);
    let block = things.add(&quad(-3.0, 5.0), false);
    let away = things.add(&quad(90.0, 1.0), false);
    let mut oracle = Oracle::new();
    let truth = things.look(&mut oracle, &view());
    for (id, exact, boxed, name) in [
        (before, true, true, "glass before the wall"),
        (wall, true, true, "the wall"),
        (same, true, true, "a part of the wall, equally far"),
        (behind, false, false, "glass behind the wall"),
        (block, false, false, "a block behind the wall"),
        (away, false, false, "something behind the eye"),
    ] {
        assert_eq!(truth.exact.contains(id), exact, "{name}");
        assert_eq!(truth.box_visible.contains(id), boxed, "{name}, its box");
    }
    assert!(!truth.in_frustum.contains(away));
    assert_eq!(oracle.surface(100, 75).expect("a surface").object.id, before);
}

#[test]
fn an_object_with_a_bad_box_is_looked_at_too() {
    let mut things = Things::new();
    let id = things.add(&[[Vec3::ZERO, Vec3::X, Vec3::Y]], false);
    things.scene.set_bounds(id, Aabb::new(Vec3::NAN, Vec3::ONE));
    things.scene.update();
    let truth = things.look(&mut Oracle::new(), &view());
    assert!(truth.exact.contains(id) && truth.box_visible.contains(id) && truth.in_frustum.contains(id));
}
