//! The list of parts, and the paint.

use super::super::dice::Dice;
use super::{BAY, CLEAR, parts, pipework, structure};
use crate::scene::mesh::Mesh;

parts! {
    Slab => structure::slab(),
    Ground => structure::ground(),
    Wall => structure::wall(),
    WallDoor => structure::wall_with_door(),
    WallGate => structure::wall_with_gate(),
    WallWindows => structure::wall_with_windows(),
    Column => structure::column(),
    Beam => structure::beam(),
    Crane => structure::crane(),
    PipeSmall => pipework::pipe("small pipe", 0.1, BAY),
    PipeMedium => pipework::pipe("medium pipe", 0.22, BAY),
    PipeLarge => pipework::pipe("large pipe", 0.45, BAY),
    RiserSmall => pipework::pipe("small riser", 0.1, CLEAR),
    RiserMedium => pipework::pipe("medium riser", 0.22, CLEAR),
    ElbowMedium => pipework::elbow("medium elbow", 0.22),
    ElbowLarge => pipework::elbow("large elbow", 0.45),
    ValveSmall => pipework::valve("small valve", 0.1),
    ValveMedium => pipework::valve("medium valve", 0.22),
    Gauge => pipework::gauge(),
    BundleLong => parts::bundle("long bundle", [14, 13], 6.0, 0.1),
    BundleTall => parts::bundle("tall bundle", [20, 10], 4.5, 0.1),
    BundleShort => parts::bundle("short bundle", [11, 11], 2.6, 0.09),
    WaterWall => parts::water_wall(CLEAR),
    TankLow => parts::tank("low tank", 1.1, 3.0),
    TankHigh => parts::tank("high tank", 0.9, 4.2),
    Drum => parts::drum(0.9, 5.0),
    Pump => parts::pump(),
    Turbine => parts::turbine(),
    Generator => parts::generator(),
    Fan => parts::fan(),
    Grating => parts::grating(),
    Railing => parts::railing(),
    Stairs => parts::stairs(2.5),
    CableTray => parts::cable_tray(),
    Cabinet => parts::cabinet(),
    Barrel => parts::barrel(),
    Crate => parts::crate_of_boards(),
    Duct => parts::duct(),
    Lamp => parts::lamp(),
    Transformer => parts::transformer(),
    StorageTank => parts::storage_tank(),
    ChimneyRing => parts::chimney_ring(),
    Tower0 => parts::tower_patch(0),
    Tower1 => parts::tower_patch(1),
    Tower2 => parts::tower_patch(2),
    Tower3 => parts::tower_patch(3),
    Tower4 => parts::tower_patch(4),
}

/// The rings of a cooling tower, from the ground up.
pub(super) const TOWER: [Part; parts::TOWER_RINGS] =
    [Part::Tower0, Part::Tower1, Part::Tower2, Part::Tower3, Part::Tower4];

pub(super) const CONCRETE: [u8; 3] = [168, 166, 160];
pub(super) const FLOOR: [u8; 3] = [142, 146, 148];
pub(super) const PLASTER: [u8; 3] = [206, 202, 188];
pub(super) const FACADE: [u8; 3] = [176, 190, 198];
pub(super) const GROUND: [u8; 3] = [118, 122, 104];
pub(super) const STEEL: [u8; 3] = [136, 144, 154];
pub(super) const GALVANISED: [u8; 3] = [178, 184, 188];
pub(super) const GIRDER: [u8; 3] = [96, 116, 136];
pub(super) const YELLOW: [u8; 3] = [236, 190, 40];
pub(super) const RED: [u8; 3] = [188, 52, 44];
pub(super) const BLUE: [u8; 3] = [52, 104, 176];
pub(super) const GREEN: [u8; 3] = [64, 138, 88];
pub(super) const ORANGE: [u8; 3] = [222, 124, 44];
pub(super) const COPPER: [u8; 3] = [184, 112, 72];
pub(super) const RUST: [u8; 3] = [134, 78, 52];
pub(super) const WHITE: [u8; 3] = [228, 228, 222];
pub(super) const MACHINE: [u8; 3] = [74, 126, 130];
pub(super) const CABINET: [u8; 3] = [188, 192, 180];
pub(super) const WOOD: [u8; 3] = [176, 138, 90];

/// What flows in a pipe gives it its colour.
pub(super) const PIPES: [[u8; 3]; 7] = [RED, BLUE, GREEN, STEEL, RUST, ORANGE, WHITE];

/// A colour a little lighter or darker, as paint ages.
pub(super) fn aged(color: [u8; 3], dice: &mut Dice) -> [u8; 3] {
    let shade = dice.below(29) as i32 - 16;
    color.map(|c| (i32::from(c) + shade).clamp(0, 255) as u8)
}

/// One of several.
pub(super) fn any<T: Copy>(of: &[T], dice: &mut Dice) -> T {
    of[dice.below(of.len())]
}
