//! The machines and furniture of the plant: shared meshes with levels of detail.
//!
//! Each mesh stands on the floor of its own space (y from 0 up) or, if it is long, runs along x
//! about the origin. Metres.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh, sagitta, turn};
use super::BAY;
use crate::scene::mesh::Mesh;

/// Short for [`Vec3::new`], as there are hundreds.
pub(super) const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A heat exchanger's bundle: a grid of bare tubes along x between tube sheets, on saddles.
pub(super) fn bundle(name: &str, [rows, columns]: [usize; 2], long: f32, pitch: f32) -> Mesh {
    mesh(name, 5, |s, c| {
        let (wide, high) = (columns as f32 * pitch, rows as f32 * pitch);
        let (foot, half) = (0.45, 0.5 * long);
        for x in [-half, -0.06, half - 0.12] {
            s.cuboid(
                v(x, foot - 0.06, -0.5 * wide - 0.06),
                v(x + 0.12, foot + high + 0.06, 0.5 * wide + 0.06),
            );
        }
        for x in [-0.35 * long, 0.35 * long] {
            s.cuboid(v(x - 0.15, 0.0, -0.45 * wide), v(x + 0.15, foot + 0.01, 0.45 * wide));
        }
        let start = v(-half, foot + 0.5 * pitch, -0.5 * wide + 0.5 * pitch);
        if c.finer_than(4) {
            for tube in 0..rows * columns {
                let (row, column) = ((tube / columns) as f32, (tube % columns) as f32);
                let at = start + v(0.0, row * pitch, column * pitch);
                s.cylinder(Stand::x(at), 0.4 * pitch, long, c.segments(16));
            }
        } else {
            // From afar a grid of tubes is a block: no point of it is farther than a pitch from one.
            s.cuboid(v(-half, foot, -0.5 * wide), v(half, foot + high, 0.5 * wide));
            s.off_by(pitch);
        }
    })
}

/// A boiler's water wall: upright tubes side by side with a thin sheet between them.
pub(super) fn water_wall(high: f32) -> Mesh {
    const TUBES: usize = 56;
    mesh("water wall", 4, |s, c| {
        let pitch = 7.0 / TUBES as f32;
        s.cuboid(v(-3.5, 0.0, -0.02), v(3.5, high, 0.02));
        for k in 0..TUBES {
            let at = v(-3.5 + (k as f32 + 0.5) * pitch, 0.0, 0.0);
            s.cylinder(Stand::y(at), 0.45 * pitch, high, c.segments(24));
        }
        for y in [0.2, 0.5 * high, high - 0.4] {
            s.cuboid(v(-3.5, y, -0.12), v(3.5, y + 0.2, 0.12));
        }
    })
}

/// An upright tank with domes on three legs, a manhole and a ladder's two rails.
pub(super) fn tank(name: &str, radius: f32, high: f32) -> Mesh {
    mesh(name, 4, |s, c| {
        let foot = 0.5;
        s.vessel(
            Stand::y(v(0.0, foot - 0.25 * radius, 0.0)),
            radius,
            high - foot + 0.25 * radius,
            c.segments(64),
        );
        for k in 0..3 {
            let (cos, sin) = turn(k, 3);
            s.cylinder(
                Stand::y(v(0.8 * radius * cos, 0.0, 0.8 * radius * sin)),
                0.08,
                foot + 0.4,
                c.segments(16),
            );
        }
        for y in [0.35, 0.65] {
            s.torus(Stand::y(v(0.0, y * high, 0.0)), radius, 0.05, [c.segments(64), c.segments(8)]);
        }
        s.cylinder(Stand::x(v(0.9 * radius, 0.5 * high, 0.0)), 0.35, 0.1 * radius + 0.15, c.segments(32));
        s.cylinder(Stand::y(v(0.0, high - 0.1, 0.0)), 0.12, 0.3, c.segments(16));
    })
}

