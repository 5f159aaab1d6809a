//! How finely a mesh is drawn: levels of detail by projected error.

use glam::{Affine3A, DVec3, DVec4, Vec3A};

use crate::geom::View;
use crate::scene::mesh::Mesh;

/// The accuracy that a frame is drawn with. The level follows from the object and the view
/// alone, never from history: every algorithm draws the same triangles for the same frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// How far a drawn surface may lie from the true one, in pixels along either axis of the
    /// screen. Zero, a negative number or NaN: always the finest level.
    pub max_error_px: f32,
}

impl Default for Detail {
    /// One pixel.
    fn default() -> Self {
        Self { max_error_px: 1.0 }
    }
}

impl Detail {
    /// Always the finest level.
    pub const FULL: Self = Self { max_error_px: 0.0 };

    /// The coarsest level whose error stays within [`Detail::max_error_px`] at the object's
    /// point that is nearest to the eye; level 0 when none does, when the object reaches behind
    /// the eye's plane, or when a number is not finite. O(levels).
    pub fn level(&self, mesh: &Mesh, world_from_object: &Affine3A, view: &View) -> usize {
        let levels = mesh.levels();
        if levels.len() == 1 || self.max_error_px.is_nan() || self.max_error_px <= 0.0 {
            return 0;
        }
        let px_per_metre = pixels_per_metre(mesh, world_from_object, view) * largest_scale(world_from_object);
        // A NaN fails the comparison, and so does infinity.
        let fits = |error: f32| f64::from(error) * px_per_metre <= f64::from(self.max_error_px);
        levels.iter().rposition(|level| fits(level.error)).unwrap_or(0)
    }
}

/// How many pixels a world-space displacement of one metre can move a point of the object on the
/// screen, along x or along y; infinite when the object reaches behind the eye's plane.
///
/// With clip coordinates `x(p)` and `w(p)`, both affine in p, the screen's abscissa is
/// `W/2 · x/w`, and its gradient `W/2 · (∇x − u·∇w) / w` with `u = x/w`. A point on the screen
/// has |u| ≤ 1, and the length of the bracket is convex in u: its greatest value lies at u = ±1.
/// An orthographic view has ∇w = 0 and w = 1, and needs no case of its own.
fn pixels_per_metre(mesh: &Mesh, world_from_object: &Affine3A, view: &View) -> f64 {
    let clip = view.clip_from_world();
    let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
    let nearest_w = least(w, mesh, world_from_object);
    if nearest_w.is_nan() || nearest_w <= 0.0 {
        return f64::INFINITY;
    }
    let slope = |row: DVec4| {
        let (row, w) = (row.truncate(), w.truncate());
        (row - w).length().max((row + w).length())
    };
    let viewport = view.viewport();
    let pixels = (slope(x) * f64::from(viewport.width)).max(slope(y) * f64::from(viewport.height));
    0.5 * pixels / nearest_w
}

/// The least value of an affine function over the object's world box.
fn least(row: DVec4, mesh: &Mesh, world_from_object: &Affine3A) -> f64 {
    let bounds = mesh.bounds().transformed(world_from_object);
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let slope = row.truncate();
    let corner = DVec3::select(slope.cmpge(DVec3::ZERO), min, max);
    slope.dot(corner) + row.w
}

/// An upper bound on how much a transform can stretch a length: the largest singular value is
/// at most the root of the largest absolute row sum of the Gram matrix, and equals it for a
/// rotation with uniform scale.
fn largest_scale(world_from_object: &Affine3A) -> f64 {
    let m = &world_from_object.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c: Vec3A| c.as_dvec3());
    let row_sum = |a: DVec3| columns.iter().map(|&b| a.dot(b).abs()).sum::<f64>();
    let gram = columns.map(row_sum);
    // `fold` with a comparison that keeps NaN: an object that is nowhere is drawn in full.
    gram.into_iter().fold(0.0, |most: f64, g| if g <= most { most } else { g }).sqrt()
}
