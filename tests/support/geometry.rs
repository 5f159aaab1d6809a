//! Random and adversarial views and boxes, and a reference rasteriser that shares no code with
//! the library: it transforms as an app's vertex shader does, in f32, snaps as a rasteriser does,
//! and decides coverage in exact integers.

#[path = "lens.rs"]
pub(crate) mod lens;

use glam::{Affine3A, DVec3, DVec4, Mat4, Quat, Vec2, Vec3, Vec4};
use rand::{Rng, RngExt};
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};

use lens::{Lens, direction, log_range};

/// A box in a view, with an object in it to draw triangles of.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) view: View,
    /// Where the triangles are taken from, in object space.
    pub(crate) object: Aabb,
    pub(crate) world_from_object: Affine3A,
    /// What the library is asked about.
    pub(crate) world: Aabb,
    /// How the app associates its product; see [`Case::clip`].
    transform: u32,
}

/// A sample that a triangle owns: its pixel in the viewport, and its nearness interpolated in
/// two ways.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) nearness: [f64; 2],
}

fn rotation(rng: &mut impl Rng) -> Quat {
    if rng.random_bool(0.3) {
        let quarter = std::f32::consts::FRAC_PI_2;
        return Quat::from_rotation_y(quarter * rng.random_range(0..4) as f32);
    }
    Quat::from_axis_angle(direction(rng), rng.random_range(0.0..std::f32::consts::TAU))
}

/// A view of any kind that the library promises to handle.
pub(crate) fn random_view(rng: &mut impl Rng) -> View {
    let side = |rng: &mut _| log_range(rng, 1.0, 4096.0).round() as u32;
    let mut viewport = Viewport::new(side(rng), side(rng));
    if rng.random_bool(0.2) {
        (viewport.x, viewport.y) = (side(rng), side(rng));
    }
    let fov = match rng.random_range(0..4) {
        0 => log_range(rng, 0.1, 10.0),
        1 => rng.random_range(120.0..179.0f32),
        _ => rng.random_range(30.0..90.0f32),
    };
    let (fov, near) = (fov.to_radians(), log_range(rng, 1e-3, 10.0));
    let far = near * log_range(rng, 10.0, 1e9);
    let lens = Lens { viewport, fov, near, far, widths: 1e-2..1e4 };
    let (clip_from_view, depth) = lens.projection(rng);
    let scale = [0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 1e7][rng.random_range(0..7)];
    let (turn, eye) = (rotation(rng), direction(rng) * scale);
    let view_from_world = Mat4::from_rotation_translation(turn, -(turn * eye));
    let format = if rng.random_bool(0.3) { DepthFormat::Depth24Plus } else { DepthFormat::Depth32Float };
    let samples = if rng.random_bool(0.25) { 4 } else { 1 };
    View::new(view_from_world, clip_from_view, viewport)
        .expect("every one of these is a usable view")
        .with_target(depth, format, samples)
}

/// A view such as a game has: 60 degrees, 0.1 m, 1280 × 720, near the origin.
pub(crate) fn ordinary_view(rng: &mut impl Rng) -> View {
    let turn = Quat::from_axis_angle(direction(rng), rng.random_range(0.0..6.0));
    let eye = direction(rng) * 50.0;
    let viewport = Viewport::new(1280, 720);
    let clip_from_view = projection::perspective(60f32.to_radians(), 16.0 / 9.0, 0.1);
    View::new(Mat4::from_rotation_translation(turn, -(turn * eye)), clip_from_view, viewport).unwrap()
}

/// A point of the view and the length that a pixel spans there, in metres.
fn place(rng: &mut impl Rng, view: &View) -> (DVec3, f64) {
    let away = 10f64.powf(-rng.random_range(0.0..6.0));
    let depth = match view.depth() {
        _ if rng.random_bool(0.2) => rng.random_range(0.0..1.0),
        DepthDirection::Reversed => away,
        DepthDirection::Standard => 1.0 - away,
    };
    let (x, y) = (rng.random_range(-1.05..1.05), rng.random_range(-1.05..1.05));
    let at = |x: f64| {
        let p = view.world_from_clip() * DVec4::new(x, y, depth, 1.0);
        p.truncate() / p.w
    };
    (at(x), at(x).distance(at(x + 2.0 / f64::from(view.viewport().width))))
}

