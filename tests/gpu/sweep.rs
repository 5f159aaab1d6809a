//! Sweeps, stage by stage against their twins on the CPU: proxies made on the device against
//! geometry and against the normative ones, the pyramid against a fold of the depth, each test
//! against a plain loop over the device's own proxies, and rays against rasters.

use glam::Vec4;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Frustum, PixelRect, Proxy, Question, View};
use tercet::query::gpu::{GpuConfig, GpuQueries, Level};
use tercet::query::{Answer, QueryBackend, Sweep, SweepTest, Ticket, Wait};
use tercet::scene::{ObjectId, ObjectSet, Scene, SceneConfig, Traits};
use tercet::tree::{NodeId, TreeConfig};

use crate::geometry::{Case, Sample, random_case};
use crate::support::{Gpu, Nearness, clip, depth_of, gpus, gpus_with, targets};
use crate::sweep_mutations::rays_alone;
use crate::twin::{Convention, conventions, occluders, plain_any, view_of};

/// What a comparison met.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Boxes that had a proxy.
    pub asked: usize,
    /// Samples of geometry that were looked at.
    samples: usize,
    /// Boxes with a sample in sight, and without.
    seen: usize,
    pub hidden: usize,
    /// Hidden ones that the pyramid took for seen.
    loose: usize,
    /// Objects that only the normative proxy shows.
    fewer: usize,
    /// Objects that only the device's proxy shows.
    pub more: usize,
    /// Groups that rays were cast into, and those of them that stand for a larger one, which was opened.
    groups: u64,
    opened: usize,
    /// What was found in and beside them, and what was not.
    by_rays: [usize; 2],
    /// What is outside the bounds, a stage: proxies, pyramid, raster, Hi-Z, rays.
    pub faults: [usize; 5],
}

/// A backend that is compared.
pub struct Twin<'g> {
    gpu: &'g Gpu,
    queries: GpuQueries,
    pub tally: Tally,
}

/// Boxes in a scene, in the order of their ids.
struct Boxes {
    scene: Scene,
    cases: Vec<Case>,
    ids: Vec<ObjectId>,
}

impl Boxes {
    fn new(cases: Vec<Case>) -> Self {
        // A tree of some depth: small leaves from the beginning.
        let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let ids = cases.iter().map(|case| scene.insert(case.world, Traits::default())).collect();
        scene.update();
        Self { scene, cases, ids }
    }

    fn random(dice: &mut ChaCha8Rng, view: &View, count: usize) -> Self {
        Self::new((0..count).map(|_| random_case(dice, |_| view.clone())).collect())
    }

    /// Some nodes, none below another, and some objects.
    fn targets(&self, dice: &mut ChaCha8Rng) -> (Vec<NodeId>, Vec<ObjectId>) {
        let tree = self.scene.tree();
        let (mut groups, mut stack) = (Vec::new(), vec![tree.root()]);
        while let Some(node) = stack.pop() {
            match (tree.children(node), dice.random_range(0..6)) {
                (Some(children), 0..3) => stack.extend(children),
                (_, 3) => {}
                _ => groups.push(node),
            }
        }
        (groups, self.ids.iter().copied().filter(|_| dice.random_bool(0.1)).collect())
    }
}

impl<'g> Twin<'g> {
    pub fn new(gpu: &'g Gpu, config: GpuConfig) -> Self {
        Self { gpu, queries: gpu.exact_queries(config), tally: Tally::default() }
    }

