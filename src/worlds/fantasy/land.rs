//! The land: gentle hills around the one that carries the castle, in square pieces.

use glam::Vec3;

use super::super::shape::mesh;
use super::CASTLE;
use crate::scene::mesh::Mesh;

/// The side of a piece of land, in metres.
const PIECE: f32 = 24.0;
/// Quads along the side of a piece.
const QUADS: usize = 40;
/// Pieces along the side of the land at scale 1.
const PIECES: f64 = 12.0;
/// How high the castle stands above the plain, in metres.
const HILL: f32 = 12.0;

/// As many pieces along z as along x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Land {
    pieces: usize,
}

impl Land {
    pub(super) fn of(scale: f32) -> Self {
        let pieces = libm::round(PIECES * libm::sqrt(f64::from(scale))) as usize;
        Self { pieces: pieces.max(4) }
    }

    /// Its side; the middle is the origin.
    pub(super) fn side(&self) -> f32 {
        self.pieces as f32 * PIECE
    }

    /// How high the ground is. It is flat where the castle stands.
    pub(super) fn height(&self, x: f32, z: f32) -> f32 {
        let from = (x * x + z * z).sqrt() - (CASTLE + 6.0);
        let t = (from * (1.0 / 34.0)).clamp(0.0, 1.0);
        let outside = t * t * (3.0 - 2.0 * t);
        let wave = libm::sinf(x * (1.0 / 17.0)) * libm::cosf(z * (1.0 / 23.0)) * 3.0
            + libm::sinf((x + 2.0 * z) * (1.0 / 41.0)) * 4.0;
        HILL * (1.0 - outside) + wave * outside
    }

    /// Each piece and where its middle is.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (Mesh, Vec3)> {
        let along = move |k: usize| PIECE * (k as f32 - 0.5 * (self.pieces as f32 - 1.0));
        (0..self.pieces * self.pieces).map(move |n| {
            let middle = Vec3::new(along(n % self.pieces), 0.0, along(n / self.pieces));
            (self.piece(middle), middle)
        })
    }

    /// A slab with a rough upper side; neighbours share the points of their common edge.
    fn piece(&self, middle: Vec3) -> Mesh {
        let step = PIECE / QUADS as f32;
        let place = |i: usize, j: usize| (step * i as f32 - 0.5 * PIECE, step * j as f32 - 0.5 * PIECE);
        mesh("land", 1, |s, _| {
            s.slab(
                QUADS,
                QUADS,
                |i, j| {
                    let (x, z) = place(i, j);
                    Vec3::new(x, self.height(middle.x + x, middle.z + z), z)
                },
                |i, j| {
                    let (x, z) = place(i, j);
                    Vec3::new(x, -9.0, z)
                },
            );
        })
    }
}
