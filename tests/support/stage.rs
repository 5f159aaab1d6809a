//! A world in which everything happens every frame, and a camera that goes everywhere.

use glam::{Affine3A, Mat4, Vec2, Vec3};
use hecs::{Entity, World};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::draw::{Detail, Drawable};
use tercet::geom::{Aabb, DepthDirection, DepthFormat, View, Viewport, projection};
use tercet::scene::{Bounds, NeverCull, NotOccluder, Slack};
use tercet::worlds::Model;

/// A changing world with a camera.
pub struct Stage {
    pub world: World,
    pub detail: Detail,
    model: Model,
    rng: ChaCha8Rng,
    viewport: Viewport,
    /// Whether objects change from frame to frame.
    churn: bool,
    eye: Vec3,
    target: Vec3,
}

impl Stage {
    /// Spawns a model. `seed` decides everything that happens to it.
    pub fn new(model: Model, seed: u64, viewport: Viewport, churn: bool) -> Self {
        let mut world = World::new();
        model.spawn(&mut world);
        let mut stage = Self {
            world,
            detail: Detail::default(),
            model,
            rng: ChaCha8Rng::seed_from_u64(seed),
            viewport,
            churn,
            eye: Vec3::ZERO,
            target: Vec3::NEG_Z,
        };
        if churn {
            stage.dress();
        }
        stage
    }

    /// Moves the world on and returns the next view.
    pub fn next(&mut self, frame: u32) -> View {
        if self.churn {
            self.change();
        }
        // A cut every few frames; small steps between.
        if frame.is_multiple_of(6) {
            (self.eye, self.target) = (self.place(), self.place());
            if self.rng.random_range(0..3) == 0 {
                self.eye = self.somewhere_inside();
            }
        } else {
            let step = self.extent() * 0.01;
            let (walk, turn) = (self.offset() * step, self.offset() * step);
            self.eye += walk;
            self.target += turn;
        }
        self.view()
    }

    /// Gives some objects optional components.
    fn dress(&mut self) {
        for entity in self.entities() {
            match self.rng.random_range(0..40) {
                0 => drop(self.world.insert_one(entity, NeverCull)),
                1 | 2 => drop(self.world.insert_one(entity, NotOccluder)),
                3 => drop(self.world.insert_one(entity, Slack(0.1))),
                _ => {}
            }
        }
    }

    /// Spawns, moves, teleports, despawns, spoils and mends some objects.
    fn change(&mut self) {
        let entities = self.entities();
        let count = self.model.objects.len();
        for _ in 0..(entities.len() / 12).max(1) {
            let Some(&entity) = entities.get(self.rng.random_range(0..entities.len().max(1))) else { break };
            match self.rng.random_range(0..8) {
                0..4 => {
                    let step = self.offset() * self.extent() * 0.01;
                    self.shift(entity, step);
                }
                4 => {
                    let to = self.place();
                    self.shift(entity, to);
                }
                5 => drop(self.world.despawn(entity)),
                6 => drop(self.world.insert_one(entity, Bounds(Aabb::new(Vec3::NAN, Vec3::ZERO)))),
                _ => {
                    let placed = self.model.objects[self.rng.random_range(0..count)];
                    let mesh = self.model.meshes[placed.mesh].clone();
                    let (world_from_object, color) = (placed.world_from_object, placed.color);
                    let drawable = Drawable { mesh, world_from_object, color };
                    let entity = self.world.spawn((Bounds(placed.bounds), drawable));
                    if placed.not_occluder {
                        self.world.insert_one(entity, NotOccluder).expect("it was just spawned");
                    }
                }
            }
        }
    }

    /// Moves an object, or one that was spoiled back to a sound box.
    fn shift(&mut self, entity: Entity, by: Vec3) {
        let moved = self.world.query_one_mut::<&mut Drawable>(entity).map(|d| {
            let moved = Affine3A::from_translation(by) * d.world_from_object;
            let bounds = d.mesh.bounds_under(&moved);
            // An object that would leave the range of f32 stays where it is.
            if bounds.is_valid() {
                d.world_from_object = moved;
            }
            Bounds(d.mesh.bounds_under(&d.world_from_object))
        });
        if let Ok(bounds) = moved {
            self.world.insert_one(entity, bounds).expect("the entity is alive");
        }
    }

    fn entities(&self) -> Vec<Entity> {
        let mut all: Vec<Entity> = self.world.query::<(Entity, &Drawable)>().iter().map(|(e, _)| e).collect();
        all.sort_unstable_by_key(|e| e.id());
        all
    }

    /// The larger part of the model's size, metres, within reason.
    fn extent(&self) -> f32 {
        let size = self.model.bounds.size().max_element();
        if size.is_finite() && size > 0.0 { size.min(1e6) } else { 1.0 }
    }

    fn offset(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.rng.random_range(-1.0..1.0)))
    }

    /// A point in or near the model.
    fn place(&mut self) -> Vec3 {
        let center = self.model.bounds.center();
        let center = if center.is_finite() { center } else { Vec3::ZERO };
        center + self.offset() * self.extent() * 0.7
    }

    /// A point in the box of some object.
    fn somewhere_inside(&mut self) -> Vec3 {
        let entities = self.entities();
        if entities.is_empty() {
            return Vec3::ZERO;
        }
        let entity = entities[self.rng.random_range(0..entities.len())];
        let bounds = self.world.get::<&Bounds>(entity).map(|b| b.0).unwrap_or(Aabb::EMPTY);
        if bounds.is_valid() { bounds.center() } else { Vec3::ZERO }
    }

    /// A view of some kind: mostly perspective, reversed z.
    fn view(&mut self) -> View {
        let kind = self.rng.random_range(0..10u32);
        let fov = [30.0f32, 60.0, 100.0, 5.0][self.rng.random_range(0..4)].to_radians();
        let Viewport { width, height, .. } = self.viewport;
        let aspect = width as f32 / height as f32;
        let extent = self.extent();
        let near = extent * 1e-3;
        let (clip_from_view, depth) = match kind {
            0 => (
                projection::orthographic(extent * aspect, extent, 0.0, extent * 3.0),
                DepthDirection::Reversed,
            ),
            1 => {
                (projection::perspective_standard(fov, aspect, near, extent * 4.0), DepthDirection::Standard)
            }
            2 => (projection::perspective_finite(fov, aspect, near, extent * 2.0), DepthDirection::Reversed),
            3 => {
                let jitter = Vec2::new(self.rng.random_range(-0.5..0.5), self.rng.random_range(-0.5..0.5));
                let plain = projection::perspective(fov, aspect, near);
                (projection::jittered(plain, jitter, width, height), DepthDirection::Reversed)
            }
            _ => (projection::perspective(fov, aspect, near), DepthDirection::Reversed),
        };
        let mut target = self.target;
        if (target - self.eye).length() < extent * 1e-4 {
            target = self.eye + Vec3::X * extent;
        }
        let up = if self.rng.random_bool(0.8) { Vec3::Y } else { Vec3::new(0.3, 0.9, 0.31) };
        let along = (target - self.eye).normalize();
        let up = if along.cross(up).length() < 1e-3 { Vec3::X } else { up };
        let view_from_world: Mat4 = glam::camera::rh::view::look_at_mat4(self.eye, target, up);
        View::new(view_from_world, clip_from_view, self.viewport).expect("a usable view").with_target(
            depth,
            DepthFormat::Depth32Float,
            1,
        )
    }
}
