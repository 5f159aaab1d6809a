//! Production cells: presses, robots, storage, vessels with their pipes, and benches.

use glam::Vec3;

use super::super::dice::Dice;
use super::parts::Part;
use super::{Site, stood};

const YELLOW: [u8; 3] = [222, 176, 46];
const ORANGE: [u8; 3] = [226, 112, 38];
const GREEN: [u8; 3] = [84, 124, 104];
const BLUE: [u8; 3] = [70, 104, 150];
const GREY: [u8; 3] = [142, 148, 154];
const DARK: [u8; 3] = [74, 78, 84];
const WOOD: [u8; 3] = [176, 140, 96];
const BOXES: [[u8; 3]; 5] = [WOOD, [150, 118, 82], [94, 122, 156], [176, 72, 60], [96, 136, 90]];

/// Builds one cell about the middle of its floor.
pub(super) fn build(site: &mut Site, dice: &mut Dice, middle: Vec3) {
    let kind = dice.below(6);
    let mut cell = Cell { site, dice, middle };
    cell.services();
    match kind {
        0 => cell.press(),
        1 => cell.robots(),
        2 | 3 => cell.storage(),
        4 => cell.vessels(),
        _ => cell.benches(),
    }
    cell.clutter();
}

struct Cell<'a> {
    site: &'a mut Site,
    dice: &'a mut Dice,
    middle: Vec3,
}

