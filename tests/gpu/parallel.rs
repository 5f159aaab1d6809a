//! Views that are culled at once, on one device and over one scene.

use std::thread;

use tercet::Culler;
use tercet::geom::{View, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::gpu::{GpuConfig, GpuQueries};
use tercet::scene::{ObjectRef, Scene, SceneConfig};
use tercet::worlds;

use crate::renderer::Renderer;
use crate::stage::Stage;
use crate::support::{Gpu, depth_texture, gpus, targets};

const SCREEN: Viewport = Viewport::new(96, 54);
const FRAMES: u32 = 12;

/// A view, with all that belongs to it.
struct Eye<'g> {
    gpu: &'g Gpu,
    culler: Culler<Box<dyn Policy>>,
    queries: GpuQueries,
    renderer: Renderer<'g>,
}

impl<'g> Eye<'g> {
    /// With dials that depend on no time, so that the same frames get the same answers.
    fn new(gpu: &'g Gpu, policy: &str) -> Self {
        let mut policy = policy::by_name(policy).expect("a policy of that name");
        policy.set("n_skip", "0").expect("a dial of that name");
        let queries = GpuQueries::with_config(&gpu.device, &gpu.queue, GpuConfig::default());
        let queries = queries.expect("a backend");
        Self { gpu, culler: Culler::new(policy), queries, renderer: Renderer::new(gpu) }
    }

    /// What is drawn, in order.
    fn draw(&mut self, scene: &Scene, stage: &Stage, view: &View) -> Vec<ObjectRef> {
        self.renderer.prepare(&stage.world, view, stage.detail);
        self.queries.target(&targets(&depth_texture(self.gpu, view), false));
        let draw = |pass: &mut _, objects: &[_]| self.renderer.draw(pass, view, objects);
        self.culler.frame(scene, view, &mut self.queries, draw).expect("a frame");
        self.culler.visible().to_vec()
    }
}

#[test]
fn views_culled_at_once_see_what_they_see_in_turn() {
    for gpu in gpus() {
        for policy in ["dual-query", "statistical"] {
            let model = || worlds::random(3, 400);
            let mut stage = Stage::new(model(), 3, SCREEN, true);
            // Only for where it looks from.
            let mut other = Stage::new(model(), 4, SCREEN, false);
            let mut scene = Scene::new(SceneConfig::default());
            let [mut in_turn, mut at_once] = [(); 2].map(|()| [(); 2].map(|()| Eye::new(&gpu, policy)));
            let mut culled = 0;
            for frame in 0..FRAMES {
                let views = [stage.next(frame), other.next(frame)];
                scene.sync(&stage.world);
                let (scene_now, stage_now) = (&scene, &stage);
                let eyes = in_turn.iter_mut().zip(&views);
                let expected: Vec<_> = eyes.map(|(eye, view)| eye.draw(scene_now, stage_now, view)).collect();
                let found: Vec<_> = thread::scope(|scope| {
                    let eyes = at_once.iter_mut().zip(&views);
                    let threads: Vec<_> = eyes
                        .map(|(eye, view)| scope.spawn(move || eye.draw(scene_now, stage_now, view)))
                        .collect();
                    threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
                });
                assert!(found == expected, "{:?}, {policy}, frame {frame}", gpu.backend);
                culled += expected.iter().filter(|drawn| drawn.len() < scene.len()).count();
                // The tree changes; the eyes that do not vote have to live with it.
                scene.adapt(in_turn.iter_mut().map(|eye| &mut eye.culler));
            }
            assert!(culled > FRAMES as usize, "{culled} of {} frames were culled", 2 * FRAMES);
        }
    }
}
