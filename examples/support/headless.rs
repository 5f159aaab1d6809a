//! A run without a window: every frame of the flight, then figures, plots and pictures. This is the
//! engine as an app uses it, frame by frame.

use tercet::Culler;
use tercet::scene::{Scene, SceneConfig};

use super::flags::Flags;
use super::recording::Recording;
use super::run::{Frame, Run};
use super::scenario::Scenario;
use super::stage::Stage;

/// Runs a scenario and writes what was measured.
pub fn run(flags: &Flags, mut scenario: Scenario) -> anyhow::Result<()> {
    // The scene knows where things are, the culler what one camera sees, and the stage holds the
    // backend, which answers whether a box is hidden, with the renderer that goes with it.
    let config = SceneConfig { tree: flags.tree()?, ..Default::default() };
    let mut scene = Scene::new(config.clone());
    let mut eye = Culler::new(flags.policy()?);
    eye.tradeoff = flags.tradeoff()?;
    let mut stage = Stage::new(flags)?;
    stage.dress(&mut scenario.world);
    let mut recording = Recording::new(flags, &config, &mut scene, &eye, &mut stage, &scenario.name)?;
    // Before the first frame: the tree is built at once as finely as somebody who asks wants it.
    scene.adapt([&mut eye]);

    let mut run = Run::new(flags, &stage, &scenario.name, &scenario.world)?;
    while let Some(frame) = run.advance() {
        // The world goes its own way.
        scenario.step();
        let view = scenario.view(frame, flags)?;
        let world = &scenario.world;

        // 1. What has changed? Spawned, moved and despawned entities become edits of the tree.
        let synced = scene.sync(world);
        run.look(&scene, world, &view, &mut eye)?;

        // 2. Draw, without what is hidden: the app's own renderer is handed the objects to draw,
        //    in several batches, and the engine asks its questions between.
        recording.begin(&mut scene, &view, &eye);
        let drawn = stage.frame(&mut eye, &scene, world, &view)?;
        recording.end(&eye, &mut stage)?;
        run.audit(&scene, world, &view, &eye)?;

        // 3. What was seen tells the tree where to be finer, and where coarser.
        let adapted = scene.adapt([&mut eye]);

        run.record(world, Frame { scene: &scene, view: &view, eye: &eye, synced, drawn, adapted })?;
    }
    run.finish(&scene, &scenario.world, &eye)?;
    recording.finish()
}
