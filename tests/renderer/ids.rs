//! Item buffers: whose each sample is, in every shading, is what its colour says where each object has a
//! colour of its own; and nothing else is drawn otherwise for it.

use glam::{Affine3A, Vec2, Vec3};
use hecs::World;
use tercet::draw::{Detail, Drawable, Lines, Renderer, Shading};
use tercet::geom::{Aabb, DepthFormat, ScreenOutline, View, Viewport};
use tercet::query::QueryBackend;
use tercet::query::gpu::{FrameTargets, GpuQueries, IndirectConfig, IndirectCuller};
use tercet::scene::{Bounds, ObjectRef};
use tercet::worlds;
use wgpu::{Color, LoadOp, RenderPass, Texture};

use crate::by_slot;
use crate::pixels::{FORMAT, SHADINGS, Shot, Target, objects};
use crate::stage::Stage;
use crate::support::{Gpu, gpus, read_texels, texture};
use crate::uploads::{flat_view, tile};

const SCREEN: Viewport = Viewport::new(128, 72);

/// Targets with an item buffer beside the colour.
struct Owned {
    target: Target,
    ids: Texture,
}

impl Owned {
    fn new(gpu: &Gpu, view: &View) -> Self {
        let target = Target::new(gpu, view);
        let ids = texture(gpu, Renderer::IDS, target.size(), view.samples());
        Self { target, ids }
    }

    fn frame_targets(&self, has_color: bool) -> FrameTargets {
        let mut targets = self.target.frame_targets();
        if !has_color {
            targets.colors = vec![None];
        }
        targets.with_color(self.ids.create_view(&Default::default()), LoadOp::Clear(Color::TRANSPARENT))
    }

    /// One more than each sample's owner's slot; 0 where there is none.
    fn read(&self, gpu: &Gpu, view: &View) -> Vec<u32> {
        read_texels(gpu, &self.ids, view, "texel.x | (texel.y << 16u)")
    }
}

/// Draws a frame of one pass with ids or without; what its samples are, and whose.
fn shoot(
    gpu: &Gpu,
    view: &View,
    (detail, shading, look_ups): (Detail, Shading, u32),
    (has_color, has_ids): (bool, bool),
    record: impl FnOnce(&mut Renderer, &mut RenderPass<'static>),
) -> (Shot, Vec<u32>) {
    let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
    let new = if has_ids { Renderer::with_ids } else { Renderer::new };
    let mut renderer = new(&gpu.device, &gpu.queue, has_color.then_some(FORMAT)).expect("a renderer");
    renderer.set_look_ups(look_ups);
    let owned = Owned::new(gpu, view);
    let targets = if has_ids { owned.frame_targets(has_color) } else { owned.target.frame_targets() };
    queries.target(&targets);
    renderer.begin(view, detail, shading);
    queries.begin(view).expect("begin");
    queries.draw(|pass| record(&mut renderer, pass)).expect("draw");
    queries.end().expect("end");
    (owned.target.shot(gpu, view), owned.read(gpu, view))
}

/// Draws objects in two calls, each in a colour that says who it is.
fn draw_named(renderer: &mut Renderer, pass: &mut RenderPass<'static>, world: &World, all: &[ObjectRef]) {
    let name = |object: &ObjectRef| (0xff00_0000 | (object.id.slot() as u32 + 1)).to_le_bytes();
    for objects in all.chunks(all.len().div_ceil(2)) {
        renderer.draw_tinted(pass, world, objects.iter().map(|object| (*object, name(object))));
    }
}

#[test]
fn every_shading_says_whose_each_sample_is() {
    for gpu in gpus() {
        for &samples in gpu.sample_counts() {
            let mut stage = Stage::new(worlds::random(5, 300), 2, SCREEN, true);
            let mut covered = 0;
            for frame in 0..3 {
                let view = stage.next(7 * frame);
                let format = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus][frame as usize % 2];
                let view = view.clone().with_target(view.depth(), format, samples);
                let (world, all) = (&stage.world, objects(&stage.world));
                let shot = |shading, look_ups, targets| {
                    shoot(&gpu, &view, (stage.detail, shading, look_ups), targets, |renderer, pass| {
                        draw_named(renderer, pass, world, &all);
                    })
                };
                let (named, none) = shot(Shading::Unlit, 0, (true, false));
                assert!(none.iter().all(|&id| id == 0), "nobody wrote them");
                let owners: Vec<u32> = named.colors.iter().map(|color| color & 0xff_ffff).collect();
                covered += owners.iter().filter(|&&id| id != 0).count();
                for (shading, look_ups) in SHADINGS {
                    let run = format!("{:?}, {samples} samples, {shading:?}, {look_ups}", gpu.backend);
                    let (plain, _) = shot(shading, look_ups, (true, false));
                    let (shot, ids) = shot(shading, look_ups, (true, true));
                    assert!(ids == owners, "{run}: whose they are");
                    assert!(shot == plain, "{run}: what they look like");
                }
                let (depth, ids) = shot(Shading::Lit, 0, (false, true));
                assert!(ids == owners && depth.nearness == named.nearness, "{:?}, no colour", gpu.backend);
            }
            assert!(covered > 5000, "{covered} samples");
        }
    }
}

