//! The coefficients of a proxy: the edges of its outline and its entry planes, from the projected corners. The
//! proof is in [`proxy`](super::Proxy)'s module.

use glam::{DVec2, DVec4};

use super::aabb::f32_above;
use super::pixel_rect::PixelRect;
use super::project::{Screen, UNIT, greatest, least};
use super::silhouette::SILHOUETTES;
use super::{Aabb, DepthDirection, View};

/// The faces of a box that are turned to the viewer, an axis each, and the slopes of their planes.
pub(super) struct Faces {
    /// 0: neither of the two faces of this axis; 1: that at the least coordinate; 2: the other.
    turned: [usize; 3],
    /// Nearness a unit of normalised device coordinates, x and y; not finite for a face that is
    /// seen edge on.
    slopes: [[f64; 2]; 3],
}

impl Faces {
    /// Of a face with the inward plane (A, B, C, D) in clip space, A·x + B·y + C·z + D·w ≥ 0 on
    /// the box's side, a line of sight toward the viewer leaves the box through it if z lessens the
    /// form: C < 0 under reversed z, C > 0 under standard z. No eye point is needed, so
    /// orthographic and oblique views are no special cases.
    #[inline]
    pub(super) fn turned_to(view: &View, aabb: &Aabb) -> Self {
        let world = view.world_from_clip();
        let sign = sign(view.depth());
        let mut faces = Self { turned: [0; 3], slopes: [[0.0; 2]; 3] };
        for axis in 0..3 {
            let (low, high) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
            // The inward plane of the lesser face, p − low ≥ 0, is (1, −low) in world space and
            // so `form(column, low)` in clip space; that of the greater one is its negation.
            let form = |column: DVec4, at: f64| column[axis] - at * column.w;
            let at = if sign * form(world.z_axis, low) < 0.0 {
                faces.turned[axis] = 1;
                low
            } else if sign * form(world.z_axis, high) > 0.0 {
                faces.turned[axis] = 2;
                high
            } else {
                continue;
            };
            let per_depth = -sign / form(world.z_axis, at);
            faces.slopes[axis] = [form(world.x_axis, at) * per_depth, form(world.y_axis, at) * per_depth];
        }
        faces
    }

    /// Which entry of [`SILHOUETTES`].
    fn index(&self) -> usize {
        self.turned[0] + 3 * self.turned[1] + 9 * self.turned[2]
    }
}

/// The projected corners relative to the rectangle's, from which the coefficients are made.
pub(super) struct Local<'a> {
    screen: &'a Screen,
    x: [f64; 8],
    y: [f64; 8],
    /// Columns and rows of the rectangle.
    size: DVec2,
}

impl<'a> Local<'a> {
    #[inline]
    pub(super) fn new(screen: &'a Screen, rect: PixelRect) -> Self {
        let origin = DVec2::new(f64::from(rect.x0), f64::from(rect.y0));
        Self {
            screen,
            x: screen.x.map(|x| x - origin.x),
            y: screen.y.map(|y| y - origin.y),
            size: DVec2::new(f64::from(rect.width()), f64::from(rect.height())),
        }
    }

    /// The silhouette has two edges along an axis or none. Walked along the axis, one has the box
    /// on its left and the other on its right; which one is which is decided for both together,
    /// so that a box without width still gets both of its sides.
    #[inline]
    pub(super) fn edges(&self, faces: &Faces) -> [[f32; 3]; 6] {
        let mut edges = [[0.0; 3]; 6];
        let mut used = 0;
        let silhouette = &SILHOUETTES[faces.index()];
        for pair in silhouette.pairs[..silhouette.len].iter() {
            let [first, second] = pair.map(|ends| self.support(ends));
            let lies_low = first.above - first.below >= second.above - second.below;
            for (support, low) in [(first, lies_low), (second, !lies_low)] {
                let edge = self.pushed(if low { support.from_low } else { support.from_high });
                if self.least(edge) < 0.0 {
                    edges[used] = self.rounded_up(edge);
                    used += 1;
                }
            }
        }
        edges
    }