    /// One view with some boxes, against the depth of some triangles.
    pub fn round(&mut self, dice: &mut ChaCha8Rng, convention: Convention) {
        let view = small_view(dice, convention);
        let boxes = Boxes::random(dice, &view, 60);
        let normative: Vec<_> = boxes.cases.iter().map(|case| Question::new(&case.world, &view)).collect();
        let proxies: Vec<_> = normative.iter().filter_map(proxy).collect();
        let mut triangles = occluders(dice, &view, &proxies);
        if dice.random() {
            triangles = mosaic(dice, &view, &proxies);
        }
        triangles.extend((0..3).map(|_| wall_before(dice, &view, &proxies)));
        let (depth, nearness) = depth_of(self.gpu, &mut self.queries, &view, &triangles);
        self.queries.target(&targets(&depth, true));
        self.queries.begin(&view).expect("begin");
        let frustum = Frustum::new(&view);
        let of = |test| Sweep {
            scene: &boxes.scene,
            view: &view,
            frustum: &frustum,
            groups: &[],
            loose: &boxes.ids,
            test,
        };
        let made = self.queries.inspect_proxies(&of(SweepTest::Raster)).expect("proxies");
        for (i, case) in boxes.cases.iter().enumerate() {
            let question = made.iter().find(|(id, _)| *id == boxes.ids[i]);
            let question = question.map_or(Question::Outside, |(_, question)| *question);
            self.tally.faults[0] += self.geometry_outside(dice, case, &question);
            self.tally.asked += usize::from(proxy(&question).is_some());
        }
        let levels = self.queries.inspect_pyramid().expect("a pyramid");
        self.tally.faults[1] += usize::from(levels != folded(&nearness));
        let raster = sweep(&mut self.queries, &of(SweepTest::Raster));
        let hi_z = sweep(&mut self.queries, &of(SweepTest::HiZ));
        for (id, question) in &made {
            let [least, most] = [-1.0, 1.0].map(|sign| in_sight(question, &nearness, sign));
            let seen = raster.contains(*id);
            self.tally.faults[2] += usize::from(seen && !most || !seen && least);
            (self.tally.seen, self.tally.hidden) =
                (self.tally.seen + usize::from(seen), self.tally.hidden + usize::from(!seen));
            let expected = match question {
                Question::Ask(proxy) => proxy.nearest >= farthest_around(&levels, &proxy.rect),
                question => *question == Question::Visible,
            };
            self.tally.faults[3] += usize::from(hi_z.contains(*id) != expected);
            self.tally.loose += usize::from(hi_z.contains(*id) && !seen);
        }
        for (id, question) in boxes.ids.iter().zip(&normative) {
            let seen = in_sight(question, &nearness, 0.0) && frustum_holds(&boxes.scene, *id, &frustum);
            self.tally.fewer += usize::from(seen && !raster.contains(*id));
            self.tally.more += usize::from(!seen && raster.contains(*id));
        }
        for _ in 0..2 {
            let (groups, loose) = boxes.targets(dice);
            let of = |test| Sweep { groups: &groups, loose: &loose, ..of(test) };
            let raster = sweep(&mut self.queries, &of(SweepTest::Raster));
            let rays = sweep(&mut self.queries, &of(SweepTest::Rays));
            self.tally.faults[4] += usize::from(!raster.slots().eq(rays.slots()));
            let cast = self.queries.inspect_groups(&of(SweepTest::Rays)).expect("groups");
            // Those of the whole screen are opened.
            self.tally.faults[4] += cast.iter().filter(|(_, pixels)| pixels.is_none()).count();
            self.tally.opened += cast.iter().filter(|(group, _)| !groups.contains(group)).count();
            let [found, others] = &mut self.tally.by_rays;
            (*found, *others) = (*found + rays.len(), *others + boxes.ids.len() - rays.len());
        }
        self.tally.groups += self.queries.stats().groups;
        self.queries.end().expect("end");
    }

    /// How many samples of a box's geometry its proxy on the device does not hold.
    fn geometry_outside(&mut self, dice: &mut ChaCha8Rng, case: &Case, question: &Question) -> usize {
        let mut samples = Vec::new();
        for _ in 0..3 {
            let triangle = case.triangle(dice);
            case.samples(triangle, 16, dice, &mut samples);
        }
        self.tally.samples += samples.len();
        samples.iter().filter(|sample| !holds(question, sample)).count()
    }
}

/// A view of few pixels.
fn small_view(dice: &mut ChaCha8Rng, convention: Convention) -> View {
    loop {
        let view = view_of(dice, convention);
        if view.viewport().width * view.viewport().height < 1 << 13 {
            return view;
        }
    }
}