/// A drum lying along x on two saddles.
pub(super) fn drum(radius: f32, long: f32) -> Mesh {
    mesh("drum", 4, |s, c| {
        let center = radius + 0.4;
        s.vessel(Stand::x(v(-0.5 * long, center, 0.0)), radius, long, c.segments(64));
        for x in [-0.3 * long, 0.3 * long] {
            s.cuboid(v(x - 0.15, 0.0, -0.8 * radius), v(x + 0.15, center - 0.5 * radius, 0.8 * radius));
            s.torus(Stand::x(v(x, center, 0.0)), radius, 0.04, [c.segments(64), c.segments(8)]);
        }
        s.cylinder(Stand::y(v(0.0, center + 0.9 * radius, 0.0)), 0.2, 0.1 * radius + 0.3, c.segments(24));
    })
}

/// A centrifugal pump: volute, suction and pressure nozzle, shaft, finned motor, base plate.
pub(super) fn pump() -> Mesh {
    mesh("pump", 4, |s, c| {
        s.cuboid(v(-1.2, 0.0, -0.45), v(1.2, 0.2, 0.45));
        let axis = 0.75;
        s.torus(Stand::x(v(-0.75, axis, 0.0)), 0.32, 0.17, [c.segments(32), c.segments(16)]);
        s.cylinder(Stand::x(v(-0.88, axis, 0.0)), 0.34, 0.26, c.segments(48));
        s.cylinder(Stand::x(v(-1.2, axis, 0.0)), 0.18, 0.4, c.segments(32));
        s.cylinder(Stand::y(v(-0.75, axis, 0.33)), 0.14, 0.7, c.segments(32));
        s.cylinder(Stand::x(v(-0.65, axis, 0.0)), 0.06, 0.9, c.segments(16));
        motor(s, c, v(0.15, axis, 0.0), 0.38, 0.95);
        s.cuboid(v(-0.9, 0.19, -0.25), v(-0.6, 0.5, 0.25));
        s.cuboid(v(0.3, 0.19, -0.3), v(0.95, 0.5, 0.3));
    })
}

/// An electric motor along x, with cooling fins around it.
fn motor(s: &mut Shape, c: Coarseness, at: Vec3, radius: f32, long: f32) {
    s.cylinder(Stand::x(at), radius, long, c.segments(32));
    let fins = 12;
    for k in 0..fins {
        let x = (k as f32 + 0.5) / fins as f32 * long - 0.01;
        s.cylinder(Stand::x(at + Vec3::X * x), 1.12 * radius, 0.02, c.segments(32));
    }
}

/// A steam turbine along x: stepped casing with ribs, bearing pedestals, steam chest.
pub(super) fn turbine() -> Mesh {
    mesh("turbine", 5, |s, c| {
        let axis = 1.9;
        let casing = [[0.0, 0.0], [0.5, 0.0], [0.6, 0.5], [1.0, 0.7], [1.2, 1.8], [1.5, 2.4], [1.6, 4.4]];
        let tail = [[1.3, 4.8], [0.7, 5.2], [0.6, 6.0], [0.0, 6.0]];
        let profile: Vec<[f32; 2]> = casing.into_iter().chain(tail).collect();
        s.lathe(Stand::x(v(-3.0, axis, 0.0)), &profile, c.segments(96));
        for k in 0..9 {
            let x = -2.2 + 0.45 * k as f32;
            let radius = 1.15 + 0.06 * k as f32;
            s.torus(Stand::x(v(x, axis, 0.0)), radius, 0.06, [c.segments(96), c.segments(12)]);
        }
        s.cuboid(v(-3.0, 0.0, -1.3), v(3.0, 0.4, 1.3));
        for x in [-2.8, 2.2] {
            s.cuboid(v(x, 0.39, -0.7), v(x + 0.6, axis, 0.7));
        }
        s.cuboid(v(-1.0, 0.39, -1.2), v(1.6, axis - 0.4, 1.2));
        for z in [-0.5, 0.5] {
            s.cylinder(Stand::y(v(-0.9, axis + 0.8, z)), 0.22, 1.0, c.segments(32));
        }
    })
}

/// A generator along x: a long round housing with many cooling fins.
pub(super) fn generator() -> Mesh {
    mesh("generator", 5, |s, c| {
        let axis = 1.9;
        s.cylinder(Stand::x(v(-3.0, axis, 0.0)), 1.3, 6.0, c.segments(96));
        for k in 0..40 {
            s.cylinder(Stand::x(v(-2.8 + 0.14 * k as f32, axis, 0.0)), 1.42, 0.05, c.segments(96));
        }
        s.cuboid(v(-3.0, 0.0, -1.2), v(3.0, 1.0, 1.2));
        s.cuboid(v(-0.8, axis + 1.2, -0.5), v(0.8, axis + 1.9, 0.5));
    })
}

