//! What a question rasterises: the normative stand-in for a box, the same on every backend.
//!
//! # Why a hidden proxy means a hidden box
//!
//! *Claim.* Let geometry lie in the closed box (its faces included), let an app transform it in
//! f32, and let a rasteriser snap its vertices to a grid of at least 4 subpixel bits. Then every
//! pixel with a sample that the geometry owns is in [`Proxy::rect`], is covered
//! ([`Proxy::covers`]), and the nearness stored for that sample is at most [`Proxy::nearness`].
//! So if every covered pixel's proxy is farther than what is stored, no sample of the geometry
//! could be seen.
//!
//! *Assumed of the app and the rasteriser:* each clip coordinate errs by at most
//! [`View::clip_error`]; vertices move by at most 1/16 pixel an axis when snapped, after a
//! viewport transform of four roundings; depth is interpolated between the vertices as snapped
//! and errs by at most 16 half units in the last place of the greatest depth of the triangle.
//!
//! *Screen space* is (X, Y, N): pixels, y down, and nearness. Where w > 0, projection maps
//! segments to segments, so the image of the box is the convex hull of its eight projected
//! corners, and **every half space of screen space that holds the eight corners holds the box**.
//! That is all that the construction relies on: an edge of the outline is such a half space
//! `aX + bY + c ≥ 0`, an entry plane is such a half space `N ≤ gX + hY + c`. In both, `c` is taken
//! from all eight corners, so *any* slope gives a valid bound. Which silhouette or face the slope
//! was taken from, and how exactly, decides how tight the bound is and never whether it holds; an
//! edge or plane left out enlarges the proxy.
//!
//! *Float error.* Let q be the exact clip position of a point of the geometry, q′ = q + e what the
//! app has after transforming and clipping, |e| ≤ δ a component. Vertices are such points and so
//! are, by convexity, all points of the triangle. For q′ on the screen at X′ (in normalised device
//! coordinates) X′ − X = (e_x − X′e_w)/w, so |X′ − X| ≤ (δ_x + |X′|δ_w)/w. Only points within
//! snapping distance of the viewport matter, where |X′| ≤ 1 + that distance: the bound does not
//! grow with the parts of the box that lie far beside the screen. In the same way
//! N′ − N = (e_z − N′e_w)/w, and with δ_w ≤ w/4 that is at most 4/3·(δ_z + max|N|·δ_w)/w. Both are
//! taken at the least w of the corners. The f64 corners used here differ from exact ones by less
//! than 2⁻²⁸ δ; δ is twice the view's bound, which covers this as well.
//!
//! *Snapping.* A sample at S in the snapped triangle has weights λ; the point with the same
//! weights in the triangle before snapping, S′, lies within 1/16 pixel (and the rounding of the
//! viewport transform) of S on either axis. Depth is interpolated with the same weights, so it is
//! the nearness N′ at S′, and its own rounding.
//!
//! *Together:* S lies within r = (r_x, r_y) of the exact projection (X, Y, N) of a point of the
//! box, and the stored nearness is at most N + ε. Hence aS_x + bS_y + c ≥ −(|a|r_x + |b|r_y): the
//! outline, pushed outward by that much, covers S. And the stored nearness is at most
//! N + ε ≤ gX + hY + c + ε ≤ gS_x + hS_y + |g|r_x + |h|r_y + c + ε, as well as at most the greatest
//! N of a corner + ε: the entry nearness, the least of these, is not farther.
//!
//! *Multisampling.* A sample lies within half a pixel of the centre that the proxy is evaluated
//! at, on either axis: half a pixel joins r, in the outline, the rectangle and the planes.
//!
//! *Evaluation in f32.* `(a·dx + b·dy) + c` with rounded coefficients errs by less than
//! 6·2⁻²⁴·(|a|W + |b|H + |c|) over a rectangle of W × H pixels, in any order, fused or not; that
//! much is added to c before it is rounded up. So the two methods are bounds as they stand.
//!
//! *Depth beyond the far plane.* A stored nearness is never less than the cleared one. A plane
//! that falls below it inside the rectangle is left out if the box reaches the far plane.
//!
//! *Six edges.* Seen from a point outside, at most one of two opposite faces is turned to the
//! viewer, so one, two or three faces are, and the edges between a turned and an unturned face
//! number 4, 6 and 6 (Schmalstieg and Tobler, *Fast Projected Area Computation for
//! Three-Dimensional Bounding Boxes*, 1999); `tables_have_at_most_six_edges` counts them.
//!
//! # Deviations
//!
//! From the design: the entry nearness also allows for the float error of the geometry's own
//! depth, ε: without it geometry on the box's very face could be stored nearer than the proxy.
//! The planes' constants come from the eight corners, not from the faces, so that a wrong sign or
//! an inexact inverse cannot make them wrong. A box that lies between pixel centres, r included,
//! is [`Question::Outside`] although it may lie on the screen.

