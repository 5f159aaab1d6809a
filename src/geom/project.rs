//! A box on the screen: where it may show, and how near and far it is.
//!
//! Everything here is taken in f64 and rounded outward at the end. The error that is allowed for
//! is the app's: it transforms in f32 ([`View::clip_error`]) and its rasteriser snaps vertices to
//! a grid of as little as 4 subpixel bits. The proof is in [`proxy`](super::Proxy)'s module.

use glam::{DVec2, DVec4, Vec2};

use super::aabb::{f32_above, f32_below};
use super::pixel_rect::PixelRect;
use super::{Aabb, DepthDirection, DepthFormat, View};

/// Half of the distance from 1 to the next f32: the relative error of one rounding.
pub(super) const UNIT: f64 = 1.0 / 16_777_216.0;

/// How many times [`View::clip_error`] is allowed for: once for the app's vertices, once for the
/// vertices that clipping makes of them and for the f64 arithmetic here.
pub(super) const CLIP_SHARE: f64 = 2.0;

/// The farthest that snapping moves a vertex along an axis, in pixels: one step of the coarsest
/// grid that Vulkan allows (`subPixelPrecisionBits` = 4).
const SNAP: f64 = 1.0 / 16.0;

/// Where a box lies on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projected {
    /// No part of it can own a sample.
    Outside,
    /// It crosses the near plane, holds the eye, or is so near that f32 cannot say: it may show
    /// anywhere.
    Near,
    /// All of it lies ahead.
    Rect(ScreenRect),
}

/// A rectangle of the viewport, in pixels, and a range of nearness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenRect {
    /// The upper left corner, within the viewport.
    pub min: Vec2,
    /// The lower right corner, within the viewport.
    pub max: Vec2,
    /// No sample of the box is nearer.
    pub nearest: f32,
    /// No sample of the box is farther.
    pub farthest: f32,
}

impl ScreenRect {
    /// In square pixels.
    pub fn area(&self) -> f32 {
        let size = self.max - self.min;
        size.x * size.y
    }

    /// Whether the rectangles share a point; touching ones do.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }
}

/// A rectangle that every sample of the box lies in, and the range of its nearness. O(1), no
/// allocation.
///
/// An invalid box is [`Projected::Near`].
pub fn project(aabb: &Aabb, view: &View) -> Projected {
    let screen = match place(aabb, view) {
        Ok(screen) => screen,
        Err(Unprojected::Outside) => return Projected::Outside,
        Err(Unprojected::Near) => return Projected::Near,
    };
    let viewport = view.viewport();
    let size = DVec2::new(f64::from(viewport.width), f64::from(viewport.height));
    let (min, max) = (screen.min - screen.reach, screen.max + screen.reach);
    if max.cmplt(DVec2::ZERO).any() || min.cmpgt(size).any() {
        return Projected::Outside;
    }
    let (min, max) = (min.max(DVec2::ZERO), max.min(size));
    Projected::Rect(ScreenRect {
        min: Vec2::new(f32_below(min.x), f32_below(min.y)),
        max: Vec2::new(f32_above(max.x), f32_above(max.y)),
        nearest: f32_above(screen.nearest + screen.depth_error),
        farthest: f32_below(screen.farthest - screen.depth_error),
    })
}

/// How far a sample of geometry in a box may lie from the box on the screen: across and down, in
/// pixels, and in nearness. A question about the box allows for exactly this much. None for a box
/// that is not asked about. O(1).
pub(crate) fn uncertainty(aabb: &Aabb, view: &View) -> Option<[f64; 3]> {
    let screen = place(aabb, view).ok()?;
    Some([screen.reach.x, screen.reach.y, screen.depth_error])
}

/// Why a box has no [`Screen`].
pub(super) enum Unprojected {
    /// It lies outside the view.
    Outside,
    /// As [`Projected::Near`].
    Near,
}

