//! Two scenes from seeds: small boxes, and bunnies of triangles below a pixel.

use glam::{Affine3A, EulerRot, Quat, Vec2, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, Proxy, Question, View, Viewport};
use tercet::scene::mesh::Mesh;
use tercet::worlds::bunny_mesh;

const FOV_DEGREES: f32 = 60.0;
/// Sizes are pixels of this height; at others, the scenes stand as they are.
const REFERENCE_HEIGHT: f32 = 720.0;
const ASPECT: f32 = 16.0 / 9.0;
const QUERY_BOXES: usize = 4000;

/// What is drawn, from near to far, and what is asked about.
pub struct Scene {
    pub name: &'static str,
    pub calls: Vec<(Mesh, Affine3A)>,
    /// Boxes that cover about 5 to 50 pixels.
    boxes: Vec<Aabb>,
}

impl Scene {
    /// `count` boxes, each as many pixels wide as its die says, a draw call each.
    pub fn boxes(name: &'static str, count: usize, mut side: impl FnMut(&mut ChaCha8Rng) -> f32) -> Self {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let cube = unit_cube();
        let calls = (0..count).map(|_| {
            let side = side(&mut dice);
            let (at, size) = place(&mut dice, 10.0..100.0, side);
            (cube.clone(), Affine3A::from_scale_rotation_translation(Vec3::splat(size), turn(&mut dice), at))
        });
        let calls = from_near_to_far(calls.collect());
        Self { name, calls, boxes: query_boxes(&mut dice) }
    }

    /// `count` bunnies of about 200 pixels a side, a draw call each.
    pub fn bunnies(count: usize) -> Self {
        let mut dice = ChaCha8Rng::seed_from_u64(2);
        let mesh = bunny_mesh().expect("the bunny");
        let bounds = mesh.bounds();
        let calls = (0..count).map(|_| {
            let (at, size) = place(&mut dice, 10.0..100.0, 200.0);
            let scale = size / bounds.size().max_element();
            let centred = Affine3A::from_translation(-bounds.center());
            let placed = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn(&mut dice), at);
            (mesh.clone(), placed * centred)
        });
        let calls = from_near_to_far(calls.collect());
        Self { name: "bunnies", calls, boxes: query_boxes(&mut dice) }
    }

    pub fn triangles(&self) -> usize {
        self.calls.iter().map(|(mesh, _)| mesh.triangle_count()).sum()
    }

    /// The questions as a view puts them.
    pub fn proxies(&self, view: &View) -> Vec<Proxy> {
        let asked = |aabb| match Question::new(aabb, view) {
            Question::Ask(proxy) => Some(proxy),
            _ => None,
        };
        self.boxes.iter().filter_map(asked).collect()
    }
}

/// The one camera, on a screen of some size.
pub fn view(width: u32, height: u32) -> View {
    View::look_at(Vec3::ZERO, Vec3::NEG_Z, FOV_DEGREES, 0.1, Viewport::new(width, height)).expect("a view")
}

fn query_boxes(dice: &mut ChaCha8Rng) -> Vec<Aabb> {
    let mut one = || {
        let side = f32::sqrt(dice.random_range(5.0..50.0));
        let (at, size) = place(dice, 10.0..100.0, side);
        Aabb::from_center(at, Vec3::splat(0.5 * size))
    };
    (0..QUERY_BOXES).map(|_| one()).collect()
}

/// A random place in the view, and how long `pixels` are there.
fn place(dice: &mut ChaCha8Rng, distance: std::ops::Range<f32>, pixels: f32) -> (Vec3, f32) {
    let distance = dice.random_range(distance);
    let height = 2.0 * distance * (0.5 * FOV_DEGREES).to_radians().tan();
    let on_screen = Vec2::new(dice.random_range(-0.5..0.5) * ASPECT, dice.random_range(-0.5..0.5));
    ((on_screen * height).extend(-distance), pixels * height / REFERENCE_HEIGHT)
}

fn turn(dice: &mut ChaCha8Rng) -> Quat {
    let mut angle = || dice.random_range(0.0..std::f32::consts::TAU);
    Quat::from_euler(EulerRot::XYZ, angle(), angle(), angle())
}

fn from_near_to_far(mut calls: Vec<(Mesh, Affine3A)>) -> Vec<(Mesh, Affine3A)> {
    let distance = |(mesh, placed): &(Mesh, Affine3A)| -placed.transform_point3(mesh.bounds().center()).z;
    calls.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    calls
}

fn unit_cube() -> Mesh {
    let positions = Aabb::from_center(Vec3::ZERO, Vec3::splat(0.5)).corners().to_vec();
    // Corner i lies on the greater side of axis k where bit k of i is set. Fronts are outside.
    let faces: [[u32; 4]; 6] =
        [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];
    let indices = faces.iter().flat_map(|&[a, b, c, d]| [a, c, b, a, d, c]).collect();
    Mesh::new("cube", positions, indices).expect("a cube")
}
