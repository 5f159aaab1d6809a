//! What one camera sees: matrices, viewport and depth convention.
//!
//! # Conventions
//!
//! | | |
//! |---|---|
//! | world, view | right-handed, y up, metres; a view looks along −z |
//! | matrices | `target_from_source`, column vectors: `clip = clip_from_view * view_from_world * world` |
//! | clip | x right, y up, `-w ≤ x, y ≤ w`, `0 ≤ z ≤ w` |
//! | depth | **reversed z**: 1 at the near plane, 0 at infinity ([`DepthDirection::Reversed`]); or standard z |
//! | screen | pixels of the viewport, origin at its upper left corner, y down, pixel centres at `.5` |
//! | nearness | depth under reversed z, *minus* depth under standard z: greater is nearer in both, and negation is exact, so every comparison in the crate is written once |

use glam::{DMat4, DVec3, DVec4, Mat4, Vec3, Vec4};

use super::projection;
use crate::Error;

/// Which end of the depth range is near.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum DepthDirection {
    /// 1 is near, 0 is far: the default, precise at every distance in a float format.
    #[default]
    Reversed,
    /// 0 is near, 1 is far.
    Standard,
}

impl DepthDirection {
    /// Depth as a number that grows toward the viewer; see the module's table.
    pub fn nearness(self, depth: f32) -> f32 {
        match self {
            Self::Reversed => depth,
            Self::Standard => -depth,
        }
    }

    /// The nearness of a sample that nothing has been drawn on.
    pub fn cleared(self) -> f32 {
        match self {
            Self::Reversed => 0.0,
            Self::Standard => -1.0,
        }
    }
}

/// What the app's depth buffer stores. Sixteen bits are refused where a target is handed in:
/// too coarse to answer exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum DepthFormat {
    /// 32-bit float.
    #[default]
    Depth32Float,
    /// At least 24 bits, fixed point or float.
    Depth24Plus,
}

/// The rectangle of the target that a view is drawn to, in pixels of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Viewport {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Width, 1 to [`Viewport::MAX_SIDE`].
    pub width: u32,
    /// Height, 1 to [`Viewport::MAX_SIDE`].
    pub height: u32,
}

impl Viewport {
    /// The longest side that the software backend rasterises.
    pub const MAX_SIDE: u32 = 16_384;

    /// A viewport at the target's origin.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { x: 0, y: 0, width, height }
    }
}

/// One camera's view of the scene, checked to be usable. Coordinates are relative to the scene's
/// origin.
#[derive(Clone, Debug)]
pub struct View {
    view_from_world: Mat4,
    clip_from_view: Mat4,
    /// The product, taken in f64: exact but for f64 rounding.
    clip_from_world: DMat4,
    /// |clip_from_view| · |view_from_world|, entry by entry: times |p| it bounds the sum of the
    /// magnitudes that any f32 evaluation of the product adds up.
    magnitude: DMat4,
    world_from_clip: DMat4,
    viewport: Viewport,
    depth: DepthDirection,
    format: DepthFormat,
    samples: u32,
}

impl View {
    /// A view from the two matrices that the app draws with, in reversed z and Depth32Float.
    ///
    /// Perspective, orthographic and oblique projections, a finite or infinite far plane, and
    /// jittered (TAA) projections are all just matrices here; [`projection`] makes them.
    ///
    /// # Errors
    /// [`Error::Viewport`] for a side of 0 or above [`Viewport::MAX_SIDE`]; [`Error::Matrix`],
    /// naming the matrix, for an entry that is not finite or a matrix that cannot be inverted.
    pub fn new(view_from_world: Mat4, clip_from_view: Mat4, viewport: Viewport) -> Result<Self, Error> {
        let side = 1..=Viewport::MAX_SIDE;
        if !side.contains(&viewport.width) || !side.contains(&viewport.height) {
            return Err(Error::Viewport { width: viewport.width, height: viewport.height });
        }
        for (name, m) in [("view_from_world", view_from_world), ("clip_from_view", clip_from_view)] {
            if !m.is_finite() {
                return Err(Error::Matrix { name, why: "has an entry that is NaN or infinite" });
            }
        }
        let world_from_view = invert("view_from_world", view_from_world.as_dmat4())?;
        let view_from_clip = invert("clip_from_view", clip_from_view.as_dmat4())?;
        let view = view_from_world.as_dmat4();
        let clip = clip_from_view.as_dmat4();
        Ok(Self {
            view_from_world,
            clip_from_view,
            clip_from_world: clip * view,
            magnitude: absolute(clip) * absolute(view),
            world_from_clip: world_from_view * view_from_clip,
            viewport,
            depth: DepthDirection::Reversed,
            format: DepthFormat::Depth32Float,
            samples: 1,
        })
    }

