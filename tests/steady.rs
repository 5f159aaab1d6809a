//! A steady frame allocates nothing: objects move to and fro, are found by their frustum, and the
//! tree follows; they are drawn by the software backend on several threads, and asked about; all in
//! memory that earlier frames have made.

use std::alloc::System;

use glam::{Affine3A, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use tercet::Culler;
use tercet::geom::{Aabb, Frustum, Proxy, Question, View, Viewport};
use tercet::policy::FrustumOnly;
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{QueryBackend, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::Walk;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One test: allocations are counted for the whole process. The short part comes first, since the
/// harness takes memory to say that a test has been running for a minute.
#[test]
fn a_steady_frame_allocates_nothing() {
    drawing();
    following();
}

fn following() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut vec3 =
        |low: f32, high: f32| Vec3::from_array(std::array::from_fn(|_| rng.random_range(low..high)));
    let boxes: Vec<Aabb> = (0..5000).map(|_| Aabb::from_center(vec3(0.0, 68.0), vec3(0.1, 1.0))).collect();
    let steps: Vec<Vec3> = boxes.iter().map(|_| vec3(-0.05, 0.05)).collect();
    let mut scene = Scene::new(SceneConfig::default());
    let ids: Vec<ObjectId> = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
    let eye = Vec3::splat(34.0);
    let view = View::look_at(eye, eye - Vec3::Z, 75.0, 0.1, Viewport::new(256, 256)).expect("a view");
    let frustum = Frustum::new(&view);
    let mut walk = Walk::new();
    let mut seen = 0;
    let mut frame = |scene: &mut Scene, frame: i32| {
        // 50 frames one way, 50 back: a world that goes nowhere.
        let away = 50 - (frame % 100 - 50).abs();
        let at = |(i, b): (usize, &Aabb)| {
            (ids[i], Aabb::new(b.min + steps[i] * away as f32, b.max + steps[i] * away as f32))
        };
        scene.sync_moved(boxes.iter().enumerate().map(at));
        walk.run(scene.tree(), &frustum, view.eye(), |_, lanes| seen += lanes.count_ones());
        scene.adapt::<Culler<FrustumOnly>>([]);
    };
    // Room for blocks grows to what the fullest moment takes, which comes late.
    (0..4000).for_each(|f| frame(&mut scene, f));
    scene.tree().validate().expect("a valid tree");
    let moves = scene.tree().stats().moves;
    let region = Region::new(ALLOCATOR);
    (4000..6000).for_each(|f| frame(&mut scene, f));
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert!(scene.tree().stats().moves > moves + 1000, "objects did change their nodes");
    assert!(seen > 0);
}

fn drawing() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut vec3 = |r: f32| Vec3::from_array(std::array::from_fn(|_| rng.random_range(-r..r)));
    // More draw calls and triangles than one thread is left alone with: some of one part, some of
    // several.
    let mut soup = |triangles: usize| {
        let positions = (0..3 * triangles).map(|_| vec3(1.0)).collect();
        Mesh::new("soup", positions, (0..3 * triangles as u32).collect()).expect("a mesh")
    };
    let meshes = [soup(4), soup(50), soup(400)];
    let places: Vec<Affine3A> = (0..900).map(|_| Affine3A::from_translation(vec3(9.0))).collect();
    let eye = Vec3::new(0.0, 0.0, 20.0);
    let view = View::look_at(eye, Vec3::ZERO, 60.0, 0.1, Viewport::new(500, 300)).expect("a view");
    let boxes = places.iter().map(|place| Aabb::from_center(place.translation.into(), Vec3::splat(0.3)));
    let asked = boxes.filter_map(|bounds| match Question::new(&bounds, &view) {
        Question::Ask(proxy) => Some(proxy),
        _ => None,
    });
    let proxies: Vec<Proxy> = asked.collect();
    let mut queries = SoftwareQueries::new();
    let mut seen = 0;
    let mut frame = || {
        queries.begin(&view).expect("begin");
        for half in places.chunks(450) {
            let calls = half.iter().zip(meshes.iter().cycle());
            let record =
                |pass: &mut SoftwarePass| calls.for_each(|(place, mesh)| pass.draw_mesh(mesh, place));
            queries.draw(record).expect("draw");
            queries.ask(Ticket(0), &proxies, Want::Any).expect("ask");
        }
        queries.answers(Wait::Block, |_, answer| seen += u32::from(answer.is_visible(0))).expect("answers");
        queries.end().expect("end");
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("a pool");
    // Inside of the pool: to hand work in from outside takes memory now and then. And threads that start
    // take some: all of them have.
    let change = pool.install(|| {
        pool.broadcast(|_| ());
        (0..30).for_each(|_| frame());
        let region = Region::new(ALLOCATOR);
        (0..60).for_each(|_| frame());
        region.change()
    });
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert!(seen > 0);
}
