//! Frames, waves and waiting.

use std::time::{Duration, Instant};

use glam::{Mat4, Vec4};
use tercet::Error;
use tercet::geom::{DepthDirection, DepthFormat, PixelRect, View, Viewport, projection};
use tercet::query::gpu::{AnyBy, ColorTarget, DepthTarget, FrameTargets, GpuConfig, GpuQueries, GpuStats};
use tercet::query::{Answer, DrawTime, QueryBackend, Ticket, Wait, Want};

use crate::proxies::flat;
use crate::support::{ClipSpace, Gpu, clip, depth_texture, gpus, read_buffer, targets, texture, ways};

pub const SIDE: u32 = 64;

pub fn view() -> View {
    let clip_from_view = projection::perspective(1.0, 1.0, 0.1);
    View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(SIDE, SIDE)).expect("a view")
}

pub fn screen() -> PixelRect {
    PixelRect { x0: 0, y0: 0, x1: SIDE, y1: SIDE }
}

/// Triangles that fill the screen at a nearness.
pub fn wall(view: &View, nearness: f32) -> [Vec4; 3] {
    let far = 4.0 * SIDE as f32;
    [[-far, -far], [far, -far], [0.0, far]].map(|pixel| clip(view, pixel, nearness))
}

fn half_wall(view: &View, nearness: f32) -> [[Vec4; 3]; 2] {
    let (low, half, side) = (0.0, SIDE as f32 / 2.0, SIDE as f32);
    let [a, b, c, d] =
        [[low, low], [half, low], [half, side], [low, side]].map(|pixel| clip(view, pixel, nearness));
    [[a, b, c], [a, c, d]]
}

pub fn queries(gpu: &Gpu) -> GpuQueries {
    gpu.exact_queries(GpuConfig::default())
}

/// Tickets and their answers.
pub type Answers = Vec<(u32, String)>;

pub fn answers(queries: &mut GpuQueries, wait: Wait) -> Result<Answers, (Error, Answers)> {
    let mut all = Vec::new();
    let result = queries.answers(wait, |ticket, answer| all.push((ticket.0, format!("{answer:?}"))));
    all.sort_unstable();
    match result {
        Ok(()) => Ok(all),
        Err(error) => Err((error, all)),
    }
}

fn dual(visible: u32, total: u32) -> String {
    format!("{:?}", Answer::Dual { visible, total })
}

/// Views can be culled in parallel.
#[test]
fn backends_can_be_sent_to_threads() {
    fn assert_send_sync<T: Send + Sync>() {}
    assert_send_sync::<GpuQueries>();
}

#[test]
fn answers_are_about_the_time_of_asking() {
    for gpu in gpus() {
        for counting in ways(&gpu) {
            let view = view();
            let depth = depth_texture(&gpu, &view);
            let mut queries = gpu.exact_queries(GpuConfig { counting, ..Default::default() });
            let half = ClipSpace::new(&gpu, &view, &half_wall(&view, 0.5));
            let whole = ClipSpace::new(&gpu, &view, &[wall(&view, 0.75)]);
            queries.target(&targets(&depth, false));
            // The second frame starts anew.
            for _ in 0..2 {
                let (proxy, all) = (flat(screen(), 0.25), SIDE * SIDE);
                queries.begin(&view).expect("begin");
                queries.ask(Ticket(1), &[proxy], Want::Dual).expect("ask");
                queries.draw(|pass| half.draw(pass)).expect("draw");
                queries.ask(Ticket(2), &[proxy], Want::Dual).expect("ask");
                queries.ask(Ticket(3), &[proxy], Want::Any).expect("ask");
                queries.draw(|pass| whole.draw(pass)).expect("draw");
                queries.ask(Ticket(4), &[proxy], Want::Dual).expect("ask");
                queries.ask(Ticket(5), &[proxy, flat(screen(), 0.5)], Want::Any).expect("ask");
                queries.ask(Ticket(6), &[proxy, flat(screen(), 0.75)], Want::Any).expect("ask");
                assert_eq!(
                    answers(&mut queries, Wait::Block).expect("answers"),
                    [
                        (1, dual(all, all)),
                        (2, dual(all / 2, all)),
                        (3, "Any(true)".into()),
                        (4, dual(0, all)),
                        (5, "Any(false)".into()),
                        (6, "Any(true)".into()),
                    ]
                );
                let stats = queries.stats();
                assert_eq!((stats.submits, stats.question_passes), (1, 3), "one submission a wave");
                assert_eq!(stats.boxes, 8);
                assert_eq!(answers(&mut queries, Wait::Block).expect("answers"), [], "each comes once");
                queries.end().expect("end");
            }
        }
    }
}

