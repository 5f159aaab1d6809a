//! The question about a box that stands for others: a node of the tree, and what is below it.
//!
//! # Why nothing below is missed
//!
//! *Claim.* Let box B hold box b. If the proxy of b ([`Question::new`]) covers a pixel's centre with
//! an entry nearness of at least some stored nearness there, so does that of the group B
//! ([`Question::of_group`]). So a walk from groups down to objects finds each object that passes by
//! itself.
//!
//! *Outline.* Let H be the hull of a box's projected corners and R the rectangle ±r. The normals of
//! the six edges of H, and the four of the pixels' rectangle, bound the proxy, each pushed out by the
//! support of R. Since the axes are among them, two neighbouring normals lie in one quadrant, where
//! that support is linear: the proxy is H ⊕ R, without mitres. H of b lies in that of B, and r grows
//! with the size of coordinates and falls with the least w: it is no greater for b. What is left is
//! the rounding of the constants of b, at most 12·2⁻²⁴ of 3·(W + H) pixels, W, H ≤ 16 384: less than
//! 1/8 pixel, by which B's edges are moved out.
//!
//! *Depth.* Nearness is affine in 1/w, so the planes of the facing faces of B and b on one axis meet
//! on their horizon: over β, the nearness there, that of b is k ≤ 1 times that of B, or below it by a
//! constant in a parallel view. Where B's lies below β, b's does, and neither passes, for the cleared
//! nearness is not below β. A facing plane of B faces the viewer in b, too; b leaves it out only if it
//! changes nothing, or if b reaches the far plane: then B does, and is tested without planes. What is
//! left is again rounding, of constants no greater than the plane's rise over b and its nearness:
//! twice what the plane of B rises, and the greatest nearness of B, hold them.
//!
//! *The f64 arithmetic* errs by 2⁻⁵³ of the sums of its terms: B is grown by 2⁻²³ of its largest
//! coordinate.

use super::project::{Screen, UNIT};
use super::{Aabb, Proxy, Question, View};

/// What the edges of a group are moved out by, in pixels.
const EDGE: f32 = 0.125;

impl Question {
    /// What to ask about a box that stands for boxes within it: where the proxy of one of them passes,
    /// the group's does. It is a little larger and nearer than [`Question::new`]'s, which holds the
    /// same geometry, but not every proxy. O(1), no allocation.
    pub fn of_group(bounds: &Aabb, view: &View) -> Self {
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        Self::shaped(&bounds.inflated(largest * f32::EPSILON), view, |proxy, screen| {
            widen(proxy, screen, view);
        })
    }
}

fn widen(proxy: &mut Proxy, screen: &Screen, view: &View) {
    for edge in proxy.edges.iter_mut() {
        edge[2] += EDGE;
    }
    let (width, height) = (proxy.rect.width() as f32, proxy.rect.height() as f32);
    let reaches_far = screen.farthest - screen.depth_error <= f64::from(view.depth().cleared());
    let magnitude = screen.nearest.abs().max(screen.farthest.abs()) as f32;
    for plane in proxy.planes.iter_mut().filter(|plane| plane[2] != f32::MAX) {
        let [a, b, c] = *plane;
        let rise = 2.0 * (a.abs() * width + b.abs() * height) + c.abs() + magnitude;
        *plane = if reaches_far { [0.0, 0.0, f32::MAX] } else { [a, b, c + 16.0 * UNIT as f32 * rise] };
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::geom::{DepthDirection, DepthFormat, Viewport, projection};

    fn view(dice: &mut ChaCha8Rng, kind: u32) -> View {
        let (clip, depth) = match kind % 4 {
            0 => (projection::perspective(1.2, 1.6, 0.1), DepthDirection::Reversed),
            1 => (projection::perspective_standard(0.6, 1.6, 0.5, 40.0), DepthDirection::Standard),
            2 => (projection::perspective_finite(1.9, 1.6, 0.1, 30.0), DepthDirection::Reversed),
            _ => (projection::orthographic(16.0, 10.0, 0.0, 60.0), DepthDirection::Reversed),
        };
        let eye = Vec3::from_array(std::array::from_fn(|_| dice.random_range(-12.0..12.0)));
        let from_world: Mat4 = glam::camera::rh::view::look_at_mat4(eye, Vec3::ONE, Vec3::Y);
        let samples = if kind.is_multiple_of(3) { 4 } else { 1 };
        View::new(from_world, clip, Viewport::new(160, 100)).expect("a view").with_target(
            depth,
            DepthFormat::Depth32Float,
            samples,
        )
    }

    /// A pixel at which the proxy of the part is not within that of the whole.
    fn sticks_out(part: &Proxy, whole: &Proxy) -> Option<(u32, u32)> {
        let rect = part.rect;
        let mut pixels = (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
        pixels.find(|&(x, y)| {
            let held = whole.rect.contains(x, y)
                && whole.covers(x, y)
                && whole.nearness(x, y) >= part.nearness(x, y);
            part.covers(x, y) && !held
        })
    }

    /// Boxes at the faces, edges and corners of the group, flat and long ones, far off and near.
    #[test]
    fn the_proxy_of_a_group_holds_those_of_what_it_holds() {
        let mut dice = ChaCha8Rng::seed_from_u64(5);
        let (mut pairs, mut tight) = (0, 0);
        for round in 0..4000 {
            let view = view(&mut dice, round);
            let mut v = |r: f32| Vec3::from_array(std::array::from_fn(|_| dice.random_range(-r..r)));
            let center = v(8.0);
            let half = v(3.0).abs() * [Vec3::ONE, Vec3::new(1.0, 0.01, 1.0), Vec3::X][round as usize % 3];
            let whole = Aabb::from_center(center, half);
            let (a, b) = (v(1.0), v(1.0));
            // A third of the coordinates are those of the group itself.
            let end = |t: f32| if t.abs() > 0.66 { t.signum() } else { t };
            let (a, b) = (center + half * a.map(end), center + half * b.map(end));
            let part = Aabb::new(a.min(b).max(whole.min), a.max(b).min(whole.max));
            let Question::Ask(part) = Question::new(&part, &view) else { continue };
            match Question::of_group(&whole, &view) {
                Question::Visible => {}
                Question::Outside => panic!("round {round}: the part has a proxy, the whole has none"),
                Question::Ask(group) => {
                    assert_eq!(sticks_out(&part, &group), None, "round {round}");
                    pairs += 1;
                    let Question::Ask(plain) = Question::new(&whole, &view) else { continue };
                    tight += u32::from(sticks_out(&part, &plain).is_some());
                }
            }
        }
        println!("{pairs} pairs, {tight} that the plain proxy does not hold");
        assert!(pairs > 1000, "{pairs} pairs");
        assert!(tight > 0, "the plain proxy would have done");
    }
}
