//! How fast the software backend draws and counts: two scenes, by instruction set, threads and
//! resolution, beside a plain depth buffer that goes sample by sample.
//!
//! All ways take turns, round by round, in one process; the tables have medians, and ratios of
//! medians to the plain way's (which draws the same faces) and to one thread's. *Best* is the shortest of all rounds, which says
//! more where others use the machine. Drawing includes clearing; everything is in the
//! frustum and comes from near to far. `cargo bench --bench software`; after `--`, `--quick` makes
//! it short.

mod plain;
mod scene;

use std::time::Instant;

use rand::RngExt;
use tercet::geom::{Proxy, View};
use tercet::query::software::{Faces, SimdLevel, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};

use plain::Plain;
use scene::Scene;

fn main() {
    let quick = std::env::args().any(|argument| argument == "--quick");
    let rounds = if quick { 7 } else { 11 };
    let sizes: &[_] = if quick { &[(1280, 720)] } else { &[(640, 360), (1280, 720), (1920, 1080)] };
    println!(
        "| scene | size | way | faces | threads | Mtri/s | best | skipped | / plain | / 1 thread | ns a count | best | plain / it |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let scenes = [
        Scene::boxes("boxes", 11_000, |dice| dice.random_range(5.0..50.0)),
        Scene::boxes("small boxes", 11_000, |dice| f32::sqrt(dice.random_range(5.0..50.0))),
        Scene::bunnies(36),
    ];
    for scene in scenes {
        for &(width, height) in sizes {
            compare(&scene, width, height, rounds);
        }
    }
}

/// A way to draw and to count.
struct Way {
    by: By,
    faces: Faces,
}

enum By {
    Plain(Box<Plain>),
    Ours { level: SimdLevel, threads: usize, queries: Box<SoftwareQueries>, pool: rayon::ThreadPool },
}

/// What a way took, in seconds for everything.
#[derive(Clone, Copy)]
struct Took {
    draw: f64,
    count: f64,
}

/// All ways on one scene at one size.
fn compare(scene: &Scene, width: u32, height: u32, rounds: usize) {
    let view = scene::view(width, height);
    let proxies = scene.proxies(&view);
    let mut ways = Vec::new();
    let best = SimdLevel::detect();
    for faces in [Faces::Both, Faces::Front] {
        ways.push(Way { by: By::Plain(Box::new(Plain::new())), faces });
        let levels = SimdLevel::ALL.into_iter().filter(|&level| level <= best);
        // What culling back faces gains is shown at the best level only.
        for level in levels.filter(|&level| faces == Faces::Both || level == best) {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let queries = Box::new(SoftwareQueries::with_level(level));
                ways.push(Way { by: By::Ours { level, threads, queries, pool }, faces });
            }
        }
    }
    let mut took = vec![Vec::new(); ways.len()];
    // The first round warms up.
    for round in 0..=rounds {
        for (way, took) in ways.iter_mut().zip(&mut took) {
            let once = way.run(scene, &view, &proxies);
            took.extend((round > 0).then_some(once));
        }
    }
    let drawing = Summary::new(took.iter().map(|took| took.iter().map(|t| t.draw).collect()));
    let counting = Summary::new(took.iter().map(|took| took.iter().map(|t| t.count).collect()));
    let triangles = scene.triangles() as f64;
    let (mut one_thread, mut plain) = (f64::NAN, 0);
    for (i, way) in ways.iter().enumerate() {
        let (name, threads, drawn) = match &way.by {
            By::Plain(_) => ("plain".into(), 1, triangles),
            By::Ours { level, threads, queries, .. } => {
                (format!("{level:?}"), *threads, queries.stats().triangles as f64)
            }
        };
        let faces = match way.faces {
            Faces::Both => "both",
            Faces::Front => "front",
        };
        let draw = drawing[i];
        let count = counting[i];
        if matches!(way.by, By::Plain(_)) {
            plain = i;
        }
        if threads == 1 {
            one_thread = draw.median;
        }
        let each = 1e9 / proxies.len() as f64;
        println!(
            "| {} | {width} × {height} | {name} | {faces} | {threads} | {:.1} | {:.1} | {:.0} % | {:.1} | {:.2} | {:.0} | {:.0} | {:.1} |",
            scene.name,
            1e-6 * triangles / draw.median,
            1e-6 * triangles / draw.best,
            100.0 * (1.0 - drawn / triangles),
            drawing[plain].median / draw.median,
            one_thread / draw.median,
            each * count.median,
            each * count.best,
            counting[plain].median / count.median,
        );
    }
}

/// Of all rounds of a way, in seconds.
#[derive(Clone, Copy)]
struct Summary {
    median: f64,
    best: f64,
}

impl Summary {
    fn new(ways: impl Iterator<Item = Vec<f64>>) -> Vec<Self> {
        ways.map(|mut rounds| {
            rounds.sort_unstable_by(f64::total_cmp);
            Self { median: rounds[rounds.len() / 2], best: rounds[0] }
        })
        .collect()
    }
}

impl Way {
    fn run(&mut self, scene: &Scene, view: &View, proxies: &[Proxy]) -> Took {
        let faces = self.faces;
        match &mut self.by {
            By::Plain(plain) => {
                let start = Instant::now();
                plain.draw(view, faces, &scene.calls);
                let draw = start.elapsed().as_secs_f64();
                let start = Instant::now();
                let visible: u64 = proxies.iter().map(|proxy| u64::from(plain.dual(proxy).0)).sum();
                std::hint::black_box(visible);
                Took { draw, count: start.elapsed().as_secs_f64() }
            }
            By::Ours { queries, pool, .. } => pool.install(|| {
                let start = Instant::now();
                queries.begin(view).expect("begin");
                queries
                    .draw(|pass| {
                        for (mesh, placed) in &scene.calls {
                            pass.draw_faces(mesh, 0, faces, placed);
                        }
                    })
                    .expect("draw");
                // The hierarchy is part of drawing: it is made before the first question.
                queries.ask(Ticket(0), &proxies[..1], Want::Any).expect("ask");
                queries.answers(Wait::Block, |_, _| {}).expect("answers");
                let draw = start.elapsed().as_secs_f64();
                let start = Instant::now();
                for (ticket, proxy) in (0..).zip(proxies) {
                    queries.ask(Ticket(ticket), std::slice::from_ref(proxy), Want::Dual).expect("ask");
                }
                let mut seen = 0;
                let deliver = |_, answer: Answer<'_>| match answer {
                    Answer::Dual { visible, .. } => seen += u64::from(visible),
                    other => panic!("{other:?}"),
                };
                queries.answers(Wait::Block, deliver).expect("answers");
                std::hint::black_box(seen);
                Took { draw, count: start.elapsed().as_secs_f64() }
            }),
        }
    }
}