#[test]
fn polling_delivers_what_has_arrived_and_forgets_what_is_old() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let mut queries = queries(&gpu);
        queries.target(&targets(&depth, false));
        queries.begin(&view).expect("begin");
        queries.ask(Ticket(7), &[flat(screen(), 0.5)], Want::Any).expect("ask");
        answers(&mut queries, Wait::Poll).expect("a poll");
        queries.end().expect("end");
        for _ in 0..50 {
            queries.begin(&view).expect("begin");
            queries.ask(Ticket(8), &[flat(screen(), 0.5)], Want::Any).expect("ask");
            let deadline = Instant::now() + Duration::from_secs(60);
            let mut found = Vec::new();
            while found.is_empty() && Instant::now() < deadline {
                found = answers(&mut queries, Wait::Poll).expect("a poll");
            }
            assert_eq!(found, [(8, "Any(true)".into())]);
            queries.end().expect("end");
        }
    }
}

#[test]
fn many_boxes_fit() {
    for gpu in gpus() {
        for counting in ways(&gpu) {
            let view = view();
            let depth = depth_texture(&gpu, &view);
            let half = ClipSpace::new(&gpu, &view, &half_wall(&view, 0.5));
            let mut queries = gpu.exact_queries(GpuConfig { counting, ..Default::default() });
            queries.target(&targets(&depth, false));
            // More tiles than workgroups in a row.
            for count in [1, 70_000, 3] {
                queries.begin(&view).expect("begin");
                queries.draw(|pass| half.draw(pass)).expect("draw");
                let pixel = |i: u32| (i % SIDE, i / SIDE % SIDE);
                for i in 0..count {
                    let (x0, y0) = pixel(i);
                    let rect = PixelRect { x0, y0, x1: x0 + 1, y1: y0 + 1 };
                    queries.ask(Ticket(i), &[flat(rect, 0.25)], Want::Dual).expect("ask");
                }
                let found = answers(&mut queries, Wait::Block).expect("answers");
                assert_eq!(found.len(), count as usize);
                for (i, answer) in found {
                    assert_eq!(answer, dual(u32::from(pixel(i).0 >= SIDE / 2), 1), "{counting:?}, box {i}");
                }
                queries.end().expect("end");
            }
        }
    }
}

/// More queries than a set holds, and fewer than the sets that are there.
#[test]
fn many_native_queries_fit() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let half = ClipSpace::new(&gpu, &view, &half_wall(&view, 0.5));
        let mut queries = gpu.exact_queries(GpuConfig { any: AnyBy::Native, ..Default::default() });
        queries.target(&targets(&depth, false));
        for count in [1, 9000, 3, 4097] {
            queries.begin(&view).expect("begin");
            queries.draw(|pass| half.draw(pass)).expect("draw");
            let pixel = |i: u32| (i % SIDE, i / SIDE % SIDE);
            for i in 0..count {
                let (x0, y0) = pixel(i);
                let rect = PixelRect { x0, y0, x1: x0 + 1, y1: y0 + 1 };
                let hidden = flat(PixelRect { x0: 0, y0: 0, x1: SIDE / 2, y1: SIDE }, 0.25);
                queries.ask(Ticket(i), &[hidden, flat(rect, 0.25)], Want::Any).expect("ask");
            }
            // One that is counted in between, and one about nothing.
            queries.ask(Ticket(count), &[flat(screen(), 0.25)], Want::Dual).expect("ask");
            queries.ask(Ticket(count + 1), &[], Want::Any).expect("ask");
            let mut found = answers(&mut queries, Wait::Block).expect("answers");
            assert_eq!(found.pop(), Some((count + 1, "Any(false)".into())));
            assert_eq!(found.pop(), Some((count, dual(SIDE * SIDE / 2, SIDE * SIDE))));
            assert_eq!(found.len(), count as usize);
            for (i, answer) in found {
                let visible = pixel(i).0 >= SIDE / 2;
                assert_eq!(answer, format!("{:?}", Answer::Any(visible)), "{:?}, box {i}", gpu.backend);
            }
            queries.end().expect("end");
        }
    }
}

