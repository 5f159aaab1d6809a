//! The scenes that the tests read back.

use std::f32::consts::FRAC_1_SQRT_2;

use serde_json::{Value, json};

use crate::writer::{U16, U32, Writer};

/// The corners of a cube from −1 to 1; bit 0 of the number selects x, bit 1 y, bit 2 z.
pub(crate) fn cube_corners() -> [[f32; 3]; 8] {
    std::array::from_fn(|i| [0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 1.0 } else { -1.0 }))
}

pub(crate) const CUBE: [u32; 36] = [
    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7,
    5,
];

/// A triangle without symmetry, so that a wrong transform shows.
pub(crate) const FLAG: [[f32; 3]; 3] = [[0.0, 0.0, 0.25], [1.0, 0.0, 0.5], [0.25, 2.0, 0.75]];

/// A quarter turn about y.
pub(crate) const QUARTER: [f32; 4] = [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];

/// A chain of nodes of every kind of transform, each with the flag; its third link is mirrored,
/// the fourth a shear that no TRS can say, the fifth flat.
pub(crate) fn nested() -> Writer {
    let mut w = Writer::new();
    let flag = w.simple_mesh("Flag", &FLAG, &[0, 1, 2]);
    let links = [
        json!({ "mesh": flag, "translation": [10.0, -4.0, 0.5] }),
        json!({ "mesh": flag, "rotation": QUARTER, "scale": [2.0, 3.0, 0.5] }),
        json!({ "mesh": flag, "scale": [-1.0, 1.0, 1.0], "translation": [0.0, 0.0, 3.0] }),
        json!({ "mesh": flag, "matrix": [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0.25, -2, 0, 5, 6, 7, 1] }),
        json!({ "mesh": flag, "scale": [1.0, 0.0, 1.0], "rotation": [0.6, 0.0, 0.0, 0.8] }),
    ];
    let mut parent = None;
    for link in links {
        parent = Some(match parent {
            None => w.root(link),
            Some(parent) => w.child(parent, link),
        });
    }
    w
}

/// What each link of a chain of the [`grove`] does to those beyond it: mirrored, turned and
/// stretched, mirrored again, sheared as no TRS can say; the last is flat.
pub(crate) const LINKS: [[f32; 16]; 5] = [
    [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.3, 1.5, 0.0, 1.0],
    [0.0, 0.0, -1.5, 0.0, 0.0, 0.8, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0, 0.0, 2.0, 0.5, 1.0],
    [0.8, 0.6, 0.0, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 2.0, 0.0, 1.0],
    [1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.25, 1.2, 0.0, 0.0, 1.8, -0.4, 1.0],
    [1.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.9, 0.0, -0.5, 1.5, 0.0, 1.0],
];

/// Crooked trees in a square: each is a chain of nodes, one below the other, of every kind of
/// transform, with a cube at each. By every third stands a board large enough to hide others.
pub(crate) fn grove(trees: usize) -> Writer {
    let mut w = Writer::new();
    let cube = w.simple_mesh("Cube", &cube_corners(), &CUBE);
    let side = (trees as f32).sqrt().ceil() as usize;
    for tree in 0..trees {
        let at = [3.0 * (tree % side) as f32, 0.0, 3.0 * (tree / side) as f32];
        let (sin, cos) = (0.4 * tree as f32).sin_cos();
        let mut link = w.root(json!({ "translation": at, "rotation": [0.0, sin, 0.0, cos] }));
        if tree % 3 == 0 {
            let board = json!({ "mesh": cube, "translation": [0.0, 4.0, 2.0], "scale": [4.0, 5.0, 0.05] });
            w.child(link, board);
        }
        for matrix in LINKS {
            link = w.child(link, json!({ "mesh": cube, "matrix": matrix }));
        }
    }
    w
}

/// Racks of parts: a few meshes, thousands of nodes, three levels deep.
pub(crate) fn parts(racks: usize, shelves: usize, parts: usize) -> Writer {
    let mut w = Writer::new();
    let (cube, indices) = (w.positions(&cube_corners()), w.indices(U16, &CUBE));
    let colors: Vec<usize> = (0..6).map(|i| w.material([0.1 * i as f32, 0.5, 0.2, 1.0], "OPAQUE")).collect();
    let box_of = |material: usize| json!([{ "attributes": { "POSITION": cube }, "indices": indices, "material": material }]);
    let meshes: Vec<usize> = colors.iter().map(|&c| w.mesh("Box", box_of(c))).collect();
    for rack in 0..racks {
        let at =
            w.root(json!({ "name": format!("rack {rack}"), "translation": [4.0 * rack as f32, 0.0, 0.0] }));
        for shelf in 0..shelves {
            let shelf = w.child(at, json!({ "translation": [0.0, 2.5 * shelf as f32, 0.0] }));
            for part in 0..parts {
                let z = 2.5 * part as f32;
                let mesh = meshes[(rack + part) % meshes.len()];
                w.child(
                    shelf,
                    json!({ "mesh": mesh, "translation": [0.0, 0.0, z], "scale": [1.0, 0.5, 1.0] }),
                );
            }
        }
    }
    w
}

