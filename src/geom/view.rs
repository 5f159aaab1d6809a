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

use crate::Error;

/// Which end of the depth range is near.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
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
pub enum DepthFormat {
    /// 32-bit float.
    #[default]
    Depth32Float,
    /// At least 24 bits, fixed point or float.
    Depth24Plus,
}

/// The rectangle of the target that a view is drawn to, in pixels of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Projection matrices into `0 ≤ z ≤ w`. Angles in radians, distances in metres.
pub mod projection {
    use glam::camera::rh::proj::directx;
    use glam::{Mat4, Vec2, Vec4};

    /// Perspective, reversed z, infinite far plane.
    pub fn perspective(fov_y: f32, aspect: f32, near: f32) -> Mat4 {
        directx::perspective_infinite_reverse(fov_y, aspect, near)
    }

    /// Perspective with a finite far plane, reversed z.
    pub fn perspective_finite(fov_y: f32, aspect: f32, near: f32, far: f32) -> Mat4 {
        // Standard z with the planes exchanged is reversed z.
        directx::perspective(fov_y, aspect, far, near)
    }

    /// Perspective, standard z, finite far plane.
    pub fn perspective_standard(fov_y: f32, aspect: f32, near: f32, far: f32) -> Mat4 {
        directx::perspective(fov_y, aspect, near, far)
    }

    /// Orthographic, reversed z. `width` and `height` are the box's full sides.
    pub fn orthographic(width: f32, height: f32, near: f32, far: f32) -> Mat4 {
        let (x, y) = (width * 0.5, height * 0.5);
        directx::orthographic(-x, x, -y, y, far, near)
    }

    /// The projection with its near plane replaced by `plane` (view space, positive on the side
    /// that is kept; mirrors and portals), for reversed z with a finite or infinite far plane.
    ///
    /// After Lengyel, *Oblique View Frustum Depth Projection and Clipping* (2005), restated for
    /// `0 ≤ z ≤ w` reversed: the near plane is `w − z ≥ 0`, so row z becomes row w minus a
    /// multiple of the plane, with the multiple chosen so that z stays ≥ 0 at the corner of the
    /// frustum that lies farthest along the plane's normal.
    pub fn oblique(clip_from_view: Mat4, plane: Vec4) -> Mat4 {
        let view_from_clip = clip_from_view.inverse();
        let toward = view_from_clip.transpose() * plane;
        let corner = view_from_clip * Vec4::new(toward.x.signum(), toward.y.signum(), 0.0, 1.0);
        let row_w = clip_from_view.row(3);
        let scale = row_w.dot(corner) / plane.dot(corner);
        let row_z = row_w - plane * scale;
        let mut m = clip_from_view.transpose();
        m.z_axis = row_z;
        m.transpose()
    }

    /// The projection shifted by a fraction of a pixel, as temporal anti-aliasing does. `pixels`
    /// points right and down.
    pub fn jittered(clip_from_view: Mat4, pixels: Vec2, width: u32, height: u32) -> Mat4 {
        let shift = Vec2::new(2.0 * pixels.x / width as f32, -2.0 * pixels.y / height as f32);
        Mat4::from_translation(shift.extend(0.0)) * clip_from_view
    }
}

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