    /// The two half planes that hold all corners and have a border parallel to an edge. For
    /// corners that coincide on the screen they hold every point.
    fn support(&self, [i, j]: [usize; 2]) -> Support {
        let (x, y) = (&self.x, &self.y);
        let (a, b) = (y[i] - y[j], x[j] - x[i]);
        let scale = 1.0 / (a.abs() + b.abs());
        let (a, b) = if scale.is_finite() { (a * scale, b * scale) } else { (0.0, 0.0) };
        let along: [f64; 8] = std::array::from_fn(|k| a * x[k] + b * y[k]);
        let (low, high) = (least(&along), greatest(&along));
        Support {
            from_low: [a, b, -low],
            from_high: [-a, -b, high],
            above: high - along[i],
            below: along[i] - low,
        }
    }

    #[inline]
    pub(super) fn planes(&self, faces: &Faces, view: &View) -> [[f32; 3]; 3] {
        let mut planes = [[0.0, 0.0, f32::MAX]; 3];
        let mut used = 0;
        let (x, y, screen) = (&self.x, &self.y, self.screen);
        let viewport = view.viewport();
        let per_pixel = [2.0 / f64::from(viewport.width), -2.0 / f64::from(viewport.height)];
        let cleared = f64::from(view.depth().cleared());
        let reaches_far = screen.farthest - screen.depth_error <= cleared;
        for axis in (0..3).filter(|&axis| faces.turned[axis] != 0) {
            let [a, b] = [faces.slopes[axis][0] * per_pixel[0], faces.slopes[axis][1] * per_pixel[1]];
            if !(a.abs() < MAX_SLOPE && b.abs() < MAX_SLOPE) {
                continue;
            }
            let rise: [f64; 8] = std::array::from_fn(|k| screen.nearness[k] - (a * x[k] + b * y[k]));
            let [a, b, c] = self.pushed([a, b, greatest(&rise)]);
            let plane = [a, b, c + screen.depth_error];
            let lowest = self.least(plane);
            if lowest < screen.nearest && !(reaches_far && lowest < cleared) {
                planes[used] = self.rounded_up(plane);
                used += 1;
            }
        }
        planes
    }

    /// A form raised by the most that it changes over r.
    fn pushed(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        [a, b, c + a.abs() * self.screen.reach.x + b.abs() * self.screen.reach.y]
    }

    /// The least value of a form at the pixel centres of the rectangle.
    fn least(&self, [a, b, c]: [f64; 3]) -> f64 {
        let least = |k: f64, pixels: f64| (k * 0.5).min(k * (pixels - 0.5));
        c + least(a, self.size.x) + least(b, self.size.y)
    }

    /// In f32, with `c` raised so that evaluation in f32 is an upper bound all over the
    /// rectangle.
    fn rounded_up(&self, [a, b, c]: [f64; 3]) -> [f32; 3] {
        let magnitude = DVec2::new(a.abs(), b.abs()).dot(self.size) + c.abs();
        let error = 6.0 * UNIT * magnitude + 4.0 * f64::from(f32::MIN_POSITIVE);
        [a as f32, b as f32, f32_above(c + error)]
    }
}

/// Steeper planes, in nearness a pixel, are faces seen edge on: not worth the f32 error that
/// they would bring.
const MAX_SLOPE: f64 = 1e6;

fn sign(depth: DepthDirection) -> f64 {
    match depth {
        DepthDirection::Reversed => 1.0,
        DepthDirection::Standard => -1.0,
    }
}

/// Half planes on either side of the box, and how far the box reaches beyond an edge on either
/// side, in pixels.
#[derive(Clone, Copy)]
struct Support {
    from_low: [f64; 3],
    from_high: [f64; 3],
    above: f64,
    below: f64,
}
