//! A block: twelve lots around a courtyard, with a gap here and there.

use glam::Vec3;

use super::super::dice::Dice;
use super::{BLOCK, Frame, Grid, LOT, Site, Wishes, house, street};

/// The lots of a block, in units of half a lot from its middle, with the quarter turn toward their
/// street; corner houses have a second front, to their side.
const LOTS: [([f32; 2], usize, bool); 12] = [
    ([3.0, -3.0], 1, true),
    ([1.0, -3.0], 0, false),
    ([-1.0, -3.0], 0, false),
    ([-3.0, -3.0], 0, true),
    ([-3.0, -1.0], 3, false),
    ([-3.0, 1.0], 3, false),
    ([-3.0, 3.0], 3, true),
    ([-1.0, 3.0], 2, false),
    ([1.0, 3.0], 2, false),
    ([3.0, 3.0], 2, true),
    ([3.0, 1.0], 1, false),
    ([3.0, -1.0], 1, false),
];

/// Builds a block with its streets.
pub(super) fn build(
    site: &mut Site,
    wishes: &mut Wishes,
    dice: &mut Dice,
    grid: Grid,
    block: (usize, usize),
) {
    let center = grid.center(block);
    street::ground(site, Frame::new(center, 2));
    for ([x, z], quarters, corner) in LOTS {
        // A gap opens the view into the courtyard; corners are always built on.
        let middle = [x, z].iter().all(|c: &f32| c.abs() > 2.0);
        if !middle && dice.chance(0.08) {
            continue;
        }
        let lot = center + Vec3::new(0.5 * LOT * x, street::KERB, 0.5 * LOT * z);
        house::build(site, wishes, dice, Frame::new(lot, quarters), grid.nearness(block), corner);
    }
    for quarters in 0..4 {
        let toward = Frame::new(Vec3::ZERO, quarters).z;
        street::furnish(wishes, dice, Frame::new(center + toward * (0.5 * BLOCK), quarters));
    }
    street::courtyard(wishes, dice, Frame::new(center, 2));
}
