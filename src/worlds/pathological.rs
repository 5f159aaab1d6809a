//! Worlds that break things: every extreme that the engine must bear, one at a time.

use glam::{Affine3A, Vec3};

use super::dice::Dice;
use super::random::{cube, vessel};
use super::{Model, Placed, affine, rotation};
use crate::scene::mesh::Mesh;

/// What is wrong with a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pathology {
    /// A thousand cubes in the same place: no plane separates them.
    Coincident,
    /// Boxes of no size at all, each around a mesh that is a single point.
    Points,
    /// Boxes that hold each other and all the rest, up to a thousand times the size of the world.
    Huge,
    /// A kilometre long and a millimetre thick, in any direction, and flat sheets.
    Slivers,
    /// Coordinates to ±1e7 and sizes from 1e-6 to 1e7 metres in one scene.
    Extremes,
    /// Cubes, one inside the other: only the outermost can be seen from outside.
    Shells,
    /// Cubes on a grid: exactly on the planes that halve it lie faces along x, where the cubes
    /// touch, gaps along y, and centres along z.
    Grid,
    /// A thousand cubes behind one wall, seen from +z: one object is visible.
    OneWall,
    /// One cube.
    Single,
    /// Nothing.
    Empty,
}

impl Pathology {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Coincident,
        Self::Points,
        Self::Huge,
        Self::Slivers,
        Self::Extremes,
        Self::Shells,
        Self::Grid,
        Self::OneWall,
        Self::Single,
        Self::Empty,
    ];
}

/// A world with that pathology, always the same one. Every mesh lies within its object's bounds.
pub fn pathological(kind: Pathology) -> Model {
    let mut model = Model::new(format!("{kind:?}"));
    model.meshes = vec![cube(), vessel(), point()];
    let mut world = World { model, dice: Dice::new(kind as u64) };
    match kind {
        Pathology::Coincident => (0..1000).for_each(|_| world.exact(CUBE, Vec3::new(3.0, 1.0, -2.0))),
        Pathology::Points => world.points(),
        Pathology::Huge => world.huge(),
        Pathology::Slivers => world.slivers(),
        Pathology::Extremes => world.extremes(),
        Pathology::Shells => world.shells(),
        Pathology::Grid => world.grid(),
        Pathology::OneWall => world.one_wall(),
        Pathology::Single => world.exact(CUBE, Vec3::ZERO),
        Pathology::Empty => {}
    }
    world.model
}

const CUBE: usize = 0;
const VESSEL: usize = 1;
const POINT: usize = 2;

/// A triangle whose corners coincide: it covers no sample.
fn point() -> Mesh {
    Mesh::new("point", vec![Vec3::ZERO; 3], vec![0, 1, 2]).expect("a point is a mesh")
}

struct World {
    model: Model,
    dice: Dice,
}

impl World {
    fn color(&mut self) -> [u8; 3] {
        [0; 3].map(|_| 60 + self.dice.below(190) as u8)
    }

    fn place(&mut self, mesh: usize, axes: [Vec3; 3], position: Vec3) {
        let color = self.color();
        self.model.place(mesh, affine(axes, position), color);
    }

    fn sized(&mut self, mesh: usize, size: Vec3, position: Vec3) {
        self.place(mesh, [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z], position);
    }

    /// An object that is only shifted, by a vector that makes the sums exact in f32: its bounds
    /// need no room for rounding, and a point's box has no size.
    fn exact(&mut self, mesh: usize, shift: Vec3) {
        let color = self.color();
        let mut bounds = self.model.meshes[mesh].bounds();
        bounds.min += shift;
        bounds.max += shift;
        self.model.bounds = self.model.bounds.union(&bounds);
        let world_from_object = Affine3A::from_translation(shift);
        self.model.objects.push(Placed { mesh, world_from_object, bounds, color, not_occluder: false });
    }

    fn cubes(&mut self, count: usize, min: Vec3, max: Vec3) {
        for _ in 0..count {
            let size = self.dice.range(0.2, 1.5);
            let position = self.dice.within(min, max);
            self.sized(CUBE, Vec3::splat(size), position);
        }
    }

    fn points(&mut self) {
        for _ in 0..500 {
            let at = self.dice.within(Vec3::splat(-20.0), Vec3::splat(20.0));
            self.exact(POINT, at);
        }
        self.cubes(50, Vec3::splat(-20.0), Vec3::splat(20.0));
    }

    fn huge(&mut self) {
        self.cubes(300, Vec3::splat(-10.0), Vec3::splat(10.0));
        for n in 0..12 {
            let size = 25.0 * (1 << n) as f32;
            let offset = self.dice.within(Vec3::splat(-2.0), Vec3::splat(2.0));
            self.sized(CUBE, Vec3::splat(size), offset);
        }
    }

    fn slivers(&mut self) {
        for n in 0..400 {
            let position = self.dice.within(Vec3::splat(-50.0), Vec3::splat(50.0));
            let size = match n % 4 {
                // A sheet has no thickness, a wire neither width nor thickness.
                0 => Vec3::new(20.0, 20.0, 0.0),
                1 => Vec3::new(100.0, 0.0, 0.0),
                _ => Vec3::new(1000.0, 1e-3, 1e-3),
            };
            let [x, y, z] = rotation(self.dice.orientation());
            self.place(CUBE, [x * size.x, y * size.y, z * size.z], position);
        }
    }

    fn extremes(&mut self) {
        for _ in 0..600 {
            let far = self.power_of_ten(-6.0, 7.0);
            let size = self.power_of_ten(-6.0, 7.0);
            let position = self.dice.direction() * far;
            let mesh = if self.dice.chance(0.5) { CUBE } else { VESSEL };
            self.sized(mesh, Vec3::splat(size), position);
        }
    }

    fn power_of_ten(&mut self, low: f32, high: f32) -> f32 {
        libm::pow(10.0, f64::from(self.dice.range(low, high))) as f32
    }

    fn shells(&mut self) {
        for n in 0..60 {
            let size = libm::pow(1.25, f64::from(n)) as f32 * 0.01;
            self.sized(CUBE, Vec3::splat(size), Vec3::ZERO);
        }
    }

    fn grid(&mut self) {
        for n in 0..16 * 8 * 17 {
            let (x, y, z) = (n % 16, n / 16 % 8, n / 128);
            self.exact(CUBE, Vec3::new(x as f32 - 7.5, y as f32 * 2.0 - 7.0, z as f32 - 8.0));
        }
    }

    fn one_wall(&mut self) {
        self.sized(CUBE, Vec3::new(400.0, 400.0, 0.5), Vec3::ZERO);
        self.cubes(1000, Vec3::new(-20.0, -20.0, -40.0), Vec3::new(20.0, 20.0, -2.0));
    }
}
