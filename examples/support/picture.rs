//! Shades a frame from what each pixel shows: `last_frame.png`.
//!
//! The picture is for people. It is drawn once, after the run, at twice the size, and shrunk.

use std::path::Path;

use anyhow::{Context, anyhow};
use glam::{Mat4, Vec2, Vec3};
use image::{RgbImage, imageops};
use rayon::prelude::*;
use tercet::geom::View;

/// What one pixel shows.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// In world space, metres.
    pub position: Vec3,
    /// Unit normal of the facet, toward the eye.
    pub normal: Vec3,
    /// sRGB.
    pub color: [u8; 3],
    /// How much of the sun's light arrives, 0 to 1.
    pub sunlit: f32,
}

/// Where the sun stands: a unit vector toward it.
pub fn toward_sun() -> Vec3 {
    Vec3::new(-0.55, 0.75, 0.42).normalize()
}

// Linear light. Warm from the sun, blue from the sky, a little brown back from the ground.
const SUN: Vec3 = Vec3::new(2.15, 1.88, 1.50);
const SKY_LIGHT: Vec3 = Vec3::new(0.40, 0.52, 0.70);
const GROUND_LIGHT: Vec3 = Vec3::new(0.26, 0.22, 0.18);
const HORIZON: Vec3 = Vec3::new(0.66, 0.80, 0.95);
const ZENITH: Vec3 = Vec3::new(0.14, 0.34, 0.74);

/// Directions that feel for nearby surfaces, per pixel.
const FEELERS: usize = 20;
/// The longest feeler, as a share of the distance from the eye.
const FEELER_REACH: f32 = 0.09;

/// Shades `surfaces`, the pixels of `view` row by row (`None` shows the sky), shrinks the result
/// to half its size and saves it as a PNG file. `fog` is the distance in metres at which haze
/// takes 63 % of the light.
pub fn save(path: &Path, view: &View, surfaces: &[Option<Surface>], fog: f32) -> anyhow::Result<()> {
    let (width, height) = (view.viewport().width, view.viewport().height);
    let shot = Shot::new(view, surfaces);
    let open = shot.smooth(&shot.openness());
    let light: Vec<Vec3> =
        (0..surfaces.len()).into_par_iter().map(|at| shot.light(at, open[at], fog)).collect();
    let exposure = exposure(&light);
    let pixels: Vec<u8> = (0..light.len())
        .into_par_iter()
        .flat_map_iter(|at| encode(light[at] * exposure, shot.pixel(at)))
        .collect();
    let large = RgbImage::from_raw(width, height, pixels)
        .ok_or_else(|| anyhow!("{} pixels do not fill {width} × {height}", surfaces.len()))?;
    imageops::resize(&large, (width / 2).max(1), (height / 2).max(1), imageops::FilterType::CatmullRom)
        .save(path)
        .with_context(|| format!("cannot write {}", path.display()))
}

/// A view and what it shows.
struct Shot<'a> {
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    eye: Vec3,
    width: usize,
    height: usize,
    surfaces: &'a [Option<Surface>],
}

impl<'a> Shot<'a> {
    fn new(view: &View, surfaces: &'a [Option<Surface>]) -> Self {
        Self {
            clip_from_world: view.clip_from_world().as_mat4(),
            world_from_clip: view.world_from_clip().as_mat4(),
            eye: view.eye().truncate(),
            width: view.viewport().width as usize,
            height: view.viewport().height as usize,
            surfaces,
        }
    }

    fn pixel(&self, at: usize) -> (usize, usize) {
        (at % self.width, at / self.width)
    }

    /// How open the surroundings of each pixel's surface are, 0 to 1: ambient occlusion felt
    /// from the depth alone.
    fn openness(&self) -> Vec<f32> {
        let feelers: Vec<Vec3> = (0..FEELERS).map(feeler).collect();
        let of = |at: usize| {
            let Some(here) = self.surfaces[at] else { return 1.0 };
            let (x, y) = self.pixel(at);
            let (sin, cos) = (std::f32::consts::TAU * speckle(x, y)).sin_cos();
            let reach = FEELER_REACH * here.position.distance(self.eye);
            let (side, forth) = here.normal.any_orthonormal_pair();
            let blocked: f32 = feelers
                .iter()
                .map(|f| {
                    let (u, v) = (f.x * cos - f.y * sin, f.x * sin + f.y * cos);
                    let toward = side * u + forth * v + here.normal * f.z;
                    self.blocked(&here, here.position + toward * reach, reach)
                })
                .sum();
            1.0 - blocked / FEELERS as f32
        };
        (0..self.surfaces.len()).into_par_iter().map(of).collect()
    }

    /// 1 where a surface near `here` hides `tip` from the eye, fading to 0 for far ones.
    fn blocked(&self, here: &Surface, tip: Vec3, reach: f32) -> f32 {
        let clip = self.clip_from_world * tip.extend(1.0);
        let ndc = Vec2::new(clip.x, clip.y) / clip.w;
        if clip.w <= 0.0 || ndc.abs().max_element() >= 1.0 {
            return 0.0;
        }
        let x = ((ndc.x * 0.5 + 0.5) * self.width as f32) as usize;
        let y = ((0.5 - ndc.y * 0.5) * self.height as f32) as usize;
        let Some(Some(other)) = self.surfaces.get(y * self.width + x) else { return 0.0 };
        let nearer = tip.distance(self.eye) - other.position.distance(self.eye);
        if nearer < 0.02 * reach {
            return 0.0;
        }
        let apart = other.position.distance(here.position) / reach;
        (2.0 - apart).clamp(0.0, 1.0)
    }

