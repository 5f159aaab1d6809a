//! The axis-aligned box.

use glam::{Affine3A, DVec3, Vec3};

/// An axis-aligned box in metres, closed on all sides: flat, linear and point-like boxes are
/// ordinary boxes. A box with `min > max` on some axis is *inverted* and contains nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// The corner with the least coordinates.
    pub min: Vec3,
    /// The corner with the greatest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The inverted box that is neutral under [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box between two corners, taken as they are: see [`Aabb::is_valid`].
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The box around a centre, with the given half extent a side.
    pub fn from_center(center: Vec3, half: Vec3) -> Self {
        Self::new(center - half, center + half)
    }

    /// The smallest box around some points; [`Aabb::EMPTY`] for none.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |all, p| Self::new(all.min.min(p), all.max.max(p)))
    }

    /// The smallest f32 box that holds an f64 box, relative to an f64 origin. A coordinate beyond
    /// the range of f32 becomes infinite, which [`Aabb::is_valid`] refuses.
    pub fn from_f64(min: DVec3, max: DVec3, origin: DVec3) -> Self {
        // The difference rounds to nearest in f64; one step of f64 outward makes it a bound.
        let below = |x: f64, o: f64| f32_below((x - o).next_down());
        let above = |x: f64, o: f64| f32_above((x - o).next_up());
        Self::new(
            Vec3::new(below(min.x, origin.x), below(min.y, origin.y), below(min.z, origin.z)),
            Vec3::new(above(max.x, origin.x), above(max.y, origin.y), above(max.z, origin.z)),
        )
    }

    /// The smallest f32 box that holds an f64 box.
    pub(crate) fn from_bounds(min: DVec3, max: DVec3) -> Self {
        Self::new(
            Vec3::new(f32_below(min.x), f32_below(min.y), f32_below(min.z)),
            Vec3::new(f32_above(max.x), f32_above(max.y), f32_above(max.z)),
        )
    }

    /// Whether all six coordinates are finite and no side is inverted.
    pub fn is_valid(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The centre. It cannot overflow: each half is taken before the sum.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The length of each side, in metres; infinite where it exceeds f32.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// The area of the six faces, in square metres; 0 for an empty box.
    pub fn surface_area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let s = self.size();
        2.0 * (s.x * s.y + s.y * s.z + s.z * s.x)
    }

    /// The smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        Self::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// Whether every point of `other` lies in this box.
    pub fn contains(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    /// Whether a point lies in this box or on its faces.
    pub fn contains_point(&self, p: Vec3) -> bool {
        self.min.cmple(p).all() && self.max.cmpge(p).all()
    }

    /// Whether the boxes share a point; touching faces do.
    pub fn intersects(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }

    /// The box grown by `metres` on every side, rounded outward.
    pub fn inflated(&self, metres: f32) -> Self {
        Self::new((self.min - metres).map(f32::next_down), (self.max + metres).map(f32::next_up))
    }

    /// The square of the distance from a point to the box, 0 inside; for ordering, not a bound.
    pub fn distance_squared(&self, p: Vec3) -> f32 {
        let outside = (self.min - p).max(p - self.max).max(Vec3::ZERO);
        outside.length_squared()
    }

    /// The eight corners; bit 0 of the index selects x, bit 1 y, bit 2 z.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// A box around the image of this one under `target_from_source`, wide enough that a vertex
    /// of the source box still lies inside after it was transformed in f32 by any order of the
    /// four-term sums (fused or not).
    ///
    /// An f32 dot product of four terms errs by at most γ₄·Σ|aᵢbᵢ| with γ₄ < 4.01·2⁻²⁴ (Higham,
    /// *Accuracy and Stability*, §3.1). The bound is taken in f64 from the largest |source|
    /// coordinate, with 8·2⁻²⁴ in place of γ₄, plus the least normal number for products that
    /// underflow, then rounded outward to f32.
    pub fn transformed(&self, target_from_source: &Affine3A) -> Self {
        let m = target_from_source.matrix3;
        let t = target_from_source.translation;
        let (mut min, mut max) = (Vec3::ZERO, Vec3::ZERO);
        for row in 0..3 {
            let (mut low, mut high) = (f64::from(t[row]), f64::from(t[row]));
            let mut magnitude = low.abs();
            for column in 0..3 {
                let k = f64::from(m.col(column)[row]);
                let a = k * f64::from(self.min[column]);
                let b = k * f64::from(self.max[column]);
                low += a.min(b);
                high += a.max(b);
                magnitude += a.abs().max(b.abs());
            }
            let error = sum_error(magnitude);
            min[row] = f32_below(low - error);
            max[row] = f32_above(high + error);
        }
        Self::new(min, max)
    }
}

