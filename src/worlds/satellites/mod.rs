//! Satellites in formation: bodies full of detailed parts, in empty space. Very many triangles, a
//! part a few hundred to a few thousand of them, and what hides a part is mostly its own satellite.
//!
//! It stands in for the satellites of Lee et al. 2021 (scene ST: many and detailed), whose text
//! gives neither counts nor a flight.

mod parts;

use glam::{Affine3A, Vec3};

use self::parts::Part;
use super::dice::Dice;
use super::{CameraPath, Model, affine, rotation};

/// Satellites at scale 1.
const SATELLITES: f64 = 80.0;
/// From satellite to satellite, in metres.
const APART: f32 = 26.0;
/// How far a satellite strays from its place in the formation, in metres, each way.
const ASTRAY: f32 = 2.0;
/// Half the body: width, height, depth, in metres.
const HALF: Vec3 = Vec3::new(1.5, 2.0, 1.5);

const FOIL: [[u8; 3]; 4] = [[212, 170, 82], [198, 152, 66], [224, 186, 104], [184, 188, 194]];
const CELLS: [u8; 3] = [38, 52, 112];
const METAL: [u8; 3] = [176, 180, 186];
const DARK: [u8; 3] = [72, 76, 84];
const WHITE: [u8; 3] = [226, 228, 230];
const COPPER: [u8; 3] = [186, 110, 66];
const BOARD: [[u8; 3]; 3] = [[52, 104, 74], [58, 70, 96], [120, 120, 126]];

/// The formation. `scale` 1 has 80 satellites of 254 parts; other scales have proportionally
/// many, but never none.
///
/// Time and memory O(objects); the meshes are shared.
///
/// # Panics
/// When `scale` is not a number above 0, or above 100.
pub fn satellites(seed: u64, scale: f32) -> Model {
    let formation = Formation::of(checked(scale));
    let mut dice = Dice::new(seed);
    let mut model = Model::new(format!("satellites, seed {seed}, scale {scale}"));
    model.meshes = Part::ALL.iter().map(|part| part.mesh()).collect();
    for n in 0..formation.count {
        let stray = dice.within(Vec3::splat(-ASTRAY), Vec3::splat(ASTRAY));
        let axes = rotation(dice.orientation());
        let craft = Craft { origin: formation.place(n) + stray, axes };
        build(&mut model, craft, &mut dice);
    }
    model
}

/// A flight through the formation, between its columns, past bodies and wings, and out again to
/// look back at all of it. It fits every seed.
///
/// # Panics
/// As [`satellites()`].
pub fn path(scale: f32) -> CameraPath {
    let formation = Formation::of(checked(scale));
    let [wide, high, deep] = formation.sides.map(|n| n as f32);
    let half = Vec3::new(wide, high, deep) * (0.5 * APART);
    // Between columns and rows there is half a place's width to all sides.
    let lane = |x: f32, y: f32, z: f32| formation.between([x, y, z]);
    let out = half.z + 1.5 * APART;
    let mut controls = vec![
        (Vec3::new(0.0, 0.6 * half.y, out), Vec3::ZERO),
        (lane(0.5, 0.5, 1.0), Vec3::ZERO),
        (lane(0.5, 0.5, 0.75), lane(0.5, 0.5, 0.5) + Vec3::new(10.0, -6.0, 0.0)),
        (lane(0.5, 0.5, 0.5), lane(0.75, 0.5, 0.5) + Vec3::new(0.0, 8.0, 6.0)),
        (lane(0.75, 0.5, 0.5), lane(0.75, 0.5, 0.25) + Vec3::new(-12.0, 0.0, 0.0)),
        (lane(0.75, 0.5, 0.25), lane(0.5, 0.5, 0.25) + Vec3::new(0.0, -8.0, 0.0)),
        (lane(0.5, 0.5, 0.25), lane(0.25, 0.5, 0.25) + Vec3::new(0.0, 0.0, 12.0)),
        (lane(0.25, 0.5, 0.25), lane(0.25, 0.5, 0.0)),
        (lane(0.25, 0.5, 0.0), Vec3::new(0.0, 0.0, -out)),
    ];
    let end = Vec3::new(-0.4 * half.x, 0.8 * half.y, -out - APART);
    controls.push((end, Vec3::ZERO));
    CameraPath::new(60.0, controls)
}

fn checked(scale: f32) -> f32 {
    assert!(scale > 0.0 && scale <= 100.0, "the scale of satellites is above 0 and at most 100, not {scale}");
    scale
}

/// Satellites side by side in a box about the origin.
#[derive(Clone, Copy, Debug)]
struct Formation {
    count: usize,
    /// Places along x, y and z.
    sides: [usize; 3],
}

impl Formation {
    fn of(scale: f32) -> Self {
        let count = (libm::round(SATELLITES * f64::from(scale)) as usize).max(1);
        let side = (libm::ceil(libm::cbrt(count as f64) - 1e-9) as usize).max(1);
        let layers = count.div_ceil(side * side);
        Self { count, sides: [side, side, layers] }
    }

    /// Where a satellite belongs.
    fn place(self, n: usize) -> Vec3 {
        let [wide, high, deep] = self.sides;
        let along = |k: usize, n: usize| APART * (k as f32 - 0.5 * (n as f32 - 1.0));
        Vec3::new(along(n % wide, wide), along(n / wide % high, high), along(n / (wide * high), deep))
    }

