//! Counts against the plain loop of the contract (`geom/proxy.rs`) over the same depth.
//!
//! The loop is run twice: with the proxy as it is, and with the proxy raised by the bound that
//! `query/gpu/pack.rs` states. The GPU must count at least the first and at most the second.

use crate::proxies::flat;
use glam::Vec4;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{DepthDirection, DepthFormat, PixelRect, Proxy, Question, View, Viewport};
use tercet::query::gpu::{AnyBy, GpuConfig, GpuQueries};
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};

use crate::geometry::{ordinary_view, random_case, random_view};
use crate::proxies::random_proxy;
use crate::support::{Gpu, Nearness, clip, depth_of, gpus, targets, ways};

/// What a sweep met.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    boxes: usize,
    /// Boxes that were hidden, or in sight, or neither wholly.
    hidden: usize,
    whole: usize,
    part: usize,
    samples: u64,
    /// Answers outside the bounds.
    pub faults: usize,
}

/// Visible and covered samples of a proxy.
type Counts = [u64; 2];

/// The plain loop. `raise` is how many 2⁻²⁴ parts of the sum of magnitudes a function is raised by,
/// `slack` is added to the entry nearness.
fn plain(proxy: &Proxy, nearness: &Nearness, raise: f64, slack: f64) -> Counts {
    let (mut visible, mut total) = (0, 0);
    walk(proxy, raise, |x, y, entry| {
        let stored = nearness.pixel(x, y);
        total += stored.len() as u64;
        visible += stored.iter().filter(|&&n| entry + slack >= f64::from(n)).count() as u64;
        true
    });
    [visible, total]
}

/// Whether the plain loop finds a sample in sight.
pub fn plain_any(proxy: &Proxy, nearness: &Nearness, raise: f64) -> bool {
    let mut found = false;
    walk(proxy, raise, |x, y, entry| {
        found = nearness.pixel(x, y).iter().any(|&n| entry >= f64::from(n));
        !found
    });
    found
}

/// Visits the covered pixels of a proxy with its entry nearness, for as long as `visit` says. All
/// functions are raised, or lowered, by so many 2⁻²⁴ parts of the sum of magnitudes.
fn walk(proxy: &Proxy, raise: f64, mut visit: impl FnMut(u32, u32, f64) -> bool) {
    let size = [f64::from(proxy.rect.width()), f64::from(proxy.rect.height())];
    let tiny = 16.0 * f64::from(f32::MIN_POSITIVE);
    let affine = |&[a, b, c]: &[f32; 3], x: u32, y: u32| {
        let (dx, dy) = ((x - proxy.rect.x0) as f32 + 0.5, (y - proxy.rect.y0) as f32 + 0.5);
        let magnitude = f64::from(a.abs()) * size[0] + f64::from(b.abs()) * size[1] + f64::from(c.abs());
        let up = if raise == 0.0 { 0.0 } else { raise / 16_777_216.0 * magnitude + tiny.copysign(raise) };
        f64::from((a * dx + b * dy) + c) + up
    };
    for y in proxy.rect.y0..proxy.rect.y1 {
        for x in proxy.rect.x0..proxy.rect.x1 {
            if proxy.edges.iter().all(|edge| affine(edge, x, y) >= 0.0) {
                let nearest = f64::from(proxy.nearest);
                let entry = proxy.planes.iter().fold(nearest, |entry, p| entry.min(affine(p, x, y)));
                if !visit(x, y, entry) {
                    return;
                }
            }
        }
    }
}

/// Backends that are compared with the plain loop, on the same depth.
pub struct Twin<'g> {
    gpu: &'g Gpu,
    backends: Vec<Backend>,
    /// Windows a proxy that are asked about too: one sample decides the answer about a window, so
    /// that small mistakes show even where nothing is counted.
    windows: usize,
    pub tally: Tally,
}

/// One of them.
struct Backend {
    config: GpuConfig,
    queries: GpuQueries,
    /// Samples that only the GPU counts, as covered or in sight.
    more: u64,
}

/// What the plain loop finds, as it is and with everything raised by what is allowed for.
struct Expected {
    least: Counts,
    most: Counts,
    /// Whether a native query may find something, which may need a little more than a count.
    most_native: bool,
}

impl<'g> Twin<'g> {
    pub fn new(gpu: &'g Gpu, configs: impl IntoIterator<Item = GpuConfig>, windows: usize) -> Self {
        let backend =
            |config: GpuConfig| Backend { queries: gpu.exact_queries(config.clone()), config, more: 0 };
        Self { gpu, backends: configs.into_iter().map(backend).collect(), windows, tally: Tally::default() }
    }

