//! Frames that the device culls by itself, drawn by slot: the whole frame's depth in every sample, and its
//! colours where nobody else is as near, whatever happens between frames; and what is uploaded for them.

use std::borrow::Cow;

use glam::{Affine3A, Vec3};
use hecs::{Entity, World};
use tercet::Culler;
use tercet::draw::{BySlot, Detail, Drawable, Renderer, Shading};
use tercet::geom::{DepthFormat, View};
use tercet::policy;
use tercet::query::SweepTest;
use tercet::query::gpu::{FrameTargets, IndirectConfig, IndirectCuller, Shaders};
use tercet::scene::mesh::Mesh;
use tercet::scene::{Batch, Bounds, Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::worlds;

use crate::frames::Studio;
use crate::pixels::{FORMAT, SHADINGS, Target, objects, shoot};
use crate::support::{Gpu, gpus};
use crate::uploads::{flat_view, tile};

/// A cut every six.
const FRAMES: u32 = 14;
const TESTS: [SweepTest; 3] = [SweepTest::HiZ, SweepTest::Raster, SweepTest::Rays];
/// Bytes of an object: three rows of its transform, and a colour.
const OBJECT: u64 = 4 * 16;

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    /// What has moved is not uploaded.
    Stale,
    /// Who has another mesh is told of it a frame late.
    Undressed,
    /// The shader of lists mixes up who is in one.
    Mixed,
}

#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    /// Samples that something was drawn on, and those of them in which several share the nearest depth.
    covered: usize,
    tied: usize,
    wrong_depth: usize,
    wrong_color: usize,
    /// Objects that could have been drawn, and that were, of frames for which that came back.
    objects: u32,
    drawn: u32,
}

/// Runs a world in which things move, come, go, and change their mesh.
fn run(gpu: &Gpu, test: SweepTest, samples: u32, mistake: Option<Mistake>) -> Outcome {
    let mut studio = Studio::new(gpu, worlds::random(5, 300), 2, true);
    studio.stage.detail = Detail::FULL;
    // Small leaves from the start, for rays.
    let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
    studio.scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let mut shaders = Shaders::default();
    if mistake == Some(Mistake::Mixed) {
        let (from, to) = ("before[i] == before[i + 1u]", "before[i] != before[i + 1u]");
        assert!(shaders.compact.contains(from));
        shaders.compact = Cow::Owned(shaders.compact.replace(from, to));
    }
    let config = IndirectConfig { test, counters: true, shaders, ..IndirectConfig::default() };
    let mut eye = IndirectCuller::new(&gpu.device, &gpu.queue, config).expect("a view");
    let mut none = Culler::new(policy::by_name("none").expect("a policy of that name"));
    let mut by_slot = BySlot::new(&gpu.device, &gpu.queue);
    let mut outcome = Outcome::default();
    for frame in 0..FRAMES {
        let view = studio.stage.next(frame);
        let format = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus][frame as usize % 2];
        let view = view.clone().with_target(view.depth(), format, samples);
        if mistake == Some(Mistake::Undressed) {
            by_slot.dress(&mut studio.stage.world);
        }
        exchange(&mut studio.stage.world, frame);
        if mistake != Some(Mistake::Undressed) {
            by_slot.dress(&mut studio.stage.world);
        }
        studio.scene.sync(&studio.stage.world);
        let (whole, _) = studio.frame(&mut none, &view, |_| true);
        let [last, first] = studio.owners(&view);
        if mistake != Some(Mistake::Stale) || frame == 0 {
            by_slot.follow(&studio.scene, &studio.stage.world).expect("an upload");
        }
        let target = Target::new(gpu, &view);
        let drawn = draw(
            gpu,
            &mut eye,
            &studio.scene,
            (&mut studio.renderer, Shading::Lit),
            &by_slot,
            &view,
            &target.frame_targets(),
        );
        if let Some(drawn) = drawn {
            outcome.objects += studio.scene.len() as u32;
            outcome.drawn += drawn.iter().sum::<u32>();
        }
        let culled = target.shot(gpu, &view);
        for i in 0..whole.colors.len() {
            let is_tied = first.colors[i] != last.colors[i];
            outcome.covered += usize::from(last.colors[i] != 0);
            outcome.tied += usize::from(is_tied);
            outcome.wrong_depth += usize::from(culled.nearness[i] != whole.nearness[i]);
            let is_other = !alike(culled.colors[i], whole.colors[i]);
            outcome.wrong_color += usize::from(!is_tied && is_other);
        }
    }
    outcome
}

