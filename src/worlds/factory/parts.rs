//! The meshes: machines and furniture with levels of detail. Each stands on the floor of its own
//! space about the y axis; what is long runs along x. Metres, but for those that are stretched:
//! [`Part::Body`] and [`Part::Wall`] are one metre each way.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh};
use crate::scene::mesh::Mesh;

parts! {
    Body => mesh("body", 1, |s, _| s.cuboid(v(-0.5, 0.0, -0.5), v(0.5, 1.0, 0.5))),
    Wall => mesh("wall", 2, wall),
    Column => mesh("column", 1, column),
    Truss => mesh("truss", 3, truss),
    Lamp => mesh("lamp", 2, lamp),
    Tray => mesh("cable tray", 3, tray),
    Pipe => mesh("pipe", 4, pipe),
    Elbow => mesh("elbow", 3, elbow),
    Valve => mesh("valve", 4, valve),
    Cabinet => mesh("cabinet", 3, cabinet),
    Fence => mesh("fence", 3, fence),
    Press => mesh("press", 3, press),
    Flywheel => mesh("flywheel", 4, flywheel),
    Motor => mesh("motor", 4, motor),
    Piston => mesh("piston", 4, piston),
    Conveyor => mesh("conveyor", 4, conveyor),
    RobotBase => mesh("robot's base", 4, robot_base),
    RobotArm => mesh("robot's arm", 4, robot_arm),
    Gripper => mesh("gripper", 3, gripper),
    Rack => mesh("rack", 1, rack),
    Crate => mesh("crate", 2, crate_of_boards),
    Drum => mesh("drum", 4, drum),
    Pallet => mesh("pallet", 1, pallet),
    Vessel => mesh("vessel", 4, vessel),
    Bench => mesh("bench", 1, bench),
    Lathe => mesh("lathe", 4, lathe),
    Tool => mesh("tool", 3, tool),
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A box by its middle on the ground: width, height, depth.
fn stand(s: &mut Shape, [x, y, z]: [f32; 3], [w, h, d]: [f32; 3]) {
    s.cuboid(v(x - 0.5 * w, y, z - 0.5 * d), v(x + 0.5 * w, y + h, z + 0.5 * d));
}

/// Four posts or feet at `x` and `z` from the middle.
fn corners(s: &mut Shape, x: f32, z: f32, y: f32, size: [f32; 3]) {
    for (i, j) in [(-x, -z), (x, -z), (-x, z), (x, z)] {
        stand(s, [i, y, j], size);
    }
}

/// Corrugated sheet.
fn wall(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [1.0, 1.0, 0.1]);
    if !c.finer_than(1) {
        return s.off_by(0.04);
    }
    for n in 0..40 {
        let x = (n as f32 + 0.5) / 40.0 - 0.5;
        stand(s, [x, 0.0, 0.07], [0.012, 1.0, 0.04]);
        stand(s, [x, 0.0, -0.07], [0.012, 1.0, 0.04]);
    }
}

fn column(s: &mut Shape, _: Coarseness) {
    for z in [-0.15, 0.15] {
        stand(s, [0.0, 0.0, z], [0.3, 9.0, 0.03]);
    }
    stand(s, [0.0, 0.0, 0.0], [0.03, 9.0, 0.27]);
    stand(s, [0.0, 0.0, 0.0], [0.5, 0.04, 0.5]);
}

/// Two chords along x and a lattice of rods.
fn truss(s: &mut Shape, c: Coarseness) {
    for y in [0.0, 1.0] {
        s.cylinder(Stand::x(v(-6.0, y + 0.08, 0.0)), 0.08, 12.0, c.segments(24));
    }
    for n in 0..25 {
        let x = 0.49 * (n as f32 - 12.0);
        s.cylinder(Stand::y(v(x, 0.08, 0.0)), 0.03, 1.0, c.segments(16));
    }
}

fn lamp(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(v(0.0, 0.2, 0.0)), 0.02, 0.6, 6);
    s.hollow(Stand::y(Vec3::ZERO), [0.4, 0.1], 0.02, 0.25, c.segments(32));
}

/// A tray on hangers, with cables in it.
fn tray(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [4.0, 0.02, 0.4]);
    for z in [-0.2, 0.2] {
        stand(s, [0.0, 0.0, z], [4.0, 0.12, 0.02]);
    }
    for n in 0..7 {
        let z = 0.045 * (n as f32 - 3.0);
        s.cylinder(Stand::x(v(-2.0, 0.045, z)), 0.02, 4.0, c.segments(16));
    }
    for x in [-1.5, 1.5] {
        stand(s, [x, 0.0, 0.22], [0.03, 2.0, 0.03]);
    }
}

