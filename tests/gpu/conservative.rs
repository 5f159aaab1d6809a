//! Whole frames of the culler on the GPU: a culled object never owned a sample, in worlds in which
//! everything changes every frame. The truth is the GPU's own: what the same draw calls show when
//! nothing is culled.

use tercet::Culler;
use tercet::geom::{DepthFormat, Frustum, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::gpu::{AnyBy, GpuConfig, GpuQueries, Shaders};
use tercet::scene::{ObjectSet, Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::worlds::{self, Model, Pathology};

use crate::renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, read_depth, supported, targets};
use crate::sweep_mutations::rays_alone;

const SCREEN: Viewport = Viewport::new(96, 54);
const FRAMES: u32 = 12;

/// What a run came to, over all frames.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    /// Objects that owned a sample and were not drawn.
    lost: usize,
    /// Objects in the frustum that owned no sample, and those of them that were not drawn.
    hidden: usize,
    culled: usize,
    /// Objects that owned a sample.
    visible: usize,
    /// Samples in which the culled frame differs from the whole one.
    wrong: usize,
    /// Groups into which rays were cast.
    groups: u64,
    /// Submissions more than one a wave and one at the end.
    extra_submits: i64,
}

/// Runs a policy over a world; `seed` decides what happens to it.
fn run(
    gpu: &Gpu,
    queries: &mut GpuQueries,
    policy: Box<dyn Policy>,
    (model, seed): (Model, u64),
    (format, samples): (DepthFormat, u32),
    outcome: &mut Outcome,
) {
    let mut stage = Stage::new(model, seed, SCREEN, true);
    // Nobody asks about nodes who sweeps: leaves would stay large.
    let sweeps = ["roc", "hroc", "hi-z", "hybrid"].contains(&policy.name());
    let leaves = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
    let tree = if sweeps { leaves } else { TreeConfig::default() };
    let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
    let mut eye = Culler::new(policy);
    let mut renderer = Renderer::new(gpu);
    for frame in 0..FRAMES {
        let view = stage.next(frame);
        let view = view.clone().with_target(view.depth(), format, samples);
        scene.sync(&stage.world);
        renderer.prepare(&stage.world, &view, stage.detail);
        let (seen, whole) = renderer.truth(&scene, &view);
        let depth = depth_texture(gpu, &view);
        queries.target(&targets(&depth, false));
        let draw = |pass: &mut _, objects: &[_]| renderer.draw(pass, &view, objects);
        let stats = eye.frame(&scene, &view, queries, draw).expect("a frame");
        outcome.groups += queries.stats().groups;
        outcome.extra_submits += queries.stats().submits as i64 - i64::from(stats.waves) - 1;
        let mut drawn = ObjectSet::default();
        for object in eye.visible() {
            assert!(drawn.insert(object.id), "an object was drawn twice");
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
        scene.adapt([&mut eye]);
    }
}

/// A policy that asks, with the dials that matter here.
fn policy(name: &str) -> Box<dyn Policy> {
    let (name, order) = name.split_once(", ").map_or((name, None), |(name, order)| (name, Some(order)));
    let mut policy = policy::by_name(name).expect("a policy of that name");
    if let Some(order) = order {
        policy.set("order", order).expect("a dial of that name");
    }
    policy
}

/// What is run on random worlds: dials, policies, and how many worlds. Policies ask in other ways,
/// and ways of counting differ in what they count, but hardly in how they are asked. So all
/// policies are run with the default, and each way with one that asks for counts and one that asks
/// for any.
fn runs(gpu: &Gpu) -> Vec<(GpuConfig, &'static [&'static str], u64)> {
    let default = GpuConfig::default();
    let all: &[_] =
        &["dual-query", "dual-query, visible-first", "statistical", "chc", "chc++", "stop-and-wait"];
    let mut runs = vec![(default.clone(), all, 5)];
    for counting in supported(gpu) {
        let config = GpuConfig { counting: Some(counting), ..default.clone() };
        runs.push((config, &["dual-query", "statistical"], 4));
    }
    let native = GpuConfig { any: AnyBy::Native, ..default };
    runs.push((native, &["statistical", "chc++", "stop-and-wait"], 5));
    runs
}

#[test]
fn random_worlds() {
    for gpu in gpus() {
        for (config, policies, worlds) in runs(&gpu) {
            let what = format!("{:?}, {:?}, any by {:?}", gpu.backend, config.counting, config.any);
            let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend");
            for (&samples, name) in
                gpu.sample_counts().iter().flat_map(|s| policies.iter().map(move |p| (s, p)))
            {
                let mut all = Outcome::default();
                for seed in 0..worlds {
                    let formats = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus];
                    let target = (formats[seed as usize % 2], samples);
                    let world = (worlds::random(seed, 120), seed);
                    run(&gpu, &mut queries, policy(name), world, target, &mut all);
                }
                let run = format!("{what}, {samples} samples, {name}");
                println!("{run}: {all:?}");
                assert_eq!((all.lost, all.wrong), (0, 0), "{run} lost objects: {all:?}");
                let least = 100 * worlds as usize;
                assert!(all.hidden.min(all.visible) > least, "there are things to hide: {all:?}");
                assert!(all.culled * 3 > all.hidden, "{run} culled little: {all:?}");
                // CHC looks for answers while it walks: that is a submission, too.
                let looks = name.starts_with("chc");
                assert!(looks || all.extra_submits <= 0, "{run} submits more than once a wave: {all:?}");
            }
        }
    }
}

