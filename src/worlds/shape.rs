//! Building blocks of procedural meshes: boxes, turned bodies, bends; each knows its own error.

use glam::Vec3;

use crate::scene::mesh::{Level, Mesh};

/// How coarse the level being built is: 0 is the finest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarseness(u32);

impl Coarseness {
    /// Segments of a round body that has `finest` of them at level 0: halved a level, at least 3.
    pub(super) fn segments(self, finest: usize) -> usize {
        (finest >> self.0).max(3)
    }

    /// Whether this level is finer than `level`.
    pub(super) fn finer_than(self, level: u32) -> bool {
        self.0 < level
    }
}

/// A mesh with `levels` levels of detail, each built by `build`, whose errors come from the
/// sagittas of its round parts and the sizes of what was left out.
pub(super) fn mesh(name: &str, levels: u32, build: impl Fn(&mut Shape, Coarseness)) -> Mesh {
    let level = |i| {
        let mut shape = Shape::default();
        build(&mut shape, Coarseness(i));
        // Level 0 is what the mesh is, not an approximation of anything.
        let error = if i == 0 { 0.0 } else { shape.error };
        Level { positions: shape.positions, indices: shape.indices, error }
    };
    Mesh::with_levels(name, (0..levels).map(level).collect()).expect("a procedural mesh is well formed")
}

/// A mesh in the making. Faces turn outward, counter-clockwise.
#[derive(Default)]
pub(super) struct Shape {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
    error: f32,
}

/// The axis that a turned body stands on, with two perpendicular directions; right-handed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    pub(super) origin: Vec3,
    u: Vec3,
    v: Vec3,
    axis: Vec3,
}

impl Stand {
    pub(super) const fn x(origin: Vec3) -> Self {
        Self { origin, u: Vec3::Y, v: Vec3::Z, axis: Vec3::X }
    }

    pub(super) const fn y(origin: Vec3) -> Self {
        Self { origin, u: Vec3::Z, v: Vec3::X, axis: Vec3::Y }
    }

    pub(super) const fn z(origin: Vec3) -> Self {
        Self { origin, u: Vec3::X, v: Vec3::Y, axis: Vec3::Z }
    }

    fn point(&self, (cos, sin): (f32, f32), [radius, height]: [f32; 2]) -> Vec3 {
        self.origin + self.u * (radius * cos) + self.v * (radius * sin) + self.axis * height
    }
}

/// Cosine and sine of `k / n` of a full turn, the same on every machine.
pub(super) fn turn(k: usize, n: usize) -> (f32, f32) {
    let angle = std::f64::consts::TAU * (k % n) as f64 / n as f64;
    (libm::cos(angle) as f32, libm::sin(angle) as f32)
}

/// How far a chord of `1 / n` of a full turn runs inside its circle.
pub(super) fn sagitta(radius: f32, n: usize) -> f32 {
    radius * (1.0 - libm::cos(std::f64::consts::PI / n as f64) as f32)
}

impl Shape {
    /// Says that this level lies up to `metres` from the finest in some place.
    pub(super) fn off_by(&mut self, metres: f32) {
        self.error = self.error.max(metres);
    }