/// Rooms in a square, 5 m a side and 3 m high, walled in; each inner wall has a doorway. In each
/// room a table, four chairs of two primitives each, and a pane of glass in one doorway.
pub(crate) struct Interior {
    pub(crate) file: Writer,
    /// Rooms along a side of the building.
    pub(crate) side: usize,
}

impl Interior {
    pub(crate) const ROOM: f32 = 5.0;
    pub(crate) const HEIGHT: f32 = 3.0;

    pub(crate) fn new(side: usize) -> Self {
        let mut w = Writer::new();
        let brick = w.material([0.5, 0.2, 0.1, 1.0], "OPAQUE");
        let wood = w.material([0.4, 0.25, 0.1, 1.0], "OPAQUE");
        let cloth = w.material([0.1, 0.1, 0.6, 1.0], "OPAQUE");
        let glass = w.material([0.9, 0.9, 1.0, 0.2], "BLEND");
        let (positions, indices) = (w.positions(&cube_corners()), w.indices(U32, &CUBE));
        let solid = |material: usize| json!([{ "attributes": { "POSITION": positions }, "indices": indices, "material": material }]);
        let wall = w.mesh("Wall", solid(brick));
        let board = w.mesh("Board", solid(wood));
        let pane = w.mesh("Pane", solid(glass));
        let back = [[-0.2, 0.4, -0.2], [0.2, 0.4, -0.2], [-0.2, 1.0, -0.2], [0.2, 1.0, -0.2]];
        let seat = [[-0.2, 0.4, -0.2], [0.2, 0.4, -0.2], [-0.2, 0.4, 0.2], [0.2, 0.4, 0.2]];
        let (back, seat) = (w.positions(&back), w.positions(&seat));
        let strip = |positions: usize, material: usize| json!({ "attributes": { "POSITION": positions }, "mode": 5, "material": material });
        let chair = w.mesh("Chair", json!([strip(back, wood), strip(seat, cloth)]));
        let house = w.root(json!({ "name": "House" }));
        let across = Self::ROOM * side as f32;
        let slab = |y: f32| boxed([0.0, y, 0.0], [across, y + 0.1, across], wall);
        w.child(house, slab(-0.1));
        w.child(house, slab(Self::HEIGHT));
        for line in 0..=side {
            for room in 0..side {
                let inner = line > 0 && line < side;
                // Walls across x, and the same across z.
                for turned in [false, true] {
                    for (from, to) in wall_pieces(line, room, inner) {
                        let [from, to] =
                            [from, to].map(|[x, y, z]| if turned { [z, y, x] } else { [x, y, z] });
                        w.child(house, boxed(from, to, wall));
                    }
                }
            }
        }
        for room in 0..side * side {
            let corner = [(room % side) as f32 * Self::ROOM, 0.0, (room / side) as f32 * Self::ROOM];
            let at = w.child(house, json!({ "name": format!("Room {room}"), "translation": corner }));
            w.child(at, boxed([2.0, 0.7, 2.0], [3.2, 0.75, 3.2], board));
            for (x, z, turn) in [(2.6, 1.7, 0.0), (2.6, 3.5, 1.0), (1.7, 2.6, 0.5), (3.5, 2.6, -0.5)] {
                let half = std::f32::consts::FRAC_PI_2 * turn;
                let rotation = [0.0, half.sin(), 0.0, half.cos()];
                w.child(at, json!({ "mesh": chair, "translation": [x, 0.0, z], "rotation": rotation }));
            }
            w.child(at, boxed([0.99, 0.0, -0.02], [2.01, 2.1, 0.02], pane));
        }
        Self { file: w, side }
    }

    pub(crate) fn rooms(&self) -> usize {
        self.side * self.side
    }

    /// Table, four chairs of two parts, and a pane.
    pub(crate) const FURNITURE: usize = 1 + 4 * 2 + 1;
}

/// A wall across x at a line between rooms, in pieces around its doorway.
fn wall_pieces(line: usize, room: usize, inner: bool) -> Vec<([f32; 3], [f32; 3])> {
    const THICK: f32 = 0.1;
    let (x, z) = (line as f32 * Interior::ROOM, room as f32 * Interior::ROOM);
    let piece = |from_z: f32, to_z: f32, from_y: f32| {
        ([x - THICK, from_y, z + from_z], [x + THICK, Interior::HEIGHT, z + to_z])
    };
    if inner {
        vec![piece(0.0, 1.0, 0.0), piece(2.0, Interior::ROOM, 0.0), piece(1.0, 2.0, 2.1)]
    } else {
        vec![piece(0.0, Interior::ROOM, 0.0)]
    }
}

/// A node that stretches the cube from −1 to 1 to a given box.
fn boxed(from: [f32; 3], to: [f32; 3], mesh: usize) -> Value {
    let center: Vec<f32> = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect();
    let half: Vec<f32> = from.iter().zip(to).map(|(a, b)| 0.5 * (b - a)).collect();
    json!({ "mesh": mesh, "translation": center, "scale": half })
}
