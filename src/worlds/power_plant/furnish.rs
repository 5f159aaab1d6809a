//! What stands in the rooms: a recipe for each use of a room, bay by bay.

use glam::{Affine3A, Vec3};

use super::super::dice::Dice;
use super::plan::{Bay, Plan, Use};
use super::stock::*;
use super::{BAY, CLEAR, Turn, at};

/// A part, its place and its paint.
pub(super) type Wish = (Part, Affine3A, [u8; 3]);

/// All that the rooms could hold: more than is placed. O(bays).
pub(super) fn wishes(plan: &Plan, dice: &mut Dice) -> Vec<Wish> {
    let mut wishes = Vec::new();
    for bay in plan.bays() {
        let mut corner = Corner { floor: plan.size.center(bay), dice, wishes: &mut wishes };
        match plan.room(bay).used {
            Use::Outside => {}
            Use::Corridor => corner.corridor(),
            Use::Hall => corner.hall(bay),
            Use::Boiler => corner.boiler(plan, bay),
            Use::Exchangers => corner.exchangers(),
            Use::Pumps => corner.pumps(),
            Use::Vessels => corner.vessels(),
            Use::Electrical => corner.electrical(),
            Use::Store => corner.store(),
            Use::Air => corner.air(),
        }
    }
    wishes
}

/// One bay being furnished. Positions are relative to the middle of its floor.
struct Corner<'a> {
    floor: Vec3,
    dice: &'a mut Dice,
    wishes: &'a mut Vec<Wish>,
}

