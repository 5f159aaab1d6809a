//! What each dial of [`Tradeoff`] gives up, and what none of them may.

use glam::{Affine3A, Vec3};
use tercet::geom::{Aabb, View, Viewport};
use tercet::policy::{self, DualQuery, Policy, StopAndWait};
use tercet::query::QueryBackend;
use tercet::query::software::SoftwareQueries;
use tercet::scene::mesh::Mesh;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{LeafSize, TreeConfig};
use tercet::{Budget, Culler, FrameStats, Latency, Tradeoff};

use crate::square;

/// A world of our own: squares of side 2 that face the camera, and one behind them.
struct Cards {
    scene: Scene,
    mesh: Mesh,
    ids: Vec<ObjectId>,
    places: Vec<Affine3A>,
}

impl Cards {
    fn new(places: &[Affine3A]) -> Self {
        let mesh = square();
        // A leaf for each.
        let tree =
            TreeConfig { bulk_leaf: 1, unasked_leaf: 1, leaf_size: LeafSize::Fixed, ..TreeConfig::stable() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let bounds = |place: &Affine3A| mesh.bounds_under(place);
        let ids = places.iter().map(|place| scene.insert(bounds(place), Traits::default())).collect();
        // A tree is made of many: some stand aside, out of view.
        for n in 0..16 {
            scene.insert(bounds(&at(0.0, 300.0 + 10.0 * n as f32, 0.0, 1.0)), Traits::default());
        }
        scene.update();
        Self { scene, mesh, ids, places: places.to_vec() }
    }

    fn put(&mut self, card: usize, place: Affine3A) {
        self.places[card] = place;
        let bounds: Aabb = self.mesh.bounds_under(&place);
        assert!(self.scene.set_bounds(self.ids[card], bounds), "it is there");
        self.scene.update();
    }

    /// Draws a frame; says which cards were drawn, as bits.
    fn frame<P: Policy>(
        &self,
        eye: &mut Culler<P>,
        view: &View,
        queries: &mut SoftwareQueries,
    ) -> (u32, FrameStats) {
        let slot = |id: ObjectId| self.ids.iter().position(|&other| other == id).expect("one of ours");
        let stats = eye
            .frame(&self.scene, view, queries, |pass, objects| {
                for object in objects {
                    pass.draw_mesh(&self.mesh, &self.places[slot(object.id)]);
                }
            })
            .expect("a frame");
        (eye.visible().iter().fold(0, |cards, object| cards | 1 << slot(object.id)), stats)
    }
}

fn at(x: f32, y: f32, z: f32, size: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z)) * Affine3A::from_scale(Vec3::splat(size))
}

fn view(x: f32) -> View {
    let eye = Vec3::new(x, 0.0, 10.0);
    View::look_at(eye, eye - Vec3::Z, 60.0, 0.1, Viewport::new(200, 100)).expect("a view")
}

fn eye<P: Policy>(policy: P, tradeoff: Tradeoff) -> Culler<P> {
    let mut eye = Culler::new(policy);
    eye.tradeoff = tradeoff;
    eye
}

#[test]
fn a_budget_is_kept_and_what_it_refuses_is_drawn() {
    let mut places: Vec<_> = (0..30).map(|n| at(n as f32 * 0.2 - 3.0, 0.0, -5.0, 0.3)).collect();
    places.push(at(0.0, 0.0, 2.0, 6.0));
    let cards = Cards::new(&places);
    for name in ["stop-and-wait", "chc", "chc++", "dual-query", "roc", "hroc", "hi-z", "hybrid"] {
        let policy = || policy::by_name(name).expect("a policy of that name");
        let mut drawn = Vec::new();
        for queries in [None, Some(3), Some(0)] {
            let budget = Budget { queries, ..Budget::default() };
            let mut eye = eye(policy(), Tradeoff { budget, ..Tradeoff::EXACT });
            let mut backend = SoftwareQueries::new();
            let mut sum = 0;
            for _ in 0..4 {
                let (_, stats) = cards.frame(&mut eye, &view(0.0), &mut backend);
                assert!(stats.queries <= queries.unwrap_or(u32::MAX), "{name}: {} questions", stats.queries);
                assert_eq!(queries == Some(0), stats.queries == 0, "{name}");
                sum += stats.drawn;
            }
            drawn.push(sum);
        }
        assert_eq!(drawn[2], 4 * places.len() as u32, "{name}: without questions, all are drawn");
        assert!(drawn[0] < drawn[2], "{name} culls with them: {drawn:?}");
    }
}

#[test]
fn a_budget_of_pixels_and_one_of_time_are_kept() {
    let mut places: Vec<_> = (0..30).map(|n| at(n as f32 * 0.2 - 3.0, 0.0, -5.0, 0.3)).collect();
    places.push(at(0.0, 0.0, 2.0, 6.0));
    let cards = Cards::new(&places);
    let budgets = [
        Budget { box_pixels: Some(50), ..Budget::default() },
        Budget { time: Some(std::time::Duration::ZERO), ..Budget::default() },
    ];
    for budget in budgets {
        let mut eye = eye(StopAndWait::default(), Tradeoff { budget, ..Tradeoff::EXACT });
        let (_, stats) = cards.frame(&mut eye, &view(0.0), &mut SoftwareQueries::new());
        assert!(stats.refused > 0 && stats.drawn == places.len() as u32, "{stats:?} with {budget:?}");
    }
}