use super::aabb::f32_above;
use super::project::{Placement, Screen, UNIT, greatest, least, place};
use crate::geom::{Aabb, DepthDirection, View};

/// A rectangle of whole pixels of the viewport, half open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl PixelRect {
    /// Columns.
    pub const fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// How many pixels.
    pub const fn area(&self) -> u64 {
        self.width() as u64 * self.height() as u64
    }

    /// Whether a pixel is one of them.
    pub const fn contains(&self, x: u32, y: u32) -> bool {
        self.x0 <= x && x < self.x1 && self.y0 <= y && y < self.y1
    }
}

/// A box as a question sees it: an outline of at most six edges and an entry depth of at most
/// three planes, both affine in the pixel centre's offset from [`Proxy::origin`].
///
/// A sample at pixel `(x, y)` has `dx = (x - origin.x) as f32 + 0.5`, `dy` likewise, and
/// every backend evaluates, in f32, unfused and in this order: `(a * dx + b * dy) + c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proxy {
    /// The pixels whose centres the outline may cover, clipped to the viewport; never empty.
    pub rect: PixelRect,
    /// Coefficients `[a, b, c]` of the outline's edges, in pixels; a sample is inside where all
    /// are ≥ 0. Unused ones are `[0, 0, 0]` and come last.
    pub edges: [[f32; 3]; 6],
    /// Coefficients `[a, b, c]` of the nearness of the front-facing planes; the entry nearness
    /// is the least of them and of `nearest`. Unused ones are `[0, 0, f32::MAX]` and come last.
    pub planes: [[f32; 3]; 3],
    /// The nearness of the box's nearest point, rounded toward the viewer.
    pub nearest: f32,
}

impl Proxy {
    /// The pixel whose upper left corner the coefficients are relative to: that of `rect`.
    #[inline]
    pub const fn origin(&self) -> [u32; 2] {
        [self.rect.x0, self.rect.y0]
    }

    /// Whether the outline covers the centre of a pixel of `rect`; meaningless elsewhere.
    #[inline]
    pub fn covers(&self, x: u32, y: u32) -> bool {
        let (dx, dy) = self.offset(x, y);
        self.edges.iter().all(|&edge| affine(edge, dx, dy) >= 0.0)
    }

    /// The entry nearness at the centre of a pixel of `rect`: nothing in the box is stored
    /// nearer there. Meaningless elsewhere.
    #[inline]
    pub fn nearness(&self, x: u32, y: u32) -> f32 {
        let (dx, dy) = self.offset(x, y);
        self.planes.iter().fold(self.nearest, |entry, &plane| entry.min(affine(plane, dx, dy)))
    }

    #[inline]
    fn offset(&self, x: u32, y: u32) -> (f32, f32) {
        debug_assert!(self.rect.contains(x, y), "pixel ({x}, {y}) is not in {:?}", self.rect);
        let [x0, y0] = self.origin();
        ((x.wrapping_sub(x0)) as f32 + 0.5, (y.wrapping_sub(y0)) as f32 + 0.5)
    }
}

/// What becomes of a box that is to be asked about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// No part of it can own a sample: it lies outside the view, or between the samples.
    Outside,
    /// It crosses the near plane, holds the eye, or its projection is too uncertain: taken as
    /// visible, not asked.
    Visible,
    /// To be asked.
    Ask(Proxy),
}

impl Question {
    /// What to ask about a box: its proxy, if it has one. An invalid box is
    /// [`Question::Visible`]. No allocation; some hundred nanoseconds.
    pub fn new(aabb: &Aabb, view: &View) -> Self {
        let screen = match place(aabb, view) {
            Placement::Outside => return Self::Outside,
            Placement::Near => return Self::Visible,
            Placement::Ahead(screen) => screen,
        };
        let Some(rect) = screen.pixels(view) else { return Self::Outside };
        if screen.reach.max_element() > MAX_REACH {
            return Self::Visible;
        }
        let faces = Faces::turned_to(view, aabb);
        Self::Ask(Proxy {
            rect,
            edges: edges(&screen, rect, &faces),
            planes: planes(&screen, rect, &faces, view),
            nearest: f32_above(screen.nearest + screen.depth_error).max(view.depth().cleared()),
        })
    }
}

