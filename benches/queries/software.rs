//! Questions to the software backend, by resolution, size of the boxes and number of threads, beside
//! the plain loop over samples that defines the answers.

use std::time::Instant;

use glam::Affine3A;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, Proxy, View, Viewport};
use tercet::query::software::{SimdLevel, SoftwareQueries};
use tercet::query::{QueryBackend, Ticket, Wait, Want};
use tercet::scene::mesh::Mesh;

use crate::scene;

const BOXES: usize = 2000;

/// A way of asking about boxes.
enum Way {
    /// Sample by sample, over rows of depth.
    Plain(Vec<f32>),
    /// By this crate.
    Ours { level: SimdLevel, threads: usize, pool: rayon::ThreadPool, queries: Box<SoftwareQueries> },
}

/// Every resolution and size of boxes. The first round of each warms up.
pub fn table(short: bool) {
    let rounds = if short { 2 } else { 15 };
    println!("## Software\n");
    println!(
        "| size | pixels a box | in sight | way | threads | ns a dual count | plain / it | ns an any | plain / it |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (width, height) in [(640, 360), (1280, 720), (1920, 1080)] {
        for area in [20.0, 70.0, 2000.0] {
            compare(Viewport::new(width, height), area, rounds);
        }
    }
    println!();
}

/// All ways on one scene.
fn compare(screen: Viewport, area: f32, rounds: usize) {
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    let view = scene::view(screen);
    let (_, proxies) = scene::boxes(&mut dice, &view, BOXES, area);
    let walls: Vec<Mesh> = scene::walls(&mut dice, screen).iter().map(mesh).collect();
    let queries = |level| {
        let mut queries = Box::new(SoftwareQueries::with_level(level));
        queries.begin(&view).expect("begin");
        queries
            .draw(|pass| walls.iter().for_each(|wall| pass.draw_mesh(wall, &Affine3A::IDENTITY)))
            .expect("draw");
        queries
    };
    let best = SimdLevel::detect();
    let drawn = queries(best);
    let rows = (0..screen.height).flat_map(|y| drawn.depth().row(y)).collect();
    let mut ways = vec![Way::Plain(rows)];
    for (level, threads) in [(SimdLevel::Portable, 1), (best, 1), (best, 2)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        ways.push(Way::Ours { level, threads, pool, queries: queries(level) });
    }
    let mut took = vec![[Vec::new(), Vec::new()]; ways.len()];
    let mut in_sight = vec![0; ways.len()];
    for round in 0..=rounds {
        for ((way, took), in_sight) in ways.iter_mut().zip(&mut took).zip(&mut in_sight) {
            for (want, took) in [Want::Dual, Want::Any].into_iter().zip(took) {
                let start = Instant::now();
                *in_sight = way.ask(&view, &proxies, want);
                took.extend((round > 0).then(|| start.elapsed()));
            }
        }
    }
    assert!(in_sight.iter().all(|&seen| seen == in_sight[0]), "ways differ: {in_sight:?}");
    let medians: Vec<[f64; 2]> = took
        .into_iter()
        .map(|took| took.map(|rounds| 1e6 * crate::median(rounds.into_iter()) / proxies.len() as f64))
        .collect();
    let area = scene::mean_area(&proxies);
    for (way, [dual, any]) in ways.iter().zip(&medians) {
        let (name, threads) = match way {
            Way::Plain(_) => ("plain".into(), 1),
            Way::Ours { level, threads, .. } => (format!("{level:?}"), *threads),
        };
        println!(
            "| {} × {} | {area:.0} | {} | {name} | {threads} | {dual:.0} | {:.1} | {any:.0} | {:.1} |",
            screen.width,
            screen.height,
            in_sight[0],
            medians[0][0] / dual,
            medians[0][1] / any,
        );
    }
}

impl Way {
    /// Asks about all boxes; says how many are in sight.
    fn ask(&mut self, view: &View, proxies: &[Proxy], want: Want) -> usize {
        match self {
            Self::Plain(rows) => {
                let width = view.viewport().width as usize;
                proxies.iter().filter(|proxy| plain(proxy, rows, width, want) > 0).count()
            }
            Self::Ours { pool, queries, .. } => pool.install(|| {
                for (ticket, proxy) in (0..).zip(proxies) {
                    queries.ask(Ticket(ticket), std::slice::from_ref(proxy), want).expect("ask");
                }
                let mut visible = 0;
                let deliver = |_, answer: tercet::query::Answer<'_>| {
                    visible += usize::from(answer.is_visible(0));
                };
                queries.answers(Wait::Block, deliver).expect("answers");
                visible
            }),
        }
    }
}

/// The samples of a box that are in sight; any one of them is enough for those who want to know only
/// whether there is one.
fn plain(proxy: &Proxy, rows: &[f32], width: usize, want: Want) -> u32 {
    let (mut visible, mut total) = (0, 0);
    for y in proxy.rect.y0..proxy.rect.y1 {
        for x in proxy.rect.x0..proxy.rect.x1 {
            if proxy.covers(x, y) {
                total += 1;
                visible += u32::from(proxy.nearness(x, y) >= rows[y as usize * width + x as usize]);
                if want == Want::Any && visible > 0 {
                    return visible;
                }
            }
        }
    }
    std::hint::black_box(total);
    visible
}

/// A box as a mesh.
fn mesh(bounds: &Aabb) -> Mesh {
    // Corner i lies on the greater side of axis k where bit k of i is set.
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices = faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    Mesh::new("box", bounds.corners().to_vec(), indices).expect("a box")
}
