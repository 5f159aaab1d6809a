//! The meshes, each in full detail only: it is their triangles that this world is about. Each stands
//! on the ground of its own space about the y axis. Metres.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh, turn};
use super::super::teapot::teapot_mesh;
use crate::scene::mesh::{Level, Mesh};

parts! {
    Tower => mesh("tower", 1, tower),
    Spire => mesh("spire", 1, spire),
    Wall => mesh("wall of stones", 1, wall),
    Gate => mesh("gate", 1, gate),
    Fountain => mesh("fountain", 1, fountain),
    House => mesh("house with a shingle roof", 1, house),
    Oak => mesh("oak", 1, oak),
    Fir => mesh("fir", 1, fir),
    Boulder => mesh("boulder", 1, boulder),
    Mushroom => mesh("mushroom", 1, mushroom),
    Teapot => teapot(),
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A box by its middle on the ground: width, height, depth.
fn stand(s: &mut Shape, [x, y, z]: [f32; 3], [w, h, d]: [f32; 3]) {
    s.cuboid(v(x - 0.5 * w, y, z - 0.5 * d), v(x + 0.5 * w, y + h, z + 0.5 * d));
}

/// Only the finest level of the teapot, like everything else here.
fn teapot() -> Mesh {
    let teapot = teapot_mesh();
    let finest = &teapot.levels()[0];
    let level = Level { positions: finest.positions.clone(), indices: finest.indices.clone(), error: 0.0 };
    Mesh::with_levels("teapot", vec![level]).expect("it was one before")
}

/// Bumps on a surface: up to 1 either way, smooth, without a period that shows.
fn bumps(p: Vec3) -> f32 {
    let wave =
        |f: f32, p: Vec3| libm::sinf(f * p.x + 1.7) * libm::sinf(f * p.y + 0.3) * libm::sinf(f * p.z + 2.1);
    0.6 * wave(3.1, p) + 0.3 * wave(7.3, v(p.z, p.x, p.y)) + 0.1 * wave(17.9, v(p.y, p.z, p.x))
}

/// Courses of stone, a ledge, and battlements.
fn tower(s: &mut Shape, _: Coarseness) {
    const COURSES: usize = 28;
    let mut profile = vec![[0.0, -2.0]];
    for n in 0..COURSES {
        let (y, wide) = (-2.0 + 0.55 * n as f32, 3.6 - 0.025 * n as f32);
        profile.extend([[wide - 0.08, y], [wide, y + 0.08], [wide, y + 0.47], [wide - 0.08, y + 0.55]]);
    }
    profile.extend([[3.4, 13.4], [3.5, 14.2], [0.0, 14.2]]);
    s.lathe(Stand::y(Vec3::ZERO), &profile, 72);
    for k in 0..16 {
        let (cos, sin) = turn(k, 16);
        stand(s, [3.2 * cos, 14.2, 3.2 * sin], [0.7, 0.9, 0.7]);
    }
}

/// A roof of rings of slates, with a ball on its tip.
fn spire(s: &mut Shape, _: Coarseness) {
    const RINGS: usize = 40;
    let mut profile = vec![[0.0, 0.0]];
    for n in 0..RINGS {
        let share = n as f32 / RINGS as f32;
        let wide = 3.9 * (1.0 - share) * (1.0 - 0.35 * share * (1.0 - share));
        profile.extend([[wide, 7.0 * share], [0.97 * wide, 7.0 * share + 0.12]]);
    }
    profile.push([0.0, 7.1]);
    s.lathe(Stand::y(Vec3::ZERO), &profile, 72);
    s.blob(v(0.0, 7.3, 0.0), 24, |_| 0.35);
}

/// Hewn stones of many sizes, both faces of a curtain wall, and its battlements.
fn wall(s: &mut Shape, _: Coarseness) {
    masonry(s, [-9.0, 9.0], [-2.0, 9.0]);
    for n in 0..9 {
        stand(s, [2.1 * (n as f32 - 4.0), 9.0, 0.7], [1.1, 0.9, 0.5]);
    }
}

/// A wall from one x to another and from one y to another: a core and its stones.
fn masonry(s: &mut Shape, [left, right]: [f32; 2], [low, high]: [f32; 2]) {
    s.cuboid(v(left, low, -0.9), v(right, high, 0.9));
    let (courses, stones) = (((high - low) / 0.5) as usize, ((right - left) / 0.6) as usize);
    for n in 0..courses * stones {
        let (course, stone) = (n / stones, n % stones);
        let shift = if course % 2 == 0 { 0.15 } else { 0.45 };
        let x = left + shift + 0.6 * stone as f32;
        let out = 0.04 + 0.03 * bumps(v(x, 0.9 * course as f32, left));
        for z in [-0.9 - out, 0.9] {
            let (from, to) = (v(x, low + 0.5 * course as f32 + 0.03, z), (x + 0.56).min(right));
            s.cuboid(from, v(to, from.y + 0.44, z + out));
        }
    }
}

/// A wall with an opening four metres wide.
fn gate(s: &mut Shape, _: Coarseness) {
    masonry(s, [-9.0, -2.0], [-2.0, 9.0]);
    masonry(s, [2.0, 9.0], [-2.0, 9.0]);
    masonry(s, [-2.0, 2.0], [5.0, 9.0]);
    for n in 0..9 {
        stand(s, [2.1 * (n as f32 - 4.0), 9.0, 0.7], [1.1, 0.9, 0.5]);
    }
    for x in [-2.6, 2.6] {
        s.cylinder(Stand::y(v(x, -1.0, 1.2)), 0.4, 8.0, 64);
        s.torus(Stand::y(v(x, 7.0, 1.2)), 0.42, 0.12, [64, 24]);
    }
}

fn fountain(s: &mut Shape, _: Coarseness) {
    s.torus(Stand::y(v(0.0, 0.5, 0.0)), 2.4, 0.3, [96, 32]);
    s.cylinder(Stand::y(Vec3::ZERO), 2.4, 0.4, 96);
    for (y, wide) in [(1.4, 1.4), (2.3, 0.8)] {
        let bowl =
            [[0.0, y], [0.5 * wide, y + 0.1], [wide, y + 0.4], [0.95 * wide, y + 0.45], [0.0, y + 0.2]];
        s.lathe(Stand::y(Vec3::ZERO), &bowl, 96);
        s.torus(Stand::y(v(0.0, y + 0.42, 0.0)), wide, 0.06, [96, 16]);
    }
    s.cylinder(Stand::y(Vec3::ZERO), 0.25, 2.6, 64);
    s.blob(v(0.0, 2.9, 0.0), 48, |out| 0.35 + 0.05 * bumps(out * 2.0));
}

/// Timbers, windows, and a roof of shingles.
fn house(s: &mut Shape, _: Coarseness) {
    stand(s, [0.0, -1.5, 0.0], [6.0, 5.5, 8.0]);
    for x in [-3.0, 3.0] {
        for n in 0..7 {
            stand(s, [x, 0.0, 1.3 * (n as f32 - 3.0)], [0.2, 4.0, 0.2]);
        }
        for y in [0.0, 1.9, 3.8] {
            stand(s, [x, y, 0.0], [0.22, 0.2, 8.0]);
        }
        for z in [-2.0, 2.0] {
            stand(s, [x, 2.3, z], [0.16, 1.1, 0.9]);
        }
    }
    for z in [-4.0, 4.0] {
        for n in 0..5 {
            stand(s, [1.45 * (n as f32 - 2.0), 0.0, z], [0.2, 4.0, 0.2]);
        }
    }
    let gable = |z: f32| [v(3.3, 4.0, z), v(-3.3, 4.0, z), v(0.0, 7.6, z)];
    s.prism(gable(-4.3), gable(4.3));
    const ROWS: usize = 22;
    const SHINGLES: usize = 36;
    for n in 0..ROWS * SHINGLES {
        let (row, shingle) = (n / SHINGLES, n % SHINGLES);
        let share = (row as f32 + 0.5) / ROWS as f32;
        let (x, y) = (3.4 * (1.0 - share), 4.0 + 3.6 * share);
        let z = 8.9 * (shingle as f32 + 0.5) / SHINGLES as f32 - 4.45;
        for side in [-1.0, 1.0] {
            stand(s, [side * x, y - 0.1, z], [0.24, 0.14 + 0.05 * bumps(v(x, z, side)), 0.22]);
        }
    }
    stand(s, [1.6, 4.0, 2.4], [0.8, 4.2, 0.8]);
}

fn oak(s: &mut Shape, _: Coarseness) {
    let trunk = [[0.0, 0.0], [0.9, 0.0], [0.55, 0.8], [0.45, 2.4], [0.5, 4.0], [0.0, 5.0]];
    s.lathe(Stand::y(Vec3::ZERO), &trunk, 32);
    for k in 0..11 {
        let (cos, sin) = turn(k * 3, 11);
        let (out, up) = (1.9 - 0.09 * k as f32, 4.2 + 0.36 * k as f32);
        let center = v(out * cos, up, out * sin);
        s.blob(center, 28, |way| 1.75 + 0.4 * bumps(way * 2.3 + center));
    }
}

fn fir(s: &mut Shape, _: Coarseness) {
    s.cylinder(Stand::y(Vec3::ZERO), 0.3, 2.0, 24);
    for n in 0..9 {
        let (y, wide) = (1.2 + 1.0 * n as f32, 2.8 - 0.28 * n as f32);
        // A fringe that hangs down, and the cone above it.
        let layer = [
            [0.0, y + 0.3],
            [0.6 * wide, y + 0.1],
            [wide, y - 0.3],
            [0.9 * wide, y],
            [0.6 * wide, y + 0.5],
            [0.3 * wide, y + 1.0],
            [0.0, y + 1.5],
        ];
        s.lathe(Stand::y(Vec3::ZERO), &layer, 56);
    }
}

fn boulder(s: &mut Shape, _: Coarseness) {
    s.blob(v(0.0, 1.6, 0.0), 96, |way| 2.4 + 0.8 * bumps(way * 0.9) + 0.2 * bumps(way * 4.0));
}

fn mushroom(s: &mut Shape, _: Coarseness) {
    let stem = [[0.0, 0.0], [0.5, 0.0], [0.35, 0.5], [0.3, 1.6], [0.45, 2.4], [0.0, 2.6]];
    s.lathe(Stand::y(Vec3::ZERO), &stem, 48);
    let mut cap = vec![[0.0, 2.4], [1.5, 2.2]];
    cap.extend((0..=16).map(|k| {
        let (cos, sin) = turn(k, 64);
        [1.8 * cos, 2.3 + 1.1 * sin]
    }));
    cap.last_mut().expect("it is not empty")[0] = 0.0;
    s.lathe(Stand::y(Vec3::ZERO), &cap, 72);
    for k in 0..24 {
        let (cos, sin) = turn(7 * k, 24);
        let up = 0.3 + 0.03 * k as f32;
        let out = 1.8 * (1.0 - up * up).max(0.0).sqrt();
        s.blob(v(out * cos, 2.3 + 1.1 * up, out * sin), 12, |_| 0.14);
    }
}
