//! Random numbers that are the same everywhere: a fixed generator and our own mapping to ranges.

use glam::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A seeded stream of numbers.
pub(super) struct Dice(ChaCha8Rng);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴: exact in f32.
    pub(super) fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Uniform in [low, high).
    pub(super) fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..n. The bias is below n / 2³².
    pub(super) fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.0.next_u32()) * n as u64) >> 32) as usize
    }

    /// True with probability p.
    pub(super) fn chance(&mut self, p: f32) -> bool {
        self.unit() < p
    }

    /// Uniform in a box.
    pub(super) fn within(&mut self, min: Vec3, max: Vec3) -> Vec3 {
        let x = self.range(min.x, max.x);
        let y = self.range(min.y, max.y);
        let z = self.range(min.z, max.z);
        Vec3::new(x, y, z)
    }

    /// Uniform on the unit sphere: points of the cube are thrown away until one lies in the ball.
    pub(super) fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.within(Vec3::NEG_ONE, Vec3::ONE);
            let square = p.length_squared();
            if (0.01..=1.0).contains(&square) {
                return p / square.sqrt();
            }
        }
    }

    /// A unit quaternion, x y z w: a direction in four dimensions, found as in three.
    pub(super) fn orientation(&mut self) -> [f32; 4] {
        loop {
            let q = [0; 4].map(|_| self.range(-1.0, 1.0));
            let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            if (0.01..=1.0).contains(&square) {
                return q.map(|c| c / square.sqrt());
            }
        }
    }

    /// Fisher and Yates' shuffle.
    pub(super) fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}