    /// A perspective view from `eye` toward `target`, y up, with an infinite far plane: the
    /// common case. `fov_y` is in degrees, `near` in metres.
    ///
    /// # Errors
    /// As [`View::new`]: for instance when `eye` and `target` coincide.
    pub fn look_at(
        eye: Vec3,
        target: Vec3,
        fov_y: f32,
        near: f32,
        viewport: Viewport,
    ) -> Result<Self, Error> {
        // Looking straight up or down, y cannot be "up".
        let along = (target - eye).normalize_or_zero();
        let up = if along.y.abs() > 0.999_9 { Vec3::Z } else { Vec3::Y };
        let aspect = viewport.width as f32 / viewport.height.max(1) as f32;
        Self::new(
            glam::camera::rh::view::look_at_mat4(eye, target, up),
            projection::perspective(fov_y.to_radians(), aspect, near),
            viewport,
        )
    }

    /// The same view for another depth buffer. `samples` is the target's sample count: with more
    /// than one, questions allow for sample positions anywhere inside the pixel.
    #[must_use]
    pub fn with_target(mut self, depth: DepthDirection, format: DepthFormat, samples: u32) -> Self {
        self.depth = depth;
        self.format = format;
        self.samples = samples.max(1);
        self
    }

    /// The same view with so many times fewer columns and rows of pixels, rounded up. 0 counts as 1.
    #[must_use]
    pub fn coarsened(&self, divisor: u32) -> Self {
        let divisor = divisor.max(1);
        let Viewport { x, y, width, height } = self.viewport;
        let viewport = Viewport {
            x: x / divisor,
            y: y / divisor,
            width: width.div_ceil(divisor),
            height: height.div_ceil(divisor),
        };
        Self { viewport, ..self.clone() }
    }

    /// The matrix from world to view space, as handed in.
    pub fn view_from_world(&self) -> Mat4 {
        self.view_from_world
    }

    /// The projection, as handed in.
    pub fn clip_from_view(&self) -> Mat4 {
        self.clip_from_view
    }

    /// World to clip space, the product taken in f64.
    pub fn clip_from_world(&self) -> &DMat4 {
        &self.clip_from_world
    }

    /// Clip space to world, in f64.
    pub fn world_from_clip(&self) -> &DMat4 {
        &self.world_from_clip
    }

    /// The rectangle of the target, in pixels.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Which end of the depth range is near.
    pub fn depth(&self) -> DepthDirection {
        self.depth
    }

    /// What the depth buffer stores.
    pub fn format(&self) -> DepthFormat {
        self.format
    }

    /// Samples a pixel, at least 1.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The eye as a homogeneous point: w = 1 for a perspective view, w = 0 (a direction, toward
    /// the viewer) for an orthographic one. It is the point that clip space maps to z = ±∞.
    pub fn eye(&self) -> Vec4 {
        let eye = self.world_from_clip * DVec4::Z;
        if eye.w.abs() > f64::EPSILON * eye.abs().max_element() {
            return (eye / eye.w).as_vec4();
        }
        let toward_viewer = -self.forward().as_dvec3();
        toward_viewer.extend(0.0).as_vec4()
    }

