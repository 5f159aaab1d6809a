//! `Frustum`, `project` and `Question` against exact arithmetic, a million cases in a few seconds.
//!
//! What is exact is the view and the box *as given*, in f32. A point of the box that the view shows
//! must never lie outside; every point of the box lies in the rectangle and in its range of
//! nearness; and the proxy holds every point with the r around it that its proof promises.
//!
//! `TERCET_CASES` sets the number of cases (a hundred million take an hour or so), `TERCET_SEED` the
//! seed, which is printed.

use std::ops::{Add, AddAssign};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tercet::geom::{
    Aabb, Frustum, PixelRect, PlaneMask, Projected, Proxy, Question, ScreenRect, View, project,
};

use super::dice;
use super::exact::{Dyadic, ExactView, Point};
use super::setting;

/// What the engine says of a box.
#[derive(Clone, Debug)]
struct Answers {
    outside: bool,
    projected: Projected,
    question: Question,
}

impl Answers {
    /// From the engine; all three ways of asking the frustum must agree.
    fn new(aabb: &Aabb, view: &View, frustum: &Frustum, lane: usize) -> Self {
        let crossed = frustum.classify(aabb, PlaneMask::ALL);
        let outside = !frustum.intersects(aabb);
        let corner =
            |v: f32, empty: f32| std::array::from_fn::<f32, 16, _>(|i| if i == lane { v } else { empty });
        let min = aabb.min.to_array().map(|v| corner(v, f32::INFINITY));
        let max = aabb.max.to_array().map(|v| corner(v, f32::NEG_INFINITY));
        let lanes = frustum.outside_lanes(min.each_ref(), max.each_ref(), PlaneMask::ALL);
        assert_eq!(
            (outside, outside),
            (crossed.is_none(), lanes == 1 << lane),
            "{aabb:?}: {lanes:b}, {crossed:?}"
        );
        Self { outside, projected: project(aabb, view), question: Question::new(aabb, view) }
    }
}

/// What a sweep met.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    cases: u64,
    /// Boxes with a point that the view shows, among those looked at.
    shown: u64,
    /// Boxes that lie wholly beyond one plane, exactly; and how many of those each routine keeps.
    beyond: u64,
    beyond_kept: [u64; 3],
    /// Boxes that lie wholly ahead of eye and near plane and meet the view; and how many of those are
    /// not projected, or not asked about.
    ahead: u64,
    ahead_near: u64,
    ahead_unasked: u64,
    /// Rectangles, and those that are wider than the exact one on some side by more than a quarter of a
    /// pixel, by more than one.
    rects: u64,
    wide: [u64; 2],
    asked: u64,
    /// Pixel centres within r of a point that is shown.
    samples: u64,
    faults: u64,
}

impl Add for Tally {
    type Output = Self;

    fn add(mut self, o: Self) -> Self {
        self += o;
        self
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, o: Self) {
        self.cases += o.cases;
        self.shown += o.shown;
        self.beyond += o.beyond;
        (0..3).for_each(|i| self.beyond_kept[i] += o.beyond_kept[i]);
        self.ahead += o.ahead;
        self.ahead_near += o.ahead_near;
        self.ahead_unasked += o.ahead_unasked;
        self.rects += o.rects;
        (0..2).for_each(|i| self.wide[i] += o.wide[i]);
        self.asked += o.asked;
        self.samples += o.samples;
        self.faults += o.faults;
    }
}

/// A box's exact points: its corners, and some more.
struct Exact {
    corners: [Point; 8],
    points: Vec<Point>,
}

impl Exact {
    fn all(&self) -> impl Iterator<Item = &Point> {
        self.corners.iter().chain(&self.points)
    }

    /// Whether all corners lie strictly beyond one plane.
    fn is_beyond(&self) -> bool {
        (0..6).any(|side| self.corners.iter().all(|c| c.sides[side].is_negative()))
    }

    fn is_ahead(&self) -> bool {
        self.corners.iter().all(Point::is_ahead)
    }
}