    /// A box.
    pub(super) fn cuboid(&mut self, min: Vec3, max: Vec3) {
        let first = self.positions.len() as u32;
        self.positions.extend(crate::geom::Aabb::new(min, max).corners());
        const FACES: [[u32; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        for [a, b, c, d] in FACES {
            self.indices.extend([a, b, c, a, c, d].map(|i| first + i));
        }
    }

    /// A body between two triangles, each counter-clockwise as seen from its first end's outside:
    /// from `first`, at the lesser coordinate, straight to `last`.
    pub(super) fn prism(&mut self, first: [Vec3; 3], last: [Vec3; 3]) {
        let at = self.positions.len() as u32;
        self.positions.extend(first.into_iter().chain(last));
        const TRIANGLES: [[u32; 3]; 8] =
            [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
        self.indices.extend(TRIANGLES.iter().flatten().map(|i| at + i));
    }

    /// A body turned on a lathe: `profile` lists `[radius, height]` from the bottom to the top,
    /// or counter-clockwise around a hollow body's section, first point again at the end.
    pub(super) fn lathe(&mut self, stand: Stand, profile: &[[f32; 2]], segments: usize) {
        let widest = profile.iter().fold(0.0f32, |r, p| r.max(p[0]));
        self.off_by(sagitta(widest, segments));
        let mut below: Option<(u32, bool)> = None;
        for &point in profile {
            let (ring, tip) = (self.positions.len() as u32, point[0] == 0.0);
            let corners = if tip { 1 } else { segments };
            self.positions.extend((0..corners).map(|k| stand.point(turn(k, segments), point)));
            if let Some((lower, lower_tip)) = below {
                self.band(lower, lower_tip, ring, tip, segments as u32);
            }
            below = Some((ring, tip));
        }
    }

    /// Joins two rings of a lathe; a tip is a ring of one vertex.
    fn band(&mut self, lower: u32, lower_tip: bool, upper: u32, upper_tip: bool, segments: u32) {
        for k in 0..segments {
            let next = (k + 1) % segments;
            let at = |ring: u32, tip: bool, k: u32| if tip { ring } else { ring + k };
            let (a, b) = (at(lower, lower_tip, k), at(lower, lower_tip, next));
            let (c, d) = (at(upper, upper_tip, k), at(upper, upper_tip, next));
            if !lower_tip {
                self.indices.extend([a, b, d]);
            }
            if !upper_tip {
                self.indices.extend([a, d, c]);
            }
        }
    }

    /// A closed cylinder that stands on `stand`.
    pub(super) fn cylinder(&mut self, stand: Stand, radius: f32, height: f32, segments: usize) {
        self.lathe(stand, &[[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]], segments);
    }

    /// A pipe with a wall, open at both ends.
    pub(super) fn hollow(&mut self, stand: Stand, outer: [f32; 2], wall: f32, height: f32, segments: usize) {
        let [r0, r1] = outer;
        let profile = [[r0, 0.0], [r1, height], [r1 - wall, height], [r0 - wall, 0.0], [r0, 0.0]];
        self.lathe(stand, &profile, segments);
    }

    /// A vessel: a cylinder between two domes, each half as high as wide; `height` from tip to tip.
    pub(super) fn vessel(&mut self, stand: Stand, radius: f32, height: f32, segments: usize) {
        let rings = (segments / 4).max(2);
        // A dome recedes in both directions.
        self.off_by(sagitta(radius, 4 * rings) + sagitta(radius, segments));
        let dome = |k: usize| {
            let (cos, sin) = turn(k, 4 * rings);
            [radius * sin, 0.5 * radius * cos]
        };
        let mut profile = vec![[0.0, 0.0]];
        profile.extend((1..=rings).map(dome).map(|[r, h]| [r, 0.5 * radius - h]));
        profile.extend((1..=rings).rev().map(dome).map(|[r, h]| [r, height - 0.5 * radius + h]));
        profile.push([0.0, height]);
        self.lathe(stand, &profile, segments);
    }

    /// A closed body without symmetry: `radius` says how far from `center` its surface is in a
    /// direction; `segments` around the y axis and half as many from pole to pole.
    pub(super) fn blob(&mut self, center: Vec3, segments: usize, radius: impl Fn(Vec3) -> f32) {
        let rings = (segments / 2).max(2);
        let mut below: Option<(u32, bool)> = None;
        for ring in 0..=rings {
            let (cos, sin) = turn(ring, 2 * rings);
            let (first, tip) = (self.positions.len() as u32, ring == 0 || ring == rings);
            let corners = if tip { 1 } else { segments };
            self.positions.extend((0..corners).map(|k| {
                let (u, v) = turn(k, segments);
                let out = if tip { Vec3::Y * -cos } else { Vec3::new(sin * v, -cos, sin * u) };
                center + out * radius(out)
            }));
            if let Some((lower, lower_tip)) = below {
                self.band(lower, lower_tip, first, tip, segments as u32);
            }
            below = Some((first, tip));
        }
    }

    /// A ring of round section.
    pub(super) fn torus(&mut self, stand: Stand, radius: f32, section: f32, segments: [usize; 2]) {
        self.off_by(sagitta(section, segments[1]) + sagitta(radius + section, segments[0]));
        let profile: Vec<_> = (0..=segments[1])
            .map(|k| {
                let (cos, sin) = turn(k, segments[1]);
                [radius + section * cos, section * sin]
            })
            .collect();
        self.lathe(stand, &profile, segments[0]);
    }

    /// A quarter bend of round section, closed at both ends: it begins at the origin of the
    /// plane's corner, `radius` along −z, running along +x, and ends running along +z.
    pub(super) fn bend(&mut self, center: Vec3, radius: f32, section: f32, segments: [usize; 2]) {
        let [along, around] = segments;
        self.off_by(sagitta(section, around) + sagitta(radius + section, 4 * along));
        let first = self.positions.len() as u32;
        for i in 0..=along {
            let (cos, sin) = turn(i, 4 * along);
            let out = Vec3::new(sin, 0.0, -cos);
            let ring = (0..around).map(|k| {
                let (c, s) = turn(k, around);
                center + out * (radius + section * c) + Vec3::Y * (section * s)
            });
            self.positions.extend(ring);
        }
        let n = around as u32;
        for i in 0..along as u32 {
            for k in 0..n {
                let [a, b] = [k, (k + 1) % n].map(|k| first + i * n + k);
                self.indices.extend([a, b, b + n, a, b + n, a + n]);
            }
        }
        for k in 1..n - 1 {
            let end = first + along as u32 * n;
            self.indices.extend([first, first + k + 1, first + k]);
            self.indices.extend([end, end + k, end + k + 1]);
        }
    }

    /// A curved slab between two sheets of `wide` × `high` cells, closed at its four sides. Seen
    /// from outside the outer sheet, i runs to the left when j runs up.
    pub(super) fn slab(
        &mut self,
        wide: usize,
        high: usize,
        outer: impl Fn(usize, usize) -> Vec3,
        inner: impl Fn(usize, usize) -> Vec3,
    ) {
        let first = self.positions.len() as u32;
        for j in 0..=high {
            self.positions.extend((0..=wide).map(|i| outer(i, j)));
            self.positions.extend((0..=wide).map(|i| inner(i, j)));
        }
        let row = 2 * (wide as u32 + 1);
        let out = |i: usize, j: usize| first + j as u32 * row + i as u32;
        let inn = |i: usize, j: usize| out(i, j) + wide as u32 + 1;
        let mut quad = |a: u32, b: u32, c: u32, d: u32| self.indices.extend([a, b, c, a, c, d]);
        for j in 0..high {
            for i in 0..wide {
                quad(out(i, j), out(i, j + 1), out(i + 1, j + 1), out(i + 1, j));
                quad(inn(i, j), inn(i + 1, j), inn(i + 1, j + 1), inn(i, j + 1));
            }
            quad(out(0, j), inn(0, j), inn(0, j + 1), out(0, j + 1));
            quad(out(wide, j), out(wide, j + 1), inn(wide, j + 1), inn(wide, j));
        }
        for i in 0..wide {
            quad(out(i, 0), out(i + 1, 0), inn(i + 1, 0), inn(i, 0));
            quad(out(i, high), inn(i, high), inn(i + 1, high), out(i + 1, high));
        }
    }
}