/// Four metres with flanges and bolts.
fn pipe(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::x(v(-2.0, 0.0, 0.0)), 0.15, 4.0, c.segments(48));
    for x in [-2.0, 1.94] {
        s.cylinder(Stand::x(v(x, 0.0, 0.0)), 0.22, 0.06, c.segments(48));
        if c.finer_than(3) {
            for (y, z) in [(0.18, 0.0), (-0.18, 0.0), (0.0, 0.18), (0.0, -0.18)] {
                s.cylinder(Stand::x(v(x - 0.03, y, z)), 0.02, 0.12, 6);
            }
        } else {
            s.off_by(0.04);
        }
    }
}

fn elbow(s: &mut Shape, c: Coarseness) {
    s.bend(v(0.0, 0.0, 0.5), 0.5, 0.15, [c.segments(16), c.segments(48)]);
    s.cylinder(Stand::x(v(-0.1, 0.0, 0.0)), 0.22, 0.1, c.segments(48));
    s.cylinder(Stand::z(v(0.5, 0.0, 0.5)), 0.22, 0.1, c.segments(48));
}

fn valve(s: &mut Shape, c: Coarseness) {
    s.vessel(Stand::x(v(-0.25, 0.0, 0.0)), 0.22, 0.5, c.segments(48));
    s.cylinder(Stand::y(Vec3::ZERO), 0.04, 0.5, c.segments(24));
    s.torus(Stand::y(v(0.0, 0.48, 0.0)), 0.2, 0.025, [c.segments(48), c.segments(12)]);
    stand(s, [0.0, 0.47, 0.0], [0.38, 0.02, 0.03]);
    stand(s, [0.0, 0.47, 0.0], [0.03, 0.02, 0.38]);
}

/// A cabinet with louvres and rows of buttons.
fn cabinet(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.8, 2.0, 0.5]);
    if !c.finer_than(2) {
        return s.off_by(0.04);
    }
    for n in 0..24 {
        let (x, y) = (0.1 * ((n % 6) as f32 - 2.5), 1.3 + 0.12 * (n / 6) as f32);
        s.cylinder(Stand::z(v(x, y, 0.25)), 0.025, 0.03, c.segments(16));
    }
    for n in 0..12 {
        stand(s, [0.0, 0.2 + 0.06 * n as f32, 0.26], [0.6, 0.02, 0.04]);
    }
}

/// Three metres of upright bars.
fn fence(s: &mut Shape, c: Coarseness) {
    for x in [-1.45, 1.45] {
        stand(s, [x, 0.0, 0.0], [0.08, 2.0, 0.08]);
    }
    for y in [0.15, 1.9] {
        stand(s, [0.0, y, 0.0], [2.9, 0.05, 0.05]);
    }
    for n in 0..28 {
        let x = 0.1 * (n as f32 - 13.5);
        s.cylinder(Stand::y(v(x, 0.15, 0.0)), 0.012, 1.78, c.segments(12));
    }
}

fn press(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [2.4, 0.8, 2.0]);
    for x in [-1.05, 1.05] {
        stand(s, [x, 0.8, 0.0], [0.3, 2.4, 1.8]);
    }
    stand(s, [0.0, 3.2, 0.0], [2.5, 0.8, 2.1]);
    stand(s, [0.0, 1.9, 0.0], [1.6, 0.5, 1.4]);
    stand(s, [0.0, 0.8, 0.0], [1.6, 0.25, 1.4]);
    for (x, z) in [(-0.7, -0.6), (0.7, -0.6), (-0.7, 0.6), (0.7, 0.6)] {
        s.cylinder(Stand::y(v(x, 0.8, z)), 0.09, 2.4, c.segments(48));
    }
    if !c.finer_than(2) {
        return s.off_by(0.03);
    }
    for n in 0..48 {
        let (x, y) = (0.18 * ((n % 12) as f32 - 5.5), 3.3 + 0.18 * (n / 12) as f32);
        for z in [-1.08, 1.05] {
            s.cylinder(Stand::z(v(x, y, z)), 0.03, 0.03, c.segments(12));
        }
    }
}