/// A triangle that hides most of what is about as far as some proxy, around it.
fn wall_before(dice: &mut ChaCha8Rng, view: &View, proxies: &[Proxy]) -> [Vec4; 3] {
    let Some(proxy) = proxies.get(dice.random_range(0..proxies.len().max(1))) else { return [Vec4::ZERO; 3] };
    let PixelRect { x0, y0, x1, y1 } = proxy.rect;
    let (x, y) = ((x0 + x1) as f32 / 2.0, (y0 + y1) as f32 / 2.0);
    let size = 4.0 * ((x1 - x0).max(y1 - y0) as f32 + dice.random_range(0.0..40.0));
    let far = view.depth().cleared();
    let nearness = (far + (proxy.nearest - far) * dice.random_range(1.0..2.0)).min(far + 1.0);
    [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.5]].map(|[i, j]| clip(view, [x + i * size, y + j * size], nearness))
}

/// Squares of a few pixels over all of the screen, each about as near as some proxy: the farthest of
/// neighbouring texels differ everywhere.
fn mosaic(dice: &mut ChaCha8Rng, view: &View, proxies: &[Proxy]) -> Vec<[Vec4; 3]> {
    const SIDE: u32 = 4;
    let (width, height) = (view.viewport().width, view.viewport().height);
    let far = view.depth().cleared();
    let mut triangles = Vec::new();
    for (x, y) in (0..height.div_ceil(SIDE)).flat_map(|y| (0..width.div_ceil(SIDE)).map(move |x| (x, y))) {
        let Some(proxy) = proxies.get(dice.random_range(0..proxies.len().max(1))) else { break };
        let by = dice.random_range(0.9..1.5);
        let nearness = (far + (proxy.nearest - far) * by).clamp(far, far + 1.0);
        let corner =
            |i: u32, j: u32| clip(view, [((x + i) * SIDE) as f32, ((y + j) * SIDE) as f32], nearness);
        triangles.push([corner(0, 0), corner(1, 0), corner(1, 1)]);
        triangles.push([corner(0, 0), corner(1, 1), corner(0, 1)]);
    }
    triangles
}

fn proxy(question: &Question) -> Option<Proxy> {
    if let Question::Ask(proxy) = question { Some(*proxy) } else { None }
}

fn frustum_holds(scene: &Scene, id: ObjectId, frustum: &Frustum) -> bool {
    scene.object(id).and_then(|object| object.bounds).is_some_and(|bounds| frustum.intersects(&bounds))
}

fn holds(question: &Question, sample: &Sample) -> bool {
    match question {
        Question::Visible => true,
        Question::Outside => false,
        Question::Ask(proxy) => {
            proxy.rect.contains(sample.x, sample.y)
                && proxy.covers(sample.x, sample.y)
                && sample.nearness.iter().all(|&n| f64::from(proxy.nearness(sample.x, sample.y)) >= n)
        }
    }
}

/// Whether some sample is in sight, with everything raised by what evaluation may differ by (or
/// lowered).
fn in_sight(question: &Question, nearness: &Nearness, sign: f64) -> bool {
    match question {
        Question::Visible => true,
        Question::Outside => false,
        Question::Ask(proxy) => plain_any(proxy, nearness, 12.0 * sign),
    }
}

/// The answer to a sweep.
pub fn sweep(queries: &mut GpuQueries, sweep: &Sweep<'_>) -> ObjectSet {
    queries.sweep(Ticket(7), sweep).expect("a sweep");
    let mut found = None;
    queries
        .answers(Wait::Block, |ticket, answer| match answer {
            Answer::Swept(objects) => {
                assert!(ticket == Ticket(7) && found.replace(objects.clone()).is_none());
            }
            other => panic!("{other:?}"),
        })
        .expect("answers");
    found.expect("an answer")
}

/// The pyramid of some depth.
fn folded(nearness: &Nearness) -> Vec<Level> {
    let down = (nearness.values.len() / nearness.samples as usize) as u32 / nearness.width;
    let pixels = nearness.values.chunks(nearness.samples as usize);
    let least = |values: &[f32]| values.iter().copied().fold(f32::INFINITY, f32::min);
    let mut below = Level { width: nearness.width, height: down, nearness: pixels.map(least).collect() };
    let mut levels = Vec::new();
    while levels.is_empty() || (below.width, below.height) != (1, 1) {
        let (width, height) = (below.width.div_ceil(2), below.height.div_ceil(2));
        let mut level = Level { width, height, nearness: vec![f32::INFINITY; (width * height) as usize] };
        for (i, &n) in below.nearness.iter().enumerate() {
            let (x, y) = (i as u32 % below.width / 2, i as u32 / below.width / 2);
            let farthest = &mut level.nearness[(y * width + x) as usize];
            *farthest = farthest.min(n);
        }
        levels.push(level.clone());
        below = level;
    }
    levels
}