/// Holds a case's answers against the exact points; the first fault found, in words.
fn check(
    view: &View,
    aabb: &Aabb,
    answers: &Answers,
    exact: &Exact,
    tally: &mut Tally,
) -> Result<(), String> {
    let shown = exact.all().any(Point::shows);
    tally.cases += 1;
    tally.shown += u64::from(shown);
    if shown && answers.outside {
        return Err("a point of the box is shown, and the frustum calls it outside".into());
    }
    if shown && answers.projected == Projected::Outside {
        return Err("a point of the box is shown, and its projection is outside".into());
    }
    match &answers.projected {
        Projected::Rect(rect) => check_rect(view, rect, exact)?,
        Projected::Outside | Projected::Near => {}
    }
    // The share of r that does not depend on the view: snapping, and anywhere in the pixel.
    let r = Dyadic::new(if view.samples() > 1 { 0.125 + 0.5 } else { 0.125 });
    if !matches!(answers.question, Question::Visible) {
        check_samples(view, &answers.question, exact, &r, tally)?;
    }
    if let Question::Ask(proxy) = &answers.question {
        tally.asked += 1;
        check_proxy(proxy, exact, &r)?;
    }
    measure(view, aabb, answers, exact, shown, tally);
    Ok(())
}

/// All of the box is ahead, and in the rectangle where that is not clipped; its nearness is within
/// the range.
fn check_rect(view: &View, rect: &ScreenRect, exact: &Exact) -> Result<(), String> {
    if !exact.is_ahead() {
        return Err(format!("{rect:?} of a box that is not all ahead"));
    }
    let viewport = view.viewport();
    let size = [viewport.width, viewport.height].map(|side| side as f32);
    let (nearest, farthest) = (Dyadic::from(rect.nearest), Dyadic::from(rect.farthest));
    for point in exact.all() {
        for (axis, &size) in size.iter().enumerate() {
            let beyond = |limit: f32| point.beyond(&point.screen[axis], &Dyadic::from(limit));
            let below = rect.min[axis] > 0.0 && beyond(rect.min[axis]).is_negative();
            let above = rect.max[axis] < size && beyond(rect.max[axis]).is_positive();
            if below || above {
                return Err(format!("{:?} is not in {rect:?}", point.pixel()));
            }
        }
        let is_nearer = point.beyond(&point.nearness, &nearest).is_positive();
        if is_nearer || point.beyond(&point.nearness, &farthest).is_negative() {
            return Err(format!("nearness {} is not in {rect:?}", point.nearness.about() / point.w.about()));
        }
    }
    Ok(())
}

/// The proxy's edges and planes, as real functions, at the points that lie over its rectangle: they
/// hold the point and all within r of it.
fn check_proxy(proxy: &Proxy, exact: &Exact, r: &Dyadic) -> Result<(), String> {
    let nearest = Dyadic::from(proxy.nearest);
    for point in exact.all() {
        if !point.w.is_positive() {
            return Err("a point of the box is not ahead, and it is asked about".into());
        }
        if point.beyond(&point.nearness, &nearest).is_positive() {
            return Err(format!("nearer than {}", proxy.nearest));
        }
        if !is_over(point, &proxy.rect) {
            continue;
        }
        for edge in proxy.edges {
            if point.form(edge, proxy.origin(), r).is_negative() {
                return Err(format!("{:?} or what is within r of it is beyond edge {edge:?}", point.pixel()));
            }
        }
        for plane in proxy.planes.into_iter().filter(|plane| plane[2] != f32::MAX) {
            // The plane at its lowest within r, less the nearness.
            if (&point.form(plane, proxy.origin(), r) - &point.nearness).is_negative() {
                return Err(format!("{:?} is nearer than plane {plane:?} within r", point.pixel()));
            }
        }
    }
    Ok(())
}

fn is_over(point: &Point, rect: &PixelRect) -> bool {
    let within = |axis: usize, low: u32, high: u32| {
        let beyond = |limit: u32| point.beyond(&point.screen[axis], &Dyadic::new(f64::from(limit)));
        !beyond(low).is_negative() && !beyond(high).is_positive()
    };
    within(0, rect.x0, rect.x1) && within(1, rect.y0, rect.y1)
}

