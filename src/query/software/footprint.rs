//! What a draw call, or a part of one, can touch: is it worth transforming?

use glam::{Mat4, Vec3, Vec4};

use super::isa::{Isa, LANES, Mask, affine, magnitude};
use super::pass::DrawCall;
use super::setup::{first_sample, last_sample};
use super::vertex::{Image, SUBPIXEL_BITS, Screen, clip_from_object, snap_lanes};
use crate::geom::{Aabb, PixelRect, View};
use crate::scene::meshlets::{Boxes, Single};

/// How far the f32 image of a point can lie from what is computed here, a component, as a share of
/// the sum of magnitudes: a four-term dot product errs by less than 4.01·2⁻²⁴ of it, twice, and
/// what is left is for the sums that bounds are made of.
const GAMMA: f32 = 16.0 / 16_777_216.0;
/// Beyond f32's own rounding, for a quotient.
const QUOTIENT: f32 = 8.0 / 16_777_216.0;

/// What a draw call can touch, rounded outward so that no triangle of it reaches further.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    pub(crate) clip_from_object: Mat4,
    /// Pixels that may be written; none if the call covers no sample.
    pub(crate) rect: Option<PixelRect>,
    /// No sample of the call is nearer.
    pub(crate) nearest: f32,
    /// Whether its level is a [`Single`] that needs no clipping and is at most [`COMPACT_SIDE`]
    /// pixels wide and high.
    pub(crate) compact: bool,
}

/// See [`Footprint::compact`].
const COMPACT_SIDE: i32 = 16;

/// Bounds what a draw call touches: from its vertices if they are few, else from the corners of its
/// mesh's box. O(1).
#[inline(always)]
pub(crate) fn footprint<I: Isa>(view: &View, screen: &Screen, call: &DrawCall) -> Footprint {
    let clip_from_object = clip_from_object(view.clip_from_world(), &call.world_from_object);
    let mut footprint =
        Footprint { clip_from_object, rect: None, nearest: f32::NEG_INFINITY, compact: false };
    let level = call.geometry();
    if level.indices.is_empty() {
        return footprint;
    }
    // Larger meshes are cut into parts when they are first seen, not before.
    if level.positions.len() <= LANES
        && let Some(single) = call.mesh.meshlets(call.level).single()
        && let Some(bounds) = Snapped::new::<I>(screen, &clip_from_object, single)
    {
        footprint.rect = bounds.rect(screen);
        footprint.nearest = bounds.nearest;
        footprint.compact = bounds.is_compact();
        return footprint;
    }
    let corners = Extremes::new::<I>(&clip_from_object, &call.mesh.bounds(), screen.sign);
    if !corners.outside() {
        let (rect, nearest) = corners.extent(screen).unwrap_or((screen.whole(), f32::INFINITY));
        footprint.rect = (rect.x0 < rect.x1 && rect.y0 < rect.y1).then_some(rect);
        footprint.nearest = nearest;
    }
    footprint
}

/// The extremes of sixteen vertices on the screen: exactly what is drawn.
struct Snapped {
    /// In subpixels.
    least: [i32; 2],
    greatest: [i32; 2],
    nearest: f32,
}

impl Snapped {
    /// None if a vertex needs clipping.
    #[inline(always)]
    fn new<I: Isa>(screen: &Screen, m: &Mat4, single: &Single) -> Option<Self> {
        let [x, y, z] = &single.positions;
        let image = Image::<I>::new(screen, m, [x, y, z]);
        if image.beyond != [0; 3] {
            return None;
        }
        // Without clipping, coordinates are below 2²³: exact as floats.
        let (x, y, zero) = (I::to_f(image.x), I::to_f(image.y), I::splat_f(0.0));
        let mut runs = [[0.0; LANES]; LANES];
        runs[0] = I::store_f(x);
        runs[1] = I::store_f(y);
        runs[2] = I::store_f(I::sub_f(zero, x));
        runs[3] = I::store_f(I::sub_f(zero, y));
        runs[4] = I::store_f(I::sub_f(zero, image.nearness));
        let least = I::store_f(I::least(&runs));
        Some(Self {
            least: [least[0] as i32, least[1] as i32],
            greatest: [-least[2] as i32, -least[3] as i32],
            nearest: -least[4],
        })
    }

