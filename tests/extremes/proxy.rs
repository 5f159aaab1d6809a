//! The proxy is a bound: no sample of geometry in a box lies outside of its proxy or before it,
//! whatever the view. And it is a tight one.

use glam::{DVec2, DVec3, DVec4};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tercet::geom::{Aabb, Frustum, PlaneMask, Proxy, Question, View};

use super::samples::{Case, Sample, ordinary_view, random_case, random_view};

const SEED: u64 = 0x7e7c_e700;
const CHUNKS: u64 = 64;
const TRIANGLES: usize = 4;

/// What a sweep over random cases met.
#[derive(Default, Debug, Clone, Copy)]
struct Tally {
    cases: usize,
    outside: usize,
    visible: usize,
    asked: usize,
    samples: usize,
    violations: usize,
}

impl Tally {
    fn plus(self, o: Self) -> Self {
        Self {
            cases: self.cases + o.cases,
            outside: self.outside + o.outside,
            visible: self.visible + o.visible,
            asked: self.asked + o.asked,
            samples: self.samples + o.samples,
            violations: self.violations + o.violations,
        }
    }
}

/// What is wrong with a sample under an answer, if anything.
fn fault(question: &Question, sample: &Sample) -> Option<String> {
    match question {
        Question::Visible => None,
        Question::Outside => Some(format!("{sample:?} is owned, and the box is called outside")),
        Question::Ask(proxy) => {
            if !(proxy.rect.contains(sample.x, sample.y) && proxy.covers(sample.x, sample.y)) {
                return Some(format!("{sample:?} is not covered by {proxy:?}"));
            }
            let entry = f64::from(proxy.nearness(sample.x, sample.y));
            (sample.nearness.iter().any(|&n| n > entry))
                .then(|| format!("{sample:?} is nearer than {entry} of {proxy:?}"))
        }
    }
}