#[test]
fn what_cannot_be_evaluated_is_unknown() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let mut queries = queries(&gpu);
        queries.target(&targets(&depth, false));
        queries.begin(&view).expect("begin");
        let mut broken = flat(screen(), 0.5);
        broken.edges[0] = [f32::INFINITY, f32::NAN, 0.0];
        queries.ask(Ticket(1), &[broken], Want::Any).expect("ask");
        queries.ask(Ticket(2), &[broken], Want::Dual).expect("ask");
        queries.ask(Ticket(3), &[flat(screen(), 0.5); 2], Want::Dual).expect("ask");
        queries.ask(Ticket(4), &[], Want::Dual).expect("ask");
        let found = answers(&mut queries, Wait::Block).expect("answers");
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|(_, answer)| answer == "Unknown"), "{found:?}");
        queries.end().expect("end");
    }
}

/// The device's own clock says what passes took, some frames later, and never waits.
#[test]
fn passes_are_timed_where_the_device_can() {
    for gpu in gpus() {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let walls = ClipSpace::new(&gpu, &view, &vec![wall(&view, 0.5); 200]);
        let timed = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        for any in [AnyBy::Counts, AnyBy::Native] {
            let mut queries = gpu.exact_queries(GpuConfig { any, ..GpuConfig::default() });
            queries.target(&targets(&depth, false));
            let mut times = Vec::new();
            for _ in 0..6 {
                queries.begin(&view).expect("begin");
                let GpuStats { draw_time, awaited_draw_time, question_time, .. } = queries.stats();
                times.push([draw_time, awaited_draw_time, question_time]);
                queries.draw(|pass| walls.draw(pass)).expect("draw");
                queries.ask(Ticket(1), &[flat(screen(), 0.6)], Want::Any).expect("ask");
                answers(&mut queries, Wait::Block).expect("answers");
                assert_eq!(queries.stats().submits, 1, "times cost no submission");
                // Nobody waits for these.
                queries.draw(|pass| walls.draw(pass)).expect("draw");
                queries.end().expect("end");
            }
            assert_eq!(times[0], [None; 3], "there was no frame before the first one");
            let [draw, awaited, question] = times[5];
            println!("{:?}, {any:?}: draw {draw:?}, {awaited:?} awaited; {question:?}", gpu.backend);
            assert_eq!(times[5].map(|time| time.is_some()), [timed; 3]);
            let nothing = Some(Duration::ZERO);
            assert!(!timed || draw > awaited && awaited > nothing && question > nothing, "{:?}", times[5]);
        }
    }
}

