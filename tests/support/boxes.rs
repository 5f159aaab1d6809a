//! Worlds of boxes: each is drawn as the box that the scene is told.

use glam::{Affine3A, Quat, Vec3};
use hecs::{Entity, World};
use tercet::geom::Aabb;
use tercet::query::software::SoftwarePass;
use tercet::scene::mesh::Mesh;
use tercet::scene::{Bounds, ObjectRef};

/// Where a box is drawn: the cube from −1 to 1 under this.
pub struct Place(pub Affine3A);

impl Place {
    /// A box by its middle and its half sides.
    pub fn new(center: Vec3, half: Vec3) -> Self {
        Self(Affine3A::from_scale_rotation_translation(half, Quat::IDENTITY, center))
    }

    pub fn bounds(&self) -> Bounds {
        Bounds(Aabb::new(Vec3::NEG_ONE, Vec3::ONE).transformed(&self.0))
    }
}

/// Spawns a box.
pub fn spawn(world: &mut World, place: Place) -> Entity {
    world.spawn((place.bounds(), place))
}

/// Draws boxes.
pub fn draw(world: &World, pass: &mut SoftwarePass, objects: &[ObjectRef]) {
    for object in objects {
        let place = world.get::<&Place>(object.entity()).expect("an object that is there");
        CUBE.with(|cube| pass.draw_mesh(cube, &place.0));
    }
}

thread_local! {
    static CUBE: Mesh = cube();
}

fn cube() -> Mesh {
    let corner = |i: usize| Vec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 1.0 } else { -1.0 }));
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    Mesh::new("cube", (0..8).map(corner).collect(), triangles).expect("a cube")
}
