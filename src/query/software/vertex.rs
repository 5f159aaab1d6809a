//! Vertices: object space to snapped screen coordinates.
//!
//! Everything is f32, unfused, in one fixed order, so that a vertex lands on the same spot
//! whoever transforms it: that keeps shared edges watertight and re-rasterised triangles equal.

use glam::{Affine3A, DMat4, DVec4, Mat4, Vec3, Vec4};

use super::isa::{ALL, Isa, LANES, Mask, affine};
use crate::geom::{DepthDirection, PixelRect, View};
use crate::scene::meshlets::MOST_VERTICES;

/// Subpixel steps a pixel, as a power of two.
pub(crate) const SUBPIXEL_BITS: u32 = 8;
/// Subpixel steps a pixel.
pub(crate) const SUBPIXELS: i32 = 1 << SUBPIXEL_BITS;

/// A vertex farther than this from the viewport's centre, in subpixels, is clipped first. It lies
/// a little inside the planes that [`clip`](super::clip) cuts at, so that a vertex that
/// needs no clipping is never cut.
pub(crate) const GUARD_LIMIT: f32 = 0.98 * 4_194_304.0;

/// A transformed vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vertex {
    /// Column in subpixels of the viewport; it and the others mean nothing for a vertex that needs
    /// clipping.
    pub(crate) x: i32,
    /// Row in subpixels of the viewport, downward.
    pub(crate) y: i32,
    /// See [`DepthDirection::nearness`].
    pub(crate) nearness: f32,
}

/// How clip space lands on the viewport.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen {
    /// Width in pixels.
    pub(crate) width: i32,
    /// Height in pixels.
    pub(crate) height: i32,
    /// Half the width in subpixels: subpixels from the centre per unit of normalised x.
    pub(crate) scale_x: f32,
    /// The same for y, negative since rows go down.
    pub(crate) scale_y: f32,
    /// 1 where nearness is depth, -1 where it is minus depth.
    pub(crate) sign: f32,
    /// Whether the view shows the world mirrored.
    pub(crate) mirrors: bool,
}

impl Screen {
    pub(crate) fn new(view: &View) -> Self {
        let viewport = view.viewport();
        let half = (SUBPIXELS / 2) as f32;
        let sign = match view.depth() {
            DepthDirection::Reversed => 1.0,
            DepthDirection::Standard => -1.0,
        };
        Self {
            width: viewport.width as i32,
            height: viewport.height as i32,
            // At most 2^21: exact.
            scale_x: viewport.width as f32 * half,
            scale_y: -(viewport.height as f32 * half),
            sign,
            // Right, up and toward the eye are right-handed in the world; on the screen too, if
            // nearness counts for the third.
            mirrors: view.clip_from_world().determinant() * f64::from(sign) < 0.0,
        }
    }

    /// All pixels.
    pub(crate) fn whole(&self) -> PixelRect {
        PixelRect { x0: 0, y0: 0, x1: self.width as u32, y1: self.height as u32 }
    }

    /// A clip-space point on the screen.
    pub(crate) fn project(&self, x: f32, y: f32, z: f32, w: f32) -> Vertex {
        let inverse = 1.0 / w;
        let sx = x * inverse * self.scale_x;
        let sy = y * inverse * self.scale_y;
        Vertex {
            x: snap(sx).wrapping_add(self.width * (SUBPIXELS / 2)),
            y: snap(sy).wrapping_add(self.height * (SUBPIXELS / 2)),
            nearness: self.sign * (z / w),
        }
    }
}

/// The clip-space image of an object-space point, in the one order of operations that every
/// vertex takes.
#[inline(always)]
pub(crate) fn clip_position(clip_from_object: &Mat4, p: Vec3) -> Vec4 {
    let m = clip_from_object;
    Vec4::new(
        ((m.x_axis.x * p.x + m.y_axis.x * p.y) + m.z_axis.x * p.z) + m.w_axis.x,
        ((m.x_axis.y * p.x + m.y_axis.y * p.y) + m.z_axis.y * p.z) + m.w_axis.y,
        ((m.x_axis.z * p.x + m.y_axis.z * p.y) + m.z_axis.z * p.z) + m.w_axis.z,
        ((m.x_axis.w * p.x + m.y_axis.w * p.y) + m.z_axis.w * p.z) + m.w_axis.w,
    )
}

/// The product of view and transform, taken in f64 and rounded once.
pub(crate) fn clip_from_object(clip_from_world: &DMat4, world_from_object: &Affine3A) -> Mat4 {
    let m = world_from_object.matrix3;
    let column = |v: glam::Vec3A, w: f64| -> Vec4 {
        let v = DVec4::new(f64::from(v.x), f64::from(v.y), f64::from(v.z), w);
        (*clip_from_world * v).as_vec4()
    };
    Mat4::from_cols(
        column(m.x_axis, 0.0),
        column(m.y_axis, 0.0),
        column(m.z_axis, 0.0),
        column(world_from_object.translation, 1.0),
    )
}