    /// Averages each pixel with its neighbours on the same surface: takes the speckle out.
    fn smooth(&self, values: &[f32]) -> Vec<f32> {
        const R: isize = 3;
        let of = |at: usize| {
            let Some(here) = self.surfaces[at] else { return values[at] };
            let (x, y) = self.pixel(at);
            let near = 0.01 * here.position.distance(self.eye);
            let (mut sum, mut weight) = (0.0, 0.0);
            for dy in -R..=R {
                for dx in -R..=R {
                    let (nx, ny) = (x as isize + dx, y as isize + dy);
                    if nx < 0 || ny < 0 || nx >= self.width as isize || ny >= self.height as isize {
                        continue;
                    }
                    let other = ny as usize * self.width + nx as usize;
                    let Some(there) = self.surfaces[other] else { continue };
                    let along = (there.position - here.position).dot(here.normal).abs();
                    if along < near && here.normal.dot(there.normal) > 0.7 {
                        sum += values[other];
                        weight += 1.0;
                    }
                }
            }
            if weight > 0.0 { sum / weight } else { values[at] }
        };
        (0..values.len()).into_par_iter().map(of).collect()
    }

    /// The linear light that a pixel sends to the eye.
    fn light(&self, at: usize, open: f32, fog: f32) -> Vec3 {
        let along = self.direction(at);
        let sky = sky(along);
        let Some(s) = self.surfaces[at] else { return sky };
        let albedo = Vec3::from_array(s.color.map(|c| to_linear(f32::from(c) / 255.0)));
        let up = s.normal.y * 0.5 + 0.5;
        let ambient = GROUND_LIGHT.lerp(SKY_LIGHT, up) * open.powf(2.0);
        let sun = SUN * s.normal.dot(toward_sun()).max(0.0) * s.sunlit;
        // A weak light at the eye keeps the shapes of what stands in the shade readable.
        let fill = Vec3::splat(0.16 * s.normal.dot(-along).max(0.0) * open);
        let half = (toward_sun() - along).normalize_or_zero();
        let gloss = SUN * (0.10 * s.sunlit * s.normal.dot(half).max(0.0).powi(40));
        let lit = albedo * (ambient + sun + fill) + gloss;
        let haze = 1.0 - (-s.position.distance(self.eye) / fog).exp();
        lit.lerp(HORIZON, haze)
    }

    /// The unit direction from the eye through a pixel's centre.
    fn direction(&self, at: usize) -> Vec3 {
        let (x, y) = self.pixel(at);
        let ndc = Vec2::new(
            (x as f32 + 0.5) / self.width as f32 * 2.0 - 1.0,
            1.0 - (y as f32 + 0.5) / self.height as f32 * 2.0,
        );
        let point = self.world_from_clip * ndc.extend(0.5).extend(1.0);
        (point.truncate() / point.w - self.eye).normalize_or_zero()
    }
}

/// The `i`-th of a set of directions that cover a hemisphere around z, of growing length.
fn feeler(i: usize) -> Vec3 {
    const GOLDEN_ANGLE: f32 = 2.399_963;
    let t = (i as f32 + 0.5) / FEELERS as f32;
    let (sin, cos) = (i as f32 * GOLDEN_ANGLE).sin_cos();
    // Cosine-weighted: the square root makes the density on the disc even.
    let across = (((i * 7) % FEELERS) as f32 + 0.5) / FEELERS as f32;
    let r = across.sqrt();
    let length = 0.1 + 0.9 * t * t;
    Vec3::new(r * cos, r * sin, (1.0 - r * r).sqrt()) * length
}

fn sky(along: Vec3) -> Vec3 {
    let up = along.y.clamp(0.0, 1.0).powf(0.6);
    let glow = along.dot(toward_sun()).max(0.0).powi(12) * 0.25;
    HORIZON.lerp(ZENITH, up) + SUN * glow
}

/// A number in 0 to 1 that looks random from pixel to pixel (interleaved gradient noise,
/// Jimenez 2014).
fn speckle(x: usize, y: usize) -> f32 {
    (52.982_918 * (0.067_110_56 * x as f32 + 0.005_837_15 * y as f32).fract()).fract()
}

/// What to multiply the light with so that halls and roofs both come out well: half of the way to
/// a middle grey, by the mean of the logarithms of luminance.
fn exposure(light: &[Vec3]) -> f32 {
    const MIDDLE: f32 = 0.32;
    let log = |l: &Vec3| f64::from(l.dot(Vec3::new(0.2126, 0.7152, 0.0722)).max(1e-3).ln());
    let mean = (light.par_iter().map(log).sum::<f64>() / light.len().max(1) as f64).exp() as f32;
    (MIDDLE / mean).sqrt().clamp(0.5, 2.5)
}

/// Linear light to sRGB bytes, with highlights rolled off and half a step of noise against bands.
fn encode(light: Vec3, (x, y): (usize, usize)) -> [u8; 3] {
    let noise = speckle(x, y);
    filmic(light).to_array().map(|c| (to_srgb(c) * 255.0 + noise).clamp(0.0, 255.0) as u8)
}

/// Narkowicz's fit of the ACES curve (2015).
fn filmic(x: Vec3) -> Vec3 {
    let x = x * 0.70;
    (x * (x * 2.51 + 0.03) / (x * (x * 2.43 + 0.59) + 0.14)).clamp(Vec3::ZERO, Vec3::ONE)
}

fn to_linear(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

fn to_srgb(c: f32) -> f32 {
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}