/// A fan in a spiral housing, with its motor.
pub(super) fn fan() -> Mesh {
    mesh("fan", 4, |s, c| {
        s.cylinder(Stand::z(v(0.0, 1.3, -0.4)), 1.1, 0.8, c.segments(64));
        s.hollow(Stand::z(v(0.0, 1.3, 0.39)), [0.6, 0.7], 0.05, 0.35, c.segments(64));
        s.cuboid(v(-1.1, 1.3, -0.39), v(-0.3, 2.6, 0.39));
        s.cuboid(v(-1.0, 0.0, -0.5), v(1.0, 0.4, 0.5));
        s.cylinder(Stand::z(v(0.0, 1.3, -1.3)), 0.3, 0.91, c.segments(48));
        for k in 0..16 {
            s.cylinder(Stand::z(v(0.0, 1.3, -1.25 + 0.05 * k as f32)), 0.36, 0.02, c.segments(48));
        }
    })
}

/// A floor of bars, half a bay square and 5 cm thick, centred on its surface's centre.
pub(super) fn grating() -> Mesh {
    const SIDE: f32 = 0.5 * BAY;
    const BARS: usize = 90;
    let (half, pitch) = (0.5 * SIDE, SIDE / BARS as f32);
    mesh("grating", 2, |s, c| {
        if c.finer_than(1) {
            for k in 0..BARS {
                let x = -half + (k as f32 + 0.5) * pitch;
                s.cuboid(v(x - 0.15 * pitch, -0.05, -half), v(x + 0.15 * pitch, 0.0, half));
                let z = x;
                s.cuboid(v(-half, -0.03, z - 0.1 * pitch), v(half, -0.015, z + 0.1 * pitch));
            }
        } else {
            // From afar a grid of bars is a plate: no point of it is farther than a pitch from one.
            s.cuboid(v(-half, -0.05, -half), v(half, 0.0, half));
            s.off_by(pitch.max(0.05));
        }
        for side in [-half, half - 0.05] {
            s.cuboid(v(side, -0.12, -half), v(side + 0.05, 0.0, half));
            s.cuboid(v(-half, -0.12, side), v(half, 0.0, side + 0.05));
        }
    })
}

/// A railing of half a bay along x: posts, two rails, a kick plate.
pub(super) fn railing() -> Mesh {
    const LONG: f32 = 0.5 * BAY;
    mesh("railing", 4, |s, c| {
        for k in 0..4 {
            let x = -0.5 * LONG + 0.05 + k as f32 * (LONG - 0.1) / 3.0;
            s.cylinder(Stand::y(v(x, 0.0, 0.0)), 0.025, 1.1, c.segments(16));
        }
        for y in [0.55, 1.1] {
            s.cylinder(Stand::x(v(-0.5 * LONG, y, 0.0)), 0.025, LONG, c.segments(16));
        }
        s.cuboid(v(-0.5 * LONG, 0.0, -0.005), v(0.5 * LONG, 0.12, 0.005));
    })
}

/// A flight of stairs along x that climbs half a storey over half a bay, with hand rails.
pub(super) fn stairs(climb: f32) -> Mesh {
    const STEPS: usize = 14;
    const LONG: f32 = 0.5 * BAY;
    mesh("stairs", 3, |s, c| {
        let (run, rise) = (LONG / STEPS as f32, climb / STEPS as f32);
        for k in 0..STEPS {
            let (x, y) = (-0.5 * LONG + k as f32 * run, (k + 1) as f32 * rise);
            s.cuboid(v(x, y - 0.04, -0.5), v(x + run, y, 0.5));
            // The stringers follow the treads in steps of their own.
            for z in [-0.55, 0.5] {
                s.cuboid(v(x, y - rise - 0.1, z), v(x + run, y + 0.05, z + 0.05));
            }
            if k % 3 == 1 {
                for z in [-0.52, 0.52] {
                    s.cylinder(Stand::y(v(x, y, z)), 0.02, 1.0, c.segments(16));
                }
            }
        }
    })
}