/// The proxy as backends evaluate it, in f32, at the pixel centres within r of a point that is
/// shown: covered, and not farther.
fn check_samples(
    view: &View,
    question: &Question,
    exact: &Exact,
    r: &Dyadic,
    tally: &mut Tally,
) -> Result<(), String> {
    let viewport = view.viewport();
    let reach = r.about();
    for point in exact.all().filter(|point| point.shows()) {
        let [x, y] = point.pixel();
        // A superset by far more than `pixel` errs; the exact comparison decides.
        let range = |at: f64, side: u32| {
            let slack = reach + 1e-3;
            let first = (at - slack - 0.5).ceil().max(0.0) as u32;
            first..((at + slack - 0.5).floor() + 1.0).clamp(0.0, f64::from(side)) as u32
        };
        for row in range(y, viewport.height) {
            for column in range(x, viewport.width) {
                let is_far = |axis: usize, pixel: u32| {
                    let off = point.beyond(&point.screen[axis], &Dyadic::new(f64::from(pixel) + 0.5)).abs();
                    (&off - &(r * &point.w)).is_positive()
                };
                if is_far(0, column) || is_far(1, row) {
                    continue;
                }
                tally.samples += 1;
                let Question::Ask(proxy) = question else {
                    return Err(format!(
                        "pixel ({column}, {row}) is within r of a point, and the box is outside"
                    ));
                };
                if !(proxy.rect.contains(column, row) && proxy.covers(column, row)) {
                    return Err(format!(
                        "pixel ({column}, {row}) is within r of a point, and is not covered"
                    ));
                }
                let entry = Dyadic::from(proxy.nearness(column, row));
                if point.beyond(&point.nearness, &entry).is_positive() {
                    return Err(format!("a point is nearer than {} at ({column}, {row})", entry.about()));
                }
            }
        }
    }
    Ok(())
}

/// How much more is kept than must be: to be printed.
fn measure(view: &View, aabb: &Aabb, answers: &Answers, exact: &Exact, shown: bool, tally: &mut Tally) {
    if exact.is_beyond() {
        tally.beyond += 1;
        let kept = [
            !answers.outside,
            answers.projected != Projected::Outside,
            answers.question != Question::Outside,
        ];
        (0..3).for_each(|i| tally.beyond_kept[i] += u64::from(kept[i]));
    } else if shown && aabb.is_valid() && exact.is_ahead() {
        tally.ahead += 1;
        tally.ahead_near += u64::from(answers.projected == Projected::Near);
        tally.ahead_unasked += u64::from(answers.question == Question::Visible);
    }
    let Projected::Rect(rect) = answers.projected else { return };
    let viewport = view.viewport();
    let size = [viewport.width, viewport.height].map(f64::from);
    let pixels = exact.corners.each_ref().map(Point::pixel);
    let excess = (0..2).flat_map(|axis| {
        let low = pixels.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min).clamp(0.0, size[axis]);
        let high = pixels.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max).clamp(0.0, size[axis]);
        [low - f64::from(rect.min[axis]), f64::from(rect.max[axis]) - high]
    });
    let most = excess.fold(0.0, f64::max);
    tally.rects += 1;
    tally.wide[0] += u64::from(most > 0.25);
    tally.wide[1] += u64::from(most > 1.0);
}

/// Whether every routine holds for one box, by its corners and its centre.
pub(crate) fn holds(view: &View, aabb: &Aabb) -> Result<(), String> {
    let (frustum, exact_view) = (Frustum::new(view), ExactView::new(view));
    let inner = aabb.center().clamp(aabb.min, aabb.max);
    let exact = Exact { corners: exact_view.corners(aabb), points: vec![exact_view.point(inner)] };
    let answers = Answers::new(aabb, view, &frustum, 3);
    check(view, aabb, &answers, &exact, &mut Tally::default())
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