impl Cell<'_> {
    /// Always there; `quarters` turns it about y.
    fn put(&mut self, part: Part, [x, y, z]: [f32; 3], quarters: usize, color: [u8; 3]) {
        self.site.put(part, stood(self.middle + Vec3::new(x, y, z), quarters, [1.0; 3]), color);
    }

    /// There if there is room.
    fn wish(&mut self, part: Part, [x, y, z]: [f32; 3], quarters: usize, color: [u8; 3]) {
        self.site.wish(part, stood(self.middle + Vec3::new(x, y, z), quarters, [1.0; 3]), color);
    }

    fn any_box(&mut self) -> [u8; 3] {
        BOXES[self.dice.below(BOXES.len())]
    }

    /// Pipes and cable trays below the roof, a cabinet, a fence on the two sides that are no aisle.
    fn services(&mut self) {
        for n in 0..3 {
            let x = 4.0 * (n as f32 - 1.0);
            self.put(Part::Tray, [x, 6.9, -4.2], 0, GREY);
            for z in [-3.4, -2.8] {
                self.put(Part::Pipe, [x, 7.2, z], 0, if z < -3.0 { GREEN } else { GREY });
            }
        }
        self.wish(Part::Valve, [1.0, 7.2, -2.8], 0, ORANGE);
        self.put(Part::Cabinet, [-5.2, 0.0, -5.0], 1, GREY);
        for n in 0..4 {
            self.wish(Part::Fence, [-5.9, 0.0, 3.0 * (n as f32 - 1.5)], 1, YELLOW);
        }
    }

    fn press(&mut self) {
        for x in [-2.6, 2.6] {
            self.put(Part::Press, [x, 0.0, -1.0], 0, GREEN);
            self.put(Part::Flywheel, [x, 3.4, -2.1], 0, DARK);
            self.put(Part::Motor, [x, 3.9, 0.2], 0, BLUE);
            for (dx, z) in [(-0.8, -1.6), (0.8, -1.6), (-0.8, -0.4), (0.8, -0.4)] {
                self.put(Part::Piston, [x + dx, 1.2, z], 0, GREY);
            }
            self.put(Part::Cabinet, [x, 0.0, 2.4], 2, GREY);
            for n in 0..2 {
                self.put(Part::Conveyor, [x, 0.0, 1.2 + 2.1 * n as f32], 1, DARK);
            }
            self.stack([x + 0.4, 0.0, 4.9], 3);
        }
        for n in 0..4 {
            self.put(Part::Fence, [3.0 * (n as f32 - 1.5), 0.0, -3.6], 0, YELLOW);
        }
    }

    fn robots(&mut self) {
        for (x, z) in [(-3.0, -2.5), (3.0, -2.5), (-3.0, 2.5), (3.0, 2.5)] {
            self.put(Part::RobotBase, [x, 0.0, z], 0, ORANGE);
            let quarters = self.dice.below(4);
            self.put(Part::RobotArm, [x, 0.9, z], quarters, ORANGE);
            self.put(Part::Gripper, [x, 2.6, z], quarters, DARK);
            self.put(Part::Cabinet, [x + 1.4, 0.0, z + 1.0], 1, GREY);
        }
        for n in 0..5 {
            self.put(Part::Conveyor, [2.1 * (n as f32 - 2.0), 0.0, 0.0], 0, DARK);
            let color = self.any_box();
            self.put(Part::Crate, [2.1 * (n as f32 - 2.0), 0.82, 0.0], 0, color);
            for z in [-5.2, 5.2] {
                self.put(Part::Fence, [2.3 * (n as f32 - 2.0), 0.0, z], 0, YELLOW);
            }
        }
    }

    /// Racks in two double rows, nearly full.
    fn storage(&mut self) {
        for z in [-4.0, -2.4, 2.4, 4.0] {
            for x in [-2.8, 2.8] {
                self.put(Part::Rack, [x, 0.0, z], 0, BLUE);
                for shelf in 0..4 {
                    for place in 0..4 {
                        let at = [x + 1.25 * (place as f32 - 1.5), 0.12 + 1.4 * shelf as f32, z];
                        let part = if self.dice.chance(0.3) { Part::Drum } else { Part::Crate };
                        let color = self.any_box();
                        if self.dice.chance(0.7) {
                            self.put(part, at, 0, color);
                        } else {
                            self.wish(part, at, 0, color);
                        }
                    }
                }
            }
        }
    }

    fn vessels(&mut self) {
        for (n, (x, z)) in
            [(-3.4, -2.4), (0.0, -2.4), (3.4, -2.4), (-1.7, 2.2), (1.7, 2.2)].into_iter().enumerate()
        {
            self.put(Part::Vessel, [x, 0.0, z], 0, GREY);
            self.put(Part::Elbow, [x, 4.6, z], n, GREEN);
            for k in 0..3 {
                let y = 0.5 + 0.4 * k as f32;
                self.put(Part::Pipe, [x, y, z + 1.5], 0, GREEN);
                self.put(Part::Valve, [x + 0.9, y, z + 1.5], 0, ORANGE);
            }
            self.put(Part::Motor, [x, 0.35, z - 1.7], 0, BLUE);
        }
        for n in 0..8 {
            let at = [1.3 * (n as f32 - 3.5), 0.0, 4.9];
            self.put(Part::Drum, at, 0, BLUE);
        }
    }

    fn benches(&mut self) {
        for n in 0..8 {
            let (x, z) = (3.0 * ((n % 4) as f32 - 1.5), if n < 4 { -2.0 } else { 2.6 });
            self.put(Part::Bench, [x, 0.0, z], 0, WOOD);
            self.put(Part::Lathe, [x, 0.9, z], 0, GREEN);
            for k in 0..4 {
                let at = [x + 0.5 * (k as f32 - 1.5), 0.92, z + 0.3];
                self.wish(Part::Tool, at, k, DARK);
            }
            self.put(Part::Cabinet, [x + 1.1, 0.0, z - 1.3], 0, GREY);
        }
    }

    /// A pallet with crates on it.
    fn stack(&mut self, [x, y, z]: [f32; 3], high: usize) {
        self.put(Part::Pallet, [x, y, z], 0, WOOD);
        for n in 0..high {
            let color = self.any_box();
            self.put(Part::Crate, [x, y + 0.15 + 0.82 * n as f32, z], 0, color);
        }
    }

    /// Small things anywhere on the floor, as far as there is room for them.
    fn clutter(&mut self) {
        const SMALL: [(Part, [u8; 3]); 5] = [
            (Part::Drum, BLUE),
            (Part::Crate, WOOD),
            (Part::Pallet, WOOD),
            (Part::Tool, DARK),
            (Part::Motor, GREEN),
        ];
        for _ in 0..48 {
            let (part, color) = SMALL[self.dice.below(SMALL.len())];
            let (x, z) = (self.dice.range(-5.0, 5.0), self.dice.range(-5.2, 5.2));
            let quarters = self.dice.below(4);
            self.wish(part, [x, 0.0, z], quarters, color);
        }
    }
}