/// A cable tray of one bay along x with cables in it.
pub(super) fn cable_tray() -> Mesh {
    mesh("cable tray", 4, |s, c| {
        let half = 0.5 * BAY;
        s.cuboid(v(-half, 0.0, -0.3), v(half, 0.02, 0.3));
        for z in [-0.3, 0.28] {
            s.cuboid(v(-half, 0.019, z), v(half, 0.15, z + 0.02));
        }
        for k in 0..18 {
            let z = -0.255 + 0.03 * k as f32;
            let y = 0.04 + 0.02 * (k % 3) as f32;
            s.cylinder(Stand::x(v(-half, y, z)), 0.012 + 0.001 * (k % 5) as f32, BAY, c.segments(16));
        }
    })
}

/// A switch cabinet with doors, handles and louvres.
pub(super) fn cabinet() -> Mesh {
    mesh("cabinet", 3, |s, c| {
        s.cuboid(v(-0.5, 0.0, -0.3), v(0.5, 2.2, 0.3));
        for x in [-0.48, 0.02] {
            s.cuboid(v(x, 0.1, 0.29), v(x + 0.46, 2.1, 0.32));
            if c.finer_than(2) {
                for k in 0..14 {
                    let y = 0.2 + 0.04 * k as f32;
                    s.cuboid(v(x + 0.08, y, 0.315), v(x + 0.38, y + 0.015, 0.335));
                }
            } else {
                s.off_by(0.03);
            }
            s.cylinder(Stand::z(v(x + 0.4, 1.1, 0.31)), 0.03, 0.06, c.segments(16));
            for k in 0..4 {
                s.cylinder(Stand::z(v(x + 0.1 + 0.08 * k as f32, 1.7, 0.31)), 0.025, 0.03, c.segments(24));
            }
        }
    })
}

/// A barrel with rolled hoops.
pub(super) fn barrel() -> Mesh {
    mesh("barrel", 4, |s, c| {
        s.cylinder(Stand::y(Vec3::ZERO), 0.3, 0.9, c.segments(32));
        for y in [0.02, 0.3, 0.6, 0.88] {
            s.torus(Stand::y(v(0.0, y, 0.0)), 0.3, 0.015, [c.segments(32), c.segments(12)]);
        }
    })
}

/// A crate of boards.
pub(super) fn crate_of_boards() -> Mesh {
    mesh("crate", 2, |s, c| {
        s.cuboid(v(-0.45, 0.02, -0.45), v(0.45, 0.98, 0.45));
        if c.finer_than(1) {
            for k in 0..5 {
                let y = 0.2 * k as f32;
                s.cuboid(v(-0.5, y, 0.44), v(0.5, y + 0.17, 0.5));
                s.cuboid(v(-0.5, y, -0.5), v(0.5, y + 0.17, -0.44));
                s.cuboid(v(-0.5, y, -0.439), v(-0.44, y + 0.17, 0.439));
                s.cuboid(v(0.44, y, -0.439), v(0.5, y + 0.17, 0.439));
            }
        } else {
            // From an outer corner to the box within.
            s.off_by(0.08);
        }
    })
}

/// A rectangular air duct of one bay along x, with flanged joints.
pub(super) fn duct() -> Mesh {
    mesh("duct", 1, |s, _| {
        let half = 0.5 * BAY;
        s.cuboid(v(-half, -0.35, -0.5), v(half, 0.35, 0.5));
        for k in 0..6 {
            let x = -half + 0.02 + k as f32 * (BAY - 0.08) / 5.0;
            s.cuboid(v(x, -0.4, -0.55), v(x + 0.04, 0.4, 0.55));
        }
    })
}

/// A lamp under the ceiling: a finned bell.
pub(super) fn lamp() -> Mesh {
    mesh("lamp", 4, |s, c| {
        s.cylinder(Stand::y(v(0.0, -0.3, 0.0)), 0.02, 0.3, c.segments(12));
        let bell = [[0.0, -0.75], [0.3, -0.75], [0.22, -0.5], [0.1, -0.4], [0.1, -0.25], [0.0, -0.25]];
        s.lathe(Stand::y(Vec3::ZERO), &bell, c.segments(32));
        s.torus(Stand::y(v(0.0, -0.75, 0.0)), 0.29, 0.02, [c.segments(32), c.segments(12)]);
    })
}