/// Runs `boxes` random boxes, each with some triangles, through `question`, and hands faults to
/// `report`.
fn sweep(
    boxes: u64,
    question: impl Fn(&Case) -> Question + Sync,
    report: impl Fn(u64, &Case, String) + Sync,
) -> Tally {
    (0..CHUNKS)
        .into_par_iter()
        .map(|chunk| {
            let mut rng = ChaCha8Rng::seed_from_u64(SEED + chunk);
            let (mut tally, mut samples) = (Tally::default(), Vec::new());
            for _ in 0..boxes / CHUNKS {
                let case = random_case(&mut rng, random_view);
                let question = question(&case);
                match question {
                    Question::Outside => tally.outside += 1,
                    Question::Visible => tally.visible += 1,
                    Question::Ask(_) => tally.asked += 1,
                }
                for _ in 0..TRIANGLES {
                    let triangle = case.triangle(&mut rng);
                    let grid = if rng.random() { 16 } else { 256 };
                    samples.clear();
                    case.samples(triangle, grid, &mut rng, &mut samples);
                    tally.cases += 1;
                    tally.samples += samples.len();
                    for sample in &samples {
                        if let Some(why) = fault(&question, sample) {
                            tally.violations += 1;
                            report(SEED + chunk, &case, why);
                        }
                    }
                    if !samples.is_empty() && outside_frustum(&case) {
                        tally.violations += 1;
                        report(SEED + chunk, &case, "it owns samples and is outside the frustum".into());
                    }
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::plus)
}

/// Whether any of the three ways of asking the frustum calls the box outside.
fn outside_frustum(case: &Case) -> bool {
    let frustum = Frustum::new(&case.view);
    let (min, max) = (case.world.min, case.world.max);
    let lanes =
        frustum.outside_lanes([&[min.x], &[min.y], &[min.z]], [&[max.x], &[max.y], &[max.z]], PlaneMask::ALL);
    let outside = !frustum.intersects(&case.world);
    assert_eq!(outside, lanes == 1, "lanes and single boxes disagree");
    assert_eq!(outside, frustum.classify(&case.world, PlaneMask::ALL).is_none());
    outside
}

#[test]
fn no_sample_lies_outside_the_proxy_or_before_it() {
    let tally = sweep(
        500_000,
        |case| Question::new(&case.world, &case.view),
        |seed, case, why| panic!("seed {seed}: {why}\n{case:#?}"),
    );
    println!("{tally:?}");
    assert!(tally.cases >= 1_990_000, "{tally:?}");
    // The sweep must not pass because it asks nothing.
    assert!(tally.asked * 4 >= tally.cases / TRIANGLES, "{tally:?}");
    assert!(tally.samples > 1_000_000, "{tally:?}");
}

/// A proxy that is wrong on purpose.
type Mutation = fn(&mut Proxy);

#[test]
fn the_checker_finds_wrong_proxies() {
    /// The share of r that does not depend on the view.
    const R: f32 = 2.0 / 16.0;
    let mutations: [(&str, Mutation); 6] = [
        ("outline not pushed", |p| {
            p.edges.iter_mut().for_each(|[a, b, c]| *c -= (a.abs() + b.abs()) * R);
        }),
        ("outline pushed inward", |p| {
            p.edges.iter_mut().for_each(|[a, b, c]| *c -= (a.abs() + b.abs()) * 2.0 * R);
        }),
        ("planes not pushed", |p| {
            let used = p.planes.iter_mut().filter(|plane| plane[2] != f32::MAX);
            used.for_each(|[a, b, c]| *c -= (a.abs() + b.abs()) * R);
        }),
        ("planes leaning the wrong way", |p| {
            p.planes.iter_mut().for_each(|[a, b, _]| (*a, *b) = (-*a, -*b));
        }),
        ("nearest point a few steps away", |p| p.nearest -= p.nearest.abs() * 1e-5),
        ("a column short", |p| {
            if p.rect.width() > 1 {
                p.rect.x1 -= 1;
            }
        }),
    ];
    for (name, mutate) in mutations {
        let question = |case: &Case| match Question::new(&case.world, &case.view) {
            Question::Ask(mut proxy) => {
                mutate(&mut proxy);
                Question::Ask(proxy)
            }
            other => other,
        };
        let tally = sweep(10_000, question, |_, _, _| ());
        println!("{name}: {tally:?}");
        assert!(tally.violations > 20, "{name}: {tally:?}");
    }
}

/// The exact nearness at which a line of sight through a pixel's centre enters a box, in f64; an
/// independent slab test. `None` if it misses.
fn exact_entry(aabb: &Aabb, view: &View, x: f64, y: f64) -> Option<f64> {
    let viewport = view.viewport();
    let ndc = DVec2::new(
        2.0 * (x + 0.5) / f64::from(viewport.width) - 1.0,
        1.0 - 2.0 * (y + 0.5) / f64::from(viewport.height),
    );
    let at = |depth: f64| {
        let p = view.world_from_clip() * DVec4::new(ndc.x, ndc.y, depth, 1.0);
        p.truncate() / p.w
    };
    let (start, through) = (at(1.0), at(0.5));
    let along = through - start;
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let t = [aabb.min[axis], aabb.max[axis]].map(|v| (f64::from(v) - start[axis]) / along[axis]);
        enter = enter.max(t[0].min(t[1]));
        leave = leave.min(t[0].max(t[1]));
    }
    (enter <= leave).then(|| {
        let clip = *view.clip_from_world() * (start + along * enter).extend(1.0);
        clip.z / clip.w
    })
}

fn quantile(mut values: Vec<f64>, q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * q) as usize]
}

