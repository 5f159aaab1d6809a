//! What the proxies assume of rasterisers, of the real ones: what a box holds is covered by its
//! proxy, and not before it.

use glam::{Mat4, Vec3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, Proxy, Question, View, Viewport, projection};
use tercet::query::gpu::{FrameTargets, GpuConfig, GpuQueries};
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};

use crate::geometry::random_case;
use crate::support::{depth_of, gpus, targets};
use crate::twin::{conventions, view_of};

/// Real triangles in a box, on the real rasteriser, in all kinds of views: no sample that they own
/// lies outside of the box's proxy or before it, but for what an emulated depth range adds; and
/// the answer counts all of them. This is what culling relies on.
#[test]
fn no_box_is_hidden_by_its_own_triangles() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut dice = ChaCha8Rng::seed_from_u64(5);
        let slack = if gpu.backend == wgpu::Backend::Gl { 8.0 / 16_777_216.0 } else { 0.0 };
        let (mut owned, mut most) = (0, f32::MIN);
        for convention in conventions(&gpu) {
            let mut asked = 0;
            while asked < 30 {
                let view = view_of(&mut dice, convention);
                let case = random_case(&mut dice, |_| view.clone());
                let Question::Ask(proxy) = Question::new(&case.world, &view) else { continue };
                let triangles: Vec<_> =
                    (0..20).map(|_| case.triangle(&mut dice).map(|p| case.clip(p))).collect();
                let (depth, nearness) = depth_of(&gpu, &mut queries, &view, &triangles);
                let mut drawn = 0;
                for (x, y, stored) in nearness.drawn(view.depth().cleared()) {
                    let covered = proxy.rect.contains(x, y) && proxy.covers(x, y);
                    assert!(covered, "({x}, {y}) lies outside {proxy:?} of {case:#?}");
                    let excess = stored - proxy.nearness(x, y);
                    most = most.max(excess);
                    assert!(excess <= slack, "({x}, {y}) lies {excess} before {proxy:?} of {case:#?}");
                    drawn += 1;
                }
                let visible = ask_one(&mut queries, &view, &targets(&depth, true), &proxy);
                assert!(visible >= drawn, "{visible} of {drawn} seen of {proxy:?} in {case:#?}");
                asked += 1;
                owned += drawn;
            }
        }
        println!("{:?}: {owned} samples, at most {most} before their proxy", gpu.backend);
        assert!(owned > 20_000, "{owned} samples");
    }
}

/// A flat box that faces the viewer hides behind nothing of its own, at any distance: its depth is
/// the same all over, so nothing but the allowance for rounding keeps it in sight.
#[test]
fn no_facing_box_is_hidden_by_itself() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut exact = gpu.exact_queries(GpuConfig::default());
        let clip_from_view = projection::perspective(1.0, 1.0, 0.1);
        let view = View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(32, 32)).expect("a view");
        let mut needed = 0;
        for i in 0..200 {
            let distance = 1.08f32.powi(i) * 0.2;
            let half = Vec3::new(0.3, 0.2, 0.0) * distance;
            let bounds = Aabb::from_center(Vec3::NEG_Z * distance, half);
            let Question::Ask(proxy) = Question::new(&bounds, &view) else { panic!("{distance} m") };
            let corner = |x: f32, y: f32| {
                clip_from_view * (Vec3::new(x, y, 0.0) * half - Vec3::Z * distance).extend(1.0)
            };
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let (depth, nearness) = depth_of(&gpu, &mut queries, &view, &[[a, b, c], [a, c, d]]);
            let drawn = nearness.drawn(0.0).count() as u32;
            let targets = targets(&depth, true);
            let visible = ask_one(&mut queries, &view, &targets, &proxy);
            assert!(drawn > 0 && visible >= drawn, "{:?} at {distance} m: {visible} of {drawn}", gpu.backend);
            needed += u32::from(ask_one(&mut exact, &view, &targets, &proxy) < drawn);
        }
        println!("{:?}: {needed} would be hidden without slack", gpu.backend);
        assert!(needed == 0 || gpu.backend == wgpu::Backend::Gl, "{needed}");
    }
}

/// How many samples of a proxy are in sight in a frame in which nothing is drawn.
fn ask_one(queries: &mut GpuQueries, view: &View, targets: &FrameTargets, proxy: &Proxy) -> u32 {
    queries.target(targets);
    queries.begin(view).expect("begin");
    queries.ask(Ticket(0), &[*proxy], Want::Dual).expect("ask");
    let mut found = 0;
    queries
        .answers(Wait::Block, |_, answer| match answer {
            Answer::Dual { visible, .. } => found = visible,
            other => panic!("{other:?}"),
        })
        .expect("answers");
    queries.end().expect("end");
    found
}