/// A world's objects on the device, and its scene.
pub fn dressed(gpu: &Gpu, world: &mut World) -> (BySlot, Scene) {
    let mut by_slot = BySlot::new(&gpu.device, &gpu.queue);
    let mut scene = Scene::new(SceneConfig::default());
    by_slot.dress(world);
    scene.sync(world);
    by_slot.follow(&scene, world).expect("an upload");
    (by_slot, scene)
}

/// Draws a frame; returns how many objects were drawn in each part of an earlier one.
pub fn draw(
    gpu: &Gpu,
    eye: &mut IndirectCuller,
    scene: &Scene,
    (renderer, shading): (&mut Renderer, Shading),
    by_slot: &BySlot,
    view: &View,
    targets: &FrameTargets,
) -> Option<[u32; 3]> {
    renderer.begin(view, Detail::FULL, shading);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let stats = eye.frame(scene, view, targets, by_slot.meshes(), &mut encoder, |pass, batches| {
        renderer.draw_batches(pass, by_slot, batches);
    });
    gpu.queue.submit([encoder.finish()]);
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
    stats.expect("a frame").drawn
}

/// Two entities exchange their meshes.
fn exchange(world: &mut World, frame: u32) {
    let mut all: Vec<Entity> = world.query::<(Entity, &Drawable)>().iter().map(|(e, _)| e).collect();
    all.sort_unstable_by_key(|entity| entity.id());
    let chosen = [3, 7].map(|n| all[(frame as usize + 1) * 17 * n % all.len()]);
    let [a, b] = chosen.map(|entity| world.get::<&Drawable>(entity).expect("it is there").mesh.clone());
    for (entity, mesh) in chosen.into_iter().zip([b, a]) {
        let (bounds, drawable) =
            world.query_one_mut::<(&mut Bounds, &mut Drawable)>(entity).expect("it is there");
        *bounds = Bounds(mesh.bounds_under(&drawable.world_from_object));
        drawable.mesh = mesh;
    }
}

/// Whether colours differ by no more than a rounding: they come from numbers of 16 bits here, and of 32 there.
fn alike(a: u32, b: u32) -> bool {
    a.to_le_bytes().into_iter().zip(b.to_le_bytes()).all(|(a, b)| a.abs_diff(b) <= 1)
}

#[test]
fn frames_that_the_device_culls_are_the_whole_ones() {
    for gpu in gpus() {
        for &samples in gpu.sample_counts() {
            for test in TESTS {
                let outcome = run(&gpu, test, samples, None);
                let run = format!("{:?}, {samples} samples, {test:?}: {outcome:?}", gpu.backend);
                println!("{run}");
                assert_eq!((outcome.wrong_depth, outcome.wrong_color), (0, 0), "{run}");
                assert!(outcome.drawn > 0 && 3 * outcome.drawn < 2 * outcome.objects, "{run}");
                assert!(outcome.covered > 10_000 && outcome.tied * 4 < outcome.covered, "{run}");
            }
        }
    }
}

#[test]
fn mistakes_are_found_out() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    for mistake in [Mistake::Stale, Mistake::Undressed, Mistake::Mixed] {
        let outcome = run(&gpu, SweepTest::HiZ, 1, Some(mistake));
        assert!(outcome.wrong_depth > 0 && outcome.wrong_color > 0, "{mistake:?}: {outcome:?}");
    }
}

/// Tiles of a pixel each.
fn tiles(side: u32) -> World {
    let meshes = [tile("one"), tile("two")];
    let mut world = World::new();
    for i in 0..side * side {
        let mesh = meshes[(i % 3 % 2) as usize].clone();
        let world_from_object =
            Affine3A::from_translation(Vec3::new((i % side) as f32, (i / side) as f32, (i % 7) as f32));
        let bounds = Bounds(mesh.bounds_under(&world_from_object));
        world.spawn((bounds, Drawable { mesh, world_from_object, color: [i as u8, 255 - i as u8, 7] }));
    }
    world
}