/// A box somewhere in the view: flat, linear, point-like, tiny, huge, or with a face that the
/// view grazes.
pub(crate) fn random_case<R: Rng>(rng: &mut R, view: impl Fn(&mut R) -> View) -> Case {
    let view = view(rng);
    let (center, pixel) = place(rng, &view);
    let largest = if rng.random_bool(0.1) { 1e5 } else { 100.0 };
    let pixels = log_range(rng, 0.05, largest);
    let half = Vec3::from_array(std::array::from_fn(|_| match rng.random_range(0..8) {
        0 => 0.0,
        1 => log_range(rng, 1e-3, 1.0),
        2 => log_range(rng, 1.0, 30.0),
        _ => rng.random_range(0.1..1.0),
    }));
    let half = half * (f64::from(pixels) * pixel) as f32;
    let mut world = Aabb::from_center(center.as_vec3(), half);
    let eye = view.eye();
    if eye.w != 0.0 && rng.random_bool(0.3) {
        let axis = rng.random_range(0..3);
        let offset = [0.0, 1e-6, 1e-3][rng.random_range(0..3)] * center.as_vec3()[axis].abs();
        if rng.random() {
            world.min[axis] = eye[axis] + offset;
            world.max[axis] = world.min[axis] + 2.0 * half[axis];
        } else {
            world.max[axis] = eye[axis] - offset;
            world.min[axis] = world.max[axis] - 2.0 * half[axis];
        }
    }
    let transform = rng.random_range(0..4);
    if rng.random_bool(0.7) {
        return Case { view, object: world, world_from_object: Affine3A::IDENTITY, world, transform };
    }
    let object = Aabb::from_center(direction(rng) * half.max_element(), half);
    let world_from_object = Affine3A::from_rotation_translation(rotation(rng), center.as_vec3());
    Case { view, object, world_from_object, world: object.transformed(&world_from_object), transform }
}

impl Case {
    /// Three points of the object's box: corners, points of edges and faces, inner points.
    pub(crate) fn triangle(&self, rng: &mut impl Rng) -> [Vec3; 3] {
        std::array::from_fn(|_| {
            Vec3::from_array(std::array::from_fn(|axis| {
                let (low, high) = (self.object.min[axis], self.object.max[axis]);
                match rng.random_range(0..5) {
                    0 | 1 => low,
                    2 | 3 => high,
                    _ => (low + (high - low) * rng.random::<f32>()).clamp(low, high),
                }
            }))
        })
    }

    /// A vertex in clip space, in f32, in one of the ways that apps do it.
    pub(crate) fn clip(&self, p: Vec3) -> Vec4 {
        let (view, projection) = (self.view.view_from_world(), self.view.clip_from_view());
        let model = Mat4::from(self.world_from_object);
        match self.transform {
            0 => (projection * view) * (model * p.extend(1.0)),
            1 => projection * (view * (model * p.extend(1.0))),
            2 => ((projection * view) * model) * p.extend(1.0),
            // A compiler that fuses.
            _ => {
                let (m, q) = (projection * view, model * p.extend(1.0));
                Vec4::from_array(std::array::from_fn(|i| {
                    let r = m.row(i);
                    r.x.mul_add(q.x, r.y.mul_add(q.y, r.z.mul_add(q.z, r.w * q.w)))
                }))
            }
        }
    }

    /// The samples that a triangle of the object owns: all of them, or some at random and at its
    /// edges if it is large. `grid` is 16 or 256 subpixel steps a pixel.
    pub(crate) fn samples(
        &self,
        triangle: [Vec3; 3],
        grid: i64,
        rng: &mut impl Rng,
        found: &mut Vec<Sample>,
    ) {
        let polygon = self.clipped(triangle.map(|p| self.clip(p)));
        for i in 2..polygon.len() {
            self.fill([polygon[0], polygon[i - 1], polygon[i]], grid, rng, found);
        }
    }

    /// Clipped by the near plane.
    fn clipped(&self, triangle: [Vec4; 3]) -> Vec<Vec4> {
        let inside = |p: DVec4| match self.view.depth() {
            DepthDirection::Reversed => p.w - p.z,
            DepthDirection::Standard => p.z,
        };
        let mut polygon = Vec::with_capacity(4);
        for i in 0..3 {
            let (a, b) = (triangle[i].as_dvec4(), triangle[(i + 1) % 3].as_dvec4());
            let (at_a, at_b) = (inside(a), inside(b));
            if at_a >= 0.0 {
                polygon.push(triangle[i]);
            }
            if (at_a >= 0.0) != (at_b >= 0.0) {
                polygon.push(a.lerp(b, at_a / (at_a - at_b)).as_vec4());
            }
        }
        polygon
    }