    /// The unit direction of view in world space: the z axis of the view matrix, negated.
    pub fn forward(&self) -> Vec3 {
        let z = DVec3::new(
            f64::from(self.view_from_world.x_axis.z),
            f64::from(self.view_from_world.y_axis.z),
            f64::from(self.view_from_world.z_axis.z),
        );
        (-z).normalize_or_zero().as_vec3()
    }

    /// A bound, a component, on how far the clip-space position of a point can be from exact when
    /// an app computes it in f32: model transform, view, projection, as one matrix or as several,
    /// fused or not. `p_abs` holds upper bounds of |x|, |y|, |z|.
    ///
    /// Each f32 product of a 4×4 matrix and a vector (or of two matrices) errs by at most
    /// γ₄·|A||b| (Higham §3.5), γ₄ < 4.01·2⁻²⁴. Three products in a row (model, view and
    /// projection in any association) and the rounding of their entries stay below 16·2⁻²⁴ times
    /// the product of the absolute values; the model's own share is added by
    /// [`Aabb::transformed`](super::Aabb::transformed).
    pub fn clip_error(&self, p_abs: DVec3) -> DVec4 {
        self.magnitude * p_abs.extend(1.0) * CLIP_GAMMA
    }

    /// [`View::clip_error`] as a matrix: it is linear in `(|x|, |y|, |z|, 1)`.
    pub(super) fn clip_error_matrix(&self) -> DMat4 {
        self.magnitude * CLIP_GAMMA
    }
}

/// The relative error of [`View::clip_error`].
const CLIP_GAMMA: f64 = 16.0 / 16_777_216.0;

fn absolute(m: DMat4) -> DMat4 {
    DMat4::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs(), m.w_axis.abs())
}

