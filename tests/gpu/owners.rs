//! Who owns a sample, by the item buffer that the reference renderer draws, against frames of each
//! object alone: it owns a sample, or shares one, where its own depth is that of the whole frame.

use glam::Vec3;
use tercet::Culler;
use tercet::draw::{self, Shading};
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::gpu::{FrameTargets, GpuQueries};
use tercet::query::{Answer, QueryBackend, Sweep, SweepTest, Ticket, Wait};
use tercet::scene::{ObjectId, ObjectRef, ObjectSet, Scene, SceneConfig, Traits};
use tercet::worlds;

use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, gpus_with, read_depth, texture};

const SCREEN: Viewport = Viewport::new(97, 55);
const FRAMES: u32 = 2;

/// What some frames came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// Owners that were found, and those who own nothing.
    owners: usize,
    others: usize,
    /// Objects that own a sample at the depth of another one's, and were not found.
    tied: usize,
    /// Objects found that own nothing, or not found that own a sample alone.
    pub wrong: usize,
}

/// A view's targets: depth, and ids beside a colour that nobody needs.
struct Targets {
    depth: wgpu::Texture,
    ids: wgpu::Texture,
}

impl Targets {
    fn new(gpu: &Gpu, view: &View) -> Self {
        let depth = depth_texture(gpu, view);
        let size = [depth.width(), depth.height()];
        Self { ids: texture(gpu, draw::Renderer::IDS, size, view.samples()), depth }
    }

    fn set(&self, queries: &mut GpuQueries) {
        let (mut targets, ids) = self.targets();
        targets.colors.push(None);
        queries.target_ids(Some(&ids));
        queries.target(&targets.with_color(ids, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT)));
    }

    /// The same with samples that are somebody's before anything is drawn.
    fn set_cleared(&self, queries: &mut GpuQueries, id: u16) {
        let (targets, ids) = self.targets();
        let id = wgpu::Color { r: id.into(), ..wgpu::Color::TRANSPARENT };
        queries.target_ids(Some(&ids));
        queries.target(&targets.with_color(ids, wgpu::LoadOp::Clear(id)));
    }

    fn targets(&self) -> (FrameTargets, wgpu::TextureView) {
        let [depth, ids] = [&self.depth, &self.ids].map(|texture| texture.create_view(&Default::default()));
        (FrameTargets::new(depth), ids)
    }
}

/// Draws worlds, and asks who owns samples.
pub fn run(gpu: &Gpu, queries: &mut GpuQueries, seed: u64, samples: u32) -> Outcome {
    let mut outcome = Outcome::default();
    let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
    let mut scene = Scene::new(SceneConfig::default());
    let mut renderer = draw::Renderer::with_ids(&gpu.device, &gpu.queue, None).expect("a renderer");
    for frame in 0..FRAMES {
        let view = stage.next(frame);
        let view = view.clone().with_target(view.depth(), view.format(), samples);
        scene.sync(&stage.world);
        let objects: Vec<ObjectRef> = scene.objects().map(|object| object.object).collect();
        let mut depth_of = |objects: &[ObjectRef], ask: bool| {
            let targets = Targets::new(gpu, &view);
            targets.set(queries);
            renderer.begin(&view, stage.detail, Shading::Unlit);
            queries.begin(&view).expect("begin");
            let draw = |pass: &mut _| {
                renderer.draw(pass, &stage.world, objects);
            };
            queries.draw(draw).expect("draw");
            let found = if ask { owners(queries, &scene, &view, objects) } else { ObjectSet::default() };
            queries.end().expect("end");
            (read_depth(gpu, &targets.depth, &view).values, found)
        };
        let (whole, found) = depth_of(&objects, true);
        let cleared = view.depth().cleared();
        for &object in &objects {
            let alone = depth_of(&[object], false).0;
            let is_owner = alone.iter().zip(&whole).any(|(own, whole)| own == whole && *own > cleared);
            let is_found = found.contains(object.id);
            outcome.owners += usize::from(is_found);
            outcome.others += usize::from(!is_owner);
            outcome.wrong += usize::from(is_found && !is_owner);
            if is_owner && !is_found {
                let others: Vec<_> = objects.iter().copied().filter(|other| other.id != object.id).collect();
                let is_alone = depth_of(&others, false).0 != whole;
                outcome.wrong += usize::from(is_alone);
                outcome.tied += usize::from(!is_alone);
            }
        }
    }
    outcome
}

