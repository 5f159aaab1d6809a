//! Random objects with walls between them: small worlds for tests.

use glam::Vec3;

use super::dice::Dice;
use super::shape::{Shape, Stand, mesh};
use super::{Model, affine, rotation};
use crate::scene::mesh::Mesh;

/// `count` objects in a cube whose side grows with the cube root of the count: every twelfth is
/// a wall with a hole, long enough to hide something, the others are boxes and round bodies of
/// 0.2 to 2 m in any orientation, some with levels of detail. O(count).
pub fn random(seed: u64, count: usize) -> Model {
    let mut dice = Dice::new(seed);
    let mut model = Model::new(format!("{count} random objects, seed {seed}"));
    model.meshes = vec![wall_with_hole(), cube(), prism(), vessel(), ring()];
    let side = 4.0 * libm::cbrt(count as f64) as f32;
    for n in 0..count {
        let position = dice.within(Vec3::splat(-0.5 * side), Vec3::splat(0.5 * side));
        let color = [0; 3].map(|_| 60 + dice.below(190) as u8);
        if n % 12 == 0 {
            let size = dice.range(0.2, 0.5) * side;
            let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * size);
            let axes = if dice.chance(0.5) { [x, y, z] } else { [z, y, -x] };
            model.place(0, affine(axes, position), color);
        } else {
            let shape = 1 + dice.below(model.meshes.len() - 1);
            let size = dice.range(0.2, 2.0);
            let axes = rotation(dice.orientation()).map(|axis| axis * size);
            model.place(shape, affine(axes, position), color);
        }
    }
    model
}

/// A cube of side 1 about the origin.
pub(super) fn cube() -> Mesh {
    mesh("cube", 1, |s, _| s.cuboid(Vec3::splat(-0.5), Vec3::splat(0.5)))
}

/// A closed ball-like vessel of height and width 1 about the origin.
pub(super) fn vessel() -> Mesh {
    mesh("vessel", 3, |s, c| s.vessel(Stand::y(Vec3::NEG_Y * 0.5), 0.5, 1.0, c.segments(24)))
}

fn prism() -> Mesh {
    mesh("prism", 1, |s, _| s.cylinder(Stand::y(Vec3::NEG_Y * 0.5), 0.5, 1.0, 5))
}

fn ring() -> Mesh {
    mesh("ring", 3, |s, c| s.torus(Stand::y(Vec3::ZERO), 0.35, 0.15, [c.segments(24), c.segments(12)]))
}

/// One unit square, across z, with an opening in its middle.
fn wall_with_hole() -> Mesh {
    let thick = 0.02;
    mesh("wall with hole", 1, |s: &mut Shape, _| {
        let mut piece = |[x0, y0, x1, y1]: [f32; 4]| {
            s.cuboid(Vec3::new(x0, y0, -thick), Vec3::new(x1, y1, thick));
        };
        piece([-0.5, -0.5, 0.5, -0.1]);
        piece([-0.5, 0.1, 0.5, 0.5]);
        piece([-0.5, -0.1, -0.1, 0.1]);
        piece([0.1, -0.1, 0.5, 0.1]);
    })
}
