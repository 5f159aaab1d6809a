//! Many moving things: bunnies or teapots that fly about a room and bounce off its sides.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use crate::draw::Drawable;
use crate::geom::Aabb;
use crate::scene::Bounds;
use crate::scene::mesh::Mesh;

use super::dice::Dice;
use super::{affine, rotation};

/// Copies of one mesh in free flight inside a box. They pass through each other and through
/// everything else, as in the paper; only the box's sides turn them back.
///
/// The motion uses nothing but `+ − × ÷ √`, which round alike on every machine.
#[derive(Clone, Debug)]
pub struct Swarm {
    seed: u64,
    count: usize,
    mesh: Mesh,
    room: Aabb,
}

/// The component by which [`Swarm::step`] moves an entity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The centre of the mesh's box, in metres.
    pub position: Vec3,
    /// Metres a second.
    pub velocity: Vec3,
    /// The axis of rotation times the speed, in radians a second.
    pub spin: Vec3,
    /// A unit quaternion, x y z w.
    pub orientation: [f32; 4],
    /// Metres of world space to a metre of object space.
    pub scale: f32,
}

impl Swarm {
    /// The time step that the demos use, in seconds.
    pub const STEP: f32 = 1.0 / 30.0;

    /// `count` copies of `mesh` in `room`, each 0.8 to 1.5 m tall. Nothing is spawned yet.
    pub fn new(seed: u64, count: usize, mesh: Mesh, room: Aabb) -> Self {
        Self { seed, count, mesh, room }
    }

    /// Spawns the swarm with [`Bounds`], [`Drawable`] and [`Motion`]. The first n of a larger
    /// swarm are the same as a swarm of n.
    pub fn spawn(&self, world: &mut hecs::World) {
        let mut dice = Dice::new(self.seed);
        let tall = self.mesh.bounds().size().y.max(f32::MIN_POSITIVE);
        world
            .spawn_batch((0..self.count).map(|_| {
                let motion = random_motion(&mut dice, &self.room, tall);
                let color = COATS[dice.below(COATS.len())];
                let world_from_object = motion.world_from_object(self.mesh.bounds().center());
                let bounds = self.mesh.bounds_under(&world_from_object);
                (Bounds(bounds), Drawable { mesh: self.mesh.clone(), world_from_object, color }, motion)
            }))
            .for_each(drop);
    }

    /// Moves every entity that has a [`Motion`] on by `dt` seconds and updates its transform and
    /// bounds. O(swarm); a still swarm is one that is not stepped.
    pub fn step(&self, world: &mut hecs::World, dt: f32) {
        let pivot = self.mesh.bounds().center();
        let moving = world.query_mut::<(&mut Bounds, &mut Drawable, &mut Motion)>();
        // Entities do not know of each other: the order of the work changes nothing.
        moving.into_iter_batched(BATCH).par_bridge().flatten_iter().for_each(|(bounds, drawable, motion)| {
            motion.advance(&self.room, dt);
            drawable.world_from_object = motion.world_from_object(pivot);
            bounds.0 = drawable.mesh.bounds_under(&drawable.world_from_object);
        });
    }
}

/// Entities that one thread takes at a time: tens of microseconds of work.
const BATCH: u32 = 512;

/// Fur or glaze: white, cream, brown, grey, and a few that are easily found.
const COATS: [[u8; 3]; 6] =
    [[236, 232, 224], [222, 200, 160], [150, 108, 74], [142, 142, 148], [228, 150, 160], [120, 176, 216]];

fn random_motion(dice: &mut Dice, room: &Aabb, tall: f32) -> Motion {
    let scale = dice.range(0.8, 1.5) / tall;
    // From the room's corners, so that a flat or inverted room still yields a place.
    let position = dice.within(room.min, room.max);
    let velocity = dice.direction() * dice.range(1.0, 4.0);
    let spin = dice.direction() * dice.range(0.1, 0.8);
    Motion { position, velocity, spin, orientation: dice.orientation(), scale }
}

impl Motion {
    fn advance(&mut self, room: &Aabb, dt: f32) {
        for axis in 0..3 {
            let (low, high) = (room.min[axis], room.max[axis]);
            let mut p = self.position[axis] + self.velocity[axis] * dt;
            // A mirror at each side; the clamp ends a step that is longer than the room.
            if p < low {
                p = low + (low - p);
                self.velocity[axis] = self.velocity[axis].abs();
            } else if p > high {
                p = high - (p - high);
                self.velocity[axis] = -self.velocity[axis].abs();
            }
            self.position[axis] = p.max(low).min(high);
        }
        // dq/dt = ½ ω q: one Euler step and back to unit length.
        let [x, y, z, w] = self.orientation;
        let s = self.spin * (0.5 * dt);
        self.orientation = normalized([
            x + (s.x * w + s.y * z - s.z * y),
            y + (s.y * w + s.z * x - s.x * z),
            z + (s.z * w + s.x * y - s.y * x),
            w - (s.x * x + s.y * y + s.z * z),
        ]);
    }

    /// Turns the mesh about `pivot`, a point of object space that comes to lie at the position.
    fn world_from_object(&self, pivot: Vec3) -> Affine3A {
        let axes = rotation(self.orientation).map(|axis| axis * self.scale);
        let turned = axes[0] * pivot.x + axes[1] * pivot.y + axes[2] * pivot.z;
        affine(axes, self.position - turned)
    }
}

fn normalized(q: [f32; 4]) -> [f32; 4] {
    let length = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    if length > 0.0 { q.map(|c| c / length) } else { [0.0, 0.0, 0.0, 1.0] }
}

/// The Stanford bunny with its levels of detail, from the crate's `assets` folder.
///
/// # Errors
/// [`Error::File`](crate::Error::File) when the folder is not there: outside the crate's own
/// checkout, load the file yourself with [`scene::gltf::load_mesh`](crate::scene::gltf::load_mesh).
#[cfg(feature = "gltf")]
pub fn bunny_mesh() -> Result<Mesh, crate::Error> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/bunny.glb");
    crate::scene::gltf::load_mesh(path)
}
