//! The app's world: what is in it, how it moves, who looks at it.

use std::ops::Range;

use glam::{Vec3, vec3};
use hecs::World;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::Error;
use tercet::geom::{Aabb, View, Viewport, projection};
use tercet::query::gpu::wgpu;
use tercet::scene::Bounds;

/// What the app draws for a thing. Tercet does not know this component.
pub struct Look {
    /// Vertices of the shader: a box or a ball.
    pub vertices: Range<u32>,
    /// The thing's place in the instance buffer.
    pub instance: u32,
    /// Red, green, blue, and what it is made of.
    pub paint: [u8; 4],
}

/// Metres a frame.
pub struct Velocity(Vec3);

/// Where everything fades to.
pub const HAZE: wgpu::Color = wgpu::Color { r: 0.62, g: 0.74, b: 0.88, a: 1.0 };

const BOX: Range<u32> = 0..36;
const BALL: Range<u32> = 36..36 + 6 * 64 * 6;
/// From street to street, metres.
const BLOCK: f32 = 40.0;
/// Blocks from the middle to the edge.
const BLOCKS: i32 = 9;
const HALF: f32 = BLOCKS as f32 * BLOCK;
const PLAIN: u8 = 0;
const WALL: u8 = 128;
const GROUND: u8 = 255;

/// A city: houses, parks, cars and balloons.
pub fn build() -> World {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut city = City(World::new());
    city.put(BOX, vec3(0.0, -0.5, 0.0), vec3(HALF, 0.5, HALF), [96, 118, 70, GROUND]);
    for (x, z) in (-BLOCKS..BLOCKS).flat_map(|x| (-BLOCKS..BLOCKS).map(move |z| (x, z))) {
        let middle = vec3(x as f32 + 0.5, 0.0, z as f32 + 0.5) * BLOCK;
        let is_park = rng.random_bool(0.25);
        let quarters = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        for at in quarters.map(|(x, z)| middle + 5.8 * vec3(x, 0.0, z)) {
            if is_park {
                for _ in 0..3 {
                    let around = vec3(rng.random_range(-5.0..5.0), 0.0, rng.random_range(-5.0..5.0));
                    city.tree(at + around, rng.random_range(0.8..1.5));
                }
            } else {
                let tall = rng.random_range(0.0..1.0f32).powi(3) * 38.0;
                city.house(at, rng.random_range(5.0..12.0) + tall, rng.random_range(0..6));
            }
        }
        for at in quarters.map(|(x, z)| middle + 12.6 * vec3(x, 0.0, z)) {
            city.tree(at, rng.random_range(0.5..0.75));
        }
    }
    for _ in 0..700 {
        let street = BLOCK * rng.random_range(1 - BLOCKS..BLOCKS) as f32;
        let along = rng.random_range(-HALF..HALF);
        city.car(street, along, rng.random_range(0..4), rng.random_range(0.1..0.3));
    }
    for _ in 0..150 {
        let [x, z] = [0, 1].map(|_| rng.random_range(-HALF..HALF));
        city.balloon(vec3(x, rng.random_range(14.0..60.0), z), rng.random_range(0..6));
    }
    city.0
}

/// Where a thing is a frame later: what leaves the city comes back on the other side.
pub fn driven(Bounds(at): &Bounds, Velocity(by): &Velocity) -> Bounds {
    let center = (at.center() + *by + HALF).rem_euclid(Vec3::splat(2.0 * HALF)) - HALF;
    Bounds(Aabb::from_center(center, 0.5 * at.size()))
}

/// Down a street, above the trees.
pub fn eye_view(frame: u32, [width, height]: [u32; 2]) -> Result<View, Error> {
    let eye = eye(frame);
    View::look_at(eye, eye + vec3(-0.3, -0.25, -1.0), 60.0, 0.2, Viewport::new(width, height))
}

/// From the sun down to what lies before the eye. Rays of the sun are parallel.
pub fn sun_view(frame: u32, [width, height]: [u32; 2]) -> Result<View, Error> {
    let lit = eye(frame) + vec3(-20.0, 0.0, -130.0);
    let view_from_world = glam::camera::rh::view::look_at_mat4(lit + 300.0 * toward_sun(), lit, Vec3::Y);
    View::new(
        view_from_world,
        projection::orthographic(340.0, 340.0, 1.0, 600.0),
        Viewport::new(width, height),
    )
}