    /// The pixels of the viewport whose samples lie between the extremes.
    #[inline(always)]
    fn rect(&self, screen: &Screen) -> Option<PixelRect> {
        let x0 = first_sample(self.least[0]).max(0);
        let y0 = first_sample(self.least[1]).max(0);
        let x1 = last_sample(self.greatest[0]).min(screen.width - 1) + 1;
        let y1 = last_sample(self.greatest[1]).min(screen.height - 1) + 1;
        (x0 < x1 && y0 < y1).then_some(PixelRect {
            x0: x0 as u32,
            y0: y0 as u32,
            x1: x1 as u32,
            y1: y1 as u32,
        })
    }

    #[inline(always)]
    fn is_compact(&self) -> bool {
        let most = COMPACT_SIDE << SUBPIXEL_BITS;
        self.greatest[0] - self.least[0] <= most && self.greatest[1] - self.least[1] <= most
    }
}

/// The extremes of a box's corners in clip space and on the screen.
struct Extremes {
    least: [f32; LANES],
    greatest: [f32; LANES],
    /// See [`GAMMA`]; of x, y, z and w.
    error: Vec4,
}

// Lanes of the extremes: the place on the screen and nearness, over w; w; and the planes of the
// view, positive inside.
const SCREEN: usize = 0;
const W: usize = 3;
const PLANES: std::ops::Range<usize> = 4..10;

impl Extremes {
    #[inline(always)]
    fn new<I: Isa>(m: &Mat4, bounds: &Aabb, sign: f32) -> Self {
        // Bit k of a lane chooses the side of axis k.
        let mut p = [I::splat_f(0.0); 3];
        for axis in 0..3 {
            let upper = [0xAAAA, 0xCCCC, 0xF0F0][axis];
            p[axis] = I::blend_f(upper, I::splat_f(bounds.min[axis]), I::splat_f(bounds.max[axis]));
        }
        let (x, y) = (affine::<I>(row(m, 0), p), affine::<I>(row(m, 1), p));
        let (z, w) = (affine::<I>(row(m, 2), p), affine::<I>(row(m, 3), p));
        let mut all = [[0.0; LANES]; LANES];
        all[SCREEN] = I::store_f(I::div_f(x, w));
        all[SCREEN + 1] = I::store_f(I::div_f(y, w));
        all[SCREEN + 2] = I::store_f(I::div_f(I::mul_f(z, I::splat_f(sign)), w));
        all[W] = I::store_f(w);
        all[PLANES.start] = I::store_f(I::add_f(x, w));
        all[PLANES.start + 1] = I::store_f(I::sub_f(w, x));
        all[PLANES.start + 2] = I::store_f(I::add_f(y, w));
        all[PLANES.start + 3] = I::store_f(I::sub_f(w, y));
        all[PLANES.start + 4] = I::store_f(z);
        all[PLANES.start + 5] = I::store_f(I::sub_f(w, z));
        let largest = bounds.min.abs().max(bounds.max.abs());
        let magnitude = m.x_axis.abs() * largest.x
            + m.y_axis.abs() * largest.y
            + m.z_axis.abs() * largest.z
            + m.w_axis.abs();
        Self {
            least: I::store_f(I::least(&all)),
            greatest: I::store_f(I::greatest(&all)),
            error: magnitude * GAMMA + Vec4::splat(f32::MIN_POSITIVE),
        }
    }

    /// Whether the f32 image of every point of the box lies beyond one plane of the view. Linear
    /// functions are greatest at corners. What is not a number is not outside.
    fn outside(&self) -> bool {
        // A sum of two components errs by both errors.
        let [x, y, z, w] = self.error.to_array();
        let errors = [x + w, x + w, y + w, y + w, z, z + w];
        let finite = |v: &[f32; LANES]| v[PLANES].iter().all(|v| v.is_finite());
        let usable = finite(&self.least) && finite(&self.greatest);
        usable && self.greatest[PLANES].iter().zip(errors).any(|(greatest, error)| greatest + error < 0.0)
    }