/// A transformer with radiators and insulators.
pub(super) fn transformer() -> Mesh {
    mesh("transformer", 4, |s, c| {
        s.cuboid(v(-1.6, 0.3, -0.9), v(1.6, 2.6, 0.9));
        s.cuboid(v(-1.9, 0.0, -1.1), v(1.9, 0.31, 1.1));
        for k in 0..22 {
            let x = -1.5 + 0.14 * k as f32;
            s.cuboid(v(x, 0.6, 0.89), v(x + 0.04, 2.4, 1.5));
            s.cuboid(v(x, 0.6, -1.5), v(x + 0.04, 2.4, -0.89));
        }
        for k in 0..3 {
            let x = -1.0 + k as f32;
            s.cylinder(Stand::y(v(x, 2.59, 0.0)), 0.08, 1.3, c.segments(24));
            for ring in 0..8 {
                s.cylinder(Stand::y(v(x, 2.7 + 0.13 * ring as f32, 0.0)), 0.2, 0.05, c.segments(32));
            }
        }
        s.vessel(Stand::x(v(-1.4, 3.1, 0.6)), 0.25, 2.8, c.segments(32));
    })
}

/// A storage tank in the open, on the ground, with a shallow cone for a roof.
pub(super) fn storage_tank() -> Mesh {
    mesh("storage tank", 5, |s, c| {
        let profile = [[0.0, 0.0], [4.5, 0.0], [4.5, 8.0], [0.5, 8.9], [0.0, 8.9]];
        s.lathe(Stand::y(Vec3::ZERO), &profile, c.segments(192));
        for k in 0..5 {
            s.torus(Stand::y(v(0.0, 1.6 * (k + 1) as f32, 0.0)), 4.5, 0.06, [c.segments(192), c.segments(8)]);
        }
    })
}

/// A ring of the chimney, 5 m high.
pub(super) fn chimney_ring() -> Mesh {
    mesh("chimney ring", 5, |s, c| {
        s.hollow(Stand::y(Vec3::ZERO), [3.0, 3.0], 0.4, 5.0, c.segments(96));
        s.torus(Stand::y(v(0.0, 4.9, 0.0)), 3.0, 0.09, [c.segments(96), c.segments(8)]);
    })
}

/// One of [`TOWER_PATCHES`] pieces around one of [`TOWER_RINGS`] rings of a cooling tower's
/// shell: a hyperboloid, 0.4 m thick, with the tower's axis at the origin, from the angle 0.
pub(super) fn tower_patch(ring: usize) -> Mesh {
    let radius = |y: f32| {
        let rise = (y - 30.0) / 26.0;
        10.0 * (1.0 + rise * rise).sqrt()
    };
    mesh(&format!("tower {ring}"), 4, |s, c| {
        let (wide, high) = (c.segments(16), c.segments(16));
        let y0 = 4.0 + ring as f32 * TOWER_RING_HEIGHT;
        let point = |i: usize, j: usize, inner: f32| {
            let y = y0 + j as f32 * TOWER_RING_HEIGHT / high as f32;
            let (cos, sin) = turn(i, wide * TOWER_PATCHES);
            let r = radius(y) - inner;
            v(r * cos, y, r * sin)
        };
        s.slab(wide, high, |i, j| point(i, j, 0.0), |i, j| point(i, j, 0.4));
        // The meridian bends less than the waist does, in a circle of 26²/10 m.
        s.off_by(sagitta(radius(0.0), wide * TOWER_PATCHES));
        let step = TOWER_RING_HEIGHT / high as f32;
        s.off_by(step * step / (8.0 * 67.6));
    })
}

/// Pieces around a cooling tower.
pub(super) const TOWER_PATCHES: usize = 12;
/// Rings of pieces, one above the other.
pub(super) const TOWER_RINGS: usize = 5;
const TOWER_RING_HEIGHT: f32 = 7.5;