    /// One view with some boxes, against the depth of some triangles.
    pub fn round(&mut self, dice: &mut ChaCha8Rng, convention: Convention) {
        let view = view_of(dice, convention);
        let mut asked = proxies(dice, &view, 50);
        let triangles = occluders(dice, &view, &asked);
        let (depth, nearness) = depth_of(self.gpu, &mut self.backends[0].queries, &view, &triangles);
        let windows: Vec<_> = asked.iter().flat_map(|proxy| vec![*proxy; self.windows]).collect();
        asked.extend(windows.iter().map(|proxy| window(dice, proxy)));
        asked.extend(ties(dice, &view, &nearness, 8));
        let expected: Vec<_> =
            asked.iter().map(|proxy| Expected::new(proxy, &nearness, view.format())).collect();
        expected.iter().for_each(|expected| self.tally.meet(expected));
        for backend in &mut self.backends {
            backend.queries.target(&targets(&depth, true));
            backend.queries.begin(&view).expect("begin");
            self.tally.faults += backend.compare(&asked, &expected);
            backend.queries.end().expect("end");
        }
    }
}

impl Expected {
    fn new(proxy: &Proxy, nearness: &Nearness, format: DepthFormat) -> Self {
        let [least, most] = [0.0, 24.0].map(|raise| plain(proxy, nearness, raise, 0.0));
        let most_native = most[0] > 0
            || match format {
                DepthFormat::Depth32Float => false,
                // Two units of slack, and as much again for bringing it to whole units.
                DepthFormat::Depth24Plus => plain(proxy, nearness, 24.0, 4.0 / 16_777_216.0)[0] > 0,
            };
        Self { least, most, most_native }
    }
}

impl Tally {
    fn meet(&mut self, expected: &Expected) {
        let [visible, total] = expected.least;
        self.boxes += 1;
        self.samples += total;
        match visible {
            0 => self.hidden += 1,
            all if all == total => self.whole += 1,
            _ => self.part += 1,
        }
    }
}

impl Backend {
    /// Asks about each proxy in both ways, and compares: how many answers are outside the bounds.
    fn compare(&mut self, proxies: &[Proxy], expected: &[Expected]) -> usize {
        let queries = &mut self.queries;
        for (i, proxy) in proxies.iter().enumerate() {
            queries.ask(Ticket(2 * i as u32), &[*proxy], Want::Dual).expect("ask");
            queries.ask(Ticket(2 * i as u32 + 1), &[*proxy], Want::Any).expect("ask");
        }
        let mut found = vec![([0; 2], false); proxies.len()];
        let mut answered = 0;
        queries
            .answers(Wait::Block, |ticket, answer| {
                let found = &mut found[ticket.0 as usize / 2];
                match answer {
                    Answer::Dual { visible, total } => found.0 = [u64::from(visible), u64::from(total)],
                    Answer::Any(any) => found.1 = any,
                    other => panic!("{other:?}"),
                }
                answered += 1;
            })
            .expect("answers");
        assert_eq!(answered, 2 * proxies.len());
        let native = self.config.any == AnyBy::Native;
        let mut faults = 0;
        for (&(counts, any), Expected { least, most, most_native }) in found.iter().zip(expected) {
            let within = (0..2).all(|i| (least[i]..=most[i]).contains(&counts[i]));
            let overlooked = !any && (least[0] > 0 || native && counts[0] > 0);
            let invented = any && most[0] == 0 && !(native && *most_native);
            faults += usize::from(!within) + usize::from(overlooked || invented);
            self.more += counts[1].saturating_sub(least[1]).max(counts[0].saturating_sub(least[0]));
        }
        faults
    }
}

/// A convention of depth: direction, format, samples a pixel.
pub type Convention = (DepthDirection, DepthFormat, u32);

pub fn conventions(gpu: &Gpu) -> Vec<Convention> {
    let mut all = Vec::new();
    for direction in [DepthDirection::Reversed, DepthDirection::Standard] {
        for format in [DepthFormat::Depth32Float, DepthFormat::Depth24Plus] {
            all.extend(gpu.sample_counts().iter().map(|&samples| (direction, format, samples)));
        }
    }
    all
}

/// A view of some kind, of a size that is cheap to draw.
pub fn view_of(dice: &mut ChaCha8Rng, (direction, format, samples): Convention) -> View {
    loop {
        let ordinary = dice.random_bool(0.2) && direction == DepthDirection::Reversed;
        let view = if ordinary { ordinary_view(dice) } else { random_view(dice) };
        let Viewport { x, y, width, height } = view.viewport();
        let area = u64::from(x + width) * u64::from(y + height);
        if view.depth() == direction && area < 1 << 20 && width * height > 16 {
            return view.with_target(direction, format, samples);
        }
    }
}

