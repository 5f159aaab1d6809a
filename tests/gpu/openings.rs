//! Rays are not cast over the whole screen: groups that hold the eye, or cover more than a share of the
//! screen, are opened before. What is handed to the device is looked at, sweep by sweep.

use glam::Vec3;
use tercet::geom::{Aabb, Projected, Proxy, Question, View, Viewport, project};
use tercet::policy;
use tercet::query::gpu::{GpuConfig, GpuQueries};
use tercet::query::{Answer, DeviceTimes, DrawTime, QueryBackend, Sweep, SweepTest, Ticket, Wait, Want};
use tercet::scene::{ObjectRef, Scene, SceneConfig, Traits};
use tercet::tree::TreeConfig;
use tercet::{Culler, Error, worlds};

use crate::renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, targets};

const SCREEN: Viewport = Viewport::new(96, 54);

/// A backend, and what it is asked to cast rays into.
struct Watched {
    queries: GpuQueries,
    share: f32,
    groups: usize,
    /// Groups that the device cannot place; and those that hold the eye, or cover more than the share.
    near: usize,
    large: usize,
}

impl Watched {
    fn new(gpu: &Gpu, share: f32) -> Self {
        let queries = gpu.exact_queries(GpuConfig::default());
        Self { queries, share, groups: 0, near: 0, large: 0 }
    }

    fn look(&mut self, sweep: &Sweep<'_>) -> Result<(), Error> {
        let screen = sweep.view.viewport();
        let most = self.share * (screen.width * screen.height) as f32;
        for (group, pixels) in self.queries.inspect_groups(sweep)? {
            self.groups += 1;
            self.near += usize::from(pixels.is_none());
            self.large += usize::from(match project(&sweep.scene.tree().bounds(group), sweep.view) {
                Projected::Rect(rect) => rect.area() > most,
                Projected::Near => true,
                Projected::Outside => false,
            });
        }
        Ok(())
    }
}

impl QueryBackend for Watched {
    type Pass = wgpu::RenderPass<'static>;

    fn name(&self) -> &'static str {
        self.queries.name()
    }

    fn can_block(&self) -> bool {
        self.queries.can_block()
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.queries.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut Self::Pass)) -> Result<(), Error> {
        self.queries.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.queries.ask(ticket, boxes, want)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        if sweep.test == SweepTest::Rays {
            self.look(sweep)?;
        }
        self.queries.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.queries.answers(wait, deliver)
    }

    fn draw_time(&self) -> DrawTime {
        self.queries.draw_time()
    }

    fn device_times(&self, frame: u64) -> Option<DeviceTimes> {
        self.queries.device_times(frame)
    }

    fn end(&mut self) -> Result<(), Error> {
        self.queries.end()
    }
}

#[test]
fn policies_open_what_holds_the_eye_or_covers_their_share() {
    for gpu in gpus() {
        for (name, share) in [("hroc", 0.25), ("hroc", 0.02), ("hybrid", 0.1)] {
            let mut policy = policy::by_name(name).expect("a policy of that name");
            policy.set("share", &share.to_string()).expect("a dial of that name");
            let mut eye = Culler::new(policy);
            let mut watched = Watched::new(&gpu, share);
            let mut stage = Stage::new(worlds::random(4, 120), 4, SCREEN, true);
            let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
            let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
            let mut renderer = Renderer::new(&gpu);
            for frame in 0..24 {
                let view = stage.next(frame);
                scene.sync(&stage.world);
                renderer.prepare(&stage.world, &view, stage.detail);
                watched.queries.target(&targets(&depth_texture(&gpu, &view), false));
                let draw = |pass: &mut _, objects: &[ObjectRef]| renderer.draw(pass, &view, objects);
                eye.frame(&scene, &view, &mut watched, draw).expect("a frame");
            }
            let Watched { groups, near, large, .. } = watched;
            println!("{:?}, {name}, {share}: {groups} groups", gpu.backend);
            assert!(groups > 100, "{:?}, {name}, {share}: {groups} groups", gpu.backend);
            assert_eq!((near, large), (0, 0), "{:?}, {name}, {share}: of {groups} groups", gpu.backend);
        }
    }
}

/// A thousand kilometres from the origin f32 hardly tells where things are: what a policy finds before the eye,
/// in f64, the device may take to hold it.
#[test]
fn what_the_device_cannot_place_is_opened() {
    const HERE: Vec3 = Vec3::new(1e6, 0.0, -1e6);
    for gpu in gpus() {
        let tree = TreeConfig { bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::stable() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        for (far, step) in [(60.0, 4.0), (1000.0, 30.0)] {
            for i in 0..512 {
                let cell = Vec3::new((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32) - 3.5;
                let place = HERE + cell * step - Vec3::Z * far;
                scene.insert(Aabb::from_center(place, Vec3::splat(step / 8.0)), Traits::default());
            }
        }
        scene.update();
        let view = View::look_at(HERE, HERE - Vec3::Z, 60.0, 0.1, SCREEN).expect("a view");
        let mut watched = Watched::new(&gpu, 0.25);
        watched.queries.target(&targets(&depth_texture(&gpu, &view), false));
        let mut eye = Culler::new(policy::by_name("hroc").expect("a policy of that name"));
        // Nothing is drawn into the depth, so nothing hides anything.
        let stats = eye.frame(&scene, &view, &mut watched, |_, _| {}).expect("a frame");
        let boxes = || scene.objects().filter_map(|object| object.bounds);
        let shown = boxes().filter(|bounds| Question::new(bounds, &view) != Question::Outside).count();
        assert!(shown > 500 && stats.drawn as usize >= shown, "{:?}: {stats:?} of {shown}", gpu.backend);
        let Watched { groups, near, large, .. } = watched;
        assert!(groups > 4, "{:?}: {groups} groups", gpu.backend);
        assert_eq!((near, large), (0, 0), "{:?}: of {groups} groups", gpu.backend);
    }
}
