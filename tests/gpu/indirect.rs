//! Frames that the device culls by itself: they equal the whole frame bit for bit, whatever happens
//! between them, hidden things are culled, and what does not move is not uploaded.

use tercet::Error;
use tercet::geom::{Aabb, DepthFormat, Frustum, View, Viewport};
use tercet::query::SweepTest;
use tercet::query::gpu::{BatchMesh, IndirectBatch, IndirectConfig, IndirectCuller, IndirectStats};
use tercet::scene::{Batch, ObjectSet, Scene, SceneConfig, Traits};
use tercet::worlds::{self, Model, Pathology};

use crate::indirect_renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, read_buffer, read_depth, targets};

const SCREEN: Viewport = Viewport::new(96, 54);
const FRAMES: u32 = 12;

/// What a run came to, over all frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// Objects that owned a sample and were not drawn.
    pub lost: usize,
    /// Objects in the frustum that owned no sample, and those of them that were not drawn.
    pub hidden: usize,
    pub culled: usize,
    pub visible: usize,
    /// Samples in which the culled frame differs from the whole one.
    pub wrong: usize,
    /// Objects drawn because the last frame had found them visible; because this one has; and last.
    pub drawn: [usize; 3],
    /// Objects drawn twice, or out of order.
    pub disorder: usize,
}

/// A draw of a frame, to be read back: this is for the test alone.
struct Draw {
    instances: wgpu::Buffer,
    instances_offset: u64,
    arguments: wgpu::Buffer,
    arguments_offset: u64,
}

impl Draw {
    fn of(batch: &IndirectBatch<'_>) -> Self {
        let IndirectBatch { instances, instances_offset, arguments, arguments_offset, .. } = *batch;
        let (instances, arguments) = (instances.clone(), arguments.clone());
        Self { instances, instances_offset, arguments, arguments_offset }
    }
}

/// The words of a buffer.
fn words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u32> {
    let back = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &back, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read_buffer(gpu, &back).as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
}

/// The slots that the draws of one call have drawn, draw by draw.
fn slots(gpu: &Gpu, draws: &[Draw]) -> Vec<Vec<u32>> {
    let Some(first) = draws.first() else { return Vec::new() };
    let (instances, arguments) = (words(gpu, &first.instances), words(gpu, &first.arguments));
    draws
        .iter()
        .map(|draw| {
            let count = arguments[draw.arguments_offset as usize / 4 + 1] as usize;
            let first = draw.instances_offset as usize / 4;
            instances[first..first + count].to_vec()
        })
        .collect()
}

/// Runs a world; `seed` decides what happens to it. The view may have seen other ones.
pub fn run(
    gpu: &Gpu,
    eye: &mut IndirectCuller,
    (model, seed): (Model, u64),
    (format, samples): (DepthFormat, u32),
    outcome: &mut Outcome,
) {
    let mut stage = Stage::new(model, seed, SCREEN, true);
    let mut scene = Scene::new(SceneConfig::default());
    let mut renderer = Renderer::new(gpu);
    for frame in 0..FRAMES {
        let view = stage.next(frame);
        let view = view.clone().with_target(view.depth(), format, samples);
        renderer.dress(&mut stage.world, &view, stage.detail);
        scene.sync(&stage.world);
        renderer.prepare(&stage.world, &scene, &view);
        let (seen, whole) = renderer.truth(&scene, &view);
        let depth = depth_texture(gpu, &view);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut calls: Vec<Vec<Draw>> = Vec::new();
        eye.frame(&scene, &view, &targets(&depth, false), &renderer.meshes, &mut encoder, |pass, batches| {
            renderer.draw(pass, batches);
            calls.push(batches.iter().map(Draw::of).collect());
        })
        .expect("a frame");
        gpu.queue.submit([encoder.finish()]);
        let mut drawn = ObjectSet::default();
        let by_slot: std::collections::HashMap<_, _> =
            scene.objects().map(|object| (object.object.id.slot() as u32, object.object.id)).collect();
        for (call, draws) in calls.iter().enumerate() {
            for slots in slots(gpu, draws) {
                outcome.drawn[call] += slots.len();
                outcome.disorder += usize::from(!slots.is_sorted());
                outcome.disorder += slots.iter().filter(|slot| !drawn.insert(by_slot[*slot])).count();
            }
        }
        let frustum = Frustum::new(&view);
        for object in scene.objects() {
            let (seen, drawn) = (seen.contains(object.object.id), drawn.contains(object.object.id));
            outcome.visible += usize::from(seen);
            outcome.lost += usize::from(seen && !drawn);
            if !seen && object.bounds.is_some_and(|bounds| frustum.intersects(&bounds)) {
                outcome.hidden += 1;
                outcome.culled += usize::from(!drawn);
            }
        }
        let (whole, shown) = (read_depth(gpu, &whole, &view), read_depth(gpu, &depth, &view));
        outcome.wrong += whole.values.iter().zip(&shown.values).filter(|(a, b)| a != b).count();
    }
}

fn view(gpu: &Gpu, config: IndirectConfig) -> IndirectCuller {
    IndirectCuller::new(&gpu.device, &gpu.queue, config).expect("a view")
}

fn config(test: SweepTest) -> IndirectConfig {
    IndirectConfig { test, ..IndirectConfig::default() }
}