/// With a greater r, in pixels, the outline says so little that asking is not worth it.
const MAX_REACH: f64 = 32.0;

/// The relative error of the f64 arithmetic that an edge or plane passes through.
const UNIT_F64: f64 = 4.0 * f64::EPSILON;

#[inline]
fn affine([a, b, c]: [f32; 3], dx: f32, dy: f32) -> f32 {
    (a * dx + b * dy) + c
}

/// The faces of a box that are turned to the viewer, an axis each, and the slopes of their planes.
struct Faces {
    /// 0: neither of the two faces of this axis; 1: that at the least coordinate; 2: the other.
    turned: [usize; 3],
    /// Nearness a unit of normalised device coordinates, x and y; not finite for a face that is
    /// seen edge on.
    slopes: [[f64; 2]; 3],
}

impl Faces {
    /// Of a face with the inward plane (A, B, C, D) in clip space, A·x + B·y + C·z + D·w ≥ 0 on
    /// the box's side, a line of sight toward the viewer leaves the box through it if z lessens the
    /// form: C < 0 under reversed z, C > 0 under standard z. No eye point is needed, so
    /// orthographic and oblique views are no special cases.
    fn turned_to(view: &View, aabb: &Aabb) -> Self {
        let world = view.world_from_clip();
        let sign = sign(view.depth());
        let mut faces = Self { turned: [0; 3], slopes: [[0.0; 2]; 3] };
        for axis in 0..3 {
            let (low, high) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
            // The inward plane of the lesser face, p − low ≥ 0, is (1, −low) in world space and
            // so `form(column, low)` in clip space; that of the greater one is its negation.
            let form = |column: glam::DVec4, at: f64| column[axis] - at * column.w;
            let at = if sign * form(world.z_axis, low) < 0.0 {
                faces.turned[axis] = 1;
                low
            } else if sign * form(world.z_axis, high) > 0.0 {
                faces.turned[axis] = 2;
                high
            } else {
                continue;
            };
            let per_depth = -sign / form(world.z_axis, at);
            faces.slopes[axis] = [form(world.x_axis, at) * per_depth, form(world.y_axis, at) * per_depth];
        }
        faces
    }

    /// Which entry of [`SILHOUETTES`].
    fn index(&self) -> usize {
        self.turned[0] + 3 * self.turned[1] + 9 * self.turned[2]
    }
}

fn edges(screen: &Screen, rect: PixelRect, faces: &Faces) -> [[f32; 3]; 6] {
    let mut edges = [[0.0; 3]; 6];
    let mut used = 0;
    let (x, y) = relative(screen, rect);
    let silhouette = &SILHOUETTES[faces.index()];
    for &[i, j] in &silhouette.edges[..silhouette.len] {
        let (a, b) = (y[i] - y[j], x[j] - x[i]);
        let scale = 1.0 / (a.abs() + b.abs());
        if !scale.is_finite() {
            continue; // corners that coincide on the screen
        }
        let (a, b) = (a * scale, b * scale);
        let along: [f64; 8] = std::array::from_fn(|k| a * x[k] + b * y[k]);
        let (low, high) = (least(&along), greatest(&along));
        // The edge is where the form is least or greatest; the box is on the other side.
        let inward = if along[i] - low <= high - along[i] { [a, b, -low] } else { [-a, -b, high] };
        let edge = pushed(inward, screen, rect, low.abs().max(high.abs()));
        if least_over(rect, edge) < 0.0 {
            edges[used] = rounded_up(edge, rect);
            used += 1;
        }
    }
    edges
}