/// What an f32 sum of four products can be off by, if their magnitudes add up to at most
/// `magnitude`; see [`Aabb::transformed`].
pub(super) fn sum_error(magnitude: f64) -> f64 {
    const GAMMA: f64 = 8.0 * (1.0 / 16_777_216.0);
    GAMMA * magnitude + f64::from(f32::MIN_POSITIVE)
}

/// The greatest f32 that is not above `x`.
pub(super) fn f32_below(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

/// The least f32 that is not below `x`.
pub(super) fn f32_above(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Quat};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn from_f64_rounds_outward() {
        // 0.1 and 0.3 are no f32; the origin cancels most of the digits.
        let origin = DVec3::splat(1e7);
        let (min, max) = (origin + 0.1, origin + 0.3);
        let aabb = Aabb::from_f64(min, max, origin);
        for axis in 0..3 {
            assert!(f64::from(aabb.min[axis]) <= min[axis] - origin[axis]);
            assert!(f64::from(aabb.max[axis]) >= max[axis] - origin[axis]);
        }
        assert!((aabb.size() - 0.2).abs().max_element() < 1e-6);
        let exact = Aabb::from_f64(DVec3::splat(-2.0), DVec3::splat(2.0), DVec3::ZERO);
        assert!(exact.contains(&Aabb::new(Vec3::splat(-2.0), Vec3::splat(2.0))));
        assert!(!Aabb::from_f64(DVec3::ZERO, DVec3::splat(1e39), DVec3::ZERO).is_valid());
        assert!(!Aabb::from_f64(DVec3::NAN, DVec3::ONE, DVec3::ZERO).is_valid());
    }

    #[test]
    fn a_transformed_box_holds_every_vertex_transformed_in_f32() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for _ in 0..20_000 {
            let mut vector = |scale: f32| {
                Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..=1.0f32))) * scale
            };
            let scale = 10f32.powi((vector(1.0).x * 7.0) as i32);
            let aabb = Aabb::from_points([vector(scale), vector(scale)]);
            let turn = Quat::from_axis_angle(vector(1.0).normalize_or(Vec3::Y), vector(3.0).x);
            let size = vector(4.0);
            let target_from_source =
                Affine3A::from_scale_rotation_translation(size, turn, vector(10.0 * scale));
            let around = aabb.transformed(&target_from_source);
            let inner = (aabb.center() + vector(0.5) * aabb.size()).clamp(aabb.min, aabb.max);
            for p in aabb.corners().into_iter().chain([inner]) {
                assert!(around.contains_point(target_from_source.transform_point3(p)));
                let unfused = Mat4::from(target_from_source) * p.extend(1.0);
                assert!(around.contains_point(unfused.truncate()));
                let m = target_from_source.matrix3;
                let fused = Vec3::from_array(std::array::from_fn(|i| {
                    let row = m.row(i);
                    row.x.mul_add(
                        p.x,
                        row.y.mul_add(p.y, row.z.mul_add(p.z, target_from_source.translation[i])),
                    )
                }));
                assert!(around.contains_point(fused), "{aabb:?} under {target_from_source:?}");
            }
        }
    }

    #[test]
    fn a_transformed_box_is_no_larger_than_it_must_be() {
        let aabb = Aabb::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0));
        let moved = aabb.transformed(&Affine3A::from_translation(Vec3::new(10.0, 0.0, -1.0)));
        let exact = Aabb::new(Vec3::new(11.0, 2.0, 2.0), Vec3::new(12.0, 4.0, 5.0));
        assert!(moved.contains(&exact) && exact.inflated(2e-5).contains(&moved), "{moved:?}");
    }

    #[test]
    fn degenerate_and_invalid_boxes_are_told_apart() {
        let point = Aabb::new(Vec3::ONE, Vec3::ONE);
        assert!(point.is_valid() && !point.is_empty() && point.contains_point(Vec3::ONE));
        assert!(Aabb::EMPTY.is_empty() && !Aabb::EMPTY.is_valid());
        assert_eq!(Aabb::EMPTY.union(&point), point);
        assert!(!Aabb::new(Vec3::NAN, Vec3::ONE).is_valid());
        assert!(!Aabb::new(Vec3::ZERO, Vec3::INFINITY).is_valid());
        let inverted = Aabb::new(Vec3::X, Vec3::ZERO);
        assert!(inverted.is_empty() && !inverted.is_valid());
        let huge = Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
        assert!(huge.is_valid() && huge.center() == Vec3::ZERO);
    }

    #[test]
    fn inflating_rounds_outward_and_touching_boxes_meet() {
        let a = Aabb::new(Vec3::ZERO, Vec3::ONE);
        assert!(a.inflated(1e-9).contains(&a) && a.inflated(1e-9) != a);
        let b = Aabb::new(Vec3::X, Vec3::splat(2.0));
        assert!(a.intersects(&b) && b.intersects(&a));
        assert!(!a.intersects(&Aabb::new(Vec3::splat(1.1), Vec3::splat(2.0))));
    }
}
