//! The GPU culls by itself, and draws what it finds: nothing comes back that a frame would wait for.

use std::time::Instant;

use anyhow::{Context, bail, ensure};
use hecs::World;
use tercet::FrameStats;
use tercet::draw::{BySlot, Detail, Renderer, Shading};
use tercet::geom::{View, Viewport};
use tercet::query::SweepTest;
use tercet::query::gpu::{IndirectConfig, IndirectCuller, wgpu};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{ObjectId, Scene};
use tercet::tree::TreeConfig;

use super::lists::Lists;
use super::{Drawn, Gpu, Picture};
use crate::run::Eye;

/// What `--policy` may be, and how the device tests then.
const TESTS: [(&str, SweepTest); 3] =
    [("hi-z", SweepTest::HiZ), ("roc", SweepTest::Raster), ("hroc", SweepTest::Rays)];

/// The one that `auto` takes. On Mesa's driver for the CPU it was far ahead in a city of many small things, and
/// elsewhere behind `roc`, which culls more, by no more than the noise.
pub const FASTEST: &str = "hi-z";

/// How the device tests for a policy.
///
/// # Errors
/// For a policy that it has no test for, naming those that it has.
pub fn test_of(policy: &str) -> anyhow::Result<SweepTest> {
    match TESTS.iter().find(|(name, _)| *name == policy) {
        Some((_, test)) => Ok(*test),
        None => bail!("--backend gpu-driven takes --policy hi-z, roc or hroc: {policy} asks from the host"),
    }
}

/// The policy that tests in this way.
pub fn name_of(test: SweepTest) -> &'static str {
    TESTS.iter().find(|(_, known)| *known == test).map_or("roc", |(name, _)| name)
}

/// A tree for such a test. The groups of rays are its nodes, and nobody asks about these, so that it would
/// stay coarse.
pub fn tree(test: SweepTest, tree: TreeConfig) -> TreeConfig {
    match test {
        SweepTest::Rays => TreeConfig { unasked_leaf: tree.bulk_leaf, ..tree },
        _ => tree,
    }
}

/// A device that culls, with a renderer and what both draw into.
pub struct GpuDrivenStage {
    gpu: Gpu,
    culler: IndirectCuller,
    renderer: Renderer,
    by_slot: BySlot,
    picture: Picture,
    /// With which the eye lives through what the device did.
    echo: SoftwareQueries,
}

impl GpuDrivenStage {
    /// Tests in some way. Everything is drawn in full: no one on the host knows what is near.
    ///
    /// # Errors
    /// For another detail, or a device that cannot do it.
    pub fn new(gpu: Gpu, test: SweepTest, detail: Detail) -> anyhow::Result<Self> {
        ensure!(
            detail == Detail::FULL,
            "--backend gpu-driven draws every mesh with all its triangles: add --full-detail, and no max_error_px"
        );
        let config = IndirectConfig { test, ..Default::default() };
        Ok(Self {
            culler: IndirectCuller::new(&gpu.device, &gpu.queue, config)?,
            renderer: Renderer::new(&gpu.device, &gpu.queue, Some(Picture::COLOR))?,
            by_slot: BySlot::new(&gpu.device, &gpu.queue),
            picture: Picture::new(&gpu, Viewport::new(1, 1))?,
            echo: SoftwareQueries::new(),
            gpu,
        })
    }

    /// What it runs on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Says of new objects which mesh they are instances of, before the scene is brought in step.
    pub fn dress(&mut self, world: &mut World) {
        self.by_slot.dress(world);
    }

    /// See [`Stage::frame`](super::Stage::frame). As for the wgpu backend, the GPU has finished when the
    /// clock stops. What it drew is read back after that.
    pub fn frame(
        &mut self,
        eye: &mut Eye,
        scene: &Scene,
        world: &World,
        view: &View,
    ) -> anyhow::Result<Drawn> {
        let Self { gpu, culler, renderer, by_slot, picture, echo } = self;
        if !picture.fits(view.viewport()) {
            *picture = Picture::new(gpu, view.viewport())?;
        }
        let start = Instant::now();
        by_slot.follow(scene, world)?;
        renderer.begin(view, Detail::FULL, Shading::Lit);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut lists = Lists::default();
        culler.frame(scene, view, &picture.targets(), by_slot.meshes(), &mut encoder, |pass, batches| {
            renderer.draw_batches(pass, by_slot, batches);
            lists.note(batches);
        })?;
        gpu.queue.submit([encoder.finish()]);
        let draw = start.elapsed();
        gpu.wait()?;
        let wait = start.elapsed() - draw;

        let lists = lists.read(gpu)?;
        let triangles = lists.iter().map(|(batch, slots)| {
            let of_mesh = by_slot.meshes()[batch.0 as usize].index_count / 3;
            u64::from(of_mesh) * slots.len() as u64
        });
        let mut ids: Vec<Option<ObjectId>> = vec![None; scene.slot_bound()];
        scene.objects().for_each(|object| ids[object.object.id.slot()] = Some(object.object.id));
        let id_of = |&slot: &u32| ids.get(slot as usize).copied().flatten();
        let listed: Option<Vec<ObjectId>> = lists.iter().flat_map(|(_, slots)| slots).map(id_of).collect();
        let listed = listed.context("the device drew an object that there is not")?;
        eye.policy_mut().give_recorded(&listed);
        let FrameStats { drawn, .. } = eye.frame(scene, view, echo, |_, _| ())?;
        // The eye draws by itself what is never culled, and nothing twice: so must the device.
        ensure!(
            drawn as usize == listed.len(),
            "the device drew {} objects, and {drawn} should have been drawn",
            listed.len()
        );
        Ok(Drawn {
            stats: FrameStats { drawn, draw, wait, ..FrameStats::default() },
            triangles: triangles.sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn policies_name_the_tests() {
        for (name, test) in TESTS {
            assert_eq!((test_of(name).ok(), name_of(test)), (Some(test), name));
        }
        assert!(test_of(FASTEST).is_ok());
        let error = test_of("dual-query").expect_err("it asks").to_string();
        assert!(TESTS.iter().all(|(name, _)| error.contains(name)), "{error}");
    }
}
