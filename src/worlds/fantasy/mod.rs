//! A valley out of a tale: a castle on its hill, a village, a wood, rocks and giant mushrooms. Few
//! objects, each of thousands of triangles.
//!
//! It stands in for the fantasy scene of Lee et al. 2021 (scene FN: few complex objects), whose text
//! gives neither counts nor a flight.

mod land;
mod parts;

use glam::{Affine3A, Vec3};

use self::land::Land;
use self::parts::Part;
use super::dice::Dice;
use super::shape::turn;
use super::{CameraPath, Model, affine};
use crate::geom::Aabb;

/// Objects at scale 1.
const OBJECTS: f64 = 600.0;
/// Nothing comes nearer to the camera's way than this, in metres.
const CLEAR: f32 = 1.5;
/// From the middle of the castle to its walls, in metres.
const CASTLE: f32 = 26.0;

const STONE: [u8; 3] = [158, 152, 142];
const SLATE: [u8; 3] = [92, 98, 116];
const MEADOW: [[u8; 3]; 3] = [[104, 138, 74], [112, 146, 82], [98, 130, 70]];
const LEAVES: [[u8; 3]; 4] = [[74, 112, 58], [92, 128, 60], [118, 132, 62], [62, 98, 66]];
const ROCK: [[u8; 3]; 2] = [[132, 126, 120], [116, 114, 116]];
const CAPS: [[u8; 3]; 3] = [[186, 58, 52], [196, 140, 72], [144, 92, 150]];
const PLASTER: [[u8; 3]; 3] = [[214, 198, 166], [200, 176, 140], [222, 212, 190]];
const GOLD: [u8; 3] = [206, 168, 76];

/// The valley. `scale` 1 has 600 objects; other scales have `(600 × scale).round()` on
/// proportionally much land, but never fewer than the castle and 4 × 4 pieces of land need (51).
///
/// Time O(objects × the length of the camera's way): nothing is placed in it. The meshes are
/// shared, but for the land.
///
/// # Panics
/// When `scale` is not a number above 0, or above 100.
pub fn fantasy(seed: u64, scale: f32) -> Model {
    let land = Land::of(checked(scale));
    let mut dice = Dice::new(seed);
    let mut model = Model::new(format!("fantasy, seed {seed}, scale {scale}"));
    model.meshes = Part::ALL.iter().map(|part| part.mesh()).collect();
    for (mesh, place) in land.pieces() {
        model.meshes.push(mesh);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        model.place(model.meshes.len() - 1, affine(axes, place), MEADOW[dice.below(MEADOW.len())]);
    }
    castle(&mut model, &land);
    let way = path(scale);
    let eyes: Vec<Vec3> = (0..=800).map(|n| way.pose(n as f32 / 800.0).eye).collect();
    let wanted = libm::round(OBJECTS * f64::from(scale)) as usize;
    while model.objects.len() < wanted {
        let (part, at, color) = thing(&land, &mut dice);
        let bounds = model.meshes[part as usize].bounds_under(&at);
        if is_clear(&bounds, &eyes) {
            model.place(part as usize, at, color);
        }
    }
    model
}

/// A walk through the wood and the village, through the castle's gate, around its yard, and up over
/// the walls and away. It fits every seed.
///
/// # Panics
/// As [`fantasy()`].
pub fn path(scale: f32) -> CameraPath {
    const EYE: f32 = 1.8;
    let land = Land::of(checked(scale));
    let far = 0.5 * land.side() - 6.0;
    let afoot = |x: f32, z: f32| Vec3::new(x, land.height(x, z) + EYE, z);
    let ahead = |x: f32, z: f32| Vec3::new(x, land.height(x, z) + EYE + 2.0, z);
    let mut controls = vec![
        (afoot(-0.8 * far, 0.9 * far), ahead(0.0, 0.8 * far)),
        (afoot(-0.5 * far, 0.8 * far), ahead(0.0, 0.7 * far)),
        (afoot(-0.2 * far, 0.85 * far), ahead(0.2 * far, 0.7 * far)),
        (afoot(0.0, 0.8 * far), ahead(0.0, CASTLE)),
    ];
    // The last of the way up to the gate, which looks toward +z.
    for share in [0.75, 0.5, 0.25, 0.0] {
        let z = CASTLE + 4.0 + share * (0.75 * far - CASTLE - 4.0).max(0.0);
        controls.push((afoot(0.0, z), ahead(0.0, z - 20.0)));
    }
    controls.extend([
        (afoot(0.0, CASTLE), ahead(0.0, 0.0)),
        (afoot(0.0, CASTLE - 8.0), ahead(-10.0, 0.0)),
        (afoot(-9.0, 12.0), ahead(-16.0, -10.0)),
        (afoot(-12.0, 8.0), ahead(12.0, 16.0)),
        (afoot(-9.0, 12.0) + Vec3::Y * 12.0, ahead(12.0, 40.0)),
    ]);
    let over = |x: f32, z: f32, up: f32| Vec3::new(x, land.height(0.0, 0.0) + up, z);
    controls.extend([
        (over(-6.0, 18.0, 34.0), ahead(0.0, 0.7 * far)),
        (over(0.0, 0.5 * far + 20.0, 40.0), ahead(0.0, 0.0)),
        (over(0.5 * far, far, 44.0), ahead(0.0, 0.0)),
    ]);
    CameraPath::new(60.0, controls)
}

