//! What the tests share: views in pixel units, the slow exact rasteriser, random draws.

use glam::{Affine3A, Mat4, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use tercet::geom::{View, Viewport};
use tercet::query::QueryBackend;
use tercet::query::software::{SimdLevel, SoftwareQueries};
use tercet::scene::mesh::Mesh;

pub(crate) const LEVELS: [SimdLevel; 4] = SimdLevel::ALL;

pub(crate) fn dice(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A view whose world is the screen: x and y in pixels, y down, z the nearness. Exact in f32 for
/// sides that are powers of two and coordinates of at most 24 bits.
pub(crate) fn pixel_view(width: u32, height: u32) -> View {
    let m = Mat4::from_cols_array_2d(&[
        [2.0 / width as f32, 0.0, 0.0, 0.0],
        [0.0, -2.0 / height as f32, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0, 1.0],
    ]);
    View::new(Mat4::IDENTITY, m, Viewport::new(width, height)).expect("a usable view")
}

/// A mesh of loose triangles.
pub(crate) fn soup(triangles: &[[Vec3; 3]]) -> Mesh {
    let positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let indices = (0..positions.len() as u32).collect();
    Mesh::new("soup", positions, indices).expect("a mesh")
}

/// Draws meshes, at their own place, into a frame of its own.
pub(crate) fn draw(queries: &mut SoftwareQueries, view: &View, meshes: &[Mesh]) {
    queries.begin(view).expect("begin");
    add(queries, meshes);
}

/// Draws meshes on top of what is there.
pub(crate) fn add(queries: &mut SoftwareQueries, meshes: &[Mesh]) {
    queries
        .draw(|pass| {
            for mesh in meshes {
                pass.draw_mesh(mesh, &Affine3A::IDENTITY);
            }
        })
        .expect("draw");
}

/// The whole depth, row after row.
pub(crate) fn depth(queries: &SoftwareQueries) -> Vec<f32> {
    let image = queries.depth();
    (0..image.height()).flat_map(|y| image.row(y)).collect()
}

/// A pool of a number of threads.
pub(crate) fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool")
}

/// Nearness at the samples that a triangle covers, by the definition: integer edge functions at
/// 1/256 pixel in i128, the top-left rule by the direction of each edge, depth from the exact
/// barycentrics in f64. `None` where it does not cover.
pub(crate) fn reference(triangle: &[Vec3; 3], width: u32, height: u32) -> Vec<Option<f64>> {
    let mut p = triangle.map(|v| (snap(v.x), snap(v.y), f64::from(v.z)));
    let area = orient(p[0], p[1], (p[2].0, p[2].1));
    if area < 0 {
        p.swap(1, 2);
    }
    let mut samples = Vec::with_capacity((width * height) as usize);
    for y in 0..i128::from(height) {
        for x in 0..i128::from(width) {
            let sample = (x * 256 + 128, y * 256 + 128);
            let mut inside = area != 0;
            let mut nearness = 0.0;
            for k in 0..3 {
                let (a, b) = (p[(k + 1) % 3], p[(k + 2) % 3]);
                let e = orient(a, b, sample);
                let top = a.1 == b.1 && b.0 > a.0;
                let left = b.1 < a.1;
                inside &= e > 0 || (e == 0 && (top || left));
                nearness += e as f64 / area.abs() as f64 * p[k].2;
            }
            samples.push(inside.then_some(nearness));
        }
    }
    samples
}

fn orient(a: (i128, i128, f64), b: (i128, i128, f64), c: (i128, i128)) -> i128 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

/// Pixels to subpixels, ties to even.
fn snap(v: f32) -> i128 {
    (f64::from(v) * 256.0).round_ties_even() as i128
}

/// Random triangles in and around a viewport, of many shapes. Coordinates are multiples of 1/256
/// and at most a few thousand pixels away, so that a pixel view keeps them exact.
pub(crate) fn triangles(dice: &mut ChaCha8Rng, count: usize, width: u32, height: u32) -> Vec<[Vec3; 3]> {
    let (w, h) = (width as f32, height as f32);
    let grid = |v: f32| (v * 256.0).round() / 256.0;
    (0..count)
        .map(|i| {
            let center = Vec3::new(dice.random_range(-0.2..1.2) * w, dice.random_range(-0.2..1.2) * h, 0.0);
            let size = match i % 6 {
                0 => 0.5,
                1 => 1.5,
                2 => 4.0,
                3 => 20.0,
                4 => 150.0,
                _ => 3000.0,
            };
            let mut corner = || {
                let offset = Vec3::new(dice.random_range(-size..size), dice.random_range(-size..size), 0.0);
                let p = center + offset;
                // Now and then on a pixel's centre or edge, where the rule decides.
                let step = [1.0 / 256.0, 0.5, 1.0][dice.random_range(0..3)];
                let on = |v: f32| grid((v / step).round() * step);
                Vec3::new(on(p.x), on(p.y), dice.random_range(0.01..1.0))
            };
            let mut t = [corner(), corner(), corner()];
            match dice.random_range(0..8) {
                0 => t[2] = t[1] + Vec3::new(1.0 / 256.0, 0.0, 0.0), // a sliver
                1 => t[2].y = t[1].y,                                // a flat side
                2 => t[2].x = t[1].x,                                // an upright side
                3 => t[2] = t[0],                                    // no area
                _ => {}
            }
            t
        })
        .collect()
}