/// Those who own a sample of what has been drawn.
fn owners(queries: &mut GpuQueries, scene: &Scene, view: &View, objects: &[ObjectRef]) -> ObjectSet {
    let loose: Vec<ObjectId> = objects.iter().map(|object| object.id).collect();
    let frustum = Frustum::new(view);
    let test = SweepTest::Owners;
    let sweep = Sweep { scene, view, frustum: &frustum, groups: &[], loose: &loose, test };
    queries.sweep(Ticket(3), &sweep).expect("a sweep");
    let mut found = None;
    let deliver = |_, answer: Answer<'_>| match answer {
        Answer::Swept(objects) => found = Some(objects.clone()),
        other => panic!("{other:?}"),
    };
    queries.answers(Wait::Block, deliver).expect("answers");
    found.expect("an answer")
}

#[test]
fn owners_are_those_whose_depth_is_that_of_the_frame() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        for &samples in gpu.sample_counts() {
            let mut all = Outcome::default();
            for seed in 0..3 {
                let Outcome { owners, others, tied, wrong } = run(&gpu, &mut queries, seed, samples);
                all.owners += owners;
                all.others += others;
                all.tied += tied;
                all.wrong += wrong;
            }
            println!("{:?}, {samples} samples: {all:?}", gpu.backend);
            assert_eq!(all.wrong, 0, "{:?}, {samples} samples: {all:?}", gpu.backend);
            assert!(all.owners > 50 && all.others > 100 && all.tied * 10 < all.owners, "{all:?}");
        }
    }
}

/// Without an item buffer the answer is unknown, and what cannot be one is refused.
#[test]
fn item_buffers_are_checked() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut stage = Stage::new(worlds::random(1, 20), 1, SCREEN, true);
        let view = stage.next(0);
        let mut scene = Scene::new(SceneConfig::default());
        scene.sync(&stage.world);
        let targets = Targets::new(&gpu, &view);
        targets.set(&mut queries);
        let of = |format, size| texture(&gpu, format, size, 1).create_view(&Default::default());
        let size = [SCREEN.width, SCREEN.height];
        for bad in [of(wgpu::TextureFormat::Rgba8Unorm, size), of(draw::Renderer::IDS, [SCREEN.width, 1])] {
            queries.target_ids(Some(&bad));
            assert!(matches!(queries.begin(&view), Err(tercet::Error::Target { .. })));
        }
        queries.target_ids(None);
        queries.begin(&view).expect("begin");
        let frustum = Frustum::new(&view);
        let test = SweepTest::Owners;
        let sweep = Sweep { scene: &scene, view: &view, frustum: &frustum, groups: &[], loose: &[], test };
        queries.sweep(Ticket(3), &sweep).expect("a sweep");
        let mut answers = 0;
        let deliver = |_, answer: Answer<'_>| answers += usize::from(matches!(answer, Answer::Unknown));
        queries.answers(Wait::Block, deliver).expect("answers");
        assert_eq!(answers, 1);
    }
}

/// A scene of so many boxes, and all of them.
fn many(count: usize) -> (Scene, Vec<ObjectId>) {
    let mut scene = Scene::new(SceneConfig::default());
    let place = |i: usize| Vec3::new((i % 100) as f32, (i / 100) as f32, -5.0);
    let mut insert = |i| scene.insert(Aabb::from_center(place(i), Vec3::splat(0.4)), Traits::default());
    let ids = (0..count).map(&mut insert).collect();
    scene.update();
    (scene, ids)
}

