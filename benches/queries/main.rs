//! What questions cost. On the CPU: boxes of three sizes at three resolutions, on one thread and on
//! two, beside a plain loop. On the GPU: boxes of two sizes, asked about in every way that there is,
//! beside native occlusion queries as engines commonly use them (the boxes themselves, a query
//! each) and beside merely rasterising the same boxes.
//!
//! All ways take turns, round by round, on the same depth; the table has medians, and ratios of
//! medians to those of native queries. `cargo bench --bench queries`; after `--`, `--short` makes it
//! quick, `--software` leaves the GPU out, and `WGPU_BACKEND` chooses among the APIs.

mod conventional;
mod scene;
mod software;

use std::time::{Duration, Instant};

use tercet::query::gpu::{AnyBy, Counting, DepthTarget, FrameTargets, GpuConfig, GpuQueries};
use tercet::query::{QueryBackend, Ticket, Wait, Want};

use conventional::Conventional;
use scene::Scene;

/// A way of asking about boxes.
enum Way<'g> {
    /// By this crate.
    Ours(Box<GpuQueries>, Want),
    /// By native queries around the boxes' own triangles.
    Native(Conventional<'g>),
    /// Not at all: they are drawn.
    Raster(Conventional<'g>),
}

/// Until the device is done, and until all answers have been delivered.
type Times = [Duration; 2];

fn main() {
    let short = std::env::args().any(|argument| argument == "--short");
    software::table(short);
    if std::env::args().any(|argument| argument == "--software") {
        return;
    }
    // How many boxes, and how many rounds.
    let counts: &[_] = if short { &[(100, 3)] } else { &[(100, 15), (1000, 15), (10_000, 7)] };
    for backend in [wgpu::Backends::VULKAN, wgpu::Backends::GL, wgpu::Backends::DX12, wgpu::Backends::METAL] {
        if wgpu::Backends::from_env().is_none_or(|wanted| wanted.contains(backend)) {
            api(backend, counts);
        }
    }
}

/// Every number and size of boxes on an API's default adapter.
fn api(backend: wgpu::Backends, counts: &[(u32, usize)]) {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backend;
    let instance = wgpu::Instance::new(descriptor);
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&Default::default())) else {
        println!("SKIPPED: there is no adapter for {backend:?}\n");
        return;
    };
    let info = adapter.get_info();
    println!("## {:?}: {} ({})\n", info.backend, info.name, info.driver_info);
    println!("| boxes | pixels a box | in sight | way | device, ms | answered, ms | answered / native |");
    println!("|---|---|---|---|---|---|---|");
    let features = GpuQueries::wanted_features(&adapter);
    let descriptor = wgpu::DeviceDescriptor { required_features: features, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
    for area in [2000.0, 70.0] {
        for &(count, rounds) in counts {
            compare(&Scene::new(&device, &queue, count, area), rounds);
        }
    }
    println!();
}

/// All ways on one scene.
fn compare(scene: &Scene<'_>, rounds: usize) {
    let mut ways: Vec<(String, Way<'_>)> = vec![
        ("native queries, the boxes' triangles".into(), Way::Native(Conventional::new(scene))),
        ("plain raster of the same, no answers".into(), Way::Raster(Conventional::new(scene))),
    ];
    let mut ours = |what: String, counting, any, want| {
        let config = GpuConfig { counting, any, ..GpuConfig::default() };
        let mut queries = GpuQueries::with_config(scene.device, scene.queue, config).expect("a backend");
        let view = scene.depth.create_view(&Default::default());
        let depth = DepthTarget { view, depth_only: None, keep: true };
        queries.target(&FrameTargets { colors: Vec::new(), depth });
        ways.push((what, Way::Ours(Box::new(queries), want)));
    };
    for counting in Counting::ALL.into_iter().filter(|counting| counting.is_supported(scene.device)) {
        ours(format!("dual, {counting:?}"), Some(counting), AnyBy::Counts, Want::Dual);
    }
    ours("**dual, the default**".into(), None, AnyBy::Counts, Want::Dual);
    ours("any, the default".into(), None, AnyBy::Counts, Want::Any);
    ours("any, native".into(), None, AnyBy::Native, Want::Any);
    let mut times: Vec<Vec<Times>> = vec![Vec::new(); ways.len()];
    let mut in_sight = vec![0; ways.len()];
    // The first round warms up.
    for round in 0..=rounds {
        for (i, (_, way)) in ways.iter_mut().enumerate() {
            let (took, visible) = way.ask(scene);
            in_sight[i] = visible;
            times[i].extend((round > 0).then_some(took));
        }
    }
    let medians: Vec<[f64; 2]> =
        times.iter().map(|times| [0, 1].map(|k| median(times.iter().map(|took| took[k])))).collect();
    for (((what, way), [device, answered]), visible) in ways.iter().zip(&medians).zip(in_sight) {
        let (count, area) = (scene.proxies.len(), scene::mean_area(&scene.proxies));
        let visible = match way {
            Way::Raster(_) => "–".into(),
            _ => format!("{visible}"),
        };
        let ratio = answered / medians[0][1];
        println!("| {count} | {area:.0} | {visible} | {what} | {device:.2} | {answered:.2} | {ratio:.2} |");
    }
}

impl Way<'_> {
    /// Asks about all boxes; also says how many are in sight.
    fn ask(&mut self, scene: &Scene<'_>) -> (Times, usize) {
        let start = Instant::now();
        match self {
            Self::Native(boxes) => {
                boxes.submit_queries();
                scene.wait();
                let device = start.elapsed();
                let visible = boxes.read();
                ([device, start.elapsed()], visible)
            }
            Self::Raster(boxes) => {
                boxes.submit_draw();
                scene.wait();
                ([start.elapsed(); 2], 0)
            }
            Self::Ours(queries, want) => {
                queries.begin(&scene.view).expect("begin");
                for (ticket, proxy) in (0..).zip(&scene.proxies) {
                    queries.ask(Ticket(ticket), std::slice::from_ref(proxy), *want).expect("ask");
                }
                let mut visible = 0;
                let mut deliver = |_, answer: tercet::query::Answer<'_>| {
                    visible += usize::from(answer.is_visible(0));
                };
                queries.answers(Wait::Poll, &mut deliver).expect("answers");
                scene.wait();
                let device = start.elapsed();
                queries.answers(Wait::Block, &mut deliver).expect("answers");
                let answered = start.elapsed();
                queries.end().expect("end");
                ([device, answered], visible)
            }
        }
    }
}

/// In milliseconds.
fn median(times: impl Iterator<Item = Duration>) -> f64 {
    let mut sorted: Vec<f64> = times.map(|time| 1e3 * time.as_secs_f64()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
