//! A draw call against the view: is it worth transforming, and which pixels can it touch?

use glam::{DVec3, DVec4, Mat4};

use super::pass::DrawCall;
use super::vertex::{Screen, clip_from_object};
use crate::geom::{Aabb, PixelRect, View};

/// What a draw call can touch, rounded outward so that no triangle of it reaches further.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    pub(crate) clip_from_object: Mat4,
    /// Pixels that may be written; none if the call covers no sample.
    pub(crate) rect: Option<PixelRect>,
    /// No sample of the call is nearer.
    pub(crate) nearest: f32,
}

impl Footprint {
    /// A bound on what a draw call touches, from the corners of its mesh's box. O(1).
    pub(crate) fn new(view: &View, screen: &Screen, call: &DrawCall) -> Self {
        let clip_from_object = clip_from_object(view.clip_from_world(), &call.world_from_object);
        let corners = Corners::new(&clip_from_object, &call.mesh.bounds());
        if corners.outside() {
            return Self { clip_from_object, rect: None, nearest: f32::NEG_INFINITY };
        }
        let (rect, nearest) = corners.extent(screen).unwrap_or((
            PixelRect { x0: 0, y0: 0, x1: screen.width as u32, y1: screen.height as u32 },
            f32::INFINITY,
        ));
        let rect = (rect.x0 < rect.x1 && rect.y0 < rect.y1).then_some(rect);
        Self { clip_from_object, rect, nearest }
    }
}

/// The corners of a box in clip space.
struct Corners {
    clip: [DVec4; 8],
    /// How far the f32 image of a point of the box can lie from the exact one, a component:
    /// a four-term dot product errs by less than 4.01·2⁻²⁴ of the sum of magnitudes.
    error: DVec4,
}

impl Corners {
    fn new(m: &Mat4, bounds: &Aabb) -> Self {
        const GAMMA: f64 = 8.0 / 16_777_216.0;
        let m = m.as_dmat4();
        let clip = bounds.corners().map(|p| m * p.as_dvec3().extend(1.0));
        let largest: DVec3 = bounds.min.as_dvec3().abs().max(bounds.max.as_dvec3().abs());
        let magnitude = m.x_axis.abs() * largest.x
            + m.y_axis.abs() * largest.y
            + m.z_axis.abs() * largest.z
            + m.w_axis.abs();
        Self { clip, error: magnitude * GAMMA + DVec4::splat(f64::from(f32::MIN_POSITIVE)) }
    }

    /// Whether the f32 image of every point of the box lies beyond one plane of the view. Linear
    /// functions are greatest at corners. NaN anywhere compares as not outside.
    fn outside(&self) -> bool {
        let planes = [
            DVec4::new(1.0, 0.0, 0.0, 1.0),
            DVec4::new(-1.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 1.0, 0.0, 1.0),
            DVec4::new(0.0, -1.0, 0.0, 1.0),
            DVec4::new(0.0, 0.0, 1.0, 0.0),
            DVec4::new(0.0, 0.0, -1.0, 1.0),
        ];
        planes.iter().any(|plane| {
            let error = plane.abs().dot(self.error);
            self.clip.iter().all(|c| plane.dot(*c) + error < 0.0)
        })
    }

    /// The pixels that the box covers and its greatest nearness; none if it comes too near the
    /// plane w = 0 to tell.
    fn extent(&self, screen: &Screen) -> Option<(PixelRect, f32)> {
        let w = self.clip.iter().fold(f64::INFINITY, |least, c| least.min(c.w)) - self.error.w;
        if w.is_nan() || w <= 4.0 * self.error.w {
            return None;
        }
        let ndc = self.clip.map(|c| DVec3::new(c.x, c.y, f64::from(screen.sign) * c.z) / c.w);
        let low = ndc.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = ndc.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        // d(x/w) ≤ (dx + |x/w| dw) / (w - dw)
        let margin = (self.error.truncate() + low.abs().max(high.abs()) * self.error.w) / w;
        if !margin.is_finite() || !low.is_finite() || !high.is_finite() {
            return None;
        }
        let (low, high) = (low - margin, high + margin);
        // One pixel for snapping and the f32 division, far more than both.
        let pixels = |from: f64, to: f64, side: i32| {
            let half = f64::from(side) * 0.5;
            let first = (from * half + half - 1.0).floor().clamp(0.0, f64::from(side));
            let end = (to * half + half + 1.0).ceil().clamp(0.0, f64::from(side));
            (first as u32, end as u32)
        };
        let (x0, x1) = pixels(low.x, high.x, screen.width);
        let (y0, y1) = pixels(-high.y, -low.y, screen.height);
        // Twice up: once for the conversion, once for the f32 division of a vertex.
        Some((PixelRect { x0, y0, x1, y1 }, (high.z as f32).next_up().next_up()))
    }
}