/// The vertices of a part of a mesh on the screen, where they need no clipping.
#[derive(Debug)]
pub(crate) struct Projected {
    pub(crate) x: [i32; MOST_VERTICES],
    pub(crate) y: [i32; MOST_VERTICES],
    pub(crate) nearness: [f32; MOST_VERTICES],
    /// A bit for each vertex that needs clipping: for lying before the near plane of reversed z
    /// (`w - z < 0`), which is the far plane of standard z; beyond the other plane (`z < 0`);
    /// outside the guard band. What is not a number has each bit. `0 ≤ z ≤ w` leaves w = 0 only with
    /// z = 0: then the position is infinite or not a number, and outside the guard band.
    pub(crate) beyond: [u64; 3],
}

impl Default for Projected {
    fn default() -> Self {
        Self { x: [0; MOST_VERTICES], y: [0; MOST_VERTICES], nearness: [0.0; MOST_VERTICES], beyond: [0; 3] }
    }
}

impl Projected {
    /// The vertices that need clipping.
    #[inline(always)]
    pub(crate) fn clipped(&self) -> u64 {
        self.beyond[0] | self.beyond[1] | self.beyond[2]
    }

    /// Takes the image of some positions, an axis after the other.
    #[inline(always)]
    pub(crate) fn transform<I: Isa>(&mut self, screen: &Screen, m: &Mat4, positions: [&[[f32; LANES]]; 3]) {
        self.beyond = [0; 3];
        let (xs, _) = self.x.as_chunks_mut::<LANES>();
        let (ys, _) = self.y.as_chunks_mut::<LANES>();
        let (ns, _) = self.nearness.as_chunks_mut::<LANES>();
        for i in 0..positions[0].len().min(xs.len()) {
            let image = Image::<I>::new(screen, m, [&positions[0][i], &positions[1][i], &positions[2][i]]);
            for k in 0..3 {
                self.beyond[k] |= u64::from(image.beyond[k]) << (i * LANES);
            }
            xs[i] = I::store(image.x);
            ys[i] = I::store(image.y);
            ns[i] = I::store_f(image.nearness);
        }
    }
}

/// Sixteen vertices on the screen.
pub(crate) struct Image<I: Isa> {
    pub(crate) x: I::I,
    pub(crate) y: I::I,
    pub(crate) nearness: I::F,
    /// See [`Projected::beyond`].
    pub(crate) beyond: [Mask; 3],
}

impl<I: Isa> Image<I> {
    /// What [`clip_position`] and [`Screen::project`] make of each, operation by operation.
    #[inline(always)]
    pub(crate) fn new(screen: &Screen, m: &Mat4, positions: [&[f32; LANES]; 3]) -> Self {
        let [cx, cy, cz, cw] = [m.x_axis, m.y_axis, m.z_axis, m.w_axis];
        let p = [I::load_f(positions[0]), I::load_f(positions[1]), I::load_f(positions[2])];
        let x = affine::<I>([cx.x, cy.x, cz.x, cw.x], p);
        let y = affine::<I>([cx.y, cy.y, cz.y, cw.y], p);
        let z = affine::<I>([cx.z, cy.z, cz.z, cw.z], p);
        let w = affine::<I>([cx.w, cy.w, cz.w, cw.w], p);
        let inverse = I::div_f(I::splat_f(1.0), w);
        let sx = I::mul_f(I::mul_f(x, inverse), I::splat_f(screen.scale_x));
        let sy = I::mul_f(I::mul_f(y, inverse), I::splat_f(screen.scale_y));
        let zero = I::splat_f(0.0);
        let guarded = in_guard_band::<I>(sx) & in_guard_band::<I>(sy);
        let before = ALL & !I::ge_f(I::sub_f(w, z), zero);
        Self {
            x: I::add(snap_lanes::<I>(sx), I::splat(screen.width * (SUBPIXELS / 2))),
            y: I::add(snap_lanes::<I>(sy), I::splat(screen.height * (SUBPIXELS / 2))),
            nearness: I::mul_f(I::splat_f(screen.sign), I::div_f(z, w)),
            beyond: [before, ALL & !I::ge_f(z, zero), ALL & !guarded],
        }
    }
}

/// 1.5·2²³.
const MAGIC: f32 = 12_582_912.0;

/// The nearest integer, ties to even, for |v| ≤ 2²²: adding 1.5·2²³ leaves the integer in the low
/// bits of the mantissa. Without a float-to-integer conversion, which saturates slowly in Rust.
#[inline(always)]
fn snap(v: f32) -> i32 {
    ((v + MAGIC).to_bits() as i32).wrapping_sub(MAGIC.to_bits() as i32)
}

/// Where coordinates lie in the guard band; nowhere for what is not a number.
#[inline(always)]
fn in_guard_band<I: Isa>(v: I::F) -> Mask {
    I::ge_f(I::splat_f(GUARD_LIMIT), v) & I::ge_f(v, I::splat_f(-GUARD_LIMIT))
}

/// [`snap`] of sixteen.
#[inline(always)]
pub(crate) fn snap_lanes<I: Isa>(v: I::F) -> I::I {
    I::sub(I::bits(I::add_f(v, I::splat_f(MAGIC))), I::splat(MAGIC.to_bits() as i32))
}