/// Policies that ask about many objects at once, each of which is looked at by itself.
#[test]
fn swept_worlds() {
    for gpu in gpus() {
        let backend = |rays_from| {
            let config = GpuConfig { rays_from, ..GpuConfig::default() };
            GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend")
        };
        // Few objects are looked at one by one, unless rays are to be cast.
        let few = GpuConfig::default().rays_from;
        let ways = [("roc", few), ("hroc", 0), ("hroc", few), ("hi-z", few), ("hybrid", 0), ("hybrid", few)];
        for (&samples, (name, rays_from)) in gpu.sample_counts().iter().flat_map(|s| ways.map(|p| (s, p))) {
            let mut queries = backend(rays_from);
            let mut all = Outcome::default();
            for seed in 0..3 {
                let formats = [DepthFormat::Depth32Float, DepthFormat::Depth24Plus];
                let target = (formats[seed as usize % 2], samples);
                run(&gpu, &mut queries, policy(name), (worlds::random(seed, 120), seed), target, &mut all);
            }
            let run = format!("{:?}, {samples} samples, {name}, rays from {rays_from}", gpu.backend);
            println!("{run}: {all:?}");
            assert_eq!((all.lost, all.wrong), (0, 0), "{run} lost objects: {all:?}");
            assert!(all.hidden.min(all.visible) > 300, "there are things to hide: {all:?}");
            assert!(all.culled * 3 > all.hidden, "{run} culled little: {all:?}");
            assert!(all.extra_submits <= 0, "{run} submits more than once a wave: {all:?}");
            assert_eq!(all.groups > 100, rays_from == 0, "{run}: {all:?}");
        }
    }
}

/// Sweeping shaders that overlook some samples are found out, too.
#[test]
fn lying_sweeps_are_found_out() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    let mut shaders = Shaders::default();
    let lie = "if pixel.x % 8u == 0u && covers(&proxy, d)";
    shaders.sweep_raster.single = shaders.sweep_raster.single.replace("if covers(&proxy, d)", lie).into();
    let lie = "if pixel.x % 8u == 0u && atomicLoad(&verdicts[place])";
    let honest = "if atomicLoad(&verdicts[place])";
    shaders.sweep_rays.single = shaders.sweep_rays.single.replace(honest, lie).into();
    let lie = "if i % 2u == 0u && proxies[i].nearest >= farthest";
    let honest = "if proxies[i].nearest >= farthest";
    shaders.sweep_hi_z.single = shaders.sweep_hi_z.single.replace(honest, lie).into();
    rays_alone(&mut shaders);
    // Nothing is found beforehand.
    let config = GpuConfig { shaders, prune_from: usize::MAX, rays_from: 0, ..GpuConfig::default() };
    let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend");
    for name in ["roc", "hroc", "hi-z"] {
        let mut all = Outcome::default();
        for seed in 0..2 {
            let target = (DepthFormat::Depth32Float, 1);
            run(&gpu, &mut queries, policy(name), (worlds::random(seed, 120), seed), target, &mut all);
        }
        assert!(all.lost > 0 && all.wrong > 0, "{name}: {all:?}");
    }
}

/// Worlds that are hard on arithmetic: coincident, enormous, tiny and flat things.
#[test]
fn pathological_worlds() {
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut all = Outcome::default();
        for (kind, seed) in Pathology::ALL.into_iter().zip(0..) {
            for &samples in gpu.sample_counts() {
                let policy = policy("dual-query");
                let world = (worlds::pathological(kind), seed);
                let target = (DepthFormat::Depth32Float, samples);
                run(&gpu, &mut queries, policy, world, target, &mut all);
                assert_eq!((all.lost, all.wrong), (0, 0), "{:?}, {kind:?}: {all:?}", gpu.backend);
            }
        }
        println!("{:?}: {all:?}", gpu.backend);
        assert!(all.culled > 0, "{all:?}");
    }
}

/// Shaders that overlook some samples must be found out, or the suite proves nothing.
#[test]
fn lying_shaders_are_found_out() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    let mut shaders = Shaders::default();
    let Shaders { count_fragments, count_workgroups, count_subgroups, count_blocks, .. } = &mut shaders;
    for shader in [count_fragments, count_workgroups, count_subgroups, count_blocks] {
        let lie = "nearness >= stored && pixel.x % 8u == 0u";
        shader.single = shader.single.replace("nearness >= stored", lie).into();
    }
    let lie = "if pixel.x % 8 != 0 || !covers";
    shaders.ask_natively = shaders.ask_natively.replace("if !covers", lie).into();
    let lying = GpuConfig { shaders, ..GpuConfig::default() };
    let native = GpuConfig { any: AnyBy::Native, ..lying.clone() };
    let counted = supported(&gpu).map(|counting| GpuConfig { counting: Some(counting), ..lying.clone() });
    for (config, name) in counted.map(|config| (config, "dual-query")).chain([(native, "statistical")]) {
        let what = format!("{:?}, any by {:?}", config.counting, config.any);
        let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend");
        let mut all = Outcome::default();
        for seed in 0..3 {
            let target = (DepthFormat::Depth32Float, 1);
            run(&gpu, &mut queries, policy(name), (worlds::random(seed, 120), seed), target, &mut all);
        }
        assert!(all.lost > 0 && all.wrong > 0, "{what}: {all:?}");
    }
}
