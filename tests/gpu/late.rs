//! Late questions: they see the depth of then, are exact where nothing changes, and wait for no draw.

use tercet::geom::{DepthDirection, DepthFormat, View, Viewport};
use tercet::policy;
use tercet::query::QueryBackend;
use tercet::query::gpu::{AnyBy, GpuConfig, GpuQueries};
use tercet::scene::{ObjectSet, Scene, SceneConfig};
use tercet::{Culler, Latency, Tradeoff, worlds};

use crate::renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, targets};

const SCREEN: Viewport = Viewport::new(96, 54);
const LATE: u32 = 2;

/// A depth texture that can be copied.
fn copyable(gpu: &Gpu, view: &View) -> wgpu::Texture {
    let like = depth_texture(gpu, view);
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: like.size(),
        mip_level_count: 1,
        sample_count: like.sample_count(),
        dimension: wgpu::TextureDimension::D2,
        format: like.format(),
        usage: like.usage() | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// What each frame lost, and culled of what was hidden. The world stands still and so does the camera, but
/// that after frame 6 half of what was visible goes away.
fn run(gpu: &Gpu, queries: &mut GpuQueries, name: &str, samples: u32, copied: bool) -> Vec<(usize, usize)> {
    let model = worlds::random(3, 150);
    let (center, size) = (model.bounds.center(), model.bounds.size().max_element());
    let mut stage = Stage::new(model, 3, SCREEN, false);
    // All of it is in view: of what was not, nothing is known.
    let view = View::look_at(center + glam::Vec3::Z * 1.6 * size, center, 60.0, 0.1, SCREEN).expect("a view");
    let view = view.with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, samples);
    let mut scene = Scene::new(SceneConfig::default());
    let mut eye = Culler::new(policy::by_name(name).expect("a policy of that name"));
    eye.tradeoff = Tradeoff { latency: Latency::Late(LATE), ..Tradeoff::EXACT };
    let mut renderer = Renderer::new(gpu);
    let mut outcome = Vec::new();
    for frame in 0..12 {
        if frame == 6 {
            let gone: Vec<_> = eye.visible().iter().step_by(2).map(|object| object.entity()).collect();
            gone.into_iter().for_each(|entity| stage.world.despawn(entity).expect("it was there"));
        }
        scene.sync(&stage.world);
        renderer.prepare(&stage.world, &view, stage.detail);
        let (seen, _) = renderer.truth(&scene, &view);
        let depth = if copied { copyable(gpu, &view) } else { depth_texture(gpu, &view) };
        queries.target(&targets(&depth, false));
        eye.frame(&scene, &view, queries, |pass, objects| renderer.draw(pass, &view, objects))
            .expect("a frame");
        let mut drawn = ObjectSet::default();
        for object in eye.visible() {
            assert!(drawn.insert(object.id), "an object was drawn twice");
        }
        let all = || scene.objects().map(|object| object.object.id);
        let lost = all().filter(|&id| seen.contains(id) && !drawn.contains(id)).count();
        let culled = all().filter(|&id| !seen.contains(id) && !drawn.contains(id)).count();
        outcome.push((lost, culled));
        scene.adapt([&mut eye]);
    }
    outcome
}

#[test]
fn late_questions_lose_for_as_long_as_they_are_late() {
    for gpu in gpus() {
        for (name, &samples) in ["dual-query", "stop-and-wait", "chc"]
            .into_iter()
            .flat_map(|name| gpu.sample_counts().iter().map(move |s| (name, s)))
        {
            let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
            let frames = run(&gpu, &mut queries, name, samples, true);
            println!("{:?}, {samples} samples, {name}: {frames:?}", gpu.backend);
            for (frame, (lost, culled)) in frames.iter().enumerate() {
                let is_late = (6..6 + LATE as usize).contains(&frame);
                assert!(*lost == 0 || is_late, "{name}, frame {frame}: {frames:?}");
                assert!(*culled > 0 || frame < 2, "{name}, frame {frame}: {frames:?}");
            }
            let keeps = gpu.backend != wgpu::Backend::Gl;
            assert_eq!(frames[6].0 > 0, keeps, "{name}: {frames:?}");
        }
    }
}

#[test]
fn without_a_depth_of_then_questions_are_exact() {
    let native = GpuConfig { any: AnyBy::Native, ..GpuConfig::default() };
    for gpu in gpus() {
        for (config, copied) in [(GpuConfig::default(), false), (native.clone(), true)] {
            let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend");
            let frames = run(&gpu, &mut queries, "stop-and-wait", 1, copied);
            assert!(frames.iter().all(|(lost, _)| *lost == 0) && frames[5].1 > 20, "{frames:?}");
        }
    }
}

/// Another size, another kind of depth, or a frame that is not late: there is no past then.
#[test]
fn what_was_kept_of_another_kind_is_not_asked() {
    for gpu in gpus().into_iter().filter(|gpu| gpu.backend != wgpu::Backend::Gl) {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut frame = |side: u32, late: u32| {
            let view = View::look_at(glam::Vec3::Z, glam::Vec3::ZERO, 60.0, 0.1, Viewport::new(side, side));
            let view = view.expect("a view");
            queries.target(&targets(&copyable(&gpu, &view), false));
            let past = match late {
                0 => queries.begin(&view).map(|()| None),
                _ => queries.begin_late(&view, late),
            };
            queries.end().expect("an end");
            past.expect("a frame").is_some()
        };
        let found = [(32, 1), (32, 1), (32, 2), (32, 2), (48, 1), (48, 1), (48, 0), (48, 1), (48, 1)];
        let found = found.map(|(side, late)| frame(side, late));
        assert_eq!(found, [false, true, false, true, false, true, false, false, true]);
    }
}
