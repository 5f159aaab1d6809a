//! Objects are drawn by the software backend on several threads, and asked about, all in memory that
//! earlier frames have made.

use glam::{Affine3A, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stats_alloc::Region;
use tercet::geom::{Aabb, Proxy, Question, View, Viewport};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{QueryBackend, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;

use super::ALLOCATOR;

pub(crate) fn check() {
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