#[test]
fn the_proxy_is_tight_in_ordinary_views() {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let (mut size, mut excess) = (Vec::new(), Vec::new());
    let (mut beside, mut beside_covered) = (0, 0);
    while size.len() < 2_000 {
        let case = random_case(&mut rng, ordinary_view);
        let Question::Ask(proxy) = Question::new(&case.world, &case.view) else { continue };
        let rect = proxy.rect;
        let whole = rect.x0 > 1 && rect.y0 > 1 && rect.x1 < 1279 && rect.y1 < 719;
        if !whole || !(64..10_000).contains(&rect.area()) {
            continue;
        }
        let entry = |x: i64, y: i64| exact_entry(&case.world, &case.view, x as f64, y as f64);
        let corners = case.world.corners().map(|p| *case.view.clip_from_world() * p.as_dvec3().extend(1.0));
        let nearness = corners.map(|p| p.z / p.w);
        let range =
            nearness.iter().copied().fold(0.0, f64::max) - nearness.iter().copied().fold(1.0, f64::min);
        let (mut exact, mut covered) = (0, 0);
        for y in i64::from(rect.y0) - 1..=i64::from(rect.y1) {
            for x in i64::from(rect.x0) - 1..=i64::from(rect.x1) {
                let (px, py) = (x as u32, y as u32);
                let in_proxy = rect.contains(px, py) && proxy.covers(px, py);
                covered += u32::from(in_proxy);
                if let Some(nearness) = entry(x, y) {
                    exact += 1;
                    assert!(in_proxy, "pixel ({x}, {y}) of {case:?}");
                    excess.push((f64::from(proxy.nearness(px, py)) - nearness) / range);
                } else if (-1..=1).any(|i| (-1..=1).any(|j| entry(x + i, y + j).is_some())) {
                    beside += 1;
                    beside_covered += u32::from(in_proxy);
                }
            }
        }
        if exact >= 32 {
            size.push(f64::from(covered) / f64::from(exact));
        }
    }
    let (median, worst) = (quantile(size.clone(), 0.5), quantile(size, 0.99));
    let (near, nearer) = (quantile(excess.clone(), 0.5), quantile(excess, 0.95));
    let spill = f64::from(beside_covered) / f64::from(beside);
    println!(
        "samples, proxy / exact: median {median:.4}, 99 % {worst:.4}; share of neighbours covered {spill:.4}"
    );
    println!("entry nearness too near by, share of the box's range: median {near:.5}, 95 % {nearer:.5}");
    // A third of these boxes are thinner than a pixel somewhere, which r widens most.
    assert!(median < 1.08 && worst < 2.6, "median {median}, 99 % {worst}");
    assert!(spill < 0.35, "{spill} of the pixels next to a box are covered");
    assert!(near < 0.02 && nearer < 0.2, "median {near}, 95 % {nearer}");
}

#[test]
fn the_frustum_keeps_what_an_inner_point_shows_and_drops_the_rest() {
    let tally: [usize; 3] = (0..CHUNKS)
        .into_par_iter()
        .map(|chunk| {
            let seed = SEED + chunk;
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let (mut inner, mut far_off, mut dropped) = (0, 0, 0);
            for _ in 0..200_000 / CHUNKS {
                let ordinary = rng.random_bool(0.5);
                let case = random_case(&mut rng, if ordinary { ordinary_view } else { random_view });
                let m = *case.view.clip_from_world();
                let clip = |p: DVec3| m * p.extend(1.0);
                let (low, high) = (case.world.min.as_dvec3(), case.world.max.as_dvec3());
                let point = DVec3::from_array(std::array::from_fn(|i| {
                    low[i] + (high[i] - low[i]) * rng.random_range(0.0..=1.0)
                }));
                let c = clip(point);
                let seen = c.x.abs() <= c.w && c.y.abs() <= c.w && (0.0..=c.w).contains(&c.z);
                let outside = outside_frustum(&case);
                inner += usize::from(seen);
                assert!(!(seen && outside), "seed {seed}: {point} shows at {c}, {case:#?}");
                // More than a pixel beside an ordinary view is outside for the frustum and for
                // a question.
                let (w, h) = (1.0 + 2.0 / 1280.0, 1.0 + 2.0 / 720.0);
                let corners = case.world.corners().map(|p| clip(p.as_dvec3()));
                let all = |f: fn(DVec4, f64, f64) -> bool| corners.iter().all(|&c| f(c, w, h));
                let off = all(|c, w, _| c.x > w * c.w)
                    || all(|c, w, _| c.x < -w * c.w)
                    || all(|c, _, h| c.y > h * c.w)
                    || all(|c, _, h| c.y < -h * c.w);
                if ordinary && off {
                    far_off += 1;
                    let question = Question::new(&case.world, &case.view);
                    dropped += usize::from(outside && question == Question::Outside);
                }
            }
            [inner, far_off, dropped]
        })
        .reduce(|| [0; 3], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    let [inner, far_off, dropped] = tally;
    println!("{inner} inner points, {far_off} boxes beside, {dropped} of them dropped");
    assert!(inner > 50_000 && far_off > 1_000);
    // All but those so large that a pixel is within their float error.
    assert!(dropped * 1000 >= far_off * 999, "of {far_off} boxes beside the view {dropped} are outside");
}
