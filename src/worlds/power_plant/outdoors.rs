//! What stands around the building: ground, tanks, transformers, chimney, cooling towers.

use glam::Vec3;

use super::super::dice::Dice;
use super::super::shape::turn as circle;
use super::parts::TOWER_PATCHES;
use super::plan::Size;
use super::stock::{CONCRETE, GROUND, PIPES, Part, RED, STEEL, TOWER, WHITE, aged, any};
use super::{BAY, Site, Turn, affine, at};

/// Bays of open ground north, where the towers stand, and on the other sides.
const NORTH: i32 = 4;
const MARGIN: i32 = 2;

pub(super) fn build(site: &mut Site, size: Size, dice: &mut Dice) {
    let (nx, nz) = (size.nx as i32, size.nz as i32);
    for j in -NORTH..nz + MARGIN {
        for i in -MARGIN..nx + MARGIN {
            let inside = (0..nx).contains(&i) && (0..nz).contains(&j);
            if !inside {
                let middle = size.corner(i, j, 0) + Vec3::new(0.5 * BAY, 0.0, 0.5 * BAY);
                site.build(Part::Ground, at(middle, Turn::Yaw(0), 1.0), aged(GROUND, dice));
            }
        }
    }
    let building = size.building();
    let back = building.min.z - 0.5 * NORTH as f32 * BAY;
    let towers = (size.nx / 8).max(1);
    for n in 0..towers {
        let x = building.min.x + 16.0 + 32.0 * n as f32;
        tower(site, Vec3::new(x, 0.0, back), dice);
    }
    chimney(site, Vec3::new(building.max.x - 6.0, 0.0, back));
    let front = building.max.z + 0.5 * MARGIN as f32 * BAY;
    for n in 0..size.nx / 2 {
        let x = building.min.x + (2.0 * n as f32 + 1.0) * BAY;
        if n % 2 == 0 {
            site.put(Part::StorageTank, at(Vec3::new(x, 0.0, front), Turn::Yaw(0), 1.0), aged(WHITE, dice));
        } else {
            site.put(Part::Transformer, at(Vec3::new(x, 0.0, front), Turn::Yaw(0), 1.0), aged(STEEL, dice));
        }
    }
    pipe_bridge(site, size, dice);
}

fn tower(site: &mut Site, foot: Vec3, dice: &mut Dice) {
    for part in TOWER {
        for n in 0..TOWER_PATCHES {
            let (cos, sin) = circle(n, TOWER_PATCHES);
            let axes = [Vec3::new(cos, 0.0, sin), Vec3::Y, Vec3::new(-sin, 0.0, cos)];
            site.build(part, affine(axes, foot), aged(CONCRETE, dice));
        }
    }
}

fn chimney(site: &mut Site, foot: Vec3) {
    for n in 0..10 {
        let color = if n >= 6 && n % 2 == 0 { RED } else { WHITE };
        site.build(Part::ChimneyRing, at(foot + Vec3::Y * 5.0 * n as f32, Turn::Yaw(0), 1.0), color);
    }
}

/// A bridge of pipes along the northern wall, on columns.
fn pipe_bridge(site: &mut Site, size: Size, dice: &mut Dice) {
    let z = size.building().min.z - 3.0;
    let lanes = [(-1.2, Part::PipeLarge), (0.0, Part::PipeMedium), (1.0, Part::PipeLarge)];
    let colors = lanes.map(|_| any(&PIPES, dice));
    for i in 0..size.nx as i32 {
        let x = size.corner(i, 0, 0).x;
        site.build(Part::Column, at(Vec3::new(x, 0.0, z), Turn::Yaw(0), 1.0), aged(CONCRETE, dice));
        site.build(Part::Beam, at(Vec3::new(x, 5.2, z), Turn::Yaw(1), 1.0), aged(STEEL, dice));
        for ((across, part), color) in lanes.into_iter().zip(colors) {
            let middle = Vec3::new(x + 0.5 * BAY, 5.9, z + across);
            site.build(part, at(middle, Turn::Yaw(0), 1.0), color);
        }
    }
}