    /// The pixels that the box covers and its greatest nearness; none if it comes too near the
    /// plane w = 0 to tell.
    fn extent(&self, screen: &Screen) -> Option<(PixelRect, f32)> {
        let w = self.least[W] - self.error.w;
        if w.is_nan() || w <= 4.0 * self.error.w {
            return None;
        }
        let low = Vec3::from_slice(&self.least[SCREEN..]);
        let high = Vec3::from_slice(&self.greatest[SCREEN..]);
        // d(x/w) ≤ (dx + |x/w| dw) / (w - dw)
        let largest = low.abs().max(high.abs());
        let margin = (self.error.truncate() + largest * self.error.w) / w + largest * QUOTIENT;
        if !margin.is_finite() || !low.is_finite() || !high.is_finite() {
            return None;
        }
        let (low, high) = (low - margin, high + margin);
        let (x0, x1) = pixels(low.x, high.x, screen.width);
        let (y0, y1) = pixels(-high.y, -low.y, screen.height);
        Some((PixelRect { x0, y0, x1, y1 }, high.z.next_up()))
    }
}

/// The coefficients of one component of an image.
#[inline(always)]
fn row(m: &Mat4, i: usize) -> [f32; 4] {
    [m.x_axis[i], m.y_axis[i], m.z_axis[i], m.w_axis[i]]
}

/// The pixels of a side between two normalised coordinates, as first and end. One pixel more, for
/// snapping and the f32 rounding, far more than both.
fn pixels(from: f32, to: f32, side: i32) -> (u32, u32) {
    let (half, side) = (side as f32 * 0.5, side as f32);
    let first = (from * half + half - 1.0).floor().clamp(0.0, side);
    let end = (to * half + half + 1.0).ceil().clamp(0.0, side);
    (first as u32, end as u32)
}

/// What sixteen parts of a mesh can touch.
pub(crate) struct Extents<I: Isa> {
    /// First columns and first rows; they may lie before the viewport's.
    pub(crate) first: [I::I; 2],
    /// Last columns and last rows; they may lie beyond the viewport's, and before the first.
    pub(crate) last: [I::I; 2],
    pub(crate) nearest: I::F,
}

/// Bounds what sixteen boxes touch: wider than by their corners, since place and depth are bounded
/// apart from each other.
#[inline(always)]
pub(crate) fn extents<I: Isa>(m: &Mat4, screen: &Screen, boxes: &Boxes) -> Extents<I> {
    let (x, y) = (Reach::<I>::new(row(m, 0), boxes), Reach::<I>::new(row(m, 1), boxes).times(-1.0));
    let (z, w) = (Reach::<I>::new(row(m, 2), boxes).times(screen.sign), Reach::<I>::new(row(m, 3), boxes));
    let in_front = I::gt_f(w.least(), I::mul_f(w.greatest(), I::splat_f(1e-3)));
    let usable = x.finite & y.finite & z.finite & w.finite & in_front;
    let near = z.greatest_over(&w);
    let near = I::add_f(near, I::mul_f(magnitude::<I>(near), I::splat_f(QUOTIENT)));
    let (width, height) = (screen.width, screen.height);
    Extents {
        first: [
            place::<I>(x.least_over(&w), width, -2.0, usable, 0.0),
            place::<I>(y.least_over(&w), height, -2.0, usable, 0.0),
        ],
        last: [
            place::<I>(x.greatest_over(&w), width, 2.0, usable, width as f32),
            place::<I>(y.greatest_over(&w), height, 2.0, usable, height as f32),
        ],
        nearest: I::blend_f(usable, I::splat_f(f32::INFINITY), near),
    }
}

/// One component of the images of sixteen boxes.
struct Reach<I: Isa> {
    /// The image of the centre.
    middle: I::F,
    /// How far that of the box reaches around it, rounding included.
    around: I::F,
    /// Where all sums are far from overflow.
    finite: Mask,
}

impl<I: Isa> Reach<I> {
    #[inline(always)]
    fn new(c: [f32; 4], boxes: &Boxes) -> Self {
        let zero = I::splat_f(0.0);
        let (mut centre, mut reach, mut all) = ([zero; 3], zero, I::splat_f(c[3].abs()));
        for axis in 0..3 {
            let scale = I::splat_f(c[axis].abs());
            centre[axis] = I::load_f(&boxes.centre[axis]);
            reach = I::add_f(reach, I::mul_f(scale, I::load_f(&boxes.half[axis])));
            all = I::add_f(all, I::mul_f(scale, magnitude::<I>(centre[axis])));
        }
        let all = I::add_f(all, reach);
        let error = I::add_f(I::mul_f(all, I::splat_f(GAMMA)), I::splat_f(f32::MIN_POSITIVE));
        Self {
            middle: affine::<I>(c, centre),
            around: I::add_f(reach, error),
            finite: I::gt_f(I::splat_f(1e30), all),
        }
    }