    /// The gap between columns, rows and layers that is nearest to so much of the way through each,
    /// 0 to 1.
    fn between(self, share: [f32; 3]) -> Vec3 {
        let gap = |share: f32, n: usize| APART * (libm::roundf(share * n as f32) - 0.5 * n as f32);
        let [x, y, z] = [0, 1, 2].map(|axis| gap(share[axis], self.sides[axis]));
        Vec3::new(x, y, z)
    }
}

/// Where a satellite is: its middle and its axes.
#[derive(Clone, Copy, Debug)]
struct Craft {
    origin: Vec3,
    axes: [Vec3; 3],
}

impl Craft {
    fn direction(self, v: Vec3) -> Vec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// A part at a place of the satellite, whose y axis points along `up`, one of the satellite's
    /// axes or against one, and whose size along each of its own axes is given.
    fn at(self, place: Vec3, up: Vec3, size: Vec3) -> Affine3A {
        let side = if up.x == 0.0 { Vec3::X } else { Vec3::Z };
        let axes = [side * size.x, up * size.y, side.cross(up) * size.z];
        affine(axes.map(|axis| self.direction(axis)), self.origin + self.direction(place))
    }
}

/// Builds one satellite: always 254 parts.
fn build(model: &mut Model, craft: Craft, dice: &mut Dice) {
    let mut put = |part: Part, place: Vec3, up: Vec3, size: Vec3, color: [u8; 3]| {
        model.place(part as usize, craft.at(place, up, size), color);
    };
    let foil = FOIL[dice.below(FOIL.len())];
    // Six sides of nine tiles, which close the body.
    for up in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let side = if up.x == 0.0 { Vec3::X } else { Vec3::Z };
        let along = side.cross(up);
        let (wide, long) = (2.0 * (side * HALF).length() / 3.0, 2.0 * (along * HALF).length() / 3.0);
        for n in 0..9 {
            let (i, j) = ((n % 3) as f32 - 1.0, (n / 3) as f32 - 1.0);
            let place = up * HALF + side * (i * wide) + along * (j * long);
            put(Part::Tile, place, up, Vec3::new(wide, 1.0, long), foil);
        }
    }
    // Along the twelve edges, two strips of rivets each.
    for (axis, side, up) in [(0, Vec3::Z, Vec3::Y), (1, Vec3::X, Vec3::Z), (2, Vec3::X, Vec3::Y)] {
        let along = Vec3::AXES[axis];
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            for half in [-0.5, 0.5] {
                let place = (side * a + up * b) * HALF + along * (half * HALF[axis]);
                put(Part::Strip, place, along, Vec3::new(1.0, HALF[axis], 1.0), METAL);
            }
        }
    }
    // Two wings of ten panels and their yokes.
    for side in [-1.0, 1.0] {
        put(Part::Yoke, Vec3::X * (side * HALF.x), Vec3::X * side, Vec3::ONE, METAL);
        for n in 0..10 {
            let place =
                Vec3::new(side * (3.1 + 1.25 * (n / 2) as f32), 1.05 * ((n % 2) as f32 - 0.5) * 2.0, 0.0);
            put(Part::Panel, place, Vec3::Z, Vec3::ONE, CELLS);
        }
    }
    put(Part::Dish, Vec3::Y * (HALF.y + 0.35), Vec3::Y, Vec3::ONE, WHITE);
    put(Part::Horn, Vec3::Y * (HALF.y + 1.1), Vec3::Y, Vec3::ONE, METAL);
    for n in 0..8 {
        let corner = Vec3::new(if n & 1 == 0 { -1.1 } else { 1.1 }, 0.0, if n & 2 == 0 { -1.1 } else { 1.1 });
        let up = if n & 4 == 0 { Vec3::NEG_Y } else { Vec3::Y };
        put(Part::Thruster, corner + up * (HALF.y + 0.05), up, Vec3::ONE, DARK);
    }
    for n in 0..15 {
        let (x, y) = (dice.range(-1.2, 1.2), dice.range(-1.7, 1.7));
        let up = if n % 2 == 0 { Vec3::Z } else { Vec3::NEG_Z };
        let part = if n < 3 { Part::Tracker } else { Part::Patch };
        put(part, Vec3::new(x, y, 0.0) + up * (HALF.z + 0.05), up, Vec3::ONE, WHITE);
    }
    // Inside, where only those see it who fly in.
    for (x, z) in [(-0.7, -0.7), (0.7, -0.7), (-0.7, 0.7), (0.7, 0.7)] {
        put(Part::Tank, Vec3::new(x, -1.8, z), Vec3::Y, Vec3::ONE, COPPER);
        put(Part::Wheel, Vec3::new(0.8 * x, -0.15, 0.8 * z), Vec3::Y, Vec3::ONE, METAL);
    }
    for n in 0..54 {
        let (shelf, at) = (n / 9, n % 9);
        let place = Vec3::new(
            0.85 * ((at % 3) as f32 - 1.0),
            0.15 + 0.28 * shelf as f32,
            0.85 * ((at / 3) as f32 - 1.0),
        );
        let high = dice.range(0.6, 1.0);
        put(Part::Unit, place, Vec3::Y, Vec3::new(1.0, high, 1.0), BOARD[dice.below(BOARD.len())]);
    }
    for _ in 0..67 {
        let place = dice.within(Vec3::new(-1.2, -1.2, -1.2), Vec3::new(0.6, 1.4, 1.2));
        let up = [Vec3::Y, Vec3::Z, Vec3::NEG_Y, Vec3::NEG_Z][dice.below(4)];
        put(Part::Cable, place, up, Vec3::ONE, if dice.chance(0.3) { COPPER } else { DARK });
    }
}