/// A unit vector.
pub fn toward_sun() -> Vec3 {
    vec3(0.52, 0.62, 0.42).normalize()
}

fn eye(frame: u32) -> Vec3 {
    vec3(4.0, 26.0, 210.0 - 0.4 * frame as f32)
}

struct City(World);

impl City {
    fn put(&mut self, vertices: Range<u32>, center: Vec3, half: Vec3, paint: [u8; 4]) -> hecs::Entity {
        let look = Look { vertices, instance: self.0.len(), paint };
        self.0.spawn((Bounds(Aabb::from_center(center, half)), look))
    }

    fn drive(&mut self, entity: hecs::Entity, velocity: Vec3) {
        self.0.insert_one(entity, Velocity(velocity)).expect("it was just spawned");
    }

    fn house(&mut self, at: Vec3, height: f32, paint: usize) {
        let paints = [
            [196, 164, 132],
            [178, 90, 70],
            [214, 200, 178],
            [150, 158, 166],
            [120, 104, 92],
            [206, 178, 110],
        ];
        let [r, g, b] = paints[paint];
        let up = Vec3::Y * 0.5 * height;
        self.put(BOX, at + up, vec3(5.0, 0.5 * height, 5.0), [r, g, b, WALL]);
        self.put(BOX, at + 2.0 * up + 0.2 * Vec3::Y, vec3(5.2, 0.2, 5.2), [90, 86, 84, PLAIN]);
        self.put(BOX, at + 2.0 * up + vec3(1.5, 1.2, -1.5), vec3(1.3, 1.0, 1.3), [130, 126, 120, PLAIN]);
    }

    fn tree(&mut self, at: Vec3, size: f32) {
        self.put(BOX, at + 1.5 * size * Vec3::Y, size * vec3(0.25, 1.5, 0.25), [92, 66, 46, PLAIN]);
        let green = [60 + (size * 40.0) as u8, 110, 50, PLAIN];
        self.put(BALL, at + 4.6 * size * Vec3::Y, size * vec3(2.0, 2.4, 2.0), green);
    }

    fn car(&mut self, street: f32, along: f32, way: usize, speed: f32) {
        let paints = [[190, 40, 36], [40, 72, 140], [225, 225, 220], [36, 38, 42]];
        let [r, g, b] = paints[(along.abs() as usize) % 4];
        // Traffic keeps to the right.
        let forward = [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_X][way];
        let right = forward.cross(Vec3::Y);
        let at = street * right.abs() + 3.0 * right + along * forward.abs();
        // No two are of the same size: faces in one plane would make the picture depend on the
        // order of drawing.
        let size = 0.9 + 0.5 * speed;
        let half = |long: f32, high: f32, wide: f32| {
            size * (long * forward.abs() + high * Vec3::Y + wide * right.abs())
        };
        let body = self.put(BOX, at + 0.75 * Vec3::Y, half(2.2, 0.45, 0.95), [r, g, b, PLAIN]);
        let cabin = self.put(BOX, at + 1.5 * Vec3::Y, half(1.2, 0.35, 0.8), [46, 54, 62, PLAIN]);
        [body, cabin].into_iter().for_each(|part| self.drive(part, speed * forward));
    }

    fn balloon(&mut self, at: Vec3, paint: usize) {
        let paints =
            [[226, 74, 51], [244, 170, 40], [72, 142, 196], [238, 226, 200], [140, 86, 160], [86, 160, 96]];
        let [r, g, b] = paints[paint];
        let envelope = self.put(BALL, at, vec3(2.6, 3.0, 2.6), [r, g, b, PLAIN]);
        let basket = self.put(BOX, at - 4.2 * Vec3::Y, vec3(0.6, 0.5, 0.6), [110, 80, 50, PLAIN]);
        [envelope, basket].into_iter().for_each(|part| self.drive(part, vec3(0.05, 0.0, 0.02)));
    }
}