const SIDE: u32 = 16;

/// Four walls, of which the third is behind the others, which have the same depth. So many other objects,
/// of which nothing is drawn, have the ids before theirs.
fn walls(others: usize) -> (World, Vec<ObjectRef>) {
    let mesh = tile("wall");
    let mut world = World::new();
    let nowhere = Bounds(Aabb::from_center(Vec3::splat(-1e3), Vec3::ONE));
    world.spawn_batch((0..others).map(|_| (nowhere,)));
    for z in [0.0, 0.0, -5.0, 0.0] {
        let scale = Affine3A::from_scale(Vec3::new(SIDE as f32, SIDE as f32, 1.0));
        let world_from_object = Affine3A::from_translation(Vec3::Z * z) * scale;
        let bounds = Bounds(mesh.bounds_under(&world_from_object));
        world.spawn((bounds, Drawable { mesh: mesh.clone(), world_from_object, color: [9; 3] }));
    }
    let mut all = objects(&world);
    all.retain(|object| object.id.slot() >= others);
    all.sort_by_key(|object| object.id.slot());
    assert_eq!(all.len(), 4);
    (world, all)
}

#[test]
fn the_last_one_drawn_owns_a_depth_that_several_share() {
    // Their ids do not fit one channel.
    let (world, all) = walls(0xffff);
    for gpu in gpus() {
        for &samples in gpu.sample_counts() {
            let view = flat_view(SIDE);
            let view = view.clone().with_target(view.depth(), view.format(), samples);
            for order in [[0, 1, 2, 3], [3, 1, 0, 2], [2, 0, 3, 1]] {
                let last = order.into_iter().rfind(|&i| i != 2).expect("there are others");
                let owner = all[last].id.slot() as u32 + 1;
                assert!(owner > 0xffff);
                for (shading, look_ups) in SHADINGS {
                    for has_color in [false, true] {
                        let how = (Detail::FULL, shading, look_ups);
                        let (_, ids) = shoot(&gpu, &view, how, (has_color, true), |renderer, pass| {
                            draw_named(renderer, pass, &world, &order.map(|i| all[i]));
                        });
                        assert!(ids.iter().all(|&id| id == owner), "{shading:?}, {owner}: {:?}", ids[0]);
                    }
                }
            }
        }
    }
}

/// What lies over a frame, and what the device has culled by itself, is nobody's.
#[test]
fn overlays_and_objects_by_slot_leave_the_ids_as_they_are() {
    let (mut world, all) = walls(0);
    let view = flat_view(SIDE);
    let aabb = Aabb::new(Vec3::new(2.5, 3.5, 1.0), Vec3::new(9.5, 12.5, 2.0));
    let points = [[2.0, 3.0], [10.0, 3.0], [10.0, 9.0]].map(Vec2::from_array).to_vec();
    for gpu in gpus() {
        let how = (Detail::FULL, Shading::Unlit, 0);
        let draw = |over: bool| {
            shoot(&gpu, &view, how, (true, true), |renderer, pass| {
                renderer.draw(pass, &world, &all);
                if over {
                    renderer.draw_boxes(pass, &[(aabb, [255; 4])], Lines::DepthTested);
                    renderer.draw_boxes(pass, &[(aabb, [255; 4])], Lines::XRay);
                    let outline = ScreenOutline { points: points.clone() };
                    renderer.draw_outlines(pass, &[(outline, [255; 4])]);
                }
            })
        };
        let ((plain, ids), (over, same)) = (draw(false), draw(true));
        assert!(plain.colors != over.colors && ids == same);
    }
    for gpu in gpus() {
        let (by_slot, scene) = by_slot::dressed(&gpu, &mut world);
        for (shading, look_ups) in SHADINGS {
            let config = IndirectConfig::default();
            let mut eye = IndirectCuller::new(&gpu.device, &gpu.queue, config).expect("a view");
            let mut renderer = Renderer::with_ids(&gpu.device, &gpu.queue, Some(FORMAT)).expect("a renderer");
            renderer.set_look_ups(look_ups);
            let owned = Owned::new(&gpu, &view);
            let targets = owned.frame_targets(true);
            by_slot::draw(&gpu, &mut eye, &scene, (&mut renderer, shading), &by_slot, &view, &targets);
            assert!(owned.target.shot(&gpu, &view).colors.iter().all(|&color| color != 0), "{shading:?}");
            assert!(owned.read(&gpu, &view).iter().all(|&id| id == 0), "{shading:?}");
        }
    }
}