#[test]
fn a_coarser_depth_loses_what_shows_only_between_its_samples() {
    // Two screens with a gap of a pixel between them, and something far behind it.
    let gap = 0.02;
    let places = [at(-4.0 - gap, 0.0, 0.0, 4.0), at(4.0 + gap, 0.0, 0.0, 4.0), at(0.0, 0.0, -30.0, 0.5)];
    let cards = Cards::new(&places);
    // Nudged, so that a column of samples falls into the gap.
    let lost = |resolution_divisor: u32| {
        let tradeoff = Tradeoff { resolution_divisor, ..Tradeoff::EXACT };
        let views = (-20..20).map(|n| view(n as f32 * 0.002));
        let mut lost = 0;
        for view in views {
            let mut backend = SoftwareQueries::new();
            let (seen, _) = cards.frame(&mut eye(StopAndWait::default(), tradeoff), &view, &mut backend);
            let (width, height) = (backend.depth().width(), backend.depth().height());
            assert_eq!(
                (width, height),
                (200_u32.div_ceil(resolution_divisor), 100_u32.div_ceil(resolution_divisor))
            );
            let exact = eye(StopAndWait::default(), Tradeoff::EXACT);
            let (all, _) = cards.frame(&mut { exact }, &view, &mut SoftwareQueries::new());
            assert_eq!(all & 0b11, seen & 0b11, "the screens are large");
            lost += (all & !seen).count_ones();
        }
        lost
    };
    assert_eq!(lost(1), 0);
    assert!(lost(3) > 0, "{} of 40", lost(3));
}

#[test]
fn late_questions_see_the_depth_of_then() {
    // A curtain, a thing behind it, and one beside it.
    let places = [at(0.0, 0.0, 0.0, 3.0), at(0.0, 0.0, -5.0, 0.5), at(5.0, 0.0, -5.0, 0.5)];
    for frames in 1..=3 {
        let mut cards = Cards::new(&places);
        let latency = Latency::Late(frames);
        let mut eye = eye(StopAndWait::default(), Tradeoff { latency, ..Tradeoff::EXACT });
        let mut queries = SoftwareQueries::new();
        for frame in 0..8 {
            let (drawn, _) = cards.frame(&mut eye, &view(0.0), &mut queries);
            assert_eq!(drawn, 0b101, "frame {frame}: nothing moves, and all is as ever");
        }
        // The curtain goes up: for so many frames, nobody has seen what is behind it.
        cards.put(0, at(0.0, 40.0, 0.0, 3.0));
        for frame in 0..frames + 3 {
            let (drawn, stats) = cards.frame(&mut eye, &view(0.0), &mut queries);
            assert_eq!(drawn & 0b10 != 0, frame >= frames, "{frames} late, frame {frame}");
            assert_eq!(stats.cuts, 0);
        }
        // A cut has no past. Nor has another scene.
        cards.put(0, at(0.0, 0.0, 0.0, 3.0));
        for _ in 0..6 {
            cards.frame(&mut eye, &view(0.0), &mut queries);
        }
        cards.put(0, at(0.0, 40.0, 0.0, 3.0));
        eye.cut();
        assert_eq!(cards.frame(&mut eye, &view(0.0), &mut queries).0, 0b110, "{frames} late, after a cut");
    }
}

#[test]
fn swept_boxes_lose_less() {
    // One that flies away from the camera: where it was, it hides where it is.
    let lost = |swept: bool| {
        let mut cards = Cards::new(&[at(0.0, 0.0, 0.0, 1.0), at(3.0, 0.0, -3.0, 1.0)]);
        let mut eye =
            eye(DualQuery::default(), Tradeoff { latency: Latency::Late(2), swept, ..Tradeoff::EXACT });
        let mut queries = SoftwareQueries::new();
        let mut lost = 0;
        for frame in 0..12 {
            // Two updates a frame: what counts is what has moved since, not how often.
            cards.put(0, at(0.0, 0.0, -(frame as f32), 1.0));
            cards.put(1, at(3.0, 0.0, -3.0 - 0.01 * frame as f32, 1.0));
            cards.put(1, at(3.0, 0.0, -3.0, 1.0));
            let (drawn, _) = cards.frame(&mut eye, &view(0.0), &mut queries);
            lost += 2 - drawn.count_ones();
        }
        lost
    };
    assert!(lost(false) > 0, "it is lost now and then");
    assert_eq!(lost(true), 0);
    // One that comes into sight beside a curtain because the camera goes sideways.
    let late = |swept: bool| {
        let cards = Cards::new(&[at(0.0, 0.0, 0.0, 1.0), at(0.0, 0.0, -4.0, 0.3)]);
        let mut eye =
            eye(StopAndWait::default(), Tradeoff { latency: Latency::Late(1), swept, ..Tradeoff::EXACT });
        let mut exact = Culler::new(StopAndWait::default());
        let (mut queries, mut others) = (SoftwareQueries::new(), SoftwareQueries::new());
        let mut lost = 0;
        for frame in 0..40 {
            let view = view(frame as f32 * 0.1);
            let (drawn, _) = cards.frame(&mut eye, &view, &mut queries);
            let (seen, _) = cards.frame(&mut exact, &view, &mut others);
            lost += (seen & !drawn).count_ones();
        }
        lost
    };
    assert!(late(false) > 0 && late(true) == 0, "{} and {}", late(false), late(true));
}

#[test]
fn what_is_kept_of_earlier_frames_goes_when_it_is_no_longer_wanted() {
    let mut queries = SoftwareQueries::new();
    let mut sizes = Vec::new();
    for frames in [0, 3, 3, 3, 3, 3, 1, 1, 0] {
        match frames {
            0 => queries.begin(&view(0.0)).expect("a frame"),
            _ => drop(queries.begin_late(&view(0.0), frames).expect("a frame")),
        }
        queries.end().expect("an end");
        sizes.push(queries.bytes());
    }
    let frames: Vec<usize> = sizes.iter().map(|bytes| bytes / sizes[0]).collect();
    assert_eq!(frames, [1, 1, 2, 3, 4, 4, 2, 2, 1], "frames' worth of memory");
}