/// The projected corners of a box in screen space (pixels of the viewport, y down; nearness), and
/// how far from their hull a sample of geometry in the box may lie.
pub(super) struct Screen {
    pub(super) x: [f64; 8],
    pub(super) y: [f64; 8],
    pub(super) nearness: [f64; 8],
    pub(super) min: DVec2,
    pub(super) max: DVec2,
    /// The design's r, an axis: a pixel whose sample the geometry owns has its centre this near
    /// to the hull.
    pub(super) reach: DVec2,
    /// How much nearer (or farther) than the hull the stored depth of such a sample may be.
    pub(super) depth_error: f64,
    pub(super) nearest: f64,
    pub(super) farthest: f64,
}

impl Screen {
    /// The pixels whose centres lie within reach, clipped to the viewport; `None` for none.
    pub(super) fn pixels(&self, view: &View) -> Option<PixelRect> {
        let viewport = view.viewport();
        let first = |low: f64| (low - 0.5).ceil().max(0.0) as u32;
        let end = |high: f64, size: u32| ((high - 0.5).floor() + 1.0).clamp(0.0, f64::from(size)) as u32;
        let (min, max) = (self.min - self.reach, self.max + self.reach);
        let rect = PixelRect {
            x0: first(min.x),
            y0: first(min.y),
            x1: end(max.x, viewport.width),
            y1: end(max.y, viewport.height),
        };
        (rect.x0 < rect.x1 && rect.y0 < rect.y1).then_some(rect)
    }
}

/// Projects the eight corners, if all of them are certain to lie before the near plane. A box that
/// lies beside the viewport may be projected or found outside.
pub(super) fn place(aabb: &Aabb, view: &View) -> Result<Screen, Unprojected> {
    if !aabb.is_valid() {
        return Err(Unprojected::Near);
    }
    let (low, high) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
    let m = view.clip_from_world();
    let clip: [[f64; 8]; 4] = std::array::from_fn(|row| {
        let k = m.row(row);
        let (x, y, z) =
            ([low.x * k.x, high.x * k.x], [low.y * k.y, high.y * k.y], [low.z * k.z, high.z * k.z]);
        std::array::from_fn(|i| (x[i & 1] + y[i >> 1 & 1]) + (z[i >> 2] + k.w))
    });
    let [x, y, z, w] = &clip;
    // Products that underflow in f32 lose at most the least normal number each.
    let tiny = 16.0 * f64::from(f32::MIN_POSITIVE);
    let error = view.clip_error(low.abs().max(high.abs())) * CLIP_SHARE + DVec4::splat(tiny);

    let before_near: [f64; 8] = match view.depth() {
        DepthDirection::Reversed => std::array::from_fn(|i| w[i] - z[i]),
        DepthDirection::Standard => *z,
    };
    let before_far: [f64; 8] = match view.depth() {
        DepthDirection::Reversed => *z,
        DepthDirection::Standard => std::array::from_fn(|i| w[i] - z[i]),
    };
    // Generous to whichever of the two planes is `z`.
    let plane_error = error.w + error.z;
    if greatest(&before_near) < -plane_error || greatest(&before_far) < -plane_error {
        return Err(Unprojected::Outside);
    }
    let w_min = least(w);
    if !(w_min > 4.0 * error.w && least(&before_near) > plane_error) {
        return Err(if beside(x, y, w, error, view) { Unprojected::Outside } else { Unprojected::Near });
    }

    let viewport = view.viewport();
    let half = DVec2::new(0.5 * f64::from(viewport.width), 0.5 * f64::from(viewport.height));
    let sign = match view.depth() {
        DepthDirection::Reversed => 1.0,
        DepthDirection::Standard => -1.0,
    };
    let inverse: [f64; 8] = std::array::from_fn(|i| 1.0 / w[i]);
    let screen_x: [f64; 8] = std::array::from_fn(|i| half.x + half.x * (x[i] * inverse[i]));
    let screen_y: [f64; 8] = std::array::from_fn(|i| half.y - half.y * (y[i] * inverse[i]));
    let nearness: [f64; 8] = std::array::from_fn(|i| sign * (z[i] * inverse[i]));
    let min = DVec2::new(least(&screen_x), least(&screen_y));
    let max = DVec2::new(greatest(&screen_x), greatest(&screen_y));
    let (nearest, farthest) = (greatest(&nearness), least(&nearness));

    let far_out = min.abs().max(max.abs());
    let snapped = DVec2::new(
        pixel_slack(viewport.x, viewport.width, far_out.x),
        pixel_slack(viewport.y, viewport.height, far_out.y),
    );
    let w_low = w_min - error.w;
    let moved = (half * DVec2::new(error.x, error.y) + (half + snapped) * error.w) / w_low;
    let within_pixel = if view.samples() > 1 { 0.5 } else { 0.0 };
    let magnitude = nearest.abs().max(farthest.abs());
    Ok(Screen {
        x: screen_x,
        y: screen_y,
        nearness,
        min,
        max,
        reach: snapped + moved + DVec2::splat(within_pixel),
        depth_error: depth_error(magnitude, error, w_low) + depth_step(magnitude, view.format()),
        nearest,
        farthest,
    })
}

