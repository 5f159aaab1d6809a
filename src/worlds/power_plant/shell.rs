//! The building: floors, walls, columns and beams, each a cell of the grid.

use glam::Vec3;

use super::super::dice::Dice;
use super::plan::{Bay, Plan, Use};
use super::stock::{CONCRETE, FACADE, FLOOR, GIRDER, PLASTER, Part, aged};
use super::{BAY, CLEAR, Site, Turn, at};

/// Builds the whole shell. Nothing here asks for the camera's clearance: the plan keeps its way
/// open with doors and shafts.
pub(super) fn build(site: &mut Site, plan: &Plan, dice: &mut Dice) {
    floors(site, plan, dice);
    walls(site, plan, dice);
    frame(site, plan, dice);
}

/// A slab under every bay and over the top storey, except inside the hall and the boiler house.
fn floors(site: &mut Site, plan: &Plan, dice: &mut Dice) {
    let top = plan.size.ny as i32;
    let roof = plan.bays().filter(|bay| bay.k == top - 1).map(|bay| Bay { k: top, ..bay });
    for bay in plan.bays().chain(roof) {
        let (room, below) = (plan.room(bay), plan.room(Bay { k: bay.k - 1, ..bay }));
        let sky = room.used == Use::Outside;
        // The boiler house is open to the sky.
        if room != below && !(sky && below.used == Use::Boiler) {
            let color = if sky { CONCRETE } else { FLOOR };
            site.build(Part::Slab, at(plan.size.center(bay), Turn::Yaw(0), 1.0), aged(color, dice));
        }
    }
}

fn walls(site: &mut Site, plan: &Plan, dice: &mut Dice) {
    let (nx, nz) = (plan.size.nx as i32, plan.size.nz as i32);
    for k in 0..plan.size.ny as i32 {
        for j in 0..=nz {
            for i in 0..=nx {
                let bay = Bay { i, j, k };
                let corner = plan.size.corner(i, j, k);
                if j < nz {
                    let middle = corner + Vec3::new(0.0, 0.0, 0.5 * BAY);
                    wall(site, plan, dice, [Bay { i: i - 1, ..bay }, bay], middle, Turn::Yaw(1));
                }
                if i < nx {
                    let middle = corner + Vec3::new(0.5 * BAY, 0.0, 0.0);
                    wall(site, plan, dice, [Bay { j: j - 1, ..bay }, bay], middle, Turn::Yaw(0));
                }
            }
        }
    }
}

/// What stands between two bays side by side, if anything.
fn wall(site: &mut Site, plan: &Plan, dice: &mut Dice, sides: [Bay; 2], middle: Vec3, turn: Turn) {
    let rooms = sides.map(|bay| plan.room(bay));
    if rooms[0] == rooms[1] {
        return;
    }
    let outer = rooms.iter().any(|r| r.used == Use::Outside);
    let way = plan.is_joined(sides[0], sides[1]) || rooms.iter().all(|r| r.used == Use::Corridor);
    let part = if outer {
        match (way, sides[0].k > 0 && dice.chance(0.4)) {
            (true, _) => Part::WallDoor,
            (false, true) => Part::WallWindows,
            (false, false) => Part::Wall,
        }
    } else {
        // Out of 20: where the camera passes there is always an opening.
        match dice.below(if way { 10 } else { 20 }) {
            0..6 => Part::WallGate,
            6..10 => Part::WallDoor,
            10..13 => Part::WallWindows,
            _ => Part::Wall,
        }
    };
    let color = aged(if outer { FACADE } else { PLASTER }, dice);
    site.build(part, at(middle, turn, 1.0), color);
}

/// Columns on the grid's corners and beams between them, where a wall or a floor needs them.
fn frame(site: &mut Site, plan: &Plan, dice: &mut Dice) {
    let (nx, nz) = (plan.size.nx as i32, plan.size.nz as i32);
    for k in 0..plan.size.ny as i32 {
        for j in 0..=nz {
            for i in 0..=nx {
                let bay = Bay { i, j, k };
                let corner = plan.size.corner(i, j, k);
                let [west, north] = [Bay { i: i - 1, ..bay }, Bay { j: j - 1, ..bay }];
                let around = [bay, west, north, Bay { i: i - 1, j: j - 1, k }];
                let same = around.iter().all(|&b| plan.room(b) == plan.room(bay));
                if !(same && is_void(plan, bay)) {
                    site.build(Part::Column, at(corner, Turn::Yaw(0), 1.0), aged(CONCRETE, dice));
                }
                let ceiling = corner + Vec3::Y * CLEAR;
                if i < nx && needs_beam(plan, bay, north) {
                    let middle = ceiling + Vec3::new(0.5 * BAY, 0.0, 0.0);
                    site.build(Part::Beam, at(middle, Turn::Yaw(0), 1.0), aged(GIRDER, dice));
                }
                if j < nz && needs_beam(plan, bay, west) {
                    let middle = ceiling + Vec3::new(0.0, 0.0, 0.5 * BAY);
                    site.build(Part::Beam, at(middle, Turn::Yaw(1), 1.0), aged(GIRDER, dice));
                }
            }
        }
    }
}

/// Whether a bay belongs to a room that is higher than a storey, or lies outside.
fn is_void(plan: &Plan, bay: Bay) -> bool {
    matches!(plan.room(bay).used, Use::Hall | Use::Boiler | Use::Outside)
}

/// No beam crosses the void inside a high room, unless it carries the ceiling.
fn needs_beam(plan: &Plan, a: Bay, b: Bay) -> bool {
    let above = Bay { k: a.k + 1, ..a };
    let inner = is_void(plan, a) && plan.room(a) == plan.room(b);
    !inner || (plan.room(above) != plan.room(a) && plan.room(a).used == Use::Hall)
}
