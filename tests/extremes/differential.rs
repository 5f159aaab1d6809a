//! `Frustum`, `project` and `Question` against exact arithmetic, a million cases in a few seconds.
//!
//! What is exact is the view and the box *as given*, in f32. A point of the box that the view shows
//! must never lie outside; every point of the box lies in the rectangle and in its range of
//! nearness; and the proxy holds every point with the r around it that its proof promises.
//!
//! `TERCET_CASES` sets the number of cases (a hundred million take an hour or so), `TERCET_SEED` the
//! seed, which is printed.

use std::ops::Add;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tercet::geom::{Frustum, Projected, Question};

use super::check::{Answers, Exact, check};
use super::exact::ExactView;
use super::tally::Tally;
use super::{dice, setting};

#[test]
fn a_million_boxes_against_exact_arithmetic() {
    let (cases, seed) = (setting("TERCET_CASES", 1_000_000), setting("TERCET_SEED", 0x7e7c_e700));
    println!("{cases} cases, seed {seed} (TERCET_CASES, TERCET_SEED)");
    let tally = sweep(cases, seed, |_| (), |fault| panic!("{fault}"));
    println!("{tally:?}");
    let Tally { beyond, beyond_kept: [frustum, rect, question], ahead, rects, wide, .. } = tally;
    println!(
        "of {beyond} boxes beyond a plane, kept in per cent: frustum {:.2}, project {:.2}, question {:.2}",
        percent(frustum, beyond),
        percent(rect, beyond),
        percent(question, beyond)
    );
    println!(
        "of {ahead} boxes ahead and shown: {:.2} % not projected, {:.2} % not asked about",
        percent(tally.ahead_near, ahead),
        percent(tally.ahead_unasked, ahead)
    );
    println!(
        "of {rects} rectangles: {:.2} % wider by over a quarter of a pixel, {:.2} % by over one",
        percent(wide[0], rects),
        percent(wide[1], rects)
    );
    // The sweep must not pass because it meets nothing.
    assert!(tally.shown * 3 > tally.cases && beyond * 20 > tally.cases, "{tally:?}");
    assert!(tally.asked * 5 > tally.cases && tally.samples * 20 > tally.cases, "{tally:?}");
}

/// An answer that is wrong on purpose.
type Tamper = fn(&mut Answers);

#[test]
fn the_checker_finds_wrong_answers() {
    let tampers: [(&str, Tamper); 9] = [
        ("the frustum drops", |a| a.outside = true),
        ("the projection drops", |a| a.projected = Projected::Outside),
        ("a rectangle a step short", |a| {
            if let Projected::Rect(rect) = &mut a.projected {
                rect.max.x -= 0.2;
            }
        }),
        ("a nearness a step short", |a| {
            if let Projected::Rect(rect) = &mut a.projected {
                rect.nearest -= rect.nearest.abs() * 1e-5;
            }
        }),
        ("a farness a step short", |a| {
            if let Projected::Rect(rect) = &mut a.projected {
                rect.farthest += rect.farthest.abs() * 1e-5;
            }
        }),
        ("an outline not pushed", |a| {
            if let Question::Ask(p) = &mut a.question {
                p.edges.iter_mut().for_each(|[x, y, c]| *c -= (x.abs() + y.abs()) * 0.125);
            }
        }),
        ("planes not pushed", |a| {
            if let Question::Ask(p) = &mut a.question {
                let used = p.planes.iter_mut().filter(|plane| plane[2] != f32::MAX);
                used.for_each(|[x, y, c]| *c -= (x.abs() + y.abs()) * 0.125);
            }
        }),
        ("a column short", |a| {
            if let Question::Ask(p) = &mut a.question {
                p.rect.x1 = (p.rect.x1 - 1).max(p.rect.x0 + 1);
            }
        }),
        ("a question that is dropped", |a| a.question = Question::Outside),
    ];
    for (name, tamper) in tampers {
        let tally = sweep(8_000, 1, tamper, |_| ());
        println!("{name}: {} faults of {}", tally.faults, tally.cases);
        assert!(tally.faults > 20, "{name}: {tally:?}");
    }
}

/// Boxes a view: multiplying its matrices out takes about as long as one box.
const BOXES: u64 = 8;

/// Runs about as many cases; `tamper` may spoil the answers, and `report` is told of faults.
fn sweep(
    cases: u64,
    seed: u64,
    tamper: impl Fn(&mut Answers) + Sync,
    report: impl Fn(String) + Sync,
) -> Tally {
    const CHUNK: u64 = 1000;
    (0..cases.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(chunk);
            let mut tally = Tally::default();
            for _ in 0..CHUNK / BOXES {
                let view = dice::view(&mut rng);
                let (frustum, exact_view) = (Frustum::new(&view), ExactView::new(&view));
                for _ in 0..BOXES {
                    let case = dice::case(&mut rng, &view);
                    let mut answers = Answers::new(&case.aabb, &view, &frustum, rng.random_range(0..16));
                    tamper(&mut answers);
                    let exact = Exact {
                        corners: exact_view.corners(&case.aabb),
                        points: case.points.iter().map(|&p| exact_view.point(p)).collect(),
                    };
                    if let Err(why) = check(&view, &case.aabb, &answers, &exact, &mut tally) {
                        tally.faults += 1;
                        report(format!("seed {seed}, chunk {chunk}: {why}\n{case:?}\n{view:?}\n{answers:?}"));
                    }
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::add)
}

fn percent(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole as f64
}
