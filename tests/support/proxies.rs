//! Questions made by hand and by dice, whatever box they might come from.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tercet::geom::{PixelRect, Proxy};

/// A proxy that fills a rectangle at one nearness.
pub fn flat(rect: PixelRect, nearest: f32) -> Proxy {
    Proxy { rect, edges: [[0.0; 3]; 6], planes: [[0.0, 0.0, f32::MAX]; 3], nearest }
}

/// A random convex outline and tilted planes, in a random rectangle of a screen that is cleared to
/// the nearness `far`.
pub fn random_proxy(dice: &mut ChaCha8Rng, [width, height]: [u32; 2], far: f32) -> Proxy {
    let mut range = |side: u32| {
        let a = dice.random_range(0..side);
        let b = if dice.random_range(0..3) == 0 { a } else { dice.random_range(0..side) };
        (a.min(b), a.max(b) + 1)
    };
    let ((x0, x1), (y0, y1)) = (range(width), range(height));
    let (w, h) = ((x1 - x0) as f32, (y1 - y0) as f32);
    let mut proxy = flat(PixelRect { x0, y0, x1, y1 }, far + dice.random_range(0.1..1.1));
    for edge in proxy.edges.iter_mut().take(dice.random_range(0..=6)) {
        let angle: f32 = dice.random_range(0.0..std::f32::consts::TAU);
        let (a, b) = (angle.cos(), angle.sin());
        *edge = [a, b, -(a * w * 0.5 + b * h * 0.5) + dice.random_range(-0.1..0.6) * w.max(h)];
    }
    for plane in proxy.planes.iter_mut().take(dice.random_range(0..=3)) {
        let slope = [0.0, 1e-4, 0.01][dice.random_range(0..3)];
        *plane = [
            dice.random_range(-1.0..=1.0) * slope,
            dice.random_range(-1.0..=1.0) * slope,
            far + dice.random_range(0.0..1.2),
        ];
    }
    proxy
}