/// Times are of frames like those that are drawn now, or there are none.
#[test]
fn a_frame_of_too_many_passes_ends_the_times() {
    let can_time = |gpu: &Gpu| gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
    for gpu in gpus().into_iter().filter(can_time) {
        let view = view();
        let depth = depth_texture(&gpu, &view);
        let mut queries = queries(&gpu);
        queries.target(&targets(&depth, false));
        let mut known = Vec::new();
        for passes in [1, 1, 1, 1024, 1, 1, 1, 1] {
            queries.begin(&view).expect("begin");
            known.push(queries.draw_time() != DrawTime::Unknown);
            (0..passes).for_each(|_| queries.draw(|_| ()).expect("draw"));
            queries.ask(Ticket(1), &[flat(screen(), 0.6)], Want::Any).expect("ask");
            answers(&mut queries, Wait::Block).expect("answers");
            queries.end().expect("end");
        }
        // A frame's timestamps come back with the next one's commands, to be read by the one after.
        // The fourth frame has a pass more than are timed. Those of the third have arrived with it,
        // and do not stand for it.
        assert_eq!(known, [false, false, true, true, false, false, true, true], "{:?}", gpu.backend);
    }
}

/// Stencil formats are read through a view of the depth alone.
#[test]
fn formats_with_stencil_answer_too() {
    for gpu in gpus() {
        let view = view().with_target(DepthDirection::Reversed, DepthFormat::Depth24Plus, 1);
        let depth = texture(&gpu, wgpu::TextureFormat::Depth24PlusStencil8, [SIDE, SIDE], 1);
        let aspect = wgpu::TextureAspect::DepthOnly;
        let depth_only = depth.create_view(&wgpu::TextureViewDescriptor { aspect, ..Default::default() });
        let mut targets = targets(&depth, false);
        targets.depth.depth_only = Some(depth_only);
        let mut queries = queries(&gpu);
        queries.target(&targets);
        queries.begin(&view).expect("begin");
        queries.ask(Ticket(1), &[flat(screen(), 0.0)], Want::Dual).expect("ask");
        queries.ask(Ticket(2), &[flat(screen(), -0.5)], Want::Any).expect("ask");
        let found = answers(&mut queries, Wait::Block).expect("answers");
        assert_eq!(found, [(1, dual(SIDE * SIDE, SIDE * SIDE)), (2, "Any(false)".into())]);
        queries.end().expect("end");
    }
}

/// Colour is cleared once a frame, kept between passes, and resolved at the end; also if nothing
/// is drawn.
#[test]
fn colours_are_cleared_once_and_resolved_at_the_end() {
    for gpu in gpus().into_iter().filter(|gpu| gpu.sample_counts().contains(&4)) {
        let view = view().with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, 4);
        let depth = depth_texture(&gpu, &view);
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let size = [depth.width(), depth.height()];
        let color = texture(&gpu, format, size, 4);
        let resolved = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: depth.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let as_view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let mut queries = queries(&gpu);
        for (passes, expected) in [(0, [0, 255, 0]), (1, [255, 0, 0]), (2, [255, 0, 0])] {
            let targets = FrameTargets {
                colors: vec![Some(ColorTarget {
                    view: as_view(&color),
                    resolve: Some(as_view(&resolved)),
                    load: wgpu::LoadOp::Clear(wgpu::Color::GREEN),
                })],
                depth: DepthTarget { view: as_view(&depth), depth_only: None, keep: false },
            };
            queries.target(&targets);
            queries.begin(&view).expect("begin");
            for nearness in [0.5, 0.25].into_iter().take(passes) {
                let red = ClipSpace::with_color(&gpu, &view, &[wall(&view, nearness)], Some(format));
                queries.draw(|pass| red.draw(pass)).expect("draw");
                queries.ask(Ticket(0), &[flat(screen(), 0.1)], Want::Any).expect("ask");
                let found = answers(&mut queries, Wait::Block).expect("answers");
                assert_eq!(found, [(0, "Any(false)".into())]);
            }
            queries.end().expect("end");
            assert_eq!(first_pixel(&gpu, &resolved), expected, "{:?}, {passes} passes", gpu.backend);
        }
    }
}

fn first_pixel(gpu: &Gpu, texture: &wgpu::Texture) -> [u8; 3] {
    let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(256), rows_per_image: None };
    let destination = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), destination, size);
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_buffer(gpu, &buffer);
    [bytes[0], bytes[1], bytes[2]]
}