#[test]
fn every_shading_looks_as_ever() {
    const SIDE: u32 = 16;
    let view = flat_view(SIDE);
    let mut world = tiles(SIDE);
    for gpu in gpus() {
        let (by_slot, scene) = dressed(&gpu, &mut world);
        for (shading, look_ups) in SHADINGS {
            let want = shoot(&gpu, &view, shading, |renderer, pass| {
                renderer.set_look_ups(look_ups);
                renderer.draw(pass, &world, &objects(&world));
            });
            let config = IndirectConfig::default();
            let mut eye = IndirectCuller::new(&gpu.device, &gpu.queue, config.clone()).expect("a view");
            let mut renderer = Renderer::new(&gpu.device, &gpu.queue, Some(FORMAT)).expect("a renderer");
            renderer.set_look_ups(look_ups);
            let target = Target::new(&gpu, &view);
            draw(&gpu, &mut eye, &scene, (&mut renderer, shading), &by_slot, &view, &target.frame_targets());
            let shot = target.shot(&gpu, &view);
            assert_eq!(shot.nearness, want.nearness, "{shading:?}");
            assert!(want.colors.iter().all(|&color| color != 0));
            let same = shot.colors.iter().zip(&want.colors).all(|(&a, &b)| alike(a, b));
            assert!(same, "{shading:?} with {look_ups} look-ups");
            // Two meshes, in two passes: what was visible, and what was found; and two kinds for overdraw.
            let draws = if shading == Shading::Overdraw { 8 } else { 4 };
            assert_eq!(renderer.stats().drawn.draws, draws);
            // A shadow map.
            let mut eye = IndirectCuller::new(&gpu.device, &gpu.queue, config).expect("a view");
            let mut renderer = Renderer::new(&gpu.device, &gpu.queue, None).expect("a renderer");
            let target = Target::new(&gpu, &view);
            draw(&gpu, &mut eye, &scene, (&mut renderer, shading), &by_slot, &view, &target.depth_targets());
            assert_eq!(target.shot(&gpu, &view).nearness, want.nearness);
        }
    }
}

#[test]
fn only_what_has_changed_is_uploaded() {
    const SIDE: u32 = 40;
    for gpu in gpus() {
        let mut world = tiles(SIDE);
        let mut by_slot = BySlot::new(&gpu.device, &gpu.queue);
        let mut scene = Scene::new(SceneConfig::default());
        assert_eq!(by_slot.dress(&mut world), 1600);
        assert_eq!(by_slot.dress(&mut world), 0);
        let mut follow = |world: &World| {
            scene.sync(world);
            by_slot.follow(&scene, world).expect("an upload")
        };
        assert_eq!(follow(&world), 1600 * OBJECT);
        assert_eq!(follow(&world), 0, "nothing has changed");
        let one = world.query::<(Entity, &Drawable)>().iter().map(|(entity, _)| entity).nth(700);
        let one = one.expect("there are more");
        let moves = |d: &mut Drawable| d.world_from_object.translation.x += 0.25;
        let blushes = |d: &mut Drawable| d.color = [1, 2, 3];
        for change in [moves, blushes] {
            change(world.query_one_mut::<&mut Drawable>(one).expect("it is there"));
            let changed = follow(&world);
            assert!((OBJECT..=32 * OBJECT).contains(&changed), "{changed} bytes for one");
        }
        assert_eq!(follow(&world), 0);
    }
}

#[test]
fn a_forgotten_mesh_leaves_its_number_to_the_next() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    let mut by_slot = BySlot::new(&gpu.device, &gpu.queue);
    let mut world = World::new();
    let put = |world: &mut World, by_slot: &mut BySlot, mesh: &Mesh| {
        let drawable = Drawable { mesh: mesh.clone(), world_from_object: Affine3A::IDENTITY, color: [0; 3] };
        let entity = world.spawn((drawable,));
        assert_eq!(by_slot.dress(world), 1);
        (entity, *world.get::<&Batch>(entity).expect("it was dressed"))
    };
    let [a, b, c] = ["a", "b", "c"].map(tile);
    assert_eq!(put(&mut world, &mut by_slot, &a).1, Batch(0));
    let (gone, batch) = put(&mut world, &mut by_slot, &b);
    assert_eq!(batch, Batch(1));
    world.despawn(gone).expect("it is there");
    by_slot.forget(&b);
    assert_eq!(by_slot.meshes()[1].index_count, 0);
    assert_eq!(put(&mut world, &mut by_slot, &c).1, Batch(1));
    assert_eq!(by_slot.meshes()[1].index_count, 6);
}
