//! The meshes: each stands on the xz plane of its own space, y away from the satellite. Metres,
//! but for those that are stretched: [`Part::Tile`] and [`Part::Strip`] are one metre long.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh};
use crate::scene::mesh::Mesh;

parts! {
    Tile => mesh("tile of insulation", 3, tile),
    Strip => mesh("strip of rivets", 3, strip),
    Panel => mesh("solar panel", 2, panel),
    Yoke => mesh("yoke", 3, yoke),
    Dish => mesh("dish", 4, dish),
    Horn => mesh("horn", 4, horn),
    Thruster => mesh("thruster", 4, thruster),
    Tracker => mesh("star tracker", 4, tracker),
    Patch => mesh("patch antenna", 2, patch),
    Tank => mesh("tank", 4, tank),
    Wheel => mesh("reaction wheel", 4, wheel),
    Unit => mesh("unit", 3, unit),
    Cable => mesh("cable", 3, cable),
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A box by its middle on the ground: width, height, depth.
fn stand(s: &mut Shape, [x, y, z]: [f32; 3], [w, h, d]: [f32; 3]) {
    s.cuboid(v(x - 0.5 * w, y, z - 0.5 * d), v(x + 0.5 * w, y + h, z + 0.5 * d));
}

/// A plate with quilted cushions on it and a rivet in each corner of each.
fn tile(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, -0.03, 0.0], [1.0, 0.03, 1.0]);
    if !c.finer_than(2) {
        return s.off_by(0.03);
    }
    const CUSHIONS: usize = 6;
    let side = 1.0 / CUSHIONS as f32;
    for n in 0..CUSHIONS * CUSHIONS {
        let x = side * ((n % CUSHIONS) as f32 + 0.5) - 0.5;
        let z = side * ((n / CUSHIONS) as f32 + 0.5) - 0.5;
        stand(s, [x, 0.0, z], [0.9 * side, 0.012, 0.9 * side]);
        if c.finer_than(1) {
            s.cylinder(Stand::y(v(x, 0.012, z)), 0.12 * side, 0.008, 8);
        }
    }
    if !c.finer_than(1) {
        s.off_by(0.008);
    }
}

fn strip(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, -0.5, 0.0], [0.06, 1.0, 0.06]);
    if !c.finer_than(2) {
        return s.off_by(0.02);
    }
    for n in 0..20 {
        let y = 0.05 * (n as f32 + 0.5) - 0.5;
        for x in [-0.05, 0.03] {
            s.cylinder(Stand::x(v(x, y, 0.0)), 0.012, 0.02, c.segments(12));
        }
    }
}

/// A frame with cells in rows, seen from both sides.
fn panel(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, -0.02, 0.0], [1.2, 0.04, 2.0]);
    if !c.finer_than(1) {
        return s.off_by(0.008);
    }
    for n in 0..8 * 14 {
        let (x, z) = (0.145 * ((n % 8) as f32 - 3.5), 0.14 * ((n / 8) as f32 - 6.5));
        stand(s, [x, 0.02, z], [0.13, 0.006, 0.125]);
        stand(s, [x, -0.028, z], [0.13, 0.006, 0.125]);
    }
}

fn yoke(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(v(0.0, 0.0, 0.0)), 0.16, 0.3, c.segments(48));
    for x in [-0.4, 0.4] {
        s.cylinder(Stand::y(v(x, 0.25, 0.0)), 0.03, 0.85, c.segments(24));
    }
    s.cylinder(Stand::x(v(-0.45, 0.28, 0.0)), 0.04, 0.9, c.segments(24));
    for n in 0..5 {
        let y = 0.3 + 0.15 * n as f32;
        s.torus(Stand::y(v(0.0, y, 0.0)), 0.12, 0.015, [c.segments(32), c.segments(8)]);
    }
}

/// A thin bowl with a rim and ribs behind.
fn dish(s: &mut Shape, c: Coarseness) {
    const RINGS: usize = 16;
    let radius = |k: usize| 1.4 * k as f32 / RINGS as f32;
    let bowl = |k: usize, y: f32| [radius(k), 0.28 * radius(k) * radius(k) + y];
    let mut profile: Vec<[f32; 2]> = (0..=RINGS).map(|k| bowl(k, 0.0)).collect();
    profile.extend((0..=RINGS).rev().map(|k| bowl(k, 0.04)));
    s.lathe(Stand::y(Vec3::ZERO), &profile, c.segments(64));
    s.torus(Stand::y(v(0.0, 0.57, 0.0)), 1.4, 0.03, [c.segments(64), c.segments(8)]);
    s.cylinder(Stand::y(v(0.0, -0.35, 0.0)), 0.12, 0.36, c.segments(32));
}

