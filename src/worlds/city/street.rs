//! The streets of a block: asphalt and kerbs always, what stands about if there is room.

use super::super::dice::Dice;
use super::parts::Part;
use super::{BLOCK, Frame, PAVEMENT, PITCH, STREET, Site, Wishes, aged, any};

const ASPHALT: [u8; 3] = [74, 76, 80];
const STONE: [u8; 3] = [158, 156, 150];
const IRON: [u8; 3] = [64, 70, 72];
const LEAVES: [[u8; 3]; 3] = [[74, 118, 62], [92, 132, 66], [64, 104, 70]];
const PAINTS: [[u8; 3]; 6] =
    [[180, 46, 44], [52, 84, 140], [210, 210, 206], [60, 62, 66], [142, 146, 150], [196, 166, 84]];

/// Where the pavement's surface is, above the street's.
pub(super) const KERB: f32 = 0.15;

/// The ground: the block with its pavements, and the streets toward −x and −z.
pub(super) fn ground(site: &mut Site, middle: Frame) {
    let half = 0.5 * (BLOCK + STREET);
    site.put(Part::Body, middle.at([0.0, -0.5, 0.0], [BLOCK, 0.5 + KERB, BLOCK]), STONE);
    site.put(Part::Body, middle.at([-half, -0.5, 0.0], [STREET, 0.5, PITCH]), ASPHALT);
    site.put(Part::Body, middle.at([0.0, -0.5, -half], [BLOCK, 0.5, STREET]), ASPHALT);
}

/// One side of a block: `side` stands in the middle of its kerb, the z axis toward the street.
/// Nothing reaches farther than three metres into the street: its middle is for those who walk.
pub(super) fn furnish(wishes: &mut Wishes, dice: &mut Dice, side: Frame) {
    let kerb = -0.5;
    let mut place = |part, x: f32, z: f32, color, dice: &mut Dice| {
        wishes.add(part, side.at([x, KERB, z], [1.0; 3]), aged(color, dice));
    };
    for n in 0..4 {
        place(Part::Lamp, -25.5 + 17.0 * n as f32, kerb, IRON, dice);
    }
    for n in 0..7 {
        let x = -28.0 + 9.0 * n as f32 + dice.range(-1.0, 1.0);
        match dice.below(10) {
            0..5 => place(Part::Tree, x, kerb - 0.4, any(&LEAVES, dice), dice),
            5 | 6 => place(Part::Bench, x, kerb - 0.3, [120, 88, 58], dice),
            7 => place(Part::Planter, x, kerb - 0.3, [96, 120, 80], dice),
            8 => place(Part::Kiosk, x, -1.6, [70, 110, 90], dice),
            _ => place(Part::Sign, x, kerb, [196, 60, 50], dice),
        }
        if dice.chance(0.5) {
            place(Part::Bin, x + 2.2, kerb, IRON, dice);
        }
    }
    for end in [-1.0, 1.0] {
        for n in 0..3 {
            place(Part::Bollard, end * (33.0 - 1.2 * n as f32), kerb + 0.2, IRON, dice);
        }
        place(Part::Sign, end * 31.0, kerb - 0.6, [70, 96, 150], dice);
    }
    for n in 0..9 {
        if dice.chance(0.7) {
            let (part, color) = (if dice.chance(0.85) { Part::Car } else { Part::Van }, any(&PAINTS, dice));
            let at = [-26.0 + 6.5 * n as f32 + dice.range(-0.6, 0.6), 0.0, 1.3];
            wishes.add(part, side.across(at, [1.0; 3]), aged(color, dice));
        }
    }
}

/// The courtyard: trees and benches.
pub(super) fn courtyard(wishes: &mut Wishes, dice: &mut Dice, middle: Frame) {
    let half = 0.25 * (BLOCK - 2.0 * PAVEMENT) - 1.5;
    for n in 0..10 {
        let at = [dice.range(-half, half), KERB, dice.range(-half, half)];
        let tall = dice.range(0.7, 1.6);
        if n < 7 {
            wishes.add(Part::Tree, middle.at(at, [tall; 3]), aged(any(&LEAVES, dice), dice));
        } else {
            wishes.add(Part::Bench, middle.at(at, [1.0; 3]), aged([120, 88, 58], dice));
        }
    }
}
