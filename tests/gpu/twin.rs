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
    /// Samples that only the GPU counts, as covered or in sight.
    more: u64,
    /// Answers outside the bounds.
    pub faults: usize,
}

/// Visible and covered samples of a proxy.
type Counts = [u64; 2];

/// The plain loop. `raise` is how many 2⁻²⁴ parts of the sum of magnitudes a function is raised by,
/// `slack` is added to the entry nearness.
fn plain(proxy: &Proxy, nearness: &Nearness, raise: f64, slack: f64) -> Counts {
    let size = [f64::from(proxy.rect.width()), f64::from(proxy.rect.height())];
    let tiny = f64::from(f32::MIN_POSITIVE);
    let affine = |&[a, b, c]: &[f32; 3], x: u32, y: u32| {
        let (dx, dy) = ((x - proxy.rect.x0) as f32 + 0.5, (y - proxy.rect.y0) as f32 + 0.5);
        let magnitude = f64::from(a.abs()) * size[0] + f64::from(b.abs()) * size[1] + f64::from(c.abs());
        let up = if raise > 0.0 { raise / 16_777_216.0 * magnitude + 16.0 * tiny } else { 0.0 };
        f64::from((a * dx + b * dy) + c) + up
    };
    let (mut visible, mut total) = (0, 0);
    for y in proxy.rect.y0..proxy.rect.y1 {
        for x in proxy.rect.x0..proxy.rect.x1 {
            if proxy.edges.iter().all(|edge| affine(edge, x, y) >= 0.0) {
                let nearest = f64::from(proxy.nearest);
                let entry = proxy.planes.iter().fold(nearest, |entry, p| entry.min(affine(p, x, y)));
                let stored = nearness.pixel(x, y);
                total += stored.len() as u64;
                visible += stored.iter().filter(|&&n| entry + slack >= f64::from(n)).count() as u64;
            }
        }
    }
    [visible, total]
}

/// A backend that is compared with the plain loop.
pub struct Twin<'g> {
    gpu: &'g Gpu,
    queries: GpuQueries,
    any: AnyBy,
    pub tally: Tally,
}

impl<'g> Twin<'g> {
    pub fn new(gpu: &'g Gpu, config: GpuConfig) -> Self {
        let any = config.any;
        Self { gpu, queries: gpu.exact_queries(config), any, tally: Tally::default() }
    }

    /// One view with some boxes, against the depth of some triangles.
    pub fn round(&mut self, dice: &mut ChaCha8Rng, convention: Convention) {
        let view = view_of(dice, convention);
        let mut asked = proxies(dice, &view, 50);
        let triangles = occluders(dice, &view, &asked);
        let (depth, nearness) = depth_of(self.gpu, &mut self.queries, &view, &triangles);
        asked.extend(ties(dice, &view, &nearness, 8));
        self.queries.target(&targets(&depth, true));
        self.queries.begin(&view).expect("begin");
        self.compare(&asked, &nearness, self.any_slack(&view));
        self.queries.end().expect("end");
    }

    /// What native queries may find visible beyond what counting may.
    fn any_slack(&self, view: &View) -> f64 {
        match (self.any, view.format()) {
            (AnyBy::Counts, _) | (_, DepthFormat::Depth32Float) => 0.0,
            // The slack, and as much again as bringing it to whole units may add.
            (AnyBy::Native, DepthFormat::Depth24Plus) => 4.0 / 16_777_216.0,
        }
    }

    /// Asks about each proxy in both ways, and compares.
    fn compare(&mut self, proxies: &[Proxy], nearness: &Nearness, any_slack: f64) {
        for (i, proxy) in proxies.iter().enumerate() {
            self.queries.ask(Ticket(2 * i as u32), &[*proxy], Want::Dual).expect("ask");
            self.queries.ask(Ticket(2 * i as u32 + 1), &[*proxy], Want::Any).expect("ask");
        }
        let mut found = vec![([0; 2], false); proxies.len()];
        let mut answered = 0;
        self.queries
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
        let tally = &mut self.tally;
        for (proxy, (counts, any)) in proxies.iter().zip(found) {
            let (least, most) = (plain(proxy, nearness, 0.0, 0.0), plain(proxy, nearness, 24.0, 0.0));
            let within = (0..2).all(|i| (least[i]..=most[i]).contains(&counts[i]));
            let overlooked = !any && (least[0] > 0 || counts[0] > 0 && self.any == AnyBy::Native);
            let invented = any && most[0] == 0 && plain(proxy, nearness, 24.0, any_slack)[0] == 0;
            tally.boxes += 1;
            tally.faults += usize::from(!within) + usize::from(overlooked || invented);
            tally.samples += least[1];
            tally.more += counts[1].saturating_sub(least[1]).max(counts[0].saturating_sub(least[0]));
            match least[0] {
                0 => tally.hidden += 1,
                visible if visible == least[1] => tally.whole += 1,
                _ => tally.part += 1,
            }
        }
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
fn proxies(dice: &mut ChaCha8Rng, view: &View, count: usize) -> Vec<Proxy> {
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
fn occluders(dice: &mut ChaCha8Rng, view: &View, proxies: &[Proxy]) -> Vec<[Vec4; 3]> {
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

/// Compares a way of answering in every convention.
fn sweep(gpu: &Gpu, config: &GpuConfig) {
    let what = format!("{:?}, {:?}, any by {:?}", gpu.backend, config.counting, config.any);
    let mut twin = Twin::new(gpu, config.clone());
    for convention in conventions(gpu) {
        let mut dice = ChaCha8Rng::seed_from_u64(7);
        twin.tally = Tally::default();
        while twin.tally.boxes < 1000 {
            twin.round(&mut dice, convention);
        }
        let tally = twin.tally;
        println!("{what}, {convention:?}: {tally:?}");
        assert_eq!(tally.faults, 0, "{what}, {convention:?}: {tally:?}");
        assert!(tally.more * 1000 < tally.samples, "{tally:?}");
        assert!(tally.hidden.min(tally.whole).min(tally.part) > 50, "{tally:?}");
    }
}

#[test]
fn counts_equal_the_plain_loop() {
    for gpu in gpus() {
        for counting in ways() {
            sweep(&gpu, &GpuConfig { counting, ..GpuConfig::default() });
        }
    }
}

#[test]
fn native_queries_overlook_nothing_that_counts_find() {
    for gpu in gpus() {
        sweep(&gpu, &GpuConfig { any: AnyBy::Native, ..GpuConfig::default() });
    }
}
