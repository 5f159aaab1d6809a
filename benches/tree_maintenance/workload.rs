//! Boxes at constant density, a share of which moves each frame, and the views they are seen by.

use glam::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use tercet::geom::{Aabb, View, Viewport, projection};

/// Frames that movers go one way before they turn back, so that the world does not drift apart.
const TURN: u32 = 100;

/// How boxes lie, and how they move.
#[derive(Clone, Copy)]
pub struct Manner {
    /// Metres a frame.
    pub step: f32,
    /// Half extents, in tenths of a metre to metres.
    pub extent: f32,
    /// Whether they gather: as many at the same density, but in balls with nothing in between.
    pub gathered: bool,
}

impl Manner {
    /// What every row is measured with, unless it says otherwise.
    pub const USUAL: Self = Self { step: 0.05, extent: 1.0, gathered: false };
}

/// Balls that gathered boxes lie in, on each axis.
const BALLS: f32 = 4.0;

/// What the app of the benchmark holds: boxes, and the velocities of the first so many of them.
pub struct Workload {
    pub boxes: Vec<Aabb>,
    pub velocities: Vec<Vec3>,
    side: f32,
    frame: u32,
}

impl Workload {
    /// `count` boxes of half extents 0.1 to 1 m, one in 64 cubic metres, of which a share moves
    /// 0.05 m a frame: or in another manner.
    pub fn new(count: usize, moving: f64, manner: Manner) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let side = (64.0 * count as f32).cbrt();
        let mut unit = || (rng.next_u32() >> 8) as f32 / (1 << 24) as f32;
        let mut vec3 =
            |low: f32, high: f32| Vec3::from_array(std::array::from_fn(|_| unit() * (high - low) + low));
        let ball = side / BALLS;
        let mut aabb = || {
            let mut at = vec3(0.0, side);
            if manner.gathered {
                let middle = ((at / ball).floor() + 0.5) * ball;
                at = middle + (at - middle) * 0.3;
            }
            Aabb::from_center(at, vec3(0.1, 1.0) * manner.extent)
        };
        let boxes = (0..count).map(|_| aabb()).collect();
        let movers = (count as f64 * moving) as usize;
        let velocities = (0..movers).map(|_| vec3(-1.0, 1.0).normalize_or_zero() * manner.step).collect();
        Self { boxes, velocities, side, frame: 0 }
    }

    /// Moves the movers one step: what the app itself does in a frame, and the least that
    /// anything can cost that keeps their boxes.
    pub fn step(&mut self) {
        let turn = if self.frame.is_multiple_of(TURN) && self.frame > 0 { -1.0 } else { 1.0 };
        self.frame += 1;
        for (aabb, velocity) in self.boxes.iter_mut().zip(&mut self.velocities) {
            *velocity *= turn;
            *aabb = Aabb::new(aabb.min + *velocity, aabb.max + *velocity);
        }
    }

    /// The boxes that have just moved.
    pub fn moved(&self) -> &[Aabb] {
        &self.boxes[..self.velocities.len()]
    }

    /// Three views, by name: from a face of the world's cube across it (it sees 52 %), from its
    /// middle (10 %), and from there but not far (about 1 %).
    pub fn views(&self) -> [(&'static str, View); 3] {
        let l = self.side;
        let viewport = Viewport::new(1024, 1024);
        let view = |eye: Vec3, degrees: f32, far: f32| {
            let endless = View::look_at(eye, eye - Vec3::Z, degrees, 0.1, viewport).expect("a view");
            let clip = projection::perspective_finite(degrees.to_radians(), 1.0, 0.1, far);
            View::new(endless.view_from_world(), clip, viewport).expect("a view")
        };
        let middle = Vec3::splat(0.5 * l);
        [
            ("wide", view(middle + Vec3::Z * 0.5 * l, 70.0, 10.0 * l)),
            ("mid", view(middle, 75.0, 10.0 * l)),
            ("near", view(middle, 60.0, 0.25 * l)),
        ]
    }
}
