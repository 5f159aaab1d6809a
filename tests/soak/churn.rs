//! A world of boxes to which everything happens, and a camera in it.

use std::fmt;

use glam::Vec3;
use hecs::{Entity, World};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, View, Viewport};
use tercet::scene::{Bounds, NotOccluder};

use crate::boxes::{self, Place};

/// Objects at once.
pub const MOST: usize = 800;
const LEAST: usize = 400;
/// Objects spawned in one frame, at most.
pub const SPAWNED_AT_ONCE: usize = 40;
/// How far what is thrown gets, metres.
pub const FARTHEST: f32 = 1e6;
/// Half the side of the smallest object, metres.
pub const SMALLEST: f32 = 0.1;
/// Half the side of the world, metres.
const EXTENT: f32 = 16.0;
const SCREEN: Viewport = Viewport::new(64, 36);
/// Frames between two jumps of the camera.
const STAY: u32 = 97;

/// The world, and how often what happened to it.
pub struct Churn {
    pub world: World,
    /// Everything that is alive.
    entities: Vec<Entity>,
    /// What flies away, and how far each has got.
    thrown: Vec<Entity>,
    rng: ChaCha8Rng,
    eye: Vec3,
    target: Vec3,
    spawned: u64,
    respawned: u64,
    returned: u64,
    spoiled: u64,
}

impl Churn {
    pub fn new(seed: u64) -> Self {
        let mut churn = Self {
            world: World::new(),
            entities: Vec::new(),
            thrown: Vec::new(),
            rng: ChaCha8Rng::seed_from_u64(seed),
            eye: Vec3::ZERO,
            target: Vec3::X,
            spawned: 0,
            respawned: 0,
            returned: 0,
            spoiled: 0,
        };
        (0..MOST).for_each(|_| churn.spawn());
        churn
    }

    /// Moves the world on by a frame.
    pub fn change(&mut self) {
        for _ in 0..20 {
            let entity = self.any();
            match self.rng.random_range(0..16) {
                0..8 => {
                    let by = self.within(0.3);
                    self.shift(entity, |place| place + by);
                }
                8 | 9 => {
                    let to = self.within(EXTENT);
                    self.shift(entity, |_| to);
                }
                10 if !self.thrown.contains(&entity) => self.thrown.push(entity),
                11 => self.respawn(entity),
                12 => {
                    // Drawn always, until it is moved.
                    self.world.insert_one(entity, Bounds(Aabb::new(Vec3::NAN, Vec3::ZERO))).expect("alive");
                    self.spoiled += 1;
                }
                13 if self.entities.len() > LEAST => self.despawn(entity),
                _ if self.entities.len() < MOST => self.spawn(),
                _ => {}
            }
        }
        self.fly();
        // Now and then half of it goes at once, and half of the room is filled at once.
        if self.rng.random_range(0..400) == 0 {
            while self.entities.len() > LEAST {
                let entity = self.any();
                self.despawn(entity);
            }
        } else if self.rng.random_range(0..50) == 0 {
            for _ in 0..(SPAWNED_AT_ONCE / 2).min(MOST - self.entities.len()) {
                self.spawn();
            }
        }
    }

    /// Moves the camera on and returns the view.
    pub fn look(&mut self, frame: u32) -> View {
        if self.jumps(frame) {
            (self.eye, self.target) = (self.within(EXTENT), self.within(EXTENT));
        }
        let (walk, turn) = (self.within(0.05), self.within(0.05));
        self.eye += walk;
        self.target += turn;
        let is_near = self.target.distance(self.eye) < 0.5;
        let target = if is_near { self.eye + Vec3::X } else { self.target };
        View::look_at(self.eye, target, 60.0, 0.05, SCREEN).expect("a view")
    }

    fn jumps(&self, frame: u32) -> bool {
        frame.is_multiple_of(STAY)
    }

    /// Every other jump is announced.
    pub fn is_cut(&self, frame: u32) -> bool {
        self.jumps(frame) && frame.is_multiple_of(2 * STAY)
    }

    /// What was thrown is half as far again; what has got farthest comes home.
    fn fly(&mut self) {
        let mut thrown = std::mem::take(&mut self.thrown);
        thrown.retain(|&entity| {
            let Ok(Place(place)) = self.world.query_one_mut::<&Place>(entity) else { return false };
            let is_home_again = place.translation.length() * 1.5 > FARTHEST;
            let home = self.within(EXTENT);
            self.returned += u64::from(is_home_again);
            self.shift(entity, |place| if is_home_again { home } else { 1.5 * place });
            !is_home_again
        });
        self.thrown = thrown;
    }

    fn spawn(&mut self) {
        let n = self.entities.len();
        let (at, size) = (self.within(EXTENT), self.rng.random_range(SMALLEST..0.8));
        // Some hide much.
        let half = if n.is_multiple_of(20) { Vec3::new(6.0, 6.0, 0.1) } else { Vec3::splat(size) };
        let entity = boxes::spawn(&mut self.world, Place::new(at, half));
        if n.is_multiple_of(16) {
            self.world.insert_one(entity, NotOccluder).expect("it was just spawned");
        }
        self.entities.push(entity);
        self.spawned += 1;
    }

    fn despawn(&mut self, entity: Entity) {
        self.world.despawn(entity).expect("alive");
        self.entities.retain(|&e| e != entity);
        self.thrown.retain(|&e| e != entity);
    }

    /// Another object, of the same entity index, elsewhere.
    fn respawn(&mut self, entity: Entity) {
        self.despawn(entity);
        self.spawn();
        self.respawned += 1;
    }

    fn shift(&mut self, entity: Entity, to: impl FnOnce(Vec3) -> Vec3) {
        let (told, place) = self.world.query_one_mut::<(&mut Bounds, &mut Place)>(entity).expect("alive");
        place.0.translation = to(place.0.translation.into()).into();
        *told = place.bounds();
    }

    fn any(&mut self) -> Entity {
        self.entities[self.rng.random_range(0..self.entities.len())]
    }

    fn within(&mut self, extent: f32) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.rng.random_range(-extent..extent)))
    }
}

impl fmt::Debug for Churn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { spawned, respawned, returned, spoiled, .. } = self;
        write!(f, "{spawned} spawned, {respawned} of them at once in the place of another, ")?;
        write!(f, "{returned} came back from {FARTHEST} m, {spoiled} were spoiled")
    }
}