/// The answer about all objects where every sample is the last one's.
fn owned_by_the_last(gpu: &Gpu, queries: &mut GpuQueries, count: usize) -> Option<Vec<ObjectId>> {
    let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 0.1, SCREEN).expect("a view");
    let (scene, ids) = many(count);
    Targets::new(gpu, &view).set_cleared(queries, u16::try_from(count).expect("few"));
    queries.begin(&view).expect("begin");
    let (frustum, test) = (Frustum::new(&view), SweepTest::Owners);
    let sweep = Sweep { scene: &scene, view: &view, frustum: &frustum, groups: &[], loose: &ids, test };
    queries.sweep(Ticket(3), &sweep).expect("a sweep");
    let mut answer = None;
    let deliver = |_, found: Answer<'_>| {
        answer = Some(match found {
            Answer::Swept(found) => Some(ids.iter().copied().filter(|&id| found.contains(id)).collect()),
            _ => None,
        });
    };
    queries.answers(Wait::Block, deliver).expect("answers");
    queries.end().expect("end");
    let last = ids[count - 1];
    let answer: Option<Vec<ObjectId>> = answer.expect("an answer");
    assert!(answer.as_ref().is_none_or(|found| found == &[last]), "{answer:?}");
    answer
}

/// The device's limit is one of verdicts, a word each, and not of proxies, which nobody makes. Beyond it
/// the answer is unknown, and an error says which limit it was.
#[test]
fn as_many_owners_are_found_as_there_is_room_for_verdicts() {
    const WORDS: usize = 1 << 14;
    let limits =
        wgpu::Limits { max_storage_buffer_binding_size: 4 * WORDS as u64, ..wgpu::Limits::default() };
    for gpu in gpus_with(limits) {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        assert!(owned_by_the_last(&gpu, &mut queries, WORDS).is_some(), "{:?}", gpu.backend);
        assert!(queries.refusal().is_none());
        assert!(owned_by_the_last(&gpu, &mut queries, WORDS + 1).is_none(), "{:?}", gpu.backend);
        let refusal = queries.refusal().map(ToString::to_string).unwrap_or_default();
        let limit = format!("max_storage_buffer_binding_size = {}", 4 * WORDS);
        assert!(matches!(queries.refusal(), Some(tercet::Error::Device { .. })), "{refusal}");
        assert!(refusal.contains(&limit) && refusal.contains(&(WORDS + 1).to_string()), "{refusal}");
        assert!(owned_by_the_last(&gpu, &mut queries, 2).is_some(), "the next frame works");
        assert!(queries.refusal().is_none());
    }
}

/// A sweep for owners has verdicts, and nothing that looks at boxes needs: no proxies, no boxes, no slots.
#[test]
fn owners_take_no_memory_for_proxies() {
    for gpu in gpus() {
        let held = |label: &str| {
            let report = gpu.device.generate_allocator_report()?;
            Some(report.allocations.iter().filter(|allocation| allocation.name == label).count())
        };
        if held("").is_none() {
            continue; // OpenGL keeps no account; what is allocated there is the same.
        }
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let of_boxes = ["tercet swept proxies", "tercet swept slots", "tercet boxes", "tercet view"];
        for _ in 0..3 {
            owned_by_the_last(&gpu, &mut queries, 1000);
            assert_eq!(held("tercet verdicts"), Some(1), "{:?}", gpu.backend);
            assert_eq!(of_boxes.map(&held), [Some(0); 4], "{:?}", gpu.backend);
        }
        // Who looks at boxes has them: the account would tell.
        let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 0.1, SCREEN).expect("a view");
        let (scene, ids) = many(10);
        Targets::new(&gpu, &view).set(&mut queries);
        queries.begin(&view).expect("begin");
        let (frustum, test) = (Frustum::new(&view), SweepTest::Raster);
        let sweep = Sweep { scene: &scene, view: &view, frustum: &frustum, groups: &[], loose: &ids, test };
        queries.sweep(Ticket(3), &sweep).expect("a sweep");
        queries.end().expect("end");
        assert_eq!(of_boxes.map(&held), [Some(1); 4], "{:?}", gpu.backend);
    }
}

