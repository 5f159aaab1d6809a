//! Pipes, ducts and cable trays under the ceilings, cut into bays as the building is.

use glam::Vec3;

use super::super::dice::Dice;
use super::plan::{Bay, Plan, Use};
use super::stock::{GALVANISED, PIPES, Part, STEEL, any};
use super::{Site, Turn, at};

/// Lanes across a row of bays: distance from its middle and height above the floor.
const LANES: [(f32, f32); 4] = [(-2.75, 3.55), (-1.85, 3.7), (1.9, 3.7), (2.75, 3.5)];

/// Runs along x through every row of bays on every storey, through walls as they come.
pub(super) fn build(site: &mut Site, plan: &Plan, dice: &mut Dice) {
    for k in 0..plan.size.ny as i32 {
        for j in 0..plan.size.nz as i32 {
            for (z, y) in LANES {
                let corridor = j == plan.size.aisle();
                if corridor || dice.chance(0.45) {
                    run(site, plan, dice, [j, k], Vec3::new(0.0, y, z));
                }
            }
        }
    }
}

/// One run: a stretch of bays with one kind of pipe, and now and then a valve on it.
fn run(site: &mut Site, plan: &Plan, dice: &mut Dice, [j, k]: [i32; 2], lane: Vec3) {
    let nx = plan.size.nx;
    let first = dice.below(nx / 2) as i32;
    let last = first + (nx / 3 + dice.below(nx)) as i32;
    let kinds =
        [Part::PipeSmall, Part::PipeMedium, Part::PipeMedium, Part::PipeLarge, Part::CableTray, Part::Duct];
    let kind = any(&kinds, dice);
    let color = match kind {
        Part::CableTray => STEEL,
        Part::Duct => GALVANISED,
        _ => any(&PIPES, dice),
    };
    for i in first..last.min(nx as i32) {
        let bay = Bay { i, j, k };
        // In the high rooms pipes would hang in the air.
        if matches!(plan.room(bay).used, Use::Hall | Use::Boiler | Use::Outside) {
            continue;
        }
        let middle = plan.size.center(bay) + lane;
        site.put(kind, at(middle, Turn::Yaw(0), 1.0), color);
        let valve = match kind {
            Part::PipeSmall => Part::ValveSmall,
            Part::PipeMedium => Part::ValveMedium,
            _ => continue,
        };
        if dice.chance(0.25) {
            site.put(valve, at(middle + Vec3::X * 1.9, Turn::Yaw(0), 1.0), any(&PIPES, dice));
        }
    }
}