    fn fill(&self, clip: [Vec4; 3], grid: i64, rng: &mut impl Rng, found: &mut Vec<Sample>) {
        /// Units of fixed point a pixel.
        const ONE: i64 = 256;
        let viewport = self.view.viewport();
        let half = Vec2::new(viewport.width as f32, viewport.height as f32) * 0.5;
        let center = Vec2::new(viewport.x as f32, viewport.y as f32) + half;
        let on_screen = clip.map(|p| Vec2::new(p.x / p.w, -(p.y / p.w)) * half + center);
        if clip.iter().any(|p| p.w <= 0.0) || on_screen.iter().any(|p| p.abs().max_element() > 1e9) {
            return;
        }
        // The grid may be rounded to in any direction.
        let toward = [f64::floor, f64::round, f64::ceil][rng.random_range(0..3)];
        let snap = |v: f32| toward(f64::from(v) * grid as f64) as i64 * (ONE / grid);
        let v = on_screen.map(|p| [snap(p.x), snap(p.y)]);
        let depth = clip.map(|p| p.z / p.w);
        // The sample's place in its pixel.
        let (sx, sy) = if self.view.samples() > 1 {
            (rng.random_range(0..=16) * 16, rng.random_range(0..=16) * 16)
        } else {
            (ONE / 2, ONE / 2)
        };
        let edge = |a: [i64; 2], b: [i64; 2], p: [i64; 2]| {
            i128::from(b[0] - a[0]) * i128::from(p[1] - a[1])
                - i128::from(b[1] - a[1]) * i128::from(p[0] - a[0])
        };
        let area = edge(v[0], v[1], v[2]);
        if area == 0 {
            return;
        }
        let mut test = |x: i64, y: i64| {
            let p = [(x + i64::from(viewport.x)) * ONE + sx, (y + i64::from(viewport.y)) * ONE + sy];
            let e = [edge(v[1], v[2], p), edge(v[2], v[0], p), edge(v[0], v[1], p)];
            // Closed: the triangle owns all of its border, more than any fill rule gives it.
            if e.iter().any(|&e| e * area.signum() < 0) {
                return;
            }
            let weight = e.map(|e| e as f64 / area as f64);
            let exact: f64 = (0..3).map(|i| weight[i] * f64::from(depth[i])).sum();
            if !(0.0..=1.0).contains(&exact) {
                return; // clipped by the far plane
            }
            let weight = e.map(|e| e as f32 / area as f32);
            let single = weight[0] * depth[0] + weight[1] * depth[1] + weight[2] * depth[2];
            let nearness = [exact, f64::from(single.clamp(0.0, 1.0))].map(|d| self.stored(d));
            found.push(Sample { x: x as u32, y: y as u32, nearness });
        };

        let range = |axis: usize, origin: u32, size: u32| {
            let (low, high) =
                (v.iter().map(|p| p[axis]).min().unwrap(), v.iter().map(|p| p[axis]).max().unwrap());
            let first = (low.div_euclid(ONE) - i64::from(origin) - 1).max(0);
            let last = (high.div_euclid(ONE) - i64::from(origin) + 1).min(i64::from(size) - 1);
            (first, last)
        };
        let (x0, x1) = range(0, viewport.x, viewport.width);
        let (y0, y1) = range(1, viewport.y, viewport.height);
        if x0 > x1 || y0 > y1 {
            return;
        }
        if (x1 - x0 + 1) * (y1 - y0 + 1) <= 100 {
            for y in y0..=y1 {
                (x0..=x1).for_each(|x| test(x, y));
            }
            return;
        }
        for _ in 0..12 {
            let y = rng.random_range(y0..=y1);
            test(rng.random_range(x0..=x1), y);
            let row = (y + i64::from(viewport.y)) * ONE + sy;
            for i in 0..3 {
                let (a, b) = (v[i], v[(i + 1) % 3]);
                if (a[1] <= row) == (b[1] <= row) {
                    continue;
                }
                let along = (row - a[1]) as f64 / (b[1] - a[1]) as f64;
                let x = a[0] as f64 + along * (b[0] - a[0]) as f64;
                let x = (x / ONE as f64).floor() as i64 - i64::from(viewport.x);
                (x - 1..=x + 1).filter(|x| (x0..=x1).contains(x)).for_each(|x| test(x, y));
            }
        }
    }

    /// What the depth buffer holds, as nearness.
    fn stored(&self, depth: f64) -> f64 {
        const STEPS: f64 = 16_777_215.0;
        let depth = match self.view.format() {
            DepthFormat::Depth32Float => depth,
            DepthFormat::Depth24Plus => f64::from(((depth * STEPS).round() / STEPS) as f32),
        };
        match self.view.depth() {
            DepthDirection::Reversed => depth,
            DepthDirection::Standard => -depth,
        }
    }
}
