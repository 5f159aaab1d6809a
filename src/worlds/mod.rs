//! Seeded worlds: the same seed and scale make the same world, bit for bit, on every machine.
//!
//! Two rules keep that promise: every random number comes from a [`rand_chacha`] stream with
//! our own mapping to ranges, and every curve from [`libm`] and the four operations, which
//! round alike everywhere; glam's matrix products, which may be fused, stay out of it.

/// Declares the parts of a world once: the variants, and the list of them in order of their mesh
/// index.
macro_rules! parts {
    ($($name:ident => $mesh:expr,)*) => {
        /// A shared mesh; `as usize` is its index in the model.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Part { $($name),* }

        impl Part {
            pub(super) const ALL: &[Self] = &[$(Self::$name),*];

            /// Builds the part's mesh.
            pub(super) fn mesh(self) -> Mesh {
                match self { $(Self::$name => $mesh),* }
            }
        }
    };
}

pub mod city;
mod dice;
pub mod factory;
pub mod fantasy;
mod path;
mod pathological;
pub mod power_plant;
mod random;
pub mod satellites;
mod shape;
mod swarm;
mod teapot;
pub mod teapots;

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

use crate::draw::Drawable;
use crate::geom::Aabb;
use crate::scene::mesh::Mesh;
use crate::scene::{Bounds, NotOccluder};

pub use city::city;
pub use factory::factory;
pub use fantasy::fantasy;
pub use path::{CameraPath, Pose};
pub use pathological::{Pathology, pathological};
pub use power_plant::power_plant;
pub use random::random;
pub use satellites::satellites;
#[cfg(feature = "gltf")]
pub use swarm::bunny_mesh;
pub use swarm::{Motion, Swarm};
pub use teapot::teapot_mesh;

/// A world before it is spawned: shared meshes and the objects that use them.
#[derive(Clone, Debug)]
pub struct Model {
    /// For reports.
    pub name: String,
    /// Each is used by any number of objects.
    pub meshes: Vec<Mesh>,
    /// What stands where.
    pub objects: Vec<Placed>,
    /// The box around all objects; [`Aabb::EMPTY`] without any.
    pub bounds: Aabb,
}

/// One object of a [`Model`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Index into [`Model::meshes`].
    pub mesh: usize,
    /// Where it stands.
    pub world_from_object: Affine3A,
    /// Holds every vertex of every level as transformed in f32.
    pub bounds: Aabb,
    /// Red, green and blue, as sRGB shows them.
    pub color: [u8; 3],
    /// Whether it is spawned as a [`NotOccluder`].
    pub not_occluder: bool,
}

impl Model {
    /// A model of nothing.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), meshes: Vec::new(), objects: Vec::new(), bounds: Aabb::EMPTY }
    }

    /// Adds an object that uses a mesh already in [`Model::meshes`].
    ///
    /// # Panics
    /// When there is no such mesh.
    pub fn place(&mut self, mesh: usize, world_from_object: Affine3A, color: [u8; 3]) {
        let bounds = self.meshes[mesh].bounds_under(&world_from_object);
        self.bounds = self.bounds.union(&bounds);
        self.objects.push(Placed { mesh, world_from_object, bounds, color, not_occluder: false });
    }

    /// Triangles of all objects at full detail.
    pub fn triangles(&self) -> u64 {
        self.objects.iter().map(|o| self.meshes[o.mesh].triangle_count() as u64).sum()
    }

    /// Spawns every object with [`Bounds`], [`Drawable`] and, where it says so, [`NotOccluder`],
    /// in order.
    pub fn spawn(&self, world: &mut hecs::World) {
        world.reserve::<(Bounds, Drawable)>(self.objects.len() as u32);
        for o in &self.objects {
            let mesh = self.meshes[o.mesh].clone();
            let drawable = Drawable { mesh, world_from_object: o.world_from_object, color: o.color };
            if o.not_occluder {
                world.spawn((Bounds(o.bounds), drawable, NotOccluder));
            } else {
                world.spawn((Bounds(o.bounds), drawable));
            }
        }
    }
}

/// The axes of a rotation: the columns of the matrix of a unit quaternion, x y z w.
fn rotation([x, y, z, w]: [f32; 4]) -> [Vec3; 3] {
    [
        Vec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        Vec3::new(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        Vec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    ]
}

/// A transform from its columns, written out so that no product of matrices is involved.
fn affine(axes: [Vec3; 3], translation: Vec3) -> Affine3A {
    let [x, y, z] = axes.map(Vec3A::from);
    Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: translation.into() }
}