/// The farthest texel that a rectangle touches, on the finest level where it touches two at most
/// along each side.
fn farthest_around(levels: &[Level], rect: &PixelRect) -> f32 {
    let touched = |level: usize| {
        let texel = |pixel: u32| pixel >> (level + 1);
        [texel(rect.x0), texel(rect.y0), texel(rect.x1 - 1), texel(rect.y1 - 1)]
    };
    let spans_two = |level: &usize| {
        let [x0, y0, x1, y1] = touched(*level);
        x1 - x0 <= 1 && y1 - y0 <= 1
    };
    let level = (0..levels.len()).find(spans_two).expect("the last level is one texel");
    let [x0, y0, x1, y1] = touched(level);
    let at = |x: u32, y: u32| levels[level].nearness[(y * levels[level].width + x) as usize];
    at(x0, y0).min(at(x1, y0)).min(at(x0, y1)).min(at(x1, y1))
}

#[test]
fn stages_equal_their_twins() {
    // Once with everything found beforehand that can be, once by closer tests alone: groups by rays.
    let mut rays = GpuConfig { prune_from: usize::MAX, ..GpuConfig::default() };
    rays_alone(&mut rays.shaders);
    for (gpu, config) in gpus().iter().flat_map(|gpu| [GpuConfig::default(), rays.clone()].map(|c| (gpu, c)))
    {
        let mut twin = Twin::new(gpu, config);
        for convention in conventions(gpu) {
            let mut dice = ChaCha8Rng::seed_from_u64(3);
            twin.tally = Tally::default();
            while twin.tally.asked < 500 {
                twin.round(&mut dice, convention);
            }
            let tally = twin.tally;
            println!("{:?}, {convention:?}: {tally:?}", gpu.backend);
            assert_eq!(tally.faults, [0; 5], "{:?}, {convention:?}: {tally:?}", gpu.backend);
            assert!(tally.samples > 2500 && tally.seen.min(tally.hidden) > 100, "{tally:?}");
            assert!(tally.fewer == 0 && tally.more * 4 < tally.hidden, "{tally:?}");
            assert!(tally.loose * 2 < tally.hidden, "{tally:?}");
            assert!(
                tally.groups.min(tally.opened as u64) > 40 && tally.by_rays.iter().all(|&count| count > 200),
                "{tally:?}"
            );
        }
    }
}

/// A device that binds few bytes: what it cannot hold of the tree is tested as by rasters.
#[test]
fn where_the_tree_does_not_fit_rasters_answer() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 16, ..wgpu::Limits::default() };
    for gpu in gpus_with(limits) {
        let mut queries = gpu.exact_queries(GpuConfig::default());
        let mut dice = ChaCha8Rng::seed_from_u64(5);
        let view = small_view(&mut dice, conventions(&gpu)[0]);
        for (count, fits) in [(200, true), (1000, false)] {
            let boxes = Boxes::random(&mut dice, &view, count);
            let (depth, _) = depth_of(&gpu, &mut queries, &view, &[]);
            queries.target(&targets(&depth, true));
            queries.begin(&view).expect("begin");
            let frustum = Frustum::new(&view);
            let tree = boxes.scene.tree();
            // Its objects fit, all of the tree's may not.
            let group = tree.nodes().find(|node| (10..100).contains(&node.below)).expect("a small node").id;
            let groups = [group];
            let of = |test| Sweep {
                scene: &boxes.scene,
                view: &view,
                frustum: &frustum,
                groups: &groups,
                loose: &[],
                test,
            };
            let raster = sweep(&mut queries, &of(SweepTest::Raster));
            let rays = sweep(&mut queries, &of(SweepTest::Rays));
            assert!(raster.slots().eq(rays.slots()));
            assert_eq!(queries.stats().groups > 0, fits, "{:?}, {count} objects", gpu.backend);
            queries.end().expect("end");
        }
    }
}
