//! A factory: one wide hall of production cells between aisles, cut into departments by walls.
//! Many detailed objects side by side; what hides them are walls, racks and the machines in front.
//!
//! It stands in for the factory of Lee et al. 2021 (scene FC: wide and detailed), whose text gives
//! neither counts nor a flight.

mod cell;
mod parts;

use glam::{Affine3A, Vec3};

use self::parts::Part;
use super::dice::Dice;
use super::{CameraPath, Model, affine};

/// The side of a production cell, in metres.
const CELL: f32 = 12.0;
/// The width of an aisle, in metres: one before each row of cells, and one every few columns.
const AISLE: f32 = 4.0;
/// Columns between two cross aisles.
const COLUMNS: usize = 5;
/// Rows of a department; a wall with doors stands after each.
const ROWS: usize = 3;
/// The height of the hall to its roof, in metres.
const HIGH: f32 = 9.0;

/// Objects at scale 1.
const OBJECTS: f64 = 16_000.0;
/// Objects of a cell with some to spare.
const A_CELL: f64 = 112.0;

/// The factory. `scale` 1 has 16 000 objects; other scales have `(16 000 × scale).round()`, in
/// proportionally many cells of the same metres, but never fewer than the bare machines of 5 × 3
/// cells need (about 900).
///
/// Time and memory O(objects); the meshes are shared.
///
/// # Panics
/// When `scale` is not a number above 0, or above 100.
pub fn factory(seed: u64, scale: f32) -> Model {
    let grid = Grid::of(checked(scale));
    let mut dice = Dice::new(seed);
    let mut model = Model::new(format!("factory, seed {seed}, scale {scale}"));
    model.meshes = Part::ALL.iter().map(|part| part.mesh()).collect();
    let mut site = Site { model, wishes: Vec::new() };
    hall(&mut site, grid);
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            cell::build(&mut site, &mut dice, grid.cell(column, row));
        }
    }
    // What remains to be placed, in random order, until the number is full.
    let Site { mut model, mut wishes } = site;
    dice.shuffle(&mut wishes);
    let wanted = libm::round(OBJECTS * f64::from(scale)) as usize;
    let room = wanted.saturating_sub(model.objects.len());
    for (part, at, color) in wishes.into_iter().take(room) {
        model.place(part as usize, at, color);
    }
    model
}

/// A way along the aisles at the height of the eyes, through the doors of a department or two, and
/// up to the crane's height at the end. It fits every seed.
///
/// # Panics
/// As [`factory()`].
pub fn path(scale: f32) -> CameraPath {
    const EYE: f32 = 1.7;
    let grid = Grid::of(checked(scale));
    let (crossings, rows) = (grid.columns.div_ceil(COLUMNS), grid.rows);
    // From crossing to crossing: cross aisle, row.
    let (across, down) = (crossings / 2, rows / 2);
    let stops = [
        (0, down),
        (across, down),
        (across, (down + ROWS).min(rows)),
        ((across + 1).min(crossings), (down + ROWS).min(rows)),
        ((across + 1).min(crossings), down.saturating_sub(1)),
        (across, down.saturating_sub(1)),
    ];
    let mut eyes: Vec<Vec3> = Vec::new();
    for pair in stops.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(|(i, j)| grid.crossing(i, j) + Vec3::Y * EYE);
        let steps = libm::ceilf(from.distance(to) / 15.0) as usize;
        eyes.extend((0..steps).map(|n| from + (to - from) * (n as f32 / steps as f32)));
    }
    let last = grid.crossing(stops[stops.len() - 1].0, stops[stops.len() - 1].1);
    eyes.extend([1.7, 3.5, 5.0, 6.0].map(|y| last + Vec3::Y * y));
    let ahead = |n: usize| {
        let way = eyes[(n + 2).min(eyes.len() - 1)] - eyes[n];
        let flat = Vec3::new(way.x, 0.0, way.z).normalize_or(Vec3::X);
        eyes[n] + flat * 12.0 - Vec3::Y * (0.5 * (eyes[n].y - EYE))
    };
    CameraPath::new(60.0, (0..eyes.len()).map(|n| (eyes[n], ahead(n))))
}

fn checked(scale: f32) -> f32 {
    assert!(scale > 0.0 && scale <= 100.0, "a factory's scale is above 0 and at most 100, not {scale}");
    scale
}

/// How many cells there are, along x and along z.
#[derive(Clone, Copy, Debug)]
struct Grid {
    columns: usize,
    rows: usize,
}

impl Grid {
    fn of(scale: f32) -> Self {
        let cells = OBJECTS * f64::from(scale) / A_CELL;
        let columns = (libm::sqrt(1.6 * cells) as usize).max(COLUMNS);
        Self { columns, rows: ((cells / columns as f64) as usize).max(ROWS) }
    }

