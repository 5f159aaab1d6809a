//! A house on its lot: body, windows and roof always, the rest if there is room.

use super::super::dice::Dice;
use super::parts::{Part, WINDOWS};
use super::{Frame, LOT, Site, Wishes, aged, any};

const STOREY: f32 = 3.3;
/// The ground floor, with shops.
const BASE: f32 = 4.2;

const WALLS: [[u8; 3]; 9] = [
    [214, 198, 170],
    [196, 160, 124],
    [176, 108, 84],
    [206, 206, 200],
    [168, 152, 136],
    [222, 212, 186],
    [150, 92, 72],
    [184, 176, 150],
    [190, 196, 196],
];
const SHOPS: [[u8; 3]; 5] = [[92, 84, 76], [120, 104, 88], [84, 92, 96], [132, 116, 104], [100, 72, 60]];
const GLASS: [[u8; 3]; 3] = [[58, 76, 92], [70, 84, 92], [48, 62, 78]];
const TILES: [[u8; 3]; 3] = [[150, 78, 58], [124, 70, 56], [96, 92, 92]];
const CLOTH: [[u8; 3]; 4] = [[188, 52, 44], [52, 104, 156], [64, 128, 84], [226, 190, 90]];
const METAL: [u8; 3] = [156, 162, 166];
const FLAT: [u8; 3] = [118, 116, 114];

/// Builds a house in the middle of whose lot `frame` stands, its z axis toward the street;
/// `nearness` to the middle of the city, 0 to 1, makes it tall; `corner` houses have two fronts.
pub(super) fn build(
    site: &mut Site,
    wishes: &mut Wishes,
    dice: &mut Dice,
    frame: Frame,
    nearness: f32,
    corner: bool,
) {
    let tower = dice.chance(0.9 * (nearness - 0.45).max(0.0));
    let (storeys, front) = WINDOWS[if tower { 4 + dice.below(2) } else { dice.below(4) }];
    let wall = aged(any(&WALLS, dice), dice);
    let depth = if tower { LOT } else { dice.range(11.0, LOT) };
    // Houses stand at the pavement: a shallower one leaves more of the courtyard.
    let z = 0.5 * (LOT - depth);
    let high = storeys as f32 * STOREY;
    site.put(Part::Body, frame.at([0.0, 0.0, z], [LOT, BASE, depth]), any(&SHOPS, dice));
    site.put(Part::Body, frame.at([0.0, BASE, z], [LOT - 0.1, high, depth - 0.3]), wall);
    let glass = any(&GLASS, dice);
    let proud = z + 0.5 * depth - 0.15;
    site.put(front, frame.at([0.0, BASE, proud], [LOT, high, 0.06]), glass);
    site.put(front, frame.at([0.0, BASE, z - 0.5 * depth + 0.09], [LOT, high, 0.06]), glass);
    if corner || tower {
        site.put(front, frame.across([0.5 * LOT - 0.05, BASE, z], [depth - 0.3, high, 0.06]), glass);
    }
    let top = BASE + high;
    let house = House { frame, z, depth, top, proud, storeys };
    let flat = tower || dice.chance(0.6);
    if flat {
        site.put(Part::Parapet, frame.at([0.0, top, z], [LOT, 0.9, depth]), aged(wall, dice));
        house.flat_roof(wishes, dice);
    } else {
        let ridge = dice.range(2.5, 4.5);
        site.put(Part::Gable, frame.at([0.0, top, z], [LOT, ridge, depth + 0.6]), any(&TILES, dice));
        house.chimneys(wishes, dice);
    }
    house.front(wishes, dice, wall);
}

struct House {
    frame: Frame,
    /// The middle of the house, and from its front to its back.
    z: f32,
    depth: f32,
    top: f32,
    /// The front wall.
    proud: f32,
    storeys: usize,
}

impl House {
    /// What stands on a flat roof, nowhere near the edge.
    fn flat_roof(&self, wishes: &mut Wishes, dice: &mut Dice) {
        let deep = 0.5 * self.depth - 2.6;
        let mut on_roof = |part, color, dice: &mut Dice| {
            let (x, z) = (dice.range(-4.8, 4.8), self.z + dice.range(-deep, deep));
            wishes.add(part, self.frame.at([x, self.top, z], [1.0; 3]), aged(color, dice));
        };
        on_roof(Part::StairHouse, FLAT, dice);
        for _ in 0..1 + dice.below(4) {
            on_roof(Part::Cooler, METAL, dice);
        }
        for _ in 0..dice.below(3) {
            on_roof(Part::Skylight, [120, 150, 164], dice);
        }
        if dice.chance(0.35) {
            on_roof(Part::WaterTank, [132, 96, 66], dice);
        }
        on_roof(Part::Antenna, METAL, dice);
    }

    fn chimneys(&self, wishes: &mut Wishes, dice: &mut Dice) {
        for x in [-5.5, -1.5, 2.5, 6.0] {
            let z = self.z + dice.range(-2.5, 2.5);
            let at = self.frame.at([x, self.top + 1.2, z], [1.0; 3]);
            wishes.add(Part::Chimney, at, aged([140, 84, 66], dice));
        }
        wishes.add(Part::Antenna, self.frame.at([0.5, self.top + 2.0, self.z], [1.0; 3]), METAL);
    }

    /// Doors, awnings, balconies and a cornice.
    fn front(&self, wishes: &mut Wishes, dice: &mut Dice, wall: [u8; 3]) {
        let street = self.z + 0.5 * self.depth;
        let door = any(&[-5.6, 0.0, 5.6], dice);
        wishes.add(Part::Door, self.frame.at([door, 0.0, street], [1.0; 3]), aged([96, 62, 40], dice));
        for x in [-4.4, 4.4] {
            if dice.chance(0.6) {
                wishes.add(Part::Awning, self.frame.at([x, 0.0, street], [1.0; 3]), any(&CLOTH, dice));
            }
        }
        let cornice = self.frame.at([0.0, self.top - 0.5, self.proud], [LOT, 0.45, 0.6]);
        wishes.add(Part::Body, cornice, aged(wall, dice));
        let sill = self.frame.at([0.0, BASE - 0.15, self.proud], [LOT, 0.3, 0.5]);
        wishes.add(Part::Body, sill, aged(wall, dice));
        let bay = LOT / 4.0;
        for storey in 1..self.storeys.min(6) {
            for x in [-1.5, -0.5, 0.5, 1.5] {
                if dice.chance(0.12) {
                    let y = BASE + storey as f32 * STOREY;
                    wishes.add(Part::Balcony, self.frame.at([x * bay, y, self.proud], [1.0; 3]), METAL);
                }
            }
        }
    }
}
