//! A power plant: storeys of small rooms full of pipes and machines around a turbine hall and a
//! boiler house, with tanks, a chimney and cooling towers outside.
//!
//! It stands in for the UNC power plant, which most papers of the field use: about as many
//! objects and triangles, cut by a uniform grid, hardly any of it visible from any one place.

mod flight;
mod furnish;
mod outdoors;
mod parts;
mod pipework;
mod plan;
mod rack;
mod shell;
mod stock;
mod structure;

use glam::{Affine3A, Vec3};

use self::flight::Clearance;
use self::plan::{Plan, Size};
use self::stock::Part;
use super::dice::Dice;
use super::{CameraPath, Model, affine};
use crate::geom::Aabb;

/// The side of a bay, the cell of the plant's uniform grid, in metres.
const BAY: f32 = 7.5;
/// From floor to floor.
const STOREY: f32 = 5.0;
/// The thickness of a floor.
const SLAB: f32 = 0.3;
/// From floor to ceiling.
const CLEAR: f32 = STOREY - SLAB;

/// Objects at scale 1: as many as the paper's model had.
const OBJECTS: f64 = 11_050.0;

/// The plant. `scale` 1 has 11 050 objects and about 18 million triangles; other scales have
/// `(11 050 × scale).round()` objects in proportionally many bays of the same metres, but never
/// fewer than the bare building of 4 × 3 bays and 2 storeys needs (about 400).
///
/// Time and memory O(objects); the meshes are shared.
///
/// # Panics
/// When `scale` is not a number above 0, or above 1000.
pub fn power_plant(seed: u64, scale: f32) -> Model {
    let size = Size::of(checked(scale));
    let mut dice = Dice::new(seed);
    let plan = Plan::new(size, &mut dice);
    let mut site = Site::new(&format!("power plant, seed {seed}, scale {scale}"), size);
    shell::build(&mut site, &plan, &mut dice);
    outdoors::build(&mut site, size, &mut dice);
    rack::build(&mut site, &plan, &mut dice);
    // What remains to be placed, in random order, until the number is full.
    let mut wishes = furnish::wishes(&plan, &mut dice);
    dice.shuffle(&mut wishes);
    let wanted = libm::round(OBJECTS * f64::from(scale)) as usize;
    for (part, at, color) in wishes {
        if site.model.objects.len() >= wanted {
            break;
        }
        site.put(part, at, color);
    }
    site.model
}

/// The flight through a plant of this scale: outside half around it, in through the western
/// door, along the corridor, through the turbine hall, up the boiler house to a middle storey,
/// through rooms there, and out at the top. It fits every seed.
///
/// # Panics
/// As [`power_plant()`].
pub fn path(scale: f32) -> CameraPath {
    flight::flight(Size::of(checked(scale)))
}

/// The volume of the building, for things that fly about in it.
///
/// # Panics
/// As [`power_plant()`].
pub fn interior(scale: f32) -> Aabb {
    Size::of(checked(scale)).building()
}

fn checked(scale: f32) -> f32 {
    assert!(scale > 0.0 && scale <= 1000.0, "a plant's scale is above 0 and at most 1000, not {scale}");
    scale
}

/// The model in the making, and what must stay clear of objects.
struct Site {
    model: Model,
    clearance: Clearance,
}

impl Site {
    fn new(name: &str, size: Size) -> Self {
        let mut model = Model::new(name);
        model.meshes = Part::ALL.iter().map(|part| part.mesh()).collect();
        Self { model, clearance: Clearance::around(&flight::flight(size)) }
    }

    /// Places a part of the building.
    fn build(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        self.model.place(part as usize, at, color);
    }

    /// Places a part, unless it would stand in the camera's way.
    fn put(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        let bounds = self.model.meshes[part as usize].bounds().transformed(&at);
        if self.clearance.allows(&bounds) {
            self.build(part, at, color);
        }
    }
}

/// Which way a part lies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    /// Quarter turns about y: its x axis along x, −z, −x, z.
    Yaw(usize),
    /// Its x axis along y: lying things upright, their tops toward −x.
    Upright,
    /// The same, tops toward +x.
    UprightEast,
}

/// A transform without a product of matrices: quarter turns are exact.
fn at(position: Vec3, turn: Turn, scale: f32) -> Affine3A {
    let (x, y, z) = match turn {
        Turn::Yaw(quarters) => {
            let (x, z) = match quarters % 4 {
                0 => (Vec3::X, Vec3::Z),
                1 => (Vec3::NEG_Z, Vec3::X),
                2 => (Vec3::NEG_X, Vec3::NEG_Z),
                _ => (Vec3::Z, Vec3::NEG_X),
            };
            (x, Vec3::Y, z)
        }
        Turn::Upright => (Vec3::Y, Vec3::NEG_X, Vec3::Z),
        Turn::UprightEast => (Vec3::Y, Vec3::X, Vec3::NEG_Z),
    };
    affine([x * scale, y * scale, z * scale], position)
}