impl Corner<'_> {
    fn add(&mut self, part: Part, [x, y, z]: [f32; 3], turn: Turn, color: [u8; 3]) {
        let color = aged(color, self.dice);
        self.wishes.push((part, at(self.floor + Vec3::new(x, y, z), turn, 1.0), color));
    }

    /// The same, a little larger or smaller than drawn.
    fn sized(&mut self, part: Part, [x, y, z]: [f32; 3], color: [u8; 3], least: f32) {
        let scale = self.dice.range(least, 1.0);
        let turn = self.any_turn();
        let color = aged(color, self.dice);
        self.wishes.push((part, at(self.floor + Vec3::new(x, y, z), turn, scale), color));
    }

    fn any_turn(&mut self) -> Turn {
        Turn::Yaw(self.dice.below(4))
    }

    fn paint(&mut self) -> [u8; 3] {
        any(&PIPES, self.dice)
    }

    /// A pipe from floor to ceiling with a valve on it, near a wall.
    fn riser(&mut self, x: f32, z: f32) {
        let color = self.paint();
        let (riser, valve) = if self.dice.chance(0.5) {
            (Part::RiserSmall, Part::ValveSmall)
        } else {
            (Part::RiserMedium, Part::ValveMedium)
        };
        self.add(riser, [x, 0.5 * CLEAR, z], Turn::Upright, color);
        if self.dice.chance(0.7) {
            // The wheel points into the room.
            self.add(valve, [x, 1.3, z], if x < 0.0 { Turn::UprightEast } else { Turn::Upright }, RED);
        }
    }

    fn lamps(&mut self) {
        self.add(Part::Lamp, [0.0, CLEAR, 0.0], Turn::Yaw(0), WHITE);
    }

    fn corridor(&mut self) {
        self.lamps();
        for (x, z) in [(-2.9, -3.2), (2.9, -3.2), (-2.9, 3.2), (2.9, 3.2), (-2.0, -3.3), (2.0, 3.3)] {
            match self.dice.below(8) {
                0 | 1 => self.riser(x, z),
                2 => self.add(Part::Cabinet, [x, 0.0, z], Turn::Yaw(if z < 0.0 { 0 } else { 2 }), CABINET),
                3 => self.add(Part::Gauge, [x, 0.0, z], Turn::Yaw(0), WHITE),
                4 => self.sized(Part::Barrel, [x, 0.0, z], BLUE, 0.8),
                5 => self.sized(Part::Crate, [x, 0.0, z], WOOD, 0.6),
                _ => {}
            }
        }
    }

    fn hall(&mut self, bay: Bay) {
        if bay.k > 0 {
            return self.gallery(bay);
        }
        match (bay.i + bay.j) % 3 {
            0 => self.add(Part::Turbine, [0.0, 0.0, -1.6], Turn::Yaw(0), MACHINE),
            1 => self.add(Part::Generator, [0.0, 0.0, -1.6], Turn::Yaw(0), BLUE),
            _ => {
                for x in [-2.2, 0.8] {
                    self.add(Part::Pump, [x, 0.0, -1.8], Turn::Yaw(1), GREEN);
                }
            }
        }
        for x in [-0.25, 0.25] {
            self.add(Part::Railing, [x * BAY, 0.0, 2.6], Turn::Yaw(0), YELLOW);
        }
        self.add(Part::PipeLarge, [0.0, 0.7, 3.2], Turn::Yaw(0), RED);
        self.add(Part::ValveMedium, [-2.0, 0.5, -3.4], Turn::Yaw(0), RED);
        self.sized(Part::Gauge, [3.2, 0.0, 2.2], WHITE, 0.8);
    }

    /// A walkway along one side of the hall, pipes along the other, and the crane.
    fn gallery(&mut self, bay: Bay) {
        let quarter = 0.25 * BAY;
        if bay.j == 0 {
            for x in [-quarter, quarter] {
                self.add(Part::Grating, [x, 0.0, -quarter], Turn::Yaw(0), GALVANISED);
                self.add(Part::Railing, [x, 0.0, 0.0], Turn::Yaw(0), YELLOW);
            }
            self.riser(-2.0, -3.3);
            self.add(Part::Pump, [0.0, 0.0, -2.2], Turn::Yaw(0), ORANGE);
        }
        for (side, z) in [-3.2, 3.2].into_iter().enumerate() {
            let color = PIPES[(2 * (bay.k + bay.j) as usize + side) % PIPES.len()];
            self.add(Part::PipeMedium, [0.0, 2.2, z], Turn::Yaw(0), color);
        }
        self.add(Part::Lamp, [0.0, CLEAR, 0.0], Turn::Yaw(0), WHITE);
        if bay.k == 2 && bay.i % 4 == 1 {
            self.add(Part::Crane, [0.0, 2.0, 0.0], Turn::Yaw(0), YELLOW);
        }
    }

    /// Water walls around the boiler house, platforms and stairs between them.
    fn boiler(&mut self, plan: &Plan, bay: Bay) {
        let beside = [(1, 0, 1), (-1, 0, 1), (0, 1, 0), (0, -1, 0)];
        for (di, dj, quarter) in beside {
            let next = Bay { i: bay.i + di, j: bay.j + dj, k: bay.k };
            if plan.room(next) != plan.room(bay) {
                let (x, z) = (di as f32 * 3.3, dj as f32 * 3.3);
                self.add(Part::WaterWall, [x, 0.0, z], Turn::Yaw(quarter), RUST);
            }
        }
        let half = 0.25 * BAY;
        // On the ground there is a floor already.
        let platforms = [(-half, -half), (half, -half), (-half, half), (half, half)];
        for (x, z) in platforms.into_iter().filter(|_| bay.k > 0) {
            self.add(Part::Grating, [x, 0.0, z], Turn::Yaw(0), GALVANISED);
        }
        self.add(Part::Railing, [half, 0.0, 0.3], Turn::Yaw(0), YELLOW);
        self.add(Part::Stairs, [half, 0.0, -2.6], Turn::Yaw(0), STEEL);
        self.add(Part::Stairs, [half, 2.5, -1.4], Turn::Yaw(2), STEEL);
        self.riser(2.7, 2.7);
        self.riser(-2.7, 2.7);
    }

    fn exchangers(&mut self) {
        self.lamps();
        let copper = any(&[COPPER, STEEL, RUST], self.dice);
        match self.dice.below(3) {
            0 => {
                for z in [-2.2, 0.0, 2.2] {
                    self.add(Part::BundleLong, [0.0, 0.0, z], Turn::Yaw(0), copper);
                }
            }
            1 => {
                for x in [-2.4, -0.8, 0.8, 2.4] {
                    self.add(Part::BundleTall, [x, 0.0, 0.3], Turn::Yaw(1), copper);
                }
            }
            _ => {
                for (x, z) in [(-2.0, -2.2), (1.4, -2.2), (-2.0, 0.0), (1.4, 0.0), (-2.0, 2.2), (1.4, 2.2)] {
                    self.add(Part::BundleShort, [x, 0.0, z], Turn::Yaw(0), copper);
                }
            }
        }
        self.riser(3.2, -3.2);
        self.riser(-3.3, 3.2);
        self.add(Part::Gauge, [3.3, 0.0, 1.1], Turn::Yaw(1), WHITE);
        self.add(Part::ValveMedium, [3.0, 0.45, 3.2], Turn::Yaw(0), RED);
    }

    fn pumps(&mut self) {
        self.lamps();
        for x in [-2.2, 0.2, 2.4] {
            let color = any(&[GREEN, BLUE, MACHINE], self.dice);
            self.add(Part::Pump, [x, 0.0, -1.8], Turn::Yaw(1), color);
            let pipe = self.paint();
            self.add(Part::RiserMedium, [x, 0.5 * CLEAR, -3.2], Turn::Upright, pipe);
            let turn = if x < 0.0 { Turn::UprightEast } else { Turn::Upright };
            self.add(Part::ValveMedium, [x, 1.6, -3.2], turn, RED);
        }
        self.add(Part::TankLow, [-2.0, 0.0, 2.0], Turn::Yaw(0), WHITE);
        self.add(Part::Pump, [1.6, 0.0, 2.4], Turn::Yaw(0), BLUE);
        self.add(Part::ElbowMedium, [0.2, 0.5, 2.9], Turn::Yaw(0), GREEN);
        self.add(Part::Gauge, [3.3, 0.0, 1.0], Turn::Yaw(0), WHITE);
    }

    fn vessels(&mut self) {
        self.lamps();
        if self.dice.chance(0.5) {
            for (x, z) in [(-2.0, -2.0), (1.8, -2.0), (-2.0, 1.8), (1.8, 1.8)] {
                let part = any(&[Part::TankLow, Part::TankHigh], self.dice);
                let color = any(&[WHITE, STEEL, GREEN, ORANGE], self.dice);
                self.sized(part, [x, 0.0, z], color, 0.85);
            }
        } else {
            for z in [-2.2, 0.2, 2.4] {
                self.add(Part::Drum, [0.0, 0.0, z], Turn::Yaw(0), STEEL);
                self.add(Part::ElbowLarge, [2.9, 1.0, z], Turn::Yaw(0), RUST);
            }
        }
        self.riser(3.3, 3.3);
        self.riser(-3.3, -3.3);
        for x in [-2.4, 0.0, 2.4] {
            self.add(Part::ValveSmall, [x, 0.3, 3.4], Turn::Yaw(0), BLUE);
        }
    }

    fn electrical(&mut self) {
        self.lamps();
        for z in [-2.4, 1.6] {
            for k in 0..6 {
                self.add(Part::Cabinet, [-2.6 + 1.03 * k as f32, 0.0, z], Turn::Yaw(0), CABINET);
            }
        }
        self.add(Part::CableTray, [0.0, 2.8, -2.4], Turn::Yaw(0), STEEL);
        self.add(Part::CableTray, [0.0, 2.8, 1.6], Turn::Yaw(0), STEEL);
        if self.dice.chance(0.4) {
            self.add(Part::Transformer, [0.6, 0.0, -0.4], Turn::Yaw(0), STEEL);
        }
    }

    fn store(&mut self) {
        self.lamps();
        for _ in 0..9 {
            let x = self.dice.range(-3.0, 3.0);
            let z = self.dice.range(-3.0, 3.0);
            if self.dice.chance(0.5) {
                let color = any(&[BLUE, RED, GREEN, RUST], self.dice);
                self.sized(Part::Barrel, [x, 0.0, z], color, 0.8);
            } else {
                self.sized(Part::Crate, [x, 0.0, z], WOOD, 0.6);
            }
        }
    }

    fn air(&mut self) {
        self.lamps();
        for x in [-2.0, 1.8] {
            self.add(Part::Fan, [x, 0.0, 1.0], Turn::Yaw(0), MACHINE);
        }
        self.add(Part::Duct, [0.0, 3.0, -2.6], Turn::Yaw(0), GALVANISED);
        self.add(Part::Duct, [0.0, 3.2, 0.2], Turn::Yaw(1), GALVANISED);
        self.add(Part::Fan, [0.0, 0.0, -2.4], Turn::Yaw(2), GREEN);
        self.riser(3.2, -3.2);
    }
}