#[test]
fn random_worlds() {
    for gpu in gpus() {
        for test in [SweepTest::HiZ, SweepTest::Raster] {
            for &samples in gpu.sample_counts() {
                let mut eye = view(&gpu, config(test));
                let mut all = Outcome::default();
                for seed in 0..3 {
                    let formats = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus];
                    let target = (formats[seed as usize % 2], samples);
                    run(&gpu, &mut eye, (worlds::random(seed, 120), seed), target, &mut all);
                }
                let what = format!("{:?}, {test:?}, {samples} samples", gpu.backend);
                println!("{what}: {all:?}");
                assert_eq!((all.lost, all.wrong, all.disorder), (0, 0, 0), "{what}: {all:?}");
                assert!(all.hidden.min(all.visible) > 300, "there are things to hide: {all:?}");
                assert!(all.culled * 3 > all.hidden, "{what} culled little: {all:?}");
                assert!(all.drawn.iter().all(|&drawn| drawn > 0), "{what}: {all:?}");
            }
        }
    }
}

/// Worlds that are hard on arithmetic: coincident, enormous, tiny and flat things.
#[test]
fn pathological_worlds() {
    for gpu in gpus() {
        let mut all = Outcome::default();
        let tests = [SweepTest::HiZ, SweepTest::Raster];
        let mut eyes = tests.map(|test| view(&gpu, config(test)));
        for (kind, seed) in Pathology::ALL.into_iter().zip(0..) {
            for (&samples, eye) in gpu.sample_counts().iter().zip(&mut eyes) {
                let target = (DepthFormat::Depth32Float, samples);
                run(&gpu, eye, (worlds::pathological(kind), seed), target, &mut all);
                assert_eq!((all.lost, all.wrong, all.disorder), (0, 0, 0), "{kind:?}: {all:?}");
            }
        }
        println!("{:?}: {all:?}", gpu.backend);
        assert!(all.culled > 0, "{all:?}");
    }
}

/// A frame of a scene of plain boxes, without anything drawn.
fn frame(gpu: &Gpu, eye: &mut IndirectCuller, scene: &Scene, meshes: usize) -> Result<IndirectStats, Error> {
    let view = View::look_at(glam::Vec3::Z * 50.0, glam::Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
    let depth = depth_texture(gpu, &view);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let meshes = vec![BatchMesh::default(); meshes];
    let stats = eye.frame(scene, &view, &targets(&depth, false), &meshes, &mut encoder, |_, _| ())?;
    gpu.queue.submit([encoder.finish()]);
    Ok(stats)
}

fn traits(batch: u32) -> Traits {
    Traits { batch: Some(Batch(batch)), ..Traits::default() }
}

#[test]
fn only_what_has_changed_is_uploaded() {
    for gpu in gpus() {
        let mut scene = Scene::new(SceneConfig::default());
        let at = |i: usize, y: f32| {
            let place = glam::Vec3::new((i % 40) as f32 - 20.0, y, (i / 40) as f32 - 20.0);
            Aabb::from_center(place, glam::Vec3::splat(0.3))
        };
        let ids: Vec<_> = (0..1600).map(|i| scene.insert(at(i, 0.0), traits(i as u32 % 3))).collect();
        scene.update();
        let mut eye = view(&gpu, config(SweepTest::HiZ));
        let first = frame(&gpu, &mut eye, &scene, 3).expect("a frame");
        assert_eq!(first.objects, 1600);
        // A box of 32 bytes, a slot and a mesh each, and the meshes.
        assert_eq!(first.uploaded, 1600 * (32 + 4 + 4) + 3 * 24);
        scene.update();
        assert_eq!(frame(&gpu, &mut eye, &scene, 3).expect("a frame").uploaded, 0, "nothing has moved");
        scene.set_bounds(ids[700], at(700, 0.2));
        scene.update();
        let moved = frame(&gpu, &mut eye, &scene, 3).expect("a frame").uploaded;
        assert!((32..=32 * 32).contains(&moved), "{moved} bytes for one that moved");
    }
}

#[test]
fn an_object_without_a_mesh_is_an_error() {
    for gpu in gpus() {
        let mut eye = view(&gpu, config(SweepTest::HiZ));
        for wrong in [Traits::default(), traits(2)] {
            let mut scene = Scene::new(SceneConfig::default());
            frame(&gpu, &mut eye, &scene, 2).expect("an empty scene is a frame");
            scene.insert(Aabb::from_center(glam::Vec3::ZERO, glam::Vec3::ONE), wrong);
            assert!(matches!(frame(&gpu, &mut eye, &scene, 2), Err(Error::PendingEdits(_))));
            scene.update();
            let error = frame(&gpu, &mut eye, &scene, 2);
            assert!(matches!(error, Err(Error::Batch { meshes: 2, .. })), "{error:?}");
        }
    }
}

/// Counters come some frames late, and never wait.
#[test]
fn counters_come_back_on_demand() {
    for gpu in gpus() {
        let mut scene = Scene::new(SceneConfig::default());
        let mut insert = |x: f32, traits| {
            scene.insert(Aabb::from_center(glam::Vec3::X * x, glam::Vec3::ONE), traits);
        };
        (0..5).for_each(|i| insert(3.0 * i as f32 - 6.0, traits(i % 2)));
        insert(20.0, Traits { not_occluder: true, ..traits(0) });
        scene.update();
        let config = IndirectConfig { counters: true, ..config(SweepTest::Raster) };
        let mut eye = view(&gpu, config);
        let mut found = Vec::new();
        for _ in 0..9 {
            found.push(frame(&gpu, &mut eye, &scene, 2).expect("a frame").drawn);
            gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
        }
        assert_eq!(found[0], None);
        // In the first frame nothing is known to be visible, in the later ones everything is.
        assert!(found.contains(&Some([0, 5, 1])), "{found:?}");
        assert_eq!(found.last(), Some(&Some([5, 0, 1])), "{found:?}");
    }
}