/// How far, in pixels, snapping and the rounding of the viewport transform can move geometry and
/// proxy along one axis together, for vertices up to `far_out` pixels from the viewport's corner.
///
/// The viewport transform rounds four times at most, each time by half a unit in the last place
/// of a number no greater than the sum of these three; twice that is allowed.
pub(super) fn pixel_slack(origin: u32, length: u32, far_out: f64) -> f64 {
    2.0 * SNAP + 8.0 * UNIT * (far_out + f64::from(origin) + f64::from(length))
}

/// How much the f32 depth of geometry may differ from the exact one: see the proof in the proxy's
/// module.
fn depth_error(magnitude: f64, error: DVec4, w_low: f64) -> f64 {
    // 16 for the app's division and interpolation, one for the f64 arithmetic here.
    const INTERPOLATION: f64 = 17.0 * UNIT;
    (4.0 / 3.0) * (error.z + magnitude * error.w) / w_low + INTERPOLATION * magnitude
}

/// One step of the depth format, with the rounding of what is stored and read.
fn depth_step(magnitude: f64, format: DepthFormat) -> f64 {
    match format {
        DepthFormat::Depth32Float => 2.0 * UNIT * magnitude + f64::from(f32::MIN_POSITIVE),
        // One step is 1/(2²⁴ − 1); converting it to f32 rounds by up to another half.
        DepthFormat::Depth24Plus => 2.0 * UNIT,
    }
}

/// Whether all of a box that may reach behind the eye lies outside one side of the view.
fn beside(x: &[f64; 8], y: &[f64; 8], w: &[f64; 8], error: DVec4, view: &View) -> bool {
    let viewport = view.viewport();
    let outside = |v: &[f64; 8], v_error: f64, origin: u32, length: u32| {
        let k = 1.0 + 2.0 * pixel_slack(origin, length, 0.0) / f64::from(length);
        let slack = v_error + k * error.w;
        (0..8).all(|i| v[i] + k * w[i] < -slack) || (0..8).all(|i| k * w[i] - v[i] < -slack)
    };
    outside(x, error.x, viewport.x, viewport.width) || outside(y, error.y, viewport.y, viewport.height)
}

/// The least of eight numbers, none of them NaN.
pub(super) fn least(v: &[f64; 8]) -> f64 {
    fold(v, |a, b| if b < a { b } else { a })
}

/// The greatest of eight numbers, none of them NaN.
pub(super) fn greatest(v: &[f64; 8]) -> f64 {
    fold(v, |a, b| if b > a { b } else { a })
}