fn checked(scale: f32) -> f32 {
    assert!(scale > 0.0 && scale <= 100.0, "the scale of the valley is above 0 and at most 100, not {scale}");
    scale
}

fn is_clear(bounds: &Aabb, eyes: &[Vec3]) -> bool {
    eyes.iter().all(|&eye| bounds.distance_squared(eye) > CLEAR * CLEAR)
}

/// Turned by `k / n` of a full turn about y, and stretched.
fn turned(at: Vec3, (k, n): (usize, usize), [wide, high, deep]: [f32; 3]) -> Affine3A {
    let (cos, sin) = turn(k, n);
    affine([Vec3::new(cos, 0.0, -sin) * wide, Vec3::Y * high, Vec3::new(sin, 0.0, cos) * deep], at)
}

/// Eight towers with walls between them, a gate toward +z, the keep, and a fountain.
fn castle(model: &mut Model, land: &Land) {
    let ground = land.height(0.0, 0.0);
    let mut put = |part: Part, at: Affine3A, color| model.place(part as usize, at, color);
    let around = |k: usize, n: usize, radius: f32| {
        let (cos, sin) = turn(k, n);
        Vec3::new(radius * sin, ground, radius * cos)
    };
    for k in 0..8 {
        // Walls stand in the middle of each eighth, towers where two of them meet.
        let part = if k == 0 { Part::Gate } else { Part::Wall };
        put(part, turned(around(k, 8, CASTLE), (k, 8), [1.0; 3]), STONE);
        let corner = around(2 * k + 1, 16, CASTLE / libm::cosf(std::f32::consts::PI / 8.0));
        put(Part::Tower, turned(corner, (k, 8), [1.0; 3]), STONE);
        put(Part::Spire, turned(corner + Vec3::Y * 15.0, (k, 8), [1.0; 3]), SLATE);
    }
    let keep = Vec3::new(0.0, ground, -8.0);
    put(Part::Tower, turned(keep, (0, 1), [2.0, 1.7, 2.0]), STONE);
    put(Part::Spire, turned(keep + Vec3::Y * 25.5, (0, 1), [2.0, 1.6, 2.0]), SLATE);
    put(Part::Fountain, turned(Vec3::new(8.0, ground, 10.0), (0, 1), [1.0; 3]), STONE);
    for x in [-3.4, 3.4] {
        put(Part::Teapot, turned(Vec3::new(x, ground, CASTLE - 7.0), (1, 4), [0.4; 3]), GOLD);
    }
    for (x, z) in [(13.0, -6.0), (14.0, 2.0), (-15.0, -4.0), (-4.0, -17.0), (6.0, -17.0), (17.0, 8.0)] {
        put(Part::House, turned(Vec3::new(x, ground, z), (3, 16), [0.7; 3]), PLASTER[0]);
    }
}

/// Something that may stand anywhere outside the castle: houses near the way to the gate, the rest
/// all over the land.
fn thing(land: &Land, dice: &mut Dice) -> (Part, Affine3A, [u8; 3]) {
    let half = 0.5 * land.side() - 2.0;
    let roll = dice.unit();
    let village = roll < 0.1;
    let (x, z) = loop {
        let (x, z) = match village {
            true => (dice.range(-18.0, 18.0), dice.range(0.4 * half, 0.9 * half)),
            false => (dice.range(-half, half), dice.range(-half, half)),
        };
        if x * x + z * z > (CASTLE + 8.0) * (CASTLE + 8.0) {
            break (x, z);
        }
    };
    let (part, sink, color) = match roll {
        r if r < 0.1 => (Part::House, 0.6, PLASTER[dice.below(PLASTER.len())]),
        r if r < 0.5 => (Part::Oak, 0.4, LEAVES[dice.below(LEAVES.len())]),
        r if r < 0.72 => (Part::Fir, 0.4, LEAVES[dice.below(LEAVES.len())]),
        r if r < 0.86 => (Part::Boulder, 1.0, ROCK[dice.below(ROCK.len())]),
        _ => (Part::Mushroom, 0.2, CAPS[dice.below(CAPS.len())]),
    };
    let size = dice.range(0.7, 1.3);
    let at = Vec3::new(x, land.height(x, z) - sink, z);
    (part, turned(at, (dice.below(64), 64), [size; 3]), color)
}