    /// The hall's width, with an aisle at either end.
    fn wide(self) -> f32 {
        self.columns as f32 * CELL + (self.columns.div_ceil(COLUMNS) + 1) as f32 * AISLE
    }

    /// The hall's depth, likewise.
    fn deep(self) -> f32 {
        self.rows as f32 * (CELL + AISLE) + AISLE
    }

    /// The corner of the hall toward −x and −z; its middle is the origin.
    fn corner(self) -> Vec3 {
        Vec3::new(-0.5 * self.wide(), 0.0, -0.5 * self.deep())
    }

    /// The middle of a cell, on the floor.
    fn cell(self, column: usize, row: usize) -> Vec3 {
        let x = (column as f32 + 0.5) * CELL + (column / COLUMNS + 1) as f32 * AISLE;
        let z = (row as f32 + 0.5) * CELL + (row + 1) as f32 * AISLE;
        self.corner() + Vec3::new(x, 0.0, z)
    }

    /// Where the aisle before a row meets a cross aisle; there is one more of each at the end.
    fn crossing(self, across: usize, row: usize) -> Vec3 {
        let columns = (across * COLUMNS).min(self.columns);
        let x = columns as f32 * CELL + (across as f32 + 0.5) * AISLE;
        let z = row as f32 * (CELL + AISLE) + 0.5 * AISLE;
        self.corner() + Vec3::new(x, 0.0, z)
    }
}

/// The model in the making, and what may be placed.
struct Site {
    model: Model,
    wishes: Vec<(Part, Affine3A, [u8; 3])>,
}

impl Site {
    fn put(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        self.model.place(part as usize, at, color);
    }

    fn wish(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        self.wishes.push((part, at, color));
    }
}

/// A part at a place, turned by quarters about y and stretched along its own axes.
fn stood(at: Vec3, quarters: usize, [sx, sy, sz]: [f32; 3]) -> Affine3A {
    let (x, z) = match quarters % 4 {
        0 => (Vec3::X, Vec3::Z),
        1 => (Vec3::NEG_Z, Vec3::X),
        2 => (Vec3::NEG_X, Vec3::NEG_Z),
        _ => (Vec3::Z, Vec3::NEG_X),
    };
    affine([x * sx, Vec3::Y * sy, z * sz], at)
}

const FLOOR: [u8; 3] = [128, 132, 134];
const STEEL: [u8; 3] = [150, 156, 164];
const PAINT: [u8; 3] = [206, 208, 204];

/// Floor, roof, outer walls, columns, trusses, lamps, and the walls between departments.
fn hall(site: &mut Site, grid: Grid) {
    let (wide, deep) = (grid.wide(), grid.deep());
    for row in 0..=grid.rows {
        let z = grid.crossing(0, row).z - 0.5 * AISLE;
        let long = if row < grid.rows { CELL + AISLE } else { AISLE };
        let at = Vec3::new(0.0, 0.0, z + 0.5 * long);
        site.put(Part::Body, stood(at - Vec3::Y * 0.2, 0, [wide, 0.2, long]), FLOOR);
        site.put(Part::Body, stood(at + Vec3::Y * HIGH, 0, [wide, 0.2, long]), PAINT);
    }
    for (x, quarters, length) in [(-0.5 * wide, 1, deep), (0.5 * wide, 1, deep)] {
        site.put(Part::Body, stood(Vec3::X * x, quarters, [length, HIGH, 0.3]), PAINT);
    }
    for z in [-0.5 * deep, 0.5 * deep] {
        site.put(Part::Body, stood(Vec3::Z * z, 0, [wide, HIGH, 0.3]), PAINT);
    }
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let middle = grid.cell(column, row);
            let half = 0.5 * CELL;
            site.put(Part::Column, stood(middle + Vec3::new(-half, 0.0, -half), 0, [1.0; 3]), STEEL);
            site.put(Part::Truss, stood(middle + Vec3::new(-half, HIGH - 1.2, 0.0), 1, [1.0; 3]), STEEL);
            site.put(Part::Lamp, stood(middle + Vec3::Y * (HIGH - 1.6), 0, [1.0; 3]), [240, 238, 220]);
            // Behind the last row of a department, a wall; the doors are where cross aisles are.
            if (row + 1) % ROWS == 0 && row + 1 < grid.rows {
                let at = middle + Vec3::Z * (half + 0.1);
                site.put(Part::Wall, stood(at, 0, [CELL, HIGH, 1.0]), PAINT);
            }
        }
    }
}
