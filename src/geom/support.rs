//! How far a set of points reaches in every direction: the tight box of a turned mesh in O(1).
//!
//! The box of a turned box is too wide, by up to √3 a side. What a row d of a matrix really asks
//! is the *support function* of the points, h(d) = max d·v over all points v, and how far they
//! reach the other way, min d·v = −h(−d).
//!
//! h is sublinear: h(s·d) = s·h(d) for s ≥ 0, and h(d + e) ≤ h(d) + h(e), because no point is
//! further along d + e than the best for d and the best for e together. So for any directions qᵢ
//! and weights λᵢ ≥ 0,
//!
//! > d = Σ λᵢ·qᵢ implies h(d) ≤ Σ λᵢ·h(qᵢ).
//!
//! Here the qᵢ are the corners of a grid of triangles on the faces of the cube [−1, 1]³, at which
//! h is known exactly, and λᵢ the barycentric weights of the point in which d leaves the cube,
//! times the largest |coordinate| of d. The bound is exact at the corners, and wherever one point
//! is the furthest for all three of them.
//!
//! A face and the one opposite hold the same intervals [min q·v, max q·v], negated, so three
//! faces are kept.

use glam::{Affine3A, DVec3, Vec3};

use super::Aabb;
use super::aabb::{f32_above, f32_below, sum_error};

/// Cells along a side of a face, a power of two. Measured on the bunny and the teapot in 500
/// orientations, as the mean of (volume of the box) / (volume of the tightest):
///
/// | cells | bunny | teapot | bytes |
/// |---|---|---|---|
/// | 4 | 1.087 | 1.085 | 1 200 |
/// | 8 | 1.020 | 1.022 | 3 888 |
/// | 16 | 1.005 | 1.006 | 13 872 |
/// | box of the turned box | 2.872 | 3.653 | |
const CELLS: usize = 8;

/// Corners along a side of a face.
const SIDE: usize = CELLS + 1;

/// Samples of the support function of some points.
#[derive(Clone, Debug)]
pub(crate) struct Support {
    /// By major axis a, then by the coordinate along a + 2, then along a + 1 (modulo 3).
    samples: Box<[Interval]>,
    /// The largest |coordinate| of any point, on each axis.
    reach: DVec3,
}

/// The least and the greatest q·v.
type Interval = [f64; 2];

impl Support {
    /// Samples the support function of points, all of them finite. O(points), at a few hundred
    /// operations each.
    pub(crate) fn new(points: impl Iterator<Item = Vec3>) -> Self {
        let mut samples = vec![[f64::INFINITY, f64::NEG_INFINITY]; 3 * SIDE * SIDE];
        let mut reach = DVec3::ZERO;
        for point in points.map(|p| p.as_dvec3()) {
            reach = reach.max(point.abs());
            for (major, face) in samples.chunks_exact_mut(SIDE * SIDE).enumerate() {
                let [x, y, z] = [0, 1, 2].map(|k| point[(major + k) % 3]);
                for (j, row) in face.chunks_exact_mut(SIDE).enumerate() {
                    let x_and_z = x + z * coordinate(j);
                    for (i, [low, high]) in row.iter_mut().enumerate() {
                        let along = x_and_z + y * coordinate(i);
                        *low = low.min(along);
                        *high = high.max(along);
                    }
                }
            }
        }
        Self { samples: samples.into(), reach }
    }

    /// The part of `around` that can hold an image of a point under `target_from_source`, in f32
    /// by any order of the sums. `around` is the box of the points' box, [`Aabb::transformed`],
    /// and valid; so the transform is finite, and there is a point. O(1).
    pub(crate) fn tightened(&self, around: Aabb, target_from_source: &Affine3A) -> Aabb {
        // Roundings in f64: three in a sample, five in each coordinate of Σ λᵢ·qᵢ, five in the
        // sum; each is at most 2⁻⁵³ of what |d|∞ and the reach can make of it.
        const ROUNDING: f64 = 32.0 * f64::EPSILON;
        let translation = target_from_source.translation.as_dvec3();
        let (mut min, mut max) = (around.min, around.max);
        for row in 0..3 {
            let d = target_from_source.matrix3.row(row).as_dvec3();
            let [low, high] = self.interval(d);
            let magnitude = translation[row].abs() + d.abs().dot(self.reach);
            let rounding = ROUNDING * d.abs().max_element() * self.reach.element_sum();
            let error = sum_error(magnitude) + rounding;
            min[row] = min[row].max(f32_below(translation[row] + low - error));
            max[row] = max[row].min(f32_above(translation[row] + high + error));
        }
        Aabb::new(min, max)
    }

