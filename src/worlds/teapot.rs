//! The Utah teapot, from its Bézier patches (Martin Newell, 1975).
//!
//! Each of the 32 bicubic patches is cut into n × n quads of two triangles. The finest level has
//! n = 10, which makes the 6 400 triangles of Kovalčík and Tobola (2005). 80 of them have no area:
//! at the tip of the lid and in the middle of the bottom, a side of each patch is a single point.
//! As Newell made it, the pot is not watertight: rim, lid, handle and spout have open ends.

use glam::{DVec3, Vec3};

use crate::scene::mesh::{Level, Mesh};

/// The number of patches, then for each its degrees and its 16 control points, z up.
const DATA: &str = include_str!("../../assets/teapot.bpt");

/// Quads along a side of a patch, finest first: about half the triangles from level to level.
const SIDES: [usize; 6] = [10, 7, 5, 3, 2, 1];

/// The teapot with its levels of detail: y up, spout toward +x, 3.15 m tall, 6.4 m long and 4 m
/// wide, the middle of its bottom at the origin. Triangles are counter-clockwise from outside.
///
/// It is cut anew at each call, in some milliseconds: clone the mesh instead.
pub fn teapot_mesh() -> Mesh {
    let patches = parse(DATA);
    let nets = SIDES.map(|n| patches.iter().map(|patch| Net::new(patch, n)).collect::<Vec<_>>());
    let levels = nets.iter().map(|level| Level {
        positions: level.iter().flat_map(|net| &net.points).copied().collect(),
        indices: level.iter().enumerate().flat_map(|(patch, net)| net.triangles(patch)).collect(),
        error: error(&nets[0], level),
    });
    Mesh::with_levels("teapot", levels.collect()).expect("the teapot is well formed")
}

/// Four rows of four control points, y up.
type Patch = [[DVec3; 4]; 4];

fn parse(data: &str) -> Vec<Patch> {
    let mut words = data.split_whitespace();
    let mut number = || -> f64 { words.next().and_then(|w| w.parse().ok()).expect("the asset is whole") };
    let patches = number() as usize;
    let mut patch = || {
        assert_eq!([number(), number()], [3.0, 3.0], "the patches are bicubic");
        [[(); 4]; 4].map(|row| {
            row.map(|()| {
                let [x, y, z] = [(); 3].map(|()| number());
                DVec3::new(x, z, -y)
            })
        })
    };
    (0..patches).map(|_| patch()).collect()
}

/// A patch, cut into `side` × `side` quads.
struct Net {
    side: usize,
    /// `side + 1` rows of as many points.
    points: Vec<Vec3>,
}

impl Net {
    fn new(patch: &Patch, side: usize) -> Self {
        let point = |row: usize, column: usize| {
            let curves = patch.map(|points| curve(points, column, side));
            // Zero has one sign, or neighbours would differ in it.
            (curve(curves, row, side) + 0.0).as_vec3()
        };
        let rows = 0..=side;
        Self { side, points: rows.flat_map(|row| (0..=side).map(move |column| point(row, column))).collect() }
    }

    /// The triangles as indices, where `patch` nets of the same side come before this one.
    fn triangles(&self, patch: usize) -> impl Iterator<Item = u32> {
        let (side, stride) = (self.side, self.side + 1);
        let first = patch * self.points.len();
        (0..side * side).flat_map(move |quad| {
            let a = first + quad / side * stride + quad % side;
            let [b, c, d] = [a + stride, a + stride + 1, a + 1];
            [a, c, b, a, d, c].map(|index| index as u32)
        })
    }

    /// The point of the triangles at row `i / parts` and column `j / parts` of the whole patch.
    fn at(&self, i: usize, j: usize, parts: usize) -> DVec3 {
        let split = |k: usize| {
            let quad = (k * self.side / parts).min(self.side - 1);
            (quad, (k * self.side - quad * parts) as f64 / parts as f64)
        };
        let ((row, u), (column, v)) = (split(i), split(j));
        let corner = |i: usize, j: usize| self.points[(row + i) * (self.side + 1) + column + j].as_dvec3();
        let (a, c) = (corner(0, 0), corner(1, 1));
        if u >= v {
            let b = corner(1, 0);
            a + (b - a) * u + (c - b) * v
        } else {
            let d = corner(0, 1);
            a + (d - a) * v + (c - d) * u
        }
    }
}

/// The point at `k / n` of a cubic Bézier curve.
///
/// Patches that share an edge compute it bit for bit alike, whichever way each of them runs along
/// it: at an end of a patch the weights across are exactly one and zero, and from the other end of
/// the curve the same four products are summed in the same pairs.
fn curve(p: [DVec3; 4], k: usize, n: usize) -> DVec3 {
    let (a, b, all) = ((n - k) as f64, k as f64, (n * n * n) as f64);
    let w = [a * a * a / all, 3.0 * (a * a * b) / all, 3.0 * (b * b * a) / all, b * b * b / all];
    (p[0] * w[0] + p[3] * w[3]) + (p[1] * w[1] + p[2] * w[2])
}

/// How far the surfaces of two levels lie apart, rounded up.
///
/// Both are piecewise linear over the same patch. Where a patch is cut into the least common
/// multiple of their numbers of parts, with diagonals the same way, no edge of either crosses a
/// triangle, so that their difference is linear on each and its length is greatest at a corner.
/// The greatest length over all corners is therefore the greatest distance between points of the
/// same parameters, which the distance between the surfaces cannot exceed.
fn error(finest: &[Net], level: &[Net]) -> f32 {
    let mut most: f64 = 0.0;
    for (fine, coarse) in finest.iter().zip(level) {
        let parts = least_common_multiple(fine.side, coarse.side);
        for (i, j) in (0..=parts).flat_map(|i| (0..=parts).map(move |j| (i, j))) {
            most = most.max((fine.at(i, j, parts) - coarse.at(i, j, parts)).length());
        }
    }
    // Points of a few metres in f64: the sums above are off by less than 1e-14 m. The next f32
    // is further than that and than the rounding to f32.
    if most > 0.0 { (most as f32).next_up() } else { 0.0 }
}

fn least_common_multiple(a: usize, b: usize) -> usize {
    (a..).step_by(a).find(|multiple| multiple.is_multiple_of(b)).expect("a × b is one")
}
