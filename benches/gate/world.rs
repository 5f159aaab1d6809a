//! Worlds of which everything is visible, and one of which little is.

use glam::{Affine3A, Vec3};
use tercet::draw::Drawable;
use tercet::geom::{View, Viewport};
use tercet::scene::Bounds;
use tercet::scene::mesh::Mesh;
use tercet::worlds::{self, Model, city};

/// What is drawn.
pub const SCREEN: Viewport = Viewport::new(640, 360);

/// A kind of world.
pub struct Kind {
    /// For the command line.
    pub name: &'static str,
    /// For the table.
    pub about: &'static str,
    build: fn() -> World,
}

/// In the order of the table.
pub const WORLDS: [Kind; 4] = [
    Kind { name: "cubes", about: "10 000 cubes side by side", build: || side_by_side(cube(), 10_000, 0.0) },
    Kind {
        name: "moving",
        about: "the same, all of them moving",
        build: || side_by_side(cube(), 10_000, 0.2),
    },
    Kind {
        name: "teapots",
        about: "100 teapots side by side",
        build: || side_by_side(worlds::teapot_mesh(), 100, 0.0),
    },
    Kind { name: "city", about: "a street of 20 000 objects", build: street },
];

/// Objects, and a camera before them.
pub struct World {
    /// The app's world.
    pub world: hecs::World,
    view: fn(usize) -> View,
    /// How far objects swing, metres.
    swing: f32,
    steps: usize,
}

impl Kind {
    /// Makes the world.
    pub fn build(&self) -> World {
        (self.build)()
    }
}

impl World {
    /// Where the camera is in a frame.
    pub fn view(&self, frame: usize) -> View {
        (self.view)(frame)
    }

    /// Moves what moves.
    pub fn step(&mut self) {
        if self.swing == 0.0 {
            return;
        }
        self.steps += 1;
        let way = if self.steps % 8 < 4 { self.swing } else { -self.swing };
        for (drawable, bounds) in self.world.query_mut::<(&mut Drawable, &mut Bounds)>() {
            drawable.world_from_object.translation.y += 0.25 * way;
            bounds.0 = drawable.mesh.bounds().transformed(&drawable.world_from_object);
        }
    }
}

/// A grid of so many objects, none before another, that fills the screen.
fn side_by_side(mesh: Mesh, count: usize, swing: f32) -> World {
    let mut model = Model::new("side by side");
    let (middle, size) = (mesh.bounds().center(), mesh.bounds().size().max_element());
    model.meshes.push(mesh);
    let columns = (count as f32 * 16.0 / 9.0).sqrt().ceil();
    // The grid is 1.6 wide at a distance of 1.
    let cell = 1.6 / columns;
    for i in 0..count {
        let (column, row) = (i as f32 % columns, (i as f32 / columns).floor());
        let rows = (count as f32 / columns).ceil();
        let at = Vec3::new(column - 0.5 * (columns - 1.0), row - 0.5 * (rows - 1.0), 0.0) * 50.0 * cell;
        let scale = 50.0 * 0.6 * cell / size;
        let place = Affine3A::from_scale(Vec3::splat(scale));
        model.place(0, Affine3A::from_translation(at - middle * scale) * place, [180, 160, 140]);
    }
    let mut world = hecs::World::new();
    model.spawn(&mut world);
    let view = |_| View::look_at(Vec3::Z * 50.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    World { world, view, swing: swing * 50.0 * cell, steps: 0 }
}

fn cube() -> Mesh {
    let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    Mesh::new("cube", (0..8).map(corner).collect(), triangles).expect("a cube")
}

/// A walk along the city's streets.
fn street() -> World {
    const SCALE: f32 = 0.1;
    let mut world = hecs::World::new();
    worlds::city(1, SCALE).spawn(&mut world);
    let view = |frame| {
        let pose = city::path(SCALE).pose(0.5 * (frame as f32 / 600.0).min(1.0));
        View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, SCREEN).expect("a view")
    };
    World { world, view, swing: 0.0, steps: 0 }
}