/// HROC with occluder filtering, on the item buffer: nothing is lost, and less is drawn first.
#[test]
fn filtered_occluders_lose_nothing() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        for &samples in gpu.sample_counts() {
            let (mut wrong, mut first, mut left_out) = (0, [0; 2], [0; 2]);
            for (n, filtering) in ["false", "true"].into_iter().enumerate() {
                let mut policy = policy::by_name("hroc").expect("a policy of that name");
                policy.set("occluder_filtering", filtering).expect("a dial of that name");
                let mut eye: Culler<Box<dyn Policy>> = Culler::new(policy);
                let mut stage = Stage::new(worlds::random(2, 120), 2, SCREEN, true);
                let mut scene = Scene::new(SceneConfig::default());
                let mut renderer =
                    draw::Renderer::with_ids(&gpu.device, &gpu.queue, None).expect("a renderer");
                for frame in 0..12 {
                    let view = stage.next(frame);
                    let view = view.clone().with_target(view.depth(), view.format(), samples);
                    scene.sync(&stage.world);
                    let mut shown = |eye: &mut Culler<Box<dyn Policy>>| {
                        let targets = Targets::new(&gpu, &view);
                        targets.set(&mut queries);
                        renderer.begin(&view, stage.detail, Shading::Unlit);
                        let mut handed = 0;
                        let draw = |pass: &mut _, objects: &[ObjectRef]| {
                            handed += objects.len();
                            renderer.draw(pass, &stage.world, objects);
                        };
                        let stats = eye.frame(&scene, &view, &mut queries, draw).expect("a frame");
                        assert_eq!(handed as u32, stats.drawn + stats.left_out);
                        let shot = read_depth(&gpu, &targets.depth, &view).values;
                        // The same once more, in the same order: who owns nothing?
                        queries.begin(&view).expect("begin");
                        renderer.begin(&view, stage.detail, Shading::Unlit);
                        let draw = |pass: &mut _| {
                            renderer.draw(pass, &stage.world, eye.visible());
                        };
                        queries.draw(draw).expect("draw");
                        let found = owners(&mut queries, &scene, &view, eye.visible());
                        queries.end().expect("end");
                        let hides = |object: &&ObjectRef| {
                            let known = scene.object(object.id).expect("it was drawn");
                            // Those outside of the tree are drawn always, and nobody asks about them.
                            !known.traits.not_occluder && known.bounds.is_some()
                        };
                        let left_out = eye.visible().iter().filter(hides);
                        let left_out = left_out.filter(|object| !found.contains(object.id)).count();
                        let is_asked = eye.policy().asks_owners();
                        assert_eq!(stats.left_out as usize, if is_asked { left_out } else { 0 });
                        (shot, stats.left_out)
                    };
                    let (culled, left) = shown(&mut eye);
                    left_out[n] += left;
                    let none = policy::by_name("none").expect("a policy of that name");
                    let (whole, _) = shown(&mut Culler::new(none));
                    wrong += culled.iter().zip(&whole).filter(|(a, b)| a != b).count();
                    let counters = eye.policy().counters();
                    let drawn = counters.iter().find(|counter| counter.key == "drawn_first");
                    first[n] += drawn.expect("a counter of that name").count;
                }
            }
            println!("{:?}, {samples} samples: {first:?} drawn first, {left_out:?} left out", gpu.backend);
            assert!(left_out[0] == 0 && left_out[1] > 30, "{left_out:?} show nothing");
            assert_eq!(wrong, 0, "{:?}, {samples} samples", gpu.backend);
            assert!(first[1] > 0 && first[1] < first[0], "{first:?}: less is drawn first");
        }
    }
}
