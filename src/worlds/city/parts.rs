//! The meshes: unit bodies that are stretched to size, and small things of a few dozen triangles.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh};
use crate::scene::mesh::Mesh;

parts! {
    // One metre each way, standing on the ground, about the y axis.
    Body => whole("body", |s, _| s.cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5))),
    Gable => whole("gable", gable),
    Parapet => whole("parapet", parapet),
    Windows4 => windows(4),
    Windows5 => windows(5),
    Windows6 => windows(6),
    Windows8 => windows(8),
    Windows12 => windows(12),
    Windows18 => windows(18),
    // In their own size.
    Door => whole("door", door),
    Awning => whole("awning", awning),
    Balcony => whole("balcony", balcony),
    Chimney => whole("chimney", chimney),
    Cooler => whole("cooler", cooler),
    StairHouse => whole("stair house", stair_house),
    WaterTank => whole("water tank", water_tank),
    Antenna => whole("antenna", antenna),
    Skylight => whole("skylight", skylight),
    Lamp => whole("street lamp", lamp),
    Tree => whole("tree", tree),
    Bench => whole("bench", bench),
    Bin => whole("bin", |s, _| s.cylinder(Stand::y(Vec3::ZERO), 0.25, 0.9, 6)),
    Bollard => whole("bollard", |s, _| s.cylinder(Stand::y(Vec3::ZERO), 0.1, 0.9, 6)),
    Sign => whole("sign", sign),
    Car => whole("car", car),
    Van => whole("van", van),
    Planter => whole("planter", planter),
    Kiosk => whole("kiosk", kiosk),
}

/// Window fronts, by storeys.
pub(super) const WINDOWS: [(usize, Part); 6] = [
    (4, Part::Windows4),
    (5, Part::Windows5),
    (6, Part::Windows6),
    (8, Part::Windows8),
    (12, Part::Windows12),
    (18, Part::Windows18),
];

/// A mesh of one level.
fn whole(name: &str, build: impl Fn(&mut Shape, Coarseness)) -> Mesh {
    mesh(name, 1, build)
}

/// A box by its middle on the ground: width, height, depth.
fn stand(s: &mut Shape, [x, y, z]: [f32; 3], [w, h, d]: [f32; 3]) {
    s.cuboid(Vec3::new(x - 0.5 * w, y, z - 0.5 * d), Vec3::new(x + 0.5 * w, y + h, z + 0.5 * d));
}

/// Four windows a storey, in a front one metre wide and high, a little before z = 0.
fn windows(storeys: usize) -> Mesh {
    const BAYS: usize = 4;
    whole(&format!("windows of {storeys} storeys"), |s, _| {
        let (wide, high) = (1.0 / BAYS as f32, 1.0 / storeys as f32);
        for n in 0..BAYS * storeys {
            let (x, y) = (wide * (n % BAYS) as f32 - 0.5, high * (n / BAYS) as f32);
            s.cuboid(
                Vec3::new(x + 0.25 * wide, y + 0.25 * high, 0.0),
                Vec3::new(x + 0.75 * wide, y + 0.8 * high, 1.0),
            );
        }
    })
}

/// A roof whose ridge runs along x.
fn gable(s: &mut Shape, _: Coarseness) {
    let side = |x: f32| [Vec3::new(x, 0.0, -0.5), Vec3::new(x, 0.0, 0.5), Vec3::new(x, 1.0, 0.0)];
    s.prism(side(-0.5), side(0.5));
}

/// A rim around a flat roof.
fn parapet(s: &mut Shape, _: Coarseness) {
    const THICK: f32 = 0.03;
    for z in [-0.5 + 0.5 * THICK, 0.5 - 0.5 * THICK] {
        stand(s, [0.0, 0.0, z], [1.0, 1.0, THICK]);
    }
    for x in [-0.5 + 0.5 * THICK, 0.5 - 0.5 * THICK] {
        stand(s, [x, 0.0, 0.0], [THICK, 1.0, 1.0 - 2.0 * THICK]);
    }
}

fn door(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [1.3, 2.5, 0.16]);
    stand(s, [0.0, 2.5, 0.1], [1.8, 0.15, 0.7]);
    stand(s, [0.0, 0.0, 0.3], [1.8, 0.18, 0.6]);
}

fn awning(s: &mut Shape, _: Coarseness) {
    let side = |x: f32| [Vec3::new(x, 2.6, 0.0), Vec3::new(x, 2.5, 1.6), Vec3::new(x, 3.1, 0.0)];
    s.prism(side(-2.2), side(2.2));
}

