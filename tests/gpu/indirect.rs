//! Frames that the device culls by itself: they equal the whole frame bit for bit, whatever happens
//! between them, hidden things are culled, and what does not move is not uploaded.

use glam::Vec3;
use tercet::Error;
use tercet::geom::{Aabb, DepthFormat, Frustum, View, Viewport};
use tercet::query::SweepTest;
use tercet::query::gpu::{BatchMesh, IndirectBatch, IndirectConfig, IndirectCuller, IndirectStats};
use tercet::scene::{Batch, ObjectId, ObjectSet, Scene, SceneConfig, Traits};
use tercet::tree::{NodeId, TreeConfig};
use tercet::worlds::{self, Model, Pathology};

use crate::indirect_renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, read_buffer, read_depth, targets};
use crate::sweep_mutations::rays_alone;

const SCREEN: Viewport = Viewport::new(96, 54);
const FRAMES: u32 = 12;
const TESTS: [SweepTest; 3] = [SweepTest::HiZ, SweepTest::Raster, SweepTest::Rays];

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
    batch: Batch,
    instances: wgpu::Buffer,
    instances_offset: u64,
    arguments: wgpu::Buffer,
    arguments_offset: u64,
}

impl Draw {
    fn of(batch: &IndirectBatch<'_>) -> Self {
        let IndirectBatch { batch, instances, instances_offset, arguments, arguments_offset } = *batch;
        let (instances, arguments) = (instances.clone(), arguments.clone());
        Self { batch, instances, instances_offset, arguments, arguments_offset }
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
            // More than there is room for, if a shader is wrong.
            instances.get(first..first.saturating_add(count)).map_or(vec![u32::MAX], <[u32]>::to_vec)
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
    let mut scene = Scene::new(fine());
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

/// A tree of some depth: small leaves from the beginning.
fn fine() -> SceneConfig {
    let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
    SceneConfig { tree, ..SceneConfig::default() }
}

fn config(test: SweepTest) -> IndirectConfig {
    IndirectConfig { test, ..IndirectConfig::default() }
}

#[test]
fn random_worlds() {
    for gpu in gpus() {
        let mut by_raster = Vec::new();
        for test in TESTS {
            for (i, &samples) in gpu.sample_counts().iter().enumerate() {
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
                match test {
                    SweepTest::Raster => by_raster.push(all.drawn),
                    SweepTest::Rays => assert_eq!(all.drawn, by_raster[i], "{what}: not what rasters find"),
                    _ => {}
                }
            }
        }
    }
}

/// Worlds that are hard on arithmetic: coincident, enormous, tiny and flat things.
#[test]
fn pathological_worlds() {
    for gpu in gpus() {
        let mut all = Outcome::default();
        let mut eyes = TESTS.map(|test| view(&gpu, config(test)));
        for (kind, seed) in Pathology::ALL.into_iter().zip(0..) {
            // Rays with each number of samples, the others with one.
            let [others @ .., rays] = &mut eyes;
            for (&samples, other) in gpu.sample_counts().iter().zip(others) {
                for eye in [other, &mut *rays] {
                    let target = (DepthFormat::Depth32Float, samples);
                    run(&gpu, eye, (worlds::pathological(kind), seed), target, &mut all);
                    assert_eq!((all.lost, all.wrong, all.disorder), (0, 0, 0), "{kind:?}: {all:?}");
                }
            }
        }
        println!("{:?}: {all:?}", gpu.backend);
        assert!(all.culled > 0, "{all:?}");
    }
}

/// What the lists of some frames should hold, and what they hold: nothing is drawn, so what lies in
/// view is visible, and what lies behind the eye is not. Returns how many lists are wrong.
pub fn wrong_lists(gpu: &Gpu, config: IndirectConfig, count: usize) -> usize {
    let mut scene = Scene::new(fine());
    let z = |i: usize| if i * i % 7 < 4 { -5.0 } else { 5.0 };
    for i in 0..count {
        let place = Vec3::new((i % 50) as f32 * 0.1 - 2.5, (i / 50 % 30) as f32 * 0.1 - 1.5, z(i));
        let traits = Traits { not_occluder: i % 11 == 3, ..traits((i * 5 % 13 % 4) as u32) };
        scene.insert(Aabb::from_center(place, Vec3::splat(0.2)), traits);
    }
    scene.update();
    let mut eye = view(gpu, config);
    let mut wrong = 0;
    let mut before = ObjectSet::default();
    for toward in [-1.0, -1.0, -1.0, 1.0, -1.0] {
        let target = Vec3::Z * toward;
        let view = View::look_at(Vec3::ZERO, target, 90.0, 0.1, SCREEN).expect("a view");
        let depth = depth_texture(gpu, &view);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut calls = Vec::new();
        // The last mesh has no objects, so it is not drawn.
        let meshes: Vec<_> =
            (0..5).map(|i| BatchMesh { index_count: 3 * i, first_index: i, base_vertex: -1 }).collect();
        eye.frame(&scene, &view, &targets(&depth, false), &meshes, &mut encoder, |_, batches| {
            assert!(batches.iter().all(|batch| batch.batch.0 < 4) && batches.is_sorted_by_key(|b| b.batch.0));
            calls.push(batches.iter().map(Draw::of).collect::<Vec<_>>());
        })
        .expect("a frame");
        gpu.queue.submit([encoder.finish()]);
        let mut now = ObjectSet::default();
        for (call, draws) in calls.iter().enumerate() {
            let mut expected = vec![Vec::new(); 4];
            for object in scene.objects() {
                let (id, late) = (object.object.id, object.traits.not_occluder);
                let ahead = object.bounds.expect("it has a box").center().z * toward > 0.0;
                if ahead {
                    now.insert(id);
                }
                if ahead && call == if late { 2 } else { usize::from(!before.contains(id)) } {
                    expected[object.traits.batch.expect("it has one").0 as usize].push(id.slot() as u32);
                }
            }
            for (draw, found) in draws.iter().zip(slots(gpu, draws)) {
                let expected = std::mem::take(&mut expected[draw.batch.0 as usize]);
                wrong += usize::from(found != expected);
            }
            assert!(expected.iter().all(Vec::is_empty), "every mesh with objects is drawn");
            let arguments = words(gpu, &draws[0].arguments);
            for (mesh, words) in meshes.iter().zip(arguments.as_chunks::<5>().0) {
                let [index_count, _, first_index, base_vertex, first_instance] = *words;
                let of_mesh = [mesh.index_count, mesh.first_index, mesh.base_vertex as u32, 0];
                wrong += usize::from([index_count, first_index, base_vertex, first_instance] != of_mesh);
            }
        }
        before = now;
    }
    wrong
}

/// How often the groups and the loose objects are not those that the tree says: boxes that do not hide
/// each other, of which some come into view from frame to frame, behind a few that are drawn first.
pub fn wrong_groups(gpu: &Gpu, config: IndirectConfig) -> usize {
    // Nothing is too large, and nothing lies outside or between the samples.
    // Nor is anything found out before rays are cast.
    let mut whole = IndirectConfig { counters: true, share: 1.0, prune_from: usize::MAX, ..config };
    rays_alone(&mut whole.shaders);
    let mut eye = view(gpu, whole);
    let mut scene = Scene::new(fine());
    let at = |i: usize| Vec3::new((i % 19) as f32 - 9.0, (i / 19 % 7) as f32 - 3.0, (i % 5) as f32);
    // What hides nothing is never drawn first.
    let traits = |i: usize| Traits { not_occluder: !(i / 40).is_multiple_of(3), ..traits(0) };
    let ids: Vec<_> =
        (0..300).map(|i| scene.insert(Aabb::from_center(at(i), Vec3::splat(0.8)), traits(i))).collect();
    scene.update();
    let drawn = |i: usize| !traits(i).not_occluder;
    let mut expected = [0; 2];
    let tree = scene.tree();
    let holds_drawn = |node: NodeId| {
        let below = |id: &ObjectId| {
            let own = tree.node_of(id.slot() as u32);
            std::iter::successors(own, |&own| tree.parent(own)).any(|above| above == node)
        };
        ids.iter().enumerate().any(|(i, id)| drawn(i) && below(id))
    };
    for node in tree.nodes().filter(|node| node.below > 0) {
        let is_visible = holds_drawn(node.id);
        let hangs_off = tree.parent(node.id).is_some_and(holds_drawn);
        expected[0] += u32::from(!is_visible && hangs_off);
        expected[1] += if is_visible { node.own as u32 } else { 0 };
    }
    assert!(expected.iter().all(|&count| count > 10), "{expected:?}");
    let mut found = Vec::new();
    for _ in 0..9 {
        found.push(frame(gpu, &mut eye, &scene, 1).expect("a frame").tested);
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
    }
    // In the first frame the root is the only group.
    usize::from(!found.contains(&Some([1, 0]))) + usize::from(found.last() != Some(&Some(expected)))
}

#[test]
fn groups_are_the_largest_subtrees_without_what_was_drawn_first() {
    for gpu in gpus() {
        assert_eq!(wrong_groups(&gpu, config(SweepTest::Rays)), 0, "{:?}", gpu.backend);
    }
}

/// Lists in the order of slots, of few objects and of more than one step of the sum holds.
#[test]
fn lists_hold_what_is_visible_in_order() {
    for gpu in gpus() {
        for count in [1, 256, 1000, 70_000] {
            for test in TESTS {
                assert_eq!(wrong_lists(&gpu, config(test), count), 0, "{:?}, {count}, {test:?}", gpu.backend);
            }
        }
    }
}

/// A frame of a scene of plain boxes, without anything drawn.
fn frame(gpu: &Gpu, eye: &mut IndirectCuller, scene: &Scene, meshes: usize) -> Result<IndirectStats, Error> {
    let view = View::look_at(Vec3::Z * 50.0, Vec3::ZERO, 60.0, 0.1, SCREEN).expect("a view");
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
            let place = Vec3::new((i % 40) as f32 - 20.0, y, (i / 40) as f32 - 20.0);
            Aabb::from_center(place, Vec3::splat(0.3))
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
            scene.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), wrong);
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
            scene.insert(Aabb::from_center(Vec3::X * x, Vec3::ONE), traits);
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
