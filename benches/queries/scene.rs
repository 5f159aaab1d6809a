//! Boxes of about one size on the screen, among walls that hide about half of them.

use glam::{Vec2, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, Proxy, Question, View, Viewport};

use crate::conventional::Drawer;

const SCREEN: Viewport = Viewport::new(1280, 720);
const FOV_DEGREES: f32 = 60.0;

/// What is asked about, and the depth that decides.
pub struct Scene<'g> {
    pub device: &'g wgpu::Device,
    pub queue: &'g wgpu::Queue,
    pub view: View,
    pub boxes: Vec<Aabb>,
    pub proxies: Vec<Proxy>,
    pub depth: wgpu::Texture,
}

impl<'g> Scene<'g> {
    /// `area` is the pixels of a box.
    pub fn new(device: &'g wgpu::Device, queue: &'g wgpu::Queue, count: u32, area: f32) -> Self {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let view = view(SCREEN);
        let (boxes, proxies) = boxes(&mut dice, &view, count as usize, area);
        let walls = walls(&mut dice, SCREEN);
        let depth = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SCREEN.width, height: SCREEN.height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let scene = Self { device, queue, view, boxes, proxies, depth };
        Drawer::new(&scene, &walls, true).draw_all();
        scene.wait();
        scene
    }

    /// Until the device has done what it was given.
    pub fn wait(&self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
    }
}

/// The one camera, on a screen of some size.
pub fn view(screen: Viewport) -> View {
    View::look_at(Vec3::ZERO, Vec3::NEG_Z, FOV_DEGREES, 0.1, screen).expect("a view")
}

/// Boxes of `area` pixels, and the questions about them.
pub fn boxes(dice: &mut ChaCha8Rng, view: &View, count: usize, area: f32) -> (Vec<Aabb>, Vec<Proxy>) {
    // Boxes show a little of their sides, and most pixels that a box touches count.
    let side = (0.8 * area).sqrt();
    let (mut boxes, mut proxies) = (Vec::new(), Vec::new());
    while proxies.len() < count {
        let size = side * dice.random_range(0.8..1.2);
        let aabb = cube(dice, view.viewport(), size, 10.0..40.0, 0.5);
        if let Question::Ask(proxy) = Question::new(&aabb, view) {
            boxes.push(aabb);
            proxies.push(proxy);
        }
    }
    (boxes, proxies)
}

/// What hides about half of a screen.
pub fn walls(dice: &mut ChaCha8Rng, screen: Viewport) -> Vec<Aabb> {
    let side = 160.0 / SCREEN.height as f32 * screen.height as f32;
    (0..60).map(|_| cube(dice, screen, side, 15.0..25.0, 0.01)).collect()
}

/// The pixels that proxies cover, a box.
pub fn mean_area(proxies: &[Proxy]) -> f64 {
    let covered = |proxy: &Proxy| {
        let rect = proxy.rect;
        let pixels = (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| proxy.covers(x, y)).count()
    };
    proxies.iter().map(covered).sum::<usize>() as f64 / proxies.len() as f64
}

/// A box at a random place on the screen, `size` pixels wide and high at a distance from a range;
/// `thickness` times as thick as wide.
fn cube(
    dice: &mut ChaCha8Rng,
    screen: Viewport,
    size: f32,
    distance: std::ops::Range<f32>,
    thickness: f32,
) -> Aabb {
    let distance = dice.random_range(distance);
    let metres_per_pixel = distance * 2.0 * (0.5 * FOV_DEGREES).to_radians().tan() / screen.height as f32;
    let mut along =
        |pixels: u32| (dice.random_range(0.0..pixels as f32) - 0.5 * pixels as f32) * metres_per_pixel;
    let centre = Vec2::new(along(screen.width), along(screen.height)).extend(-distance);
    let half = 0.5 * size * metres_per_pixel;
    Aabb::from_center(centre, Vec3::new(half, half, half * thickness))
}