fn flywheel(s: &mut Shape, c: Coarseness) {
    s.torus(Stand::z(Vec3::ZERO), 0.8, 0.1, [c.segments(64), c.segments(16)]);
    s.cylinder(Stand::z(v(0.0, 0.0, -0.15)), 0.18, 0.3, c.segments(32));
    s.cylinder(Stand::x(v(-0.75, 0.0, 0.0)), 0.05, 1.5, c.segments(16));
    s.cylinder(Stand::y(v(0.0, -0.75, 0.0)), 0.05, 1.5, c.segments(16));
}

/// A motor on its foot, with a terminal box and rings for fins.
fn motor(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.7, 0.08, 0.5]);
    stand(s, [0.0, 0.08, 0.0], [0.4, 0.12, 0.3]);
    s.cylinder(Stand::x(v(-0.4, 0.4, 0.0)), 0.24, 0.8, c.segments(48));
    s.cylinder(Stand::x(v(0.4, 0.4, 0.0)), 0.04, 0.25, c.segments(16));
    stand(s, [0.0, 0.6, 0.0], [0.25, 0.15, 0.25]);
    if !c.finer_than(3) {
        return s.off_by(0.05);
    }
    for n in 0..12 {
        let x = 0.06 * (n as f32 - 5.5);
        s.torus(Stand::x(v(x, 0.4, 0.0)), 0.24, 0.012, [c.segments(48), c.segments(8)]);
    }
}

fn piston(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.07, 1.8, c.segments(48));
    s.cylinder(Stand::y(v(0.0, 0.6, 0.0)), 0.14, 1.0, c.segments(48));
    for y in [0.6, 1.1, 1.6] {
        s.torus(Stand::y(v(0.0, y, 0.0)), 0.14, 0.03, [c.segments(48), c.segments(12)]);
    }
}

/// Two metres of rollers between two beams.
fn conveyor(s: &mut Shape, c: Coarseness) {
    for z in [-0.45, 0.45] {
        stand(s, [0.0, 0.6, z], [2.1, 0.2, 0.06]);
    }
    corners(s, 0.9, 0.45, 0.0, [0.08, 0.6, 0.08]);
    for n in 0..14 {
        let at = v(0.15 * (n as f32 - 6.5), 0.74, -0.42);
        s.cylinder(Stand::z(at), 0.06, 0.84, c.segments(32));
    }
}

fn robot_base(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.9, 0.1, 0.9]);
    let profile = [[0.0, 0.1], [0.4, 0.1], [0.36, 0.35], [0.28, 0.45], [0.28, 0.8], [0.35, 0.9], [0.0, 0.9]];
    s.lathe(Stand::y(Vec3::ZERO), &profile, c.segments(64));
    for (x, z) in [(-0.38, -0.38), (0.38, -0.38), (-0.38, 0.38), (0.38, 0.38)] {
        s.cylinder(Stand::y(v(x, 0.1, z)), 0.04, 0.06, c.segments(16));
    }
}

/// Shoulder, two links and their joints.
fn robot_arm(s: &mut Shape, c: Coarseness) {
    let joint = |s: &mut Shape, y: f32, x: f32, radius: f32| {
        s.cylinder(Stand::z(v(x, y, -0.25)), radius, 0.5, c.segments(48));
        s.torus(Stand::z(v(x, y, 0.25)), 0.8 * radius, 0.03, [c.segments(48), c.segments(12)]);
    };
    joint(s, 0.25, 0.0, 0.24);
    s.cylinder(Stand::y(v(0.0, 0.25, 0.0)), 0.15, 1.2, c.segments(48));
    joint(s, 1.5, 0.0, 0.2);
    s.cylinder(Stand::x(v(0.0, 1.5, 0.0)), 0.11, 1.2, c.segments(48));
    joint(s, 1.5, 1.25, 0.15);
    s.cylinder(Stand::x(v(-0.5, 1.5, 0.0)), 0.16, 0.35, c.segments(48));
}

fn gripper(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(v(1.4, -0.6, 0.0)), 0.06, 0.5, c.segments(32));
    stand(s, [1.4, -0.65, 0.0], [0.3, 0.06, 0.12]);
    for x in [1.28, 1.52] {
        stand(s, [x, -0.9, 0.0], [0.04, 0.25, 0.1]);
    }
}

/// Four shelves of five metres on uprights with braces.
fn rack(s: &mut Shape, _: Coarseness) {
    for x in [-2.55, 0.0, 2.55] {
        for z in [-0.5, 0.5] {
            stand(s, [x, 0.0, z], [0.1, 5.8, 0.1]);
        }
        for n in 0..8 {
            stand(s, [x, 0.4 + 0.7 * n as f32, 0.0], [0.04, 0.04, 0.9]);
        }
    }
    for shelf in 0..4 {
        let y = 1.4 * shelf as f32;
        stand(s, [0.0, y + 0.06, 0.0], [5.0, 0.05, 1.0]);
        for z in [-0.52, 0.52] {
            stand(s, [0.0, y, z], [5.1, 0.12, 0.05]);
        }
    }
}

