//! The building's own pieces: slabs, walls, columns, beams, each one cell of the uniform grid.

use glam::Vec3;

use super::super::shape::{Shape, mesh};
use super::{BAY, CLEAR, SLAB};
use crate::scene::mesh::Mesh;

const HALF: f32 = 0.5 * BAY;
const WALL: f32 = 0.125;

/// A floor slab, its upper side centred on the origin.
pub(super) fn slab() -> Mesh {
    boxes("slab", &[[-HALF, -SLAB, -HALF, HALF, 0.0, HALF]])
}

/// A piece of the ground, its upper side centred on the origin.
pub(super) fn ground() -> Mesh {
    boxes("ground", &[[-HALF, -0.5, -HALF, HALF, 0.0, HALF]])
}

/// A wall of one bay along x, floor to ceiling.
pub(super) fn wall() -> Mesh {
    boxes("wall", &[[-HALF, 0.0, -WALL, HALF, CLEAR, WALL]])
}

/// A wall with an open doorway; the camera's route passes through its middle.
pub(super) fn wall_with_door() -> Mesh {
    wall_with_opening("wall with door", 2.4, 3.0)
}

/// A wall that is mostly a gate, wide enough for machines.
pub(super) fn wall_with_gate() -> Mesh {
    wall_with_opening("wall with gate", 5.6, 3.8)
}

/// A wall around a framed opening that reaches down to the floor.
fn wall_with_opening(name: &str, wide: f32, top: f32) -> Mesh {
    let side = 0.5 * wide;
    boxes(
        name,
        &[
            [-HALF, 0.0, -WALL, -side, CLEAR, WALL],
            [side, 0.0, -WALL, HALF, CLEAR, WALL],
            [-side, top, -WALL, side, CLEAR, WALL],
            [-side - 0.1, 0.0, -WALL - 0.04, -side + 0.02, top + 0.1, WALL + 0.04],
            [side - 0.02, 0.0, -WALL - 0.04, side + 0.1, top + 0.1, WALL + 0.04],
            [-side, top - 0.02, -WALL - 0.04, side, top + 0.1, WALL + 0.04],
        ],
    )
}

/// A wall with two windows that have bars but no panes.
pub(super) fn wall_with_windows() -> Mesh {
    let (sill, top) = (1.1, 2.6);
    let mut pieces = vec![
        [-HALF, 0.0, -WALL, HALF, sill, WALL],
        [-HALF, top, -WALL, HALF, CLEAR, WALL],
        [-HALF, sill, -WALL, -2.8, top, WALL],
        [-0.6, sill, -WALL, 0.6, top, WALL],
        [2.8, sill, -WALL, HALF, top, WALL],
    ];
    for x in [-2.25, -1.7, -1.15, 1.15, 1.7, 2.25] {
        pieces.push([x - 0.03, sill, -0.03, x + 0.03, top, 0.03]);
    }
    for x in [-2.8, 0.6] {
        pieces.push([x, 1.82, -0.025, x + 2.2, 1.88, 0.025]);
    }
    boxes("wall with windows", &pieces)
}

/// A column, floor to ceiling.
pub(super) fn column() -> Mesh {
    boxes("column", &[[-0.3, 0.0, -0.3, 0.3, CLEAR, 0.3]])
}

/// An I-beam of one bay along x that hangs from the ceiling at y = 0.
pub(super) fn beam() -> Mesh {
    boxes(
        "beam",
        &[
            [-HALF, -0.06, -0.18, HALF, 0.0, 0.18],
            [-HALF, -0.44, -0.14, HALF, -0.06, 0.14],
            [-HALF, -0.5, -0.18, HALF, -0.44, 0.18],
        ],
    )
}

/// A crane's girder across the hall's bay, with its trolley, along z.
pub(super) fn crane() -> Mesh {
    boxes(
        "crane",
        &[
            [-0.9, 0.0, -HALF, -0.5, 0.9, HALF],
            [0.5, 0.0, -HALF, 0.9, 0.9, HALF],
            [-1.0, 0.9, -0.8, 1.0, 1.4, 0.8],
            [-0.15, -1.2, -0.15, 0.15, 0.9, 0.15],
        ],
    )
}

fn boxes(name: &str, pieces: &[[f32; 6]]) -> Mesh {
    mesh(name, 1, |s: &mut Shape, _| {
        for &[x0, y0, z0, x1, y1, z1] in pieces {
            s.cuboid(Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1));
        }
    })
}