/// The proxies of random boxes in a view, and outlines that no box has.
pub fn proxies(dice: &mut ChaCha8Rng, view: &View, count: usize) -> Vec<Proxy> {
    let mut all = Vec::new();
    let mut tries = 0;
    while all.len() < count && tries < 40 * count {
        tries += 1;
        let case = random_case(dice, |_| view.clone());
        if let Question::Ask(proxy) = Question::new(&case.world, view) {
            all.push(proxy);
        }
    }
    let Viewport { width, height, .. } = view.viewport();
    let far = view.depth().cleared();
    (0..count / 4).for_each(|_| all.push(random_proxy(dice, [width, height], far)));
    all
}

/// Triangles in front of, behind and across the proxies.
pub fn occluders(dice: &mut ChaCha8Rng, view: &View, proxies: &[Proxy]) -> Vec<[Vec4; 3]> {
    let mut triangles = Vec::new();
    for proxy in proxies.iter().filter(|_| dice.random_bool(0.5)).copied().collect::<Vec<_>>() {
        let PixelRect { x0, y0, x1, y1 } = proxy.rect;
        let mut corner = || {
            let (x, y) = (dice.random_range(x0..x1), dice.random_range(y0..y1));
            let entry = proxy.nearness(x, y);
            let by = [0.0, 1e-4, -1e-4, 0.3, -0.3][dice.random_range(0..5)];
            let far = view.depth().cleared();
            let mut beyond = |v: f32| v * dice.random_range(-0.5..1.5f32);
            let pixel = [x0 as f32 + beyond((x1 - x0) as f32), y0 as f32 + beyond((y1 - y0) as f32)];
            let nearness = far + ((entry - far) * (1.0 + by)).clamp(0.0, 1.0);
            clip(view, pixel, nearness)
        };
        triangles.push([corner(), corner(), corner()]);
    }
    triangles
}

/// A few pixels of a proxy, with its functions about another origin.
fn window(dice: &mut ChaCha8Rng, proxy: &Proxy) -> Proxy {
    let PixelRect { x0, y0, x1, y1 } = proxy.rect;
    let (x, y) = (dice.random_range(x0..x1), dice.random_range(y0..y1));
    let rect = PixelRect { x0: x, y0: y, x1: (x + 3).min(x1), y1: (y + 2).min(y1) };
    let moved = |[a, b, c]: [f32; 3]| [a, b, a * (x - x0) as f32 + b * (y - y0) as f32 + c];
    Proxy { rect, edges: proxy.edges.map(moved), planes: proxy.planes.map(moved), nearest: proxy.nearest }
}

/// Proxies at the very nearness of some sample, where equality decides.
fn ties(dice: &mut ChaCha8Rng, view: &View, nearness: &Nearness, count: usize) -> Vec<Proxy> {
    let Viewport { width, height, .. } = view.viewport();
    (0..count)
        .map(|_| {
            let (x, y) = (dice.random_range(0..width), dice.random_range(0..height));
            let stored = nearness.pixel(x, y);
            let nearest = stored[dice.random_range(0..stored.len())];
            flat(PixelRect { x0: x, y0: y, x1: (x + 9).min(width), y1: (y + 9).min(height) }, nearest)
        })
        .collect()
}

#[test]
fn answers_equal_the_plain_loop() {
    for gpu in gpus() {
        let counted = ways(&gpu).map(|counting| GpuConfig { counting, ..GpuConfig::default() });
        let native = GpuConfig { any: AnyBy::Native, ..GpuConfig::default() };
        let mut twin = Twin::new(&gpu, counted.chain([native]), 1);
        for convention in conventions(&gpu) {
            let mut dice = ChaCha8Rng::seed_from_u64(7);
            twin.tally = Tally::default();
            twin.backends.iter_mut().for_each(|backend| backend.more = 0);
            while twin.tally.boxes < 2000 {
                twin.round(&mut dice, convention);
            }
            let tally = twin.tally;
            println!("{:?}, {convention:?}: {tally:?}", gpu.backend);
            assert_eq!(tally.faults, 0, "{:?}, {convention:?}: {tally:?}", gpu.backend);
            for Backend { config: GpuConfig { counting, any, .. }, more, .. } in &twin.backends {
                let what = format!("{:?}, {convention:?}, {counting:?}, any by {any:?}", gpu.backend);
                println!("{what}: {more} samples more");
                assert!(more * 1000 < tally.samples, "{what}: {more} of {} more", tally.samples);
            }
            assert!(tally.hidden.min(tally.whole).min(tally.part) > 50, "{tally:?}");
        }
    }
}