fn horn(s: &mut Shape, c: Coarseness) {
    s.hollow(Stand::y(v(0.0, -0.15, 0.0)), [0.16, 0.06], 0.015, 0.25, c.segments(48));
    s.cylinder(Stand::y(v(0.0, 0.09, 0.0)), 0.07, 0.12, c.segments(32));
    for n in 0..4 {
        s.torus(Stand::y(v(0.0, -0.1 + 0.05 * n as f32, 0.0)), 0.14, 0.01, [c.segments(48), c.segments(8)]);
    }
}

fn thruster(s: &mut Shape, c: Coarseness) {
    s.cylinder(Stand::y(v(0.0, -0.1, 0.0)), 0.08, 0.16, c.segments(32));
    s.hollow(Stand::y(v(0.0, 0.05, 0.0)), [0.05, 0.15], 0.01, 0.3, c.segments(64));
    for n in 0..6 {
        let y = 0.08 + 0.04 * n as f32;
        s.torus(Stand::y(v(0.0, y, 0.0)), 0.055 + 0.018 * n as f32, 0.008, [c.segments(64), c.segments(8)]);
    }
}

fn tracker(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.3, 0.15, 0.3]);
    s.hollow(Stand::y(v(0.0, 0.14, 0.0)), [0.1, 0.15], 0.01, 0.3, c.segments(64));
    s.cylinder(Stand::y(v(0.0, 0.14, 0.0)), 0.08, 0.05, c.segments(48));
    for n in 0..5 {
        s.torus(Stand::y(v(0.0, 0.18 + 0.05 * n as f32, 0.0)), 0.12, 0.012, [c.segments(64), c.segments(8)]);
    }
}

fn patch(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.5, 0.03, 0.5]);
    if !c.finer_than(1) {
        return s.off_by(0.02);
    }
    for n in 0..36 {
        let (x, z) = (0.08 * ((n % 6) as f32 - 2.5), 0.08 * ((n / 6) as f32 - 2.5));
        stand(s, [x, 0.03, z], [0.06, 0.02, 0.06]);
    }
}

fn tank(s: &mut Shape, c: Coarseness) {
    s.vessel(Stand::y(Vec3::ZERO), 0.5, 1.5, c.segments(64));
    for y in [0.35, 0.75, 1.15] {
        s.torus(Stand::y(v(0.0, y, 0.0)), 0.5, 0.02, [c.segments(64), c.segments(8)]);
    }
    s.cylinder(Stand::y(v(0.0, 1.45, 0.0)), 0.04, 0.15, c.segments(16));
}

fn wheel(s: &mut Shape, c: Coarseness) {
    s.torus(Stand::y(v(0.0, 0.08, 0.0)), 0.2, 0.06, [c.segments(48), c.segments(16)]);
    s.cylinder(Stand::y(Vec3::ZERO), 0.05, 0.16, c.segments(24));
    for n in 0..3 {
        stand(s, [0.0, 0.06 + 0.015 * n as f32, 0.0], [0.4, 0.01, 0.03]);
    }
}

/// A box of electronics: fins on top, connectors in front.
fn unit(s: &mut Shape, c: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.7, 0.18, 0.7]);
    if !c.finer_than(2) {
        return s.off_by(0.05);
    }
    for n in 0..16 {
        stand(s, [0.042 * (n as f32 - 7.5), 0.18, 0.0], [0.012, 0.05, 0.66]);
    }
    for n in 0..6 {
        let at = v(0.1 * (n as f32 - 2.5), 0.09, 0.35);
        s.cylinder(Stand::z(at), 0.035, 0.04, c.segments(24));
    }
}

/// A cable from below around a bend.
fn cable(s: &mut Shape, c: Coarseness) {
    s.bend(v(0.0, 0.0, 0.25), 0.25, 0.02, [c.segments(16), c.segments(12)]);
    s.cylinder(Stand::x(v(-0.3, 0.0, 0.0)), 0.02, 0.3, c.segments(12));
    s.cylinder(Stand::z(v(0.25, 0.0, 0.25)), 0.02, 0.3, c.segments(12));
    for x in [-0.3, -0.15] {
        s.cylinder(Stand::x(v(x, 0.0, 0.0)), 0.03, 0.03, c.segments(12));
    }
}
