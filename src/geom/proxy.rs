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
//! taken at the least w of the corners.
//!
//! *The f64 arithmetic here* errs by 2⁻²⁹ of what the same operations do in f32, and each of the
//! three bounds has room for it: δ is twice the view's bound, the rounding of the viewport
//! transform is taken twice, and ε has one unit more than the app's interpolation.
//!
//! *Snapping.* A sample at S in the snapped triangle has weights λ; the point with the same
//! weights in the triangle before snapping, S′, lies within 1/16 pixel (and the rounding of the
//! viewport transform) of S on either axis. Depth is interpolated with the same weights, so it is
//! the nearness N′ at S′, and its own rounding.
//!
//! *Together:* S lies within r = (r_x, r_y) of the exact projection (X, Y, N) of a point of the
//! box, and the stored nearness is at most N + ε. Hence aS_x + bS_y + c ≥ −(|a|r_x + |b|r_y): the
//! outline, pushed outward by that much, covers S, as the corners' bounding rectangle does, which
//! is four such half spaces. And the stored nearness is at most
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
//! *Six edges.* See `silhouette.rs`.
//!
//! # Deviations
//!
//! From the design: the entry nearness also allows for the float error of the geometry's own
//! depth, ε: without it geometry on the box's very face could be stored nearer than the proxy.
//! The planes' constants come from the eight corners, not from the faces, so that a wrong sign or
//! an inexact inverse cannot make them wrong. A box that lies between pixel centres, r included,
//! is [`Question::Outside`] although it may lie on the screen.

use super::aabb::f32_above;
use super::coefficients::{Faces, Local};
use super::pixel_rect::PixelRect;
use super::project::{Screen, Unprojected, place};
use super::{Aabb, View};

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
        ((x - x0) as f32 + 0.5, (y - y0) as f32 + 0.5)
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
    /// [`Question::Visible`]. O(1), no allocation.
    pub fn new(aabb: &Aabb, view: &View) -> Self {
        Self::shaped(aabb, view, |_, _| {})
    }

    /// The same, for a proxy that is changed by what is known of the box on the screen.
    pub(super) fn shaped(aabb: &Aabb, view: &View, shape: impl FnOnce(&mut Proxy, &Screen)) -> Self {
        let screen = match place(aabb, view) {
            Ok(screen) => screen,
            Err(Unprojected::Outside) => return Self::Outside,
            Err(Unprojected::Near) => return Self::Visible,
        };
        let Some(rect) = screen.pixels(view) else { return Self::Outside };
        if screen.reach.max_element() > MAX_REACH {
            return Self::Visible;
        }
        let (local, faces) = (Local::new(&screen, rect), Faces::turned_to(view, aabb));
        let mut proxy = Proxy {
            rect,
            edges: local.edges(&faces),
            planes: local.planes(&faces, view),
            nearest: f32_above(screen.nearest + screen.depth_error).max(view.depth().cleared()),
        };
        shape(&mut proxy, &screen);
        Self::Ask(proxy)
    }
}

/// With a greater r, in pixels, the outline says so little that asking is not worth it.
const MAX_REACH: f64 = 32.0;