fn planes(screen: &Screen, rect: PixelRect, faces: &Faces, view: &View) -> [[f32; 3]; 3] {
    let mut planes = [[0.0, 0.0, f32::MAX]; 3];
    let mut used = 0;
    let (x, y) = relative(screen, rect);
    let viewport = view.viewport();
    let per_pixel = [2.0 / f64::from(viewport.width), -2.0 / f64::from(viewport.height)];
    let cleared = f64::from(view.depth().cleared());
    let reaches_far = screen.farthest - screen.depth_error <= cleared;
    for axis in (0..3).filter(|&axis| faces.turned[axis] != 0) {
        let [a, b] = [faces.slopes[axis][0] * per_pixel[0], faces.slopes[axis][1] * per_pixel[1]];
        // A plane steeper than this a pixel is a face seen edge on; and f32 must hold it.
        if !(a.abs() < MAX_SLOPE && b.abs() < MAX_SLOPE) {
            continue;
        }
        let rise: [f64; 8] = std::array::from_fn(|k| screen.nearness[k] - (a * x[k] + b * y[k]));
        let c = greatest(&rise);
        let magnitude = least(&rise).abs().max(c.abs()) + screen.nearest.abs().max(screen.farthest.abs());
        let [a, b, c] = pushed([a, b, c], screen, rect, magnitude);
        let plane = [a, b, c + screen.depth_error];
        let lowest = least_over(rect, plane);
        if lowest < screen.nearest && !(reaches_far && lowest < cleared) {
            planes[used] = rounded_up(plane, rect);
            used += 1;
        }
    }
    planes
}

/// Steeper planes are not worth the f32 error that they bring: nearness has a range of 1.
const MAX_SLOPE: f64 = 1e6;

/// The corners relative to the rectangle's.
fn relative(screen: &Screen, rect: PixelRect) -> ([f64; 8], [f64; 8]) {
    let (x0, y0) = (f64::from(rect.x0), f64::from(rect.y0));
    (screen.x.map(|x| x - x0), screen.y.map(|y| y - y0))
}

/// A form raised by what it changes over r, and by the f64 error of terms of some magnitude.
fn pushed([a, b, c]: [f64; 3], screen: &Screen, rect: PixelRect, magnitude: f64) -> [f64; 3] {
    let reach = a.abs() * screen.reach.x + b.abs() * screen.reach.y;
    let corners = a.abs() * (f64::from(rect.x0) + screen.max.x.abs().max(screen.min.x.abs()))
        + b.abs() * (f64::from(rect.y0) + screen.max.y.abs().max(screen.min.y.abs()));
    [a, b, c + reach + UNIT_F64 * (magnitude + corners)]
}

/// The least value of a form at the pixel centres of a rectangle.
fn least_over(rect: PixelRect, [a, b, c]: [f64; 3]) -> f64 {
    let least = |k: f64, pixels: u32| (k * 0.5).min(k * (f64::from(pixels) - 0.5));
    c + least(a, rect.width()) + least(b, rect.height())
}

/// In f32, with `c` raised so that evaluation in f32 is an upper bound all over the rectangle.
fn rounded_up([a, b, c]: [f64; 3], rect: PixelRect) -> [f32; 3] {
    let magnitude = a.abs() * f64::from(rect.width()) + b.abs() * f64::from(rect.height()) + c.abs();
    let error = 6.0 * UNIT * magnitude + 4.0 * f64::from(f32::MIN_POSITIVE);
    [a as f32, b as f32, f32_above(c + error)]
}

fn sign(depth: DepthDirection) -> f64 {
    match depth {
        DepthDirection::Reversed => 1.0,
        DepthDirection::Standard => -1.0,
    }
}

/// The outline's edges as pairs of corners (indices as in [`Aabb::corners`]).
#[derive(Clone, Copy)]
struct Silhouette {
    edges: [[usize; 2]; 6],
    len: usize,
}

/// For each combination of [`Faces::turned`].
const SILHOUETTES: [Silhouette; 27] = {
    let mut table = [Silhouette { edges: [[0; 2]; 6], len: 0 }; 27];
    let mut index = 0;
    while index < 27 {
        table[index] = silhouette([index % 3, index / 3 % 3, index / 9]);
        index += 1;
    }
    table
};

/// The edges between a face that is turned to the viewer and one that is not.
const fn silhouette(turned: [usize; 3]) -> Silhouette {
    let mut found = Silhouette { edges: [[0; 2]; 6], len: 0 };
    let mut edge = 0;
    while edge < 12 {
        // The edge runs along `axis`, between the faces `p_side` of axis p and `q_side` of q.
        let (axis, p_side, q_side) = (edge / 4, edge & 1, edge >> 1 & 1);
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        if (turned[p] == p_side + 1) != (turned[q] == q_side + 1) {
            let corner = p_side << p | q_side << q;
            found.edges[found.len] = [corner, corner | 1 << axis];
            found.len += 1;
        }
        edge += 1;
    }
    found
}
