//! A city: blocks of houses around courtyards, towers toward the middle, and streets full of small
//! things. Very many objects of very few triangles, and from the street hardly any of them visible.
//!
//! It stands in for the city models of the field (Vienna and Pompeii in Mattausch et al. 2008, the
//! low-polygon city of Lee et al. 2021): a walk along its streets sees a façade or two, until a corner
//! or a gap between houses opens a whole street at once; above the roofs, the whole city lies open.

mod block;
mod house;
mod parts;
mod street;
mod walk;

use glam::{Affine3A, Vec3};

use self::parts::Part;
use super::dice::Dice;
use super::{CameraPath, Model, affine};

/// The side of a block, from kerb to kerb, in metres.
const BLOCK: f32 = 68.0;
/// From kerb to kerb across a street.
const STREET: f32 = 14.0;
/// From block to block.
const PITCH: f32 = BLOCK + STREET;
/// The width of a pavement.
const PAVEMENT: f32 = 4.0;
/// The side of a lot: four along each side of a block, and a courtyard in the middle.
const LOT: f32 = (BLOCK - 2.0 * PAVEMENT) / 4.0;

/// Objects at scale 1.
const OBJECTS: f64 = 200_000.0;
/// Objects that a block has room for, with some to spare.
const A_BLOCK: f64 = 265.0;

/// The city. `scale` 1 has 200 000 objects; other scales have `(200 000 × scale).round()`, in
/// proportionally many blocks of the same metres, but never fewer than the bare houses and streets
/// of 4 × 4 blocks need (about 1500).
///
/// Time and memory O(objects); the meshes are shared.
///
/// # Panics
/// When `scale` is not a number above 0, or above 100.
pub fn city(seed: u64, scale: f32) -> Model {
    let grid = Grid::of(checked(scale));
    let mut dice = Dice::new(seed);
    let mut site = Site::new(&format!("city, seed {seed}, scale {scale}"));
    let mut wishes = Wishes(Vec::new());
    for (i, j) in grid.blocks() {
        block::build(&mut site, &mut wishes, &mut dice, grid, (i, j));
    }
    // What remains to be placed, in random order, until the number is full.
    dice.shuffle(&mut wishes.0);
    let wanted = libm::round(OBJECTS * f64::from(scale)) as usize;
    let room = wanted.saturating_sub(site.model.objects.len());
    for (part, at, color) in wishes.0.into_iter().take(room) {
        site.put(part, at, color);
    }
    site.model
}

/// A walk at the height of the eyes: along streets, around corners, past gaps between the houses,
/// and up above the roofs at the end. It fits every seed.
///
/// # Panics
/// As [`city()`].
pub fn path(scale: f32) -> CameraPath {
    walk::walk(Grid::of(checked(scale)))
}

/// The same streets at a run: twice backwards, with quick turns that show what was behind.
///
/// # Panics
/// As [`city()`].
pub fn fast_path(scale: f32) -> CameraPath {
    walk::run(Grid::of(checked(scale)))
}

fn checked(scale: f32) -> f32 {
    assert!(scale > 0.0 && scale <= 100.0, "a city's scale is above 0 and at most 100, not {scale}");
    scale
}

/// How many blocks there are, along x and along z.
#[derive(Clone, Copy, Debug)]
struct Grid {
    wide: usize,
    deep: usize,
}

impl Grid {
    fn of(scale: f32) -> Self {
        let blocks = OBJECTS * f64::from(scale) / A_BLOCK;
        let wide = (libm::sqrt(blocks) as usize).max(4);
        Self { wide, deep: ((blocks / wide as f64) as usize).max(4) }
    }

    fn blocks(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.wide * self.deep).map(move |n| (n % self.wide, n / self.wide))
    }

    /// The middle of a block. The middle of the city is the origin.
    fn center(self, (i, j): (usize, usize)) -> Vec3 {
        let along = |k: usize, n: usize| PITCH * (k as f32 - 0.5 * (n as f32 - 1.0));
        Vec3::new(along(i, self.wide), 0.0, along(j, self.deep))
    }

    /// The crossing before a block: toward −x and −z. There is one more of them than of blocks.
    fn crossing(self, at: (usize, usize)) -> Vec3 {
        self.center(at) - Vec3::new(0.5 * PITCH, 0.0, 0.5 * PITCH)
    }

    /// How near to the middle of the city a block is: 0 in a corner, 1 in the middle.
    fn nearness(self, block: (usize, usize)) -> f32 {
        let at = self.center(block).abs() / self.crossing((0, 0)).abs();
        1.0 - at.x.max(at.z)
    }
}

/// The model in the making.
struct Site {
    model: Model,
}

impl Site {
    fn new(name: &str) -> Self {
        let mut model = Model::new(name);
        model.meshes = Part::ALL.iter().map(|part| part.mesh()).collect();
        Self { model }
    }

    fn put(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        self.model.place(part as usize, at, color);
    }
}

/// What may be placed: part, place and paint.
struct Wishes(Vec<(Part, Affine3A, [u8; 3])>);

impl Wishes {
    fn add(&mut self, part: Part, at: Affine3A, color: [u8; 3]) {
        self.0.push((part, at, color));
    }
}

/// A place in the city: quarter turns about y, exact, about a corner of the world.
#[derive(Clone, Copy, Debug)]
struct Frame {
    origin: Vec3,
    x: Vec3,
    z: Vec3,
}

impl Frame {
    /// Turned so that its z axis points along −z, x, z, −x, for 0 to 3 quarters: toward the street.
    fn new(origin: Vec3, quarters: usize) -> Self {
        let (x, z) = match quarters % 4 {
            0 => (Vec3::NEG_X, Vec3::NEG_Z),
            1 => (Vec3::NEG_Z, Vec3::X),
            2 => (Vec3::X, Vec3::Z),
            _ => (Vec3::Z, Vec3::NEG_X),
        };
        Self { origin, x, z }
    }

    /// A part at a place of this frame, stretched along the frame's axes.
    fn at(self, [x, y, z]: [f32; 3], [sx, sy, sz]: [f32; 3]) -> Affine3A {
        let origin = self.origin + self.x * x + Vec3::Y * y + self.z * z;
        affine([self.x * sx, Vec3::Y * sy, self.z * sz], origin)
    }

    /// The same, with a quarter turn more about y: the part's z axis along the frame's x.
    fn across(self, at: [f32; 3], size: [f32; 3]) -> Affine3A {
        let origin = self.origin + self.x * at[0] + Vec3::Y * at[1] + self.z * at[2];
        affine([self.z * -size[0], Vec3::Y * size[1], self.x * size[2]], origin)
    }
}

/// A colour a little lighter or darker.
fn aged(color: [u8; 3], dice: &mut Dice) -> [u8; 3] {
    let shade = dice.below(33) as i32 - 18;
    color.map(|c| (i32::from(c) + shade).clamp(0, 255) as u8)
}

/// One of several.
fn any<T: Copy>(of: &[T], dice: &mut Dice) -> T {
    of[dice.below(of.len())]
}
