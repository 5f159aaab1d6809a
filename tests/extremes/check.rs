//! Holds what the engine says of a box against the box's exact points.

use tercet::geom::{
    Aabb, Frustum, PixelRect, PlaneMask, Projected, Proxy, Question, ScreenRect, View, project,
};

use super::exact::{Dyadic, ExactView, Point};
use super::tally::Tally;

/// Whether every routine holds for one box, by its corners and its centre.
pub(super) fn holds(view: &View, aabb: &Aabb) -> Result<(), String> {
    let (frustum, exact_view) = (Frustum::new(view), ExactView::new(view));
    let inner = aabb.center().clamp(aabb.min, aabb.max);
    let exact = Exact { corners: exact_view.corners(aabb), points: vec![exact_view.point(inner)] };
    let answers = Answers::new(aabb, view, &frustum, 3);
    check(view, aabb, &answers, &exact, &mut Tally::default())
}

/// What the engine says of a box.
#[derive(Clone, Debug)]
pub(super) struct Answers {
    pub(super) outside: bool,
    pub(super) projected: Projected,
    pub(super) question: Question,
}

impl Answers {
    /// From the engine; all three ways of asking the frustum must agree.
    pub(super) fn new(aabb: &Aabb, view: &View, frustum: &Frustum, lane: usize) -> Self {
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

/// A box's exact points: its corners, and some more.
pub(super) struct Exact {
    pub(super) corners: [Point; 8],
    pub(super) points: Vec<Point>,
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
pub(super) fn check(
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