    /// An interval that holds d·v for every point v, but for roundings.
    fn interval(&self, d: DVec3) -> Interval {
        let major = d.abs().max_position();
        let scale = d[major];
        if scale == 0.0 {
            return [0.0, 0.0];
        }
        // Divided by the signed coordinate: a direction and its opposite leave at the same point.
        let (i, f) = cell(d[(major + 1) % 3] / scale);
        let (j, g) = cell(d[(major + 2) % 3] / scale);
        let at = |i: usize, j: usize| self.samples[(major * SIDE + j) * SIDE + i];
        let (near, far) = (at(i, j), at(i + 1, j + 1));
        // The cell's diagonal from its near to its far corner parts the two triangles.
        let (middle, most, least) = if f >= g { (at(i + 1, j), f, g) } else { (at(i, j + 1), g, f) };
        let mix = |k: usize| scale * ((1.0 - most) * near[k] + (most - least) * middle[k] + least * far[k]);
        let [a, b] = [mix(0), mix(1)];
        if a <= b { [a, b] } else { [b, a] }
    }
}

/// The coordinate on a face at which a grid's corner lies.
fn coordinate(corner: usize) -> f64 {
    corner as f64 * (2.0 / CELLS as f64) - 1.0
}

/// The cell that holds a coordinate from −1 to 1, and where in the cell it is, from 0 to 1.
fn cell(coordinate: f64) -> (usize, f64) {
    let corners = (coordinate + 1.0) * (0.5 * CELLS as f64);
    let cell = (corners as usize).min(CELLS - 1);
    (cell, corners - cell as f64)
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn vector(rng: &mut impl Rng) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..=1.0)))
    }

    fn extent(points: &[Vec3], d: DVec3) -> Interval {
        points
            .iter()
            .map(|p| p.as_dvec3().dot(d))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    #[test]
    fn an_interval_holds_every_point_in_every_direction() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for _ in 0..400 {
            let stretch = vector(&mut rng).map(|x| 10f64.powf(6.0 * x));
            let count = rng.random_range(1..40);
            let points: Vec<Vec3> = (0..count).map(|_| (vector(&mut rng) * stretch).as_vec3()).collect();
            let support = Support::new(points.iter().copied());
            for _ in 0..100 {
                let mut d = vector(&mut rng);
                match rng.random_range(0..8) {
                    0 => d[rng.random_range(0..3)] = 0.0,
                    1 => d = DVec3::AXES[rng.random_range(0..3)] * d.x,
                    // On an edge or a corner of the cube, or on the diagonal of a cell.
                    2 => d = d.signum(),
                    3 => d.y = d.x,
                    4 => d /= stretch,
                    _ => {}
                }
                let ([low, high], [least, most]) = (support.interval(d), extent(&points, d));
                let rounding = 1e-14 * d.abs().max_element() * support.reach.element_sum();
                assert!(low <= least + rounding && most <= high + rounding, "{d} of {points:?}");
            }
        }
    }

    #[test]
    fn an_interval_is_exact_at_the_grids_corners_and_nearly_so_between_them() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let points: Vec<Vec3> = (0..3000).map(|_| vector(&mut rng).normalize().as_vec3()).collect();
        let support = Support::new(points.iter().copied());
        for corner in 0..3 * SIDE * SIDE {
            let mut d = DVec3::ONE;
            d[corner % 3] = coordinate(corner / 3 % SIDE);
            d[(corner + 1) % 3] = coordinate(corner / 3 / SIDE);
            let ([low, high], [least, most]) = (support.interval(-3.0 * d), extent(&points, -3.0 * d));
            assert!((low - least).abs() < 1e-12 && (high - most).abs() < 1e-12, "{d}");
        }
        for _ in 0..1000 {
            let d = vector(&mut rng).normalize();
            let ([low, high], [least, most]) = (support.interval(d), extent(&points, d));
            assert!((high - low) < 1.02 * (most - least), "{d}: {low} to {high}, not {least} to {most}");
        }
        assert_eq!(support.interval(DVec3::ZERO), [0.0, 0.0]);
    }
}
