//! Random projections of every kind that the engine promises to handle.

use std::ops::Range;

use glam::camera::rh::proj::directx;
use glam::{Mat4, Vec2, Vec3};
use rand::{Rng, RngExt};
use tercet::geom::{DepthDirection, Viewport, projection};

/// What a lens may be like, whatever kind it is.
pub(crate) struct Lens {
    pub(crate) viewport: Viewport,
    /// Across the picture's height, radians.
    pub(crate) fov: f32,
    pub(crate) near: f32,
    pub(crate) far: f32,
    /// How wide the picture of an orthographic one is, metres.
    pub(crate) widths: Range<f32>,
}

impl Lens {
    /// One of the kinds: its matrix, and which way its depth goes.
    pub(crate) fn projection(&self, rng: &mut impl Rng) -> (Mat4, DepthDirection) {
        let &Self { viewport, fov, near, far, ref widths } = self;
        let aspect = viewport.width as f32 / viewport.height as f32;
        let width = |rng: &mut _| log_range(rng, widths.start, widths.end);
        let (reversed, standard) = (DepthDirection::Reversed, DepthDirection::Standard);
        match rng.random_range(0..8) {
            0 | 1 => (projection::perspective(fov, aspect, near), reversed),
            2 => (projection::perspective_finite(fov, aspect, near, far), reversed),
            3 => (projection::perspective_standard(fov, aspect, near, far), standard),
            4 => {
                let width = width(rng);
                (projection::orthographic(width, width / aspect, near, far), reversed)
            }
            5 => {
                let (x, y) = (width(rng), width(rng));
                (directx::orthographic(-x, x, -y, y, near, far), standard)
            }
            6 => {
                let tilt = Vec3::new(rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5), -1.0);
                let plane = tilt.normalize().extend(-near);
                (
                    projection::oblique(projection::perspective(fov.clamp(0.1, 2.0), aspect, near), plane),
                    reversed,
                )
            }
            _ => {
                let pixels = Vec2::new(rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5));
                let still = projection::perspective(fov, aspect, near);
                (projection::jittered(still, pixels, viewport.width, viewport.height), reversed)
            }
        }
    }
}

/// Uniform in the logarithm.
pub(crate) fn log_range(rng: &mut impl Rng, low: f32, high: f32) -> f32 {
    rng.random_range(low.ln()..=high.ln()).exp().clamp(low, high)
}

/// Of length 1.
pub(crate) fn direction(rng: &mut impl Rng) -> Vec3 {
    let v = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..=1.0f32)));
    v.normalize_or(Vec3::X)
}