#[inline]
fn affine([a, b, c]: [f32; 3], dx: f32, dy: f32) -> f32 {
    (a * dx + b * dy) + c
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::geom::{DepthDirection, DepthFormat, Viewport, projection};

    /// One pixel a metre, the near plane at z = 0 and the far one at z = −100.
    fn flat_view() -> View {
        let clip_from_view = projection::orthographic(64.0, 64.0, 0.0, 100.0);
        View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(64, 64)).unwrap()
    }

    fn proxy(aabb: &Aabb, view: &View) -> Proxy {
        match Question::new(aabb, view) {
            Question::Ask(proxy) => proxy,
            other => panic!("{aabb:?} is {other:?}"),
        }
    }

    fn covered(proxy: &Proxy) -> Vec<(u32, u32)> {
        let rect = proxy.rect;
        let pixels = (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| proxy.covers(x, y)).collect()
    }

    #[test]
    fn an_axis_aligned_box_covers_its_own_pixels() {
        let aabb = Aabb::new(Vec3::new(-22.0, 2.0, -30.0), Vec3::new(-12.0, 7.0, -20.0));
        let proxy = proxy(&aabb, &flat_view());
        assert_eq!(proxy.rect, PixelRect { x0: 10, y0: 25, x1: 20, y1: 30 });
        assert_eq!(proxy.origin(), [10, 25]);
        assert_eq!(covered(&proxy).len(), 50);
        // Reversed z: the front face at z = −20 has depth 0.8.
        let entry = proxy.nearness(15, 27);
        assert!((0.8..0.800_01).contains(&entry), "{entry}");
    }

    #[test]
    fn degenerate_boxes_keep_an_outline() {
        let view = flat_view();
        let center = Vec3::new(0.5, 0.5, -50.0);
        for (half, pixels) in [
            (Vec3::ZERO, 1),
            (Vec3::new(3.0, 0.0, 0.0), 7),
            (Vec3::new(0.0, 0.0, 3.0), 1),
            (Vec3::new(3.0, 2.0, 0.0), 35),
            (Vec3::new(0.0, 2.0, 3.0), 5),
        ] {
            let proxy = proxy(&Aabb::from_center(center, half), &view);
            assert_eq!(covered(&proxy).len(), pixels, "{half}: {proxy:?}");
        }
        let diagonal =
            View::look_at(Vec3::splat(10.0), Vec3::ZERO, 60.0, 0.1, Viewport::new(201, 201)).unwrap();
        for half in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO] {
            let proxy = proxy(&Aabb::from_center(Vec3::ZERO, half), &diagonal);
            assert!(covered(&proxy).len() <= 40, "a line is no area: {proxy:?}");
        }
    }

    #[test]
    fn a_box_between_pixel_centres_owns_nothing() {
        let between = Vec3::new(0.0, 0.0, -50.0);
        assert_eq!(Question::new(&Aabb::new(between, between), &flat_view()), Question::Outside);
        // Any sample position may be hit when there are several.
        let view = flat_view().with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, 4);
        assert_eq!(covered(&proxy(&Aabb::new(between, between), &view)).len(), 4);
    }

    #[test]
    fn what_cannot_be_asked_is_visible() {
        let eye = Vec3::new(3.0, 4.0, 5.0);
        let view = View::look_at(eye, Vec3::ZERO, 60.0, 0.1, Viewport::new(100, 100)).unwrap();
        for half in [0.2, 1.0, 1e7] {
            assert_eq!(Question::new(&Aabb::from_center(eye, Vec3::splat(half)), &view), Question::Visible);
        }
        // Wholly before the near plane: clipped away.
        assert_eq!(Question::new(&Aabb::from_center(eye, Vec3::splat(0.05)), &view), Question::Outside);
        let nan = Aabb::new(Vec3::splat(f32::NAN), Vec3::ZERO);
        assert_eq!(Question::new(&nan, &view), Question::Visible);
        assert_eq!(Question::new(&Aabb::EMPTY, &view), Question::Visible);
        // Nearer to a far-off eye than f32 can tell.
        let view = View::look_at(Vec3::splat(1e7), Vec3::ZERO, 60.0, 0.1, Viewport::new(100, 100)).unwrap();
        let aabb = Aabb::from_center(Vec3::splat(1e7 - 4.0), Vec3::splat(1.0));
        assert_eq!(Question::new(&aabb, &view), Question::Visible);
        assert!(matches!(
            Question::new(&Aabb::from_center(Vec3::ZERO, Vec3::splat(1e6)), &view),
            Question::Ask(_)
        ));
    }

    #[test]
    fn beyond_the_far_plane_the_entry_is_no_farther_than_the_cleared_depth() {
        let view = flat_view();
        let aabb = Aabb::new(Vec3::new(-5.0, -5.0, -150.0), Vec3::new(5.0, 5.0, -99.999_99));
        let proxy = proxy(&aabb, &view);
        assert!(covered(&proxy).iter().all(|&(x, y)| proxy.nearness(x, y) >= 0.0), "{proxy:?}");
        let beyond = Aabb::new(Vec3::new(-5.0, -5.0, -150.0), Vec3::new(5.0, 5.0, -101.0));
        assert_eq!(Question::new(&beyond, &view), Question::Outside);
    }

    #[test]
    fn coarser_targets_take_more() {
        let aabb = Aabb::new(Vec3::splat(-0.7), Vec3::splat(0.9));
        let view = View::look_at(Vec3::splat(4.0), Vec3::ZERO, 60.0, 0.1, Viewport::new(100, 100)).unwrap();
        let fine = proxy(&aabb, &view);
        let unorm = view.clone().with_target(DepthDirection::Reversed, DepthFormat::Depth24Plus, 1);
        assert!(proxy(&aabb, &unorm).nearest > fine.nearest);
        let multisampled = view.with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, 4);
        assert!(covered(&proxy(&aabb, &multisampled)).len() > covered(&fine).len());
    }
}