fn invert(name: &'static str, m: DMat4) -> Result<DMat4, Error> {
    let singular = Error::Matrix { name, why: "is singular: it cannot be inverted" };
    // A far/near ratio of 1e9 or an eye at 1e7 m makes columns and rows of very different size
    // and no singular matrix. So first the columns, then the rows are scaled to length 1; the
    // determinant of the result is the volume that they span, of at most 1.
    let columns = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(DVec4::normalize_or_zero);
    let rows = DMat4::from_cols_array_2d(&columns.map(|c| c.to_array())).transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis].map(DVec4::normalize_or_zero);
    let volume = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).determinant().abs();
    let inverse = m.inverse();
    // Not `volume <= limit`: NaN must be refused too.
    if !(volume > 1e-14 && inverse.is_finite()) {
        return Err(singular);
    }
    Ok(inverse)
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec2};

    use super::*;

    fn perspective() -> Mat4 {
        projection::perspective(1.0, 1.0, 0.1)
    }

    #[test]
    fn the_extremes_are_accepted() {
        let viewport = Viewport::new(Viewport::MAX_SIDE, 1);
        for eye in [Vec3::ZERO, Vec3::splat(1e7), Vec3::new(-1e7, 1e-3, 1e7)] {
            for turn in [Quat::IDENTITY, Quat::from_rotation_y(1.0), Quat::from_xyzw(0.5, 0.5, 0.5, 0.5)] {
                let view_from_world = Mat4::from_rotation_translation(turn, -(turn * eye));
                for fov in [0.1f32, 60.0, 179.0].map(f32::to_radians) {
                    for near in [1e-3, 0.1, 100.0] {
                        let far = near * 1e9;
                        for clip_from_view in [
                            projection::perspective(fov, 2.0, near),
                            projection::perspective_finite(fov, 2.0, near, far),
                            projection::perspective_standard(fov, 2.0, near, far),
                            projection::orthographic(1e-2, 1e-2, near, far),
                            projection::orthographic(1e7, 1e7, near, far),
                            projection::jittered(
                                projection::perspective(fov, 2.0, near),
                                Vec2::new(0.4, -0.3),
                                16_384,
                                1,
                            ),
                        ] {
                            let view = View::new(view_from_world, clip_from_view, viewport);
                            let view =
                                view.unwrap_or_else(|e| panic!("{e}: {view_from_world}, {clip_from_view}"));
                            let product = *view.clip_from_world() * *view.world_from_clip();
                            assert!(product.is_finite());
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        let viewport = Viewport::new(10, 10);
        let flattened = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0));
        let repeated = Mat4::from_cols(Vec4::X, Vec4::X, Vec4::Z, Vec4::W);
        let dependent = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(3.0, 4.0, 0.0, 0.0), Vec4::W);
        for singular in [Mat4::ZERO, flattened, repeated, dependent] {
            let error = View::new(singular, perspective(), viewport).unwrap_err();
            assert!(matches!(error, Error::Matrix { name: "view_from_world", .. }), "{error}");
            let error = View::new(Mat4::IDENTITY, singular, viewport).unwrap_err();
            assert!(matches!(error, Error::Matrix { name: "clip_from_view", .. }), "{error}");
        }
        assert!(View::look_at(Vec3::ONE, Vec3::ONE, 60.0, 0.1, viewport).is_err());
    }

    #[test]
    fn entries_that_are_not_finite_are_refused() {
        let viewport = Viewport::new(10, 10);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for i in 0..16 {
                let mut entries = Mat4::IDENTITY.to_cols_array();
                entries[i] = bad;
                let m = Mat4::from_cols_array(&entries);
                assert!(matches!(View::new(m, perspective(), viewport), Err(Error::Matrix { .. })));
                assert!(matches!(View::new(Mat4::IDENTITY, m, viewport), Err(Error::Matrix { .. })));
            }
        }
    }

    #[test]
    fn viewports_have_limits() {
        for (width, height) in [(0, 1), (1, 0), (0, 0), (Viewport::MAX_SIDE + 1, 1), (1, u32::MAX)] {
            let view = View::new(Mat4::IDENTITY, perspective(), Viewport::new(width, height));
            assert!(matches!(view, Err(Error::Viewport { .. })), "{width} × {height}");
        }
        assert!(View::new(Mat4::IDENTITY, perspective(), Viewport::new(1, 1)).is_ok());
    }

    #[test]
    fn the_eye_is_a_point_or_a_direction() {
        let eye = Vec3::new(3.0, -2.0, 7.0);
        let view = View::look_at(eye, Vec3::ZERO, 60.0, 0.1, Viewport::new(10, 10)).unwrap();
        assert!((view.eye() - eye.extend(1.0)).abs().max_element() < 1e-5, "{}", view.eye());
        assert!((view.forward() + eye.normalize()).length() < 1e-6);
        let turn = Mat4::from_rotation_y(0.3);
        let flat =
            View::new(turn, projection::orthographic(4.0, 4.0, 0.1, 9.0), Viewport::new(10, 10)).unwrap();
        assert_eq!(flat.eye().w, 0.0);
        assert!((flat.eye().truncate() + flat.forward()).length() < 1e-6);
    }

    #[test]
    fn the_clip_error_bounds_what_f32_does() {
        let view = View::look_at(Vec3::splat(1e5), Vec3::ZERO, 60.0, 0.1, Viewport::new(10, 10)).unwrap();
        let single = view.clip_from_view() * view.view_from_world();
        for p in [Vec3::ZERO, Vec3::splat(9e4), Vec3::new(-3e4, 17.0, 5e-3)] {
            let exact = *view.clip_from_world() * p.as_dvec3().extend(1.0);
            let off = ((single * p.extend(1.0)).as_dvec4() - exact).abs();
            let bound = view.clip_error(p.as_dvec3().abs());
            assert!(off.cmple(bound).all(), "{off} of {bound}");
            assert!(bound.max_element() < 1.0, "{bound}");
        }
    }
}