/// Pairwise: three steps deep instead of seven, and vector instructions.
fn fold(v: &[f64; 8], pick: impl Fn(f64, f64) -> f64) -> f64 {
    let four: [f64; 4] = std::array::from_fn(|i| pick(v[i], v[i + 4]));
    pick(pick(four[0], four[2]), pick(four[1], four[3]))
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::geom::{Viewport, projection};

    fn view() -> View {
        View::look_at(Vec3::ZERO, Vec3::NEG_Z, 90.0, 0.1, Viewport::new(200, 100)).unwrap()
    }

    fn rect(aabb: &Aabb, view: &View) -> ScreenRect {
        match project(aabb, view) {
            Projected::Rect(rect) => rect,
            other => panic!("{aabb:?} projects to {other:?}"),
        }
    }

    #[test]
    fn a_rectangle_holds_the_box_and_little_more() {
        // At 10 m a pixel is 0.2 m high and wide; its near face spans 90..110 × 40..60.
        let aabb = Aabb::new(Vec3::new(-2.0, -2.0, -20.0), Vec3::new(2.0, 2.0, -10.0));
        let found = rect(&aabb, &view());
        assert!((found.min - Vec2::new(90.0, 40.0)).abs().max_element() < 0.13, "{found:?}");
        assert!((found.max - Vec2::new(110.0, 60.0)).abs().max_element() < 0.13, "{found:?}");
        assert!(
            found.min.cmple(Vec2::new(90.0, 40.0)).all() && found.max.cmpge(Vec2::new(110.0, 60.0)).all()
        );
        assert!(found.nearest >= 0.01 && found.nearest < 0.010_000_1, "{found:?}");
        assert!(found.farthest <= 0.005 && found.farthest > 0.004_999, "{found:?}");
        assert!((found.area() - 400.0).abs() < 12.0);
    }

    #[test]
    fn rectangles_are_clipped_to_the_viewport_and_overlap_where_they_touch() {
        let view = view();
        let wide = rect(&Aabb::from_center(Vec3::new(0.0, 0.0, -10.0), Vec3::new(1e4, 1.0, 1.0)), &view);
        assert_eq!((wide.min.x, wide.max.x), (0.0, 200.0));
        let left = rect(&Aabb::from_center(Vec3::new(-5.0, 0.0, -10.0), Vec3::ONE), &view);
        let right = rect(&Aabb::from_center(Vec3::new(5.0, 0.0, -10.0), Vec3::ONE), &view);
        assert!(wide.overlaps(&left) && right.overlaps(&wide) && !left.overlaps(&right));
        assert!(left.overlaps(&left));
    }

    #[test]
    fn near_and_outside_are_told_apart() {
        let view = view();
        let at = |x: f32, z: f32, half: f32| Aabb::from_center(Vec3::new(x, 0.0, z), Vec3::splat(half));
        assert_eq!(project(&at(0.0, 0.0, 1.0), &view), Projected::Near, "holds the eye");
        assert_eq!(project(&at(0.0, -1.0, 0.95), &view), Projected::Near, "crosses the near plane");
        assert_eq!(project(&at(0.0, 5.0, 1.0), &view), Projected::Outside, "behind");
        assert_eq!(project(&at(100.0, 0.0, 1.0), &view), Projected::Outside, "beside, both sides of near");
        assert_eq!(project(&at(100.0, -10.0, 1.0), &view), Projected::Outside, "beside");
        let nan = Aabb::new(Vec3::splat(f32::NAN), Vec3::ONE);
        assert_eq!(project(&nan, &view), Projected::Near, "invalid");
    }

    #[test]
    fn standard_depth_gives_nearness_below_zero() {
        let clip_from_view = projection::perspective_standard(1.5, 1.0, 1.0, 100.0);
        let view = View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(64, 64)).unwrap().with_target(
            DepthDirection::Standard,
            DepthFormat::Depth24Plus,
            1,
        );
        let found = rect(&Aabb::from_center(Vec3::new(0.0, 0.0, -10.0), Vec3::ONE), &view);
        assert!(-1.0 < found.farthest && found.farthest < found.nearest && found.nearest < -0.5, "{found:?}");
        let beyond = Aabb::from_center(Vec3::new(0.0, 0.0, -110.0), Vec3::ONE);
        assert_eq!(project(&beyond, &view), Projected::Outside);
    }
}
