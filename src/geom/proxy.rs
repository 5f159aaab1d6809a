//! What a question rasterises: the normative stand-in for a box, the same on every backend.

use crate::geom::{Aabb, View};

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

/// A box as a question sees it: an outline of at most six edges and an entry depth of at most
/// three planes, both affine in the pixel centre's offset from [`Proxy::origin`].
///
/// A sample at pixel `(x, y)` has `dx = (x - origin.x) as f32 + 0.5`, `dy` likewise, and
/// every backend evaluates, in f32, unfused and in this order: `(a * dx + b * dy) + c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proxy {
    /// The pixels whose centres the outline may cover, clipped to the viewport; never empty.
    pub rect: PixelRect,
    /// Coefficients `[a, b, c]` of the outline's edges; a sample is inside where all are ≥ 0.
    /// Unused ones are `[0, 0, 0]`.
    pub edges: [[f32; 3]; 6],
    /// Coefficients `[a, b, c]` of the nearness of the front-facing planes; the entry nearness
    /// is the least of them and of `nearest`. Unused ones are `[0, 0, f32::MAX]`.
    pub planes: [[f32; 3]; 3],
    /// The nearness of the box's nearest point, rounded toward the viewer.
    pub nearest: f32,
}

/// What becomes of a box that is to be asked about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// No part of it can own a sample: it lies outside the view.
    Outside,
    /// It crosses the near plane, holds the eye, or its projection is too uncertain: taken as
    /// visible, not asked.
    Visible,
    /// To be asked.
    Ask(Proxy),
}