/// A box of boards and battens, closed inside.
fn crate_of_boards(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.01, 0.0], [0.94, 0.78, 0.94]);
    if !c.finer_than(1) {
        return s.off_by(0.03);
    }
    for n in 0..6 {
        let y = 0.02 + 0.13 * n as f32;
        for z in [-0.48, 0.48] {
            stand(s, [0.0, y, z], [0.98, 0.11, 0.02]);
            stand(s, [z, y, 0.0], [0.02, 0.11, 0.92]);
        }
        stand(s, [0.155 * (n as f32 - 2.5), 0.79, 0.0], [0.14, 0.02, 0.96]);
    }
}

fn drum(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.3, 0.9, c.segments(48));
    for y in [0.02, 0.3, 0.6, 0.88] {
        s.torus(Stand::y(v(0.0, y, 0.0)), 0.3, 0.02, [c.segments(48), c.segments(8)]);
    }
    s.cylinder(Stand::y(v(0.15, 0.89, 0.0)), 0.04, 0.03, c.segments(16));
}

fn pallet(s: &mut Shape, _: Coarseness) {
    for n in 0..7 {
        stand(s, [0.17 * (n as f32 - 3.0), 0.12, 0.0], [0.14, 0.025, 1.0]);
    }
    for z in [-0.43, 0.0, 0.43] {
        stand(s, [0.0, 0.0, z], [1.15, 0.12, 0.1]);
    }
}

/// An upright vessel on legs with a ladder and a manhole.
fn vessel(s: &mut Shape, c: Coarseness) {
    s.vessel(Stand::y(v(0.0, 0.7, 0.0)), 1.1, 3.8, c.segments(64));
    corners(s, 0.7, 0.7, 0.0, [0.15, 1.3, 0.15]);
    for y in [1.6, 2.6, 3.6] {
        s.torus(Stand::y(v(0.0, y, 0.0)), 1.1, 0.04, [c.segments(64), c.segments(8)]);
    }
    s.cylinder(Stand::z(v(0.0, 2.1, 1.0)), 0.35, 0.3, c.segments(48));
    for x in [-0.25, 0.25] {
        s.cylinder(Stand::y(v(x, 0.2, -1.25)), 0.025, 4.2, c.segments(12));
    }
    for n in 0..14 {
        s.cylinder(Stand::x(v(-0.25, 0.4 + 0.28 * n as f32, -1.25)), 0.015, 0.5, c.segments(12));
    }
}

fn bench(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.84, 0.0], [2.2, 0.06, 0.9]);
    corners(s, 1.0, 0.38, 0.0, [0.09, 0.84, 0.09]);
    stand(s, [0.0, 0.2, 0.0], [2.0, 0.04, 0.8]);
    for n in 0..3 {
        stand(s, [-0.75, 0.3 + 0.18 * n as f32, 0.0], [0.5, 0.15, 0.85]);
    }
}

/// A bench lathe: bed, head, chuck, tailstock and carriage.
fn lathe(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, -0.1], [1.5, 0.12, 0.3]);
    stand(s, [-0.55, 0.12, -0.1], [0.35, 0.4, 0.35]);
    s.cylinder(Stand::x(v(-0.38, 0.35, -0.1)), 0.12, 0.1, c.segments(48));
    s.cylinder(Stand::x(v(-0.28, 0.35, -0.1)), 0.03, 0.7, c.segments(32));
    stand(s, [0.55, 0.12, -0.1], [0.25, 0.3, 0.2]);
    stand(s, [0.1, 0.12, -0.02], [0.25, 0.12, 0.35]);
    for (x, z) in [(0.1, 0.16), (-0.55, 0.08), (0.55, 0.02)] {
        s.torus(Stand::z(v(x, 0.2, z)), 0.07, 0.012, [c.segments(32), c.segments(12)]);
    }
}

fn tool(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::x(v(-0.12, 0.03, 0.0)), 0.025, 0.2, c.segments(24));
    s.cylinder(Stand::x(v(0.08, 0.03, 0.0)), 0.01, 0.14, c.segments(16));
    stand(s, [0.22, 0.0, 0.0], [0.04, 0.06, 0.1]);
}