fn balcony(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.6], [2.4, 0.15, 1.2]);
    stand(s, [0.0, 0.15, 1.17], [2.4, 0.9, 0.06]);
    for x in [-1.17, 1.17] {
        stand(s, [x, 0.15, 0.57], [0.06, 0.9, 1.14]);
    }
}

fn chimney(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.9, 2.6, 0.6]);
    stand(s, [0.0, 2.6, 0.0], [1.1, 0.15, 0.8]);
}

fn cooler(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.25, 0.0], [1.8, 1.1, 1.1]);
    s.cylinder(Stand::y(Vec3::new(0.0, 1.35, 0.0)), 0.42, 0.12, 8);
    for x in [-0.7, 0.7] {
        stand(s, [x, 0.0, 0.0], [0.12, 0.25, 1.0]);
    }
}

fn stair_house(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [3.0, 2.6, 3.6]);
    stand(s, [0.0, 2.6, 0.1], [3.3, 0.2, 4.0]);
}

fn water_tank(s: &mut Shape, _: Coarseness) {
    for (x, z) in [(-0.9, -0.9), (0.9, -0.9), (-0.9, 0.9), (0.9, 0.9)] {
        stand(s, [x, 0.0, z], [0.15, 2.0, 0.15]);
    }
    let body = [[0.0, 0.0], [1.5, 0.0], [1.5, 2.4], [0.0, 3.4]];
    s.lathe(Stand::y(Vec3::Y * 2.0), &body, 8);
}

fn antenna(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [0.08, 4.0, 0.08]);
    for (y, wide) in [(2.6, 1.4), (3.2, 1.1), (3.8, 0.8)] {
        stand(s, [0.0, y, 0.0], [wide, 0.05, 0.05]);
    }
}

fn skylight(s: &mut Shape, _: Coarseness) {
    let side = |x: f32| [Vec3::new(x, 0.0, -0.6), Vec3::new(x, 0.0, 0.6), Vec3::new(x, 0.5, 0.0)];
    s.prism(side(-1.0), side(1.0));
}

fn lamp(s: &mut Shape, _: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.09, 5.6, 6);
    stand(s, [0.0, 5.5, 0.7], [0.1, 0.1, 1.5]);
    stand(s, [0.0, 5.35, 1.3], [0.3, 0.15, 0.6]);
}

fn tree(s: &mut Shape, _: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.16, 2.4, 5);
    let crown = [[0.0, 0.0], [1.3, 0.9], [1.6, 2.2], [1.0, 3.6], [0.0, 4.4]];
    s.lathe(Stand::y(Vec3::Y * 1.9), &crown, 7);
}

fn bench(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.42, 0.0], [1.8, 0.06, 0.45]);
    stand(s, [0.0, 0.55, -0.22], [1.8, 0.4, 0.05]);
    for x in [-0.75, 0.75] {
        stand(s, [x, 0.0, 0.0], [0.08, 0.42, 0.45]);
    }
}

fn sign(s: &mut Shape, _: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.04, 2.4, 5);
    stand(s, [0.0, 2.0, 0.05], [0.6, 0.6, 0.03]);
}

fn car(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.3, 0.0], [1.75, 0.55, 4.2]);
    stand(s, [0.0, 0.85, -0.2], [1.5, 0.55, 2.1]);
    wheels(s, 0.85, 1.3);
}

fn van(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.35, -0.5], [1.95, 1.9, 3.9]);
    stand(s, [0.0, 0.35, 1.95], [1.9, 1.0, 1.0]);
    wheels(s, 0.95, 1.5);
}

fn wheels(s: &mut Shape, beside: f32, along: f32) {
    for (x, z) in [(-beside, -along), (beside, -along), (-beside, along), (beside, along)] {
        s.cylinder(Stand::x(Vec3::new(x - 0.1, 0.33, z)), 0.33, 0.2, 8);
    }
}

fn planter(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [1.6, 0.5, 0.6]);
    s.vessel(Stand::y(Vec3::Y * 0.4), 0.5, 0.8, 6);
}

fn kiosk(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, 0.0, 0.0], [2.4, 2.4, 2.0]);
    s.lathe(Stand::y(Vec3::Y * 2.4), &[[0.0, 0.0], [1.7, 0.0], [0.0, 0.9]], 4);
}