    /// Times 1 or -1.
    #[inline(always)]
    fn times(self, sign: f32) -> Self {
        Self { middle: I::mul_f(self.middle, I::splat_f(sign)), ..self }
    }

    #[inline(always)]
    fn least(&self) -> I::F {
        I::sub_f(self.middle, self.around)
    }

    #[inline(always)]
    fn greatest(&self) -> I::F {
        I::add_f(self.middle, self.around)
    }

    /// The least quotient by a positive `w`: what is negative is least over the least.
    #[inline(always)]
    fn least_over(&self, w: &Self) -> I::F {
        let v = self.least();
        I::div_f(v, I::blend_f(I::gt_f(I::splat_f(0.0), v), w.greatest(), w.least()))
    }

    /// The greatest quotient by a positive `w`: what is positive is greatest over the least.
    #[inline(always)]
    fn greatest_over(&self, w: &Self) -> I::F {
        let v = self.greatest();
        I::div_f(v, I::blend_f(I::gt_f(v, I::splat_f(0.0)), w.greatest(), w.least()))
    }
}

/// The column or row of normalised coordinates, some pixels on: two of them cover snapping and all
/// rounding. Another where it cannot be told.
#[inline(always)]
fn place<I: Isa>(v: I::F, side: i32, more: f32, usable: Mask, otherwise: f32) -> I::I {
    let (half, side) = (I::splat_f(side as f32 * 0.5), I::splat_f(side as f32 + 2.0));
    let v = I::add_f(I::add_f(I::mul_f(v, half), half), I::splat_f(more));
    let v = I::max_f(I::min_f(v, side), I::splat_f(-2.0));
    snap_lanes::<I>(I::blend_f(usable, I::splat_f(otherwise), v))
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::isa::Portable;
    use super::super::vertex::{GUARD_LIMIT, SUBPIXELS, clip_position};
    use super::*;
    use crate::geom::Viewport;

    #[test]
    fn the_image_of_every_point_lies_in_the_extents_of_its_box() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let view =
            View::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 0.1, Viewport::new(640, 400)).expect("a view");
        let screen = Screen::new(&view);
        let (mut seen, mut bounded) = (0, 0);
        for _ in 0..400 {
            let mut v = |r: f32| Vec3::from_array(std::array::from_fn(|_| dice.random_range(-r..r)));
            // Boxes far from their own origin lose digits on their way to the view.
            let away = v(1.0) * [0.0, 1e3, 1e6][seen % 3];
            let turn = Quat::from_scaled_axis(v(3.0));
            let to = Vec3::new(0.0, 0.0, -8.0) + v(6.0) - turn * away;
            let place = Affine3A::from_rotation_translation(turn, to);
            let matrix = clip_from_object(view.clip_from_world(), &place);
            let (centre, half) = (away + v(1.0), v(0.5).abs());
            let lanes = |v: Vec3| v.to_array().map(|v| [v; LANES]);
            let found =
                extents::<Portable>(&matrix, &screen, &Boxes { centre: lanes(centre), half: lanes(half) });
            bounded += usize::from(found.nearest[0].is_finite());
            for _ in 0..20 {
                let p = centre + v(1.0) * half;
                if ((p - centre).abs().cmpgt(half)).any() {
                    continue;
                }
                let clip = clip_position(&matrix, p);
                let at = screen.project(clip.x, clip.y, clip.z, clip.w);
                let offset = [at.x - screen.width * SUBPIXELS / 2, at.y - screen.height * SUBPIXELS / 2];
                let clipped = clip.w < clip.z || clip.z < 0.0 || clip.w <= 0.0;
                if clipped || offset.iter().any(|v| v.abs() as f32 > GUARD_LIMIT) {
                    continue;
                }
                seen += 1;
                assert!(at.nearness <= found.nearest[0], "{at:?} is nearer than {}", found.nearest[0]);
                for (v, axis) in [(at.x, 0), (at.y, 1)] {
                    let side = [screen.width, screen.height][axis];
                    let pixel = v.div_euclid(SUBPIXELS);
                    let (first, last) = (found.first[axis][0], found.last[axis][0]);
                    assert!(pixel < 0 || first <= pixel, "{pixel} is before {first}");
                    assert!(pixel >= side || pixel <= last, "{pixel} is beyond {last}");
                }
            }
        }
        assert!(seen > 4000 && bounded > 200, "{seen} points, {bounded} boxes in front");
    }
}
