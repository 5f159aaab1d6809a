//! Everything that can go wrong: an error that says what, unknown answers, and no waiting.

use std::time::{Duration, Instant};

use tercet::Error;
use tercet::geom::{DepthDirection, DepthFormat, Proxy, View};
use tercet::query::gpu::{FrameTargets, GpuConfig, GpuQueries};
use tercet::query::{QueryBackend, Ticket, Wait, Want};

use crate::lifecycle::{SIDE, answers, queries, screen, view, wall};
use crate::proxies::flat;
use crate::support::{ClipSpace, depth_texture, gpus, targets, texture};

/// Why a frame cannot begin with some targets.
fn refusal(queries: &mut GpuQueries, targets: &FrameTargets, view: &View) -> String {
    queries.target(targets);
    match queries.begin(view) {
        Err(Error::Target { why }) => why,
        other => panic!("{other:?}"),
    }
}

#[test]
fn unusable_targets_are_refused() {
    for gpu in gpus() {
        let view = view();
        let mut queries = queries(&gpu);
        assert!(matches!(queries.begin(&view), Err(Error::Target { .. })), "no targets at all");
        assert!(matches!(queries.draw(|_| ()), Err(Error::Target { .. })), "no frame has begun");
        let of = |format, side, samples| targets(&texture(&gpu, format, [side, side], samples), false);
        let (float, fixed) = (wgpu::TextureFormat::Depth32Float, wgpu::TextureFormat::Depth24Plus);
        for (targets, says) in [
            (of(wgpu::TextureFormat::Depth16Unorm, SIDE, 1), "too coarse"),
            (of(wgpu::TextureFormat::Rgba8Unorm, SIDE, 1), "no depth format"),
            (of(fixed, SIDE, 1), "Depth24Plus"),
            (of(float, SIDE, 4), "4 samples"),
            (of(float, SIDE - 1, 1), "does not fit"),
            (of(wgpu::TextureFormat::Depth24PlusStencil8, SIDE, 1), "Depth24Plus"),
        ] {
            let why = refusal(&mut queries, &targets, &view);
            assert!(why.contains(says), "{why:?} should say {says:?}");
        }
        if gpu.backend == wgpu::Backend::Gl {
            let multisampled =
                view.clone().with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, 4);
            let why = refusal(&mut queries, &of(float, SIDE, 4), &multisampled);
            assert!(why.contains("OpenGL"), "{why:?}");
        }
        let fixed_view = view.clone().with_target(DepthDirection::Reversed, DepthFormat::Depth24Plus, 1);
        let why = refusal(&mut queries, &of(wgpu::TextureFormat::Depth24PlusStencil8, SIDE, 1), &fixed_view);
        assert!(why.contains("depth_only"), "{why:?}");
        let unbound = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let why = refusal(&mut queries, &targets(&unbound, false), &view);
        assert!(why.contains("TEXTURE_BINDING"), "{why:?}");
    }
}

/// The frame of a backend that has failed: whatever was asked is unknown, at each stage.
fn assert_fails(queries: &mut GpuQueries, proxy: Proxy, what: &str) {
    queries.ask(Ticket(1), &[proxy], Want::Dual).expect("ask");
    queries.ask(Ticket(2), &[proxy], Want::Any).expect("ask");
    match answers(queries, Wait::Block) {
        Err((Error::Device { .. }, found)) => {
            assert_eq!(found, [(1, "Unknown".into()), (2, "Unknown".into())], "{what}");
        }
        other => panic!("{what}: {other:?}"),
    }
    assert_eq!(answers(queries, Wait::Poll).unwrap_or_default(), [], "{what}: nothing comes twice");
}

fn assert_works(queries: &mut GpuQueries, view: &View) {
    queries.begin(view).expect("begin");
    queries.ask(Ticket(3), &[flat(screen(), 0.5)], Want::Any).expect("ask");
    assert_eq!(answers(queries, Wait::Block).expect("answers"), [(3, "Any(true)".into())]);
    queries.end().expect("end");
}

#[test]
fn a_mistake_of_the_app_is_an_error_and_the_next_frame_works() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        // A pipeline for another depth direction is fine, one for another sample count is not.
        let wrong = view.clone().with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, 4);
        let wrong = ClipSpace::new(&gpu, &wrong, &[wall(&view, 0.5)]);
        let mut queries = queries(&gpu);
        queries.target(&targets(&depth, false));
        queries.begin(&view).expect("begin");
        queries.draw(|pass| wrong.draw(pass)).expect("it comes to light later");
        assert_fails(&mut queries, flat(screen(), 0.5), "a wrong pipeline");
        assert_works(&mut queries, &view);
        // The same, found at the end of a frame.
        queries.begin(&view).expect("begin");
        queries.draw(|pass| wrong.draw(pass)).expect("it comes to light later");
        assert!(matches!(queries.end(), Err(Error::Device { .. })));
        assert_works(&mut queries, &view);
    }
}

#[test]
fn a_device_that_takes_too_long_is_an_error_and_the_next_frame_works() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let config = GpuConfig { timeout: Duration::ZERO, ..GpuConfig::default() };
        let mut hasty = gpu.exact_queries(config);
        hasty.target(&targets(&depth, false));
        let walls = vec![wall(&view, 0.5); 20_000];
        let slow = ClipSpace::new(&gpu, &view, &walls);
        hasty.begin(&view).expect("begin");
        hasty.draw(|pass| slow.draw(pass)).expect("draw");
        // A fast device may be done by the time that it is asked; OpenGL works while it is told.
        let may_be_done = gpu.backend == wgpu::Backend::Gl || !gpu.is_software;
        hasty.ask(Ticket(1), &[flat(screen(), 0.25)], Want::Dual).expect("ask");
        match answers(&mut hasty, Wait::Block) {
            Err((Error::Device { .. }, found)) => assert_eq!(found, [(1, "Unknown".into())]),
            Ok(found) => assert!(may_be_done && found.len() == 1, "{found:?}"),
            other => panic!("{other:?}"),
        }
        drop(hasty.end());
        let mut patient = queries(&gpu);
        patient.target(&targets(&depth, false));
        assert_works(&mut patient, &view);
    }
}

#[test]
fn a_lost_device_is_an_error() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let mut queries = queries(&gpu);
        queries.target(&targets(&depth, false));
        queries.begin(&view).expect("begin");
        let start = Instant::now();
        gpu.device.destroy();
        assert_fails(&mut queries, flat(screen(), 0.5), "a lost device");
        drop(queries.end());
        for _ in 0..3 {
            let failed = queries.begin(&view).is_err() || {
                let draw = queries.draw(|_| ()).is_err();
                let ask = queries.ask(Ticket(9), &[flat(screen(), 0.5)], Want::Any).is_err();
                draw || ask || answers(&mut queries, Wait::Block).is_err()
            };
            assert!(failed, "a lost device stays lost");
            drop(queries.end());
        }
        assert!(start.elapsed() < Duration::from_secs(20), "nothing waits for a lost device");
    }
}
