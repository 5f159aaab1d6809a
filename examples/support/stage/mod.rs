//! What answers and draws: a backend, and the renderer that goes with it.

mod gpu;
pub mod gpu_driven;
mod inspected;
mod listed;
mod lists;
mod software;
mod watched;
mod wgpu;

pub use gpu::Gpu;
pub use gpu_driven::GpuDrivenStage;
pub use inspected::{Inspected, Level};
pub use listed::Listed;
pub use software::SoftwareStage;
pub use watched::{Asked, Watched};
pub use wgpu::{Picture, WgpuStage};

use hecs::World;
use tercet::FrameStats;
use tercet::draw::Detail;
use tercet::geom::View;
use tercet::query::SweepTest;
use tercet::scene::Scene;

use super::flags::{Backend, Flags};
use super::run::Eye;

/// One of the backends, chosen at run time.
pub enum Stage {
    /// The CPU.
    Software(Box<SoftwareStage>),
    /// The GPU.
    Wgpu(Box<WgpuStage>),
    /// The GPU, which is not asked: it culls by itself. Its eye has a [`Listed`] for a policy.
    GpuDriven(Box<GpuDrivenStage>),
}

/// What was done for a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drawn {
    /// What [`Culler::frame`](tercet::Culler::frame) returned.
    pub stats: FrameStats,
    /// Triangles that the closure drew.
    pub triangles: u64,
}

impl Stage {
    /// The backend that `--backend` names, on an adapter of its own.
    ///
    /// # Errors
    /// When there is no adapter and one is asked for, or it cannot be used.
    pub fn new(flags: &Flags) -> anyhow::Result<Self> {
        Self::on_one_of(flags, Gpu::open)
    }

    /// The same, on the adapter that `open` gives, if it is called for.
    ///
    /// # Errors
    /// As [`Stage::new`].
    pub fn on_one_of(
        flags: &Flags,
        open: impl FnOnce() -> anyhow::Result<Option<Gpu>>,
    ) -> anyhow::Result<Self> {
        let detail = flags.detail()?;
        match flags.backend {
            Backend::Software => Ok(Self::software(detail)),
            Backend::Wgpu => Self::on(Gpu::found(open()?)?, detail),
            Backend::GpuDriven => {
                Self::gpu_driven(Gpu::found(open()?)?, gpu_driven::test_of(&flags.policy)?, detail)
            }
            Backend::Auto => Ok(Self::best(open(), detail)),
        }
    }

    /// The GPU if it is one and can be used, and else the CPU: nobody asked for a GPU.
    fn best(gpu: anyhow::Result<Option<Gpu>>, detail: Detail) -> Self {
        let stage = gpu.and_then(|gpu| match gpu.filter(Gpu::is_hardware) {
            Some(gpu) => Self::on(gpu, detail),
            None => Ok(Self::software(detail)),
        });
        stage.unwrap_or_else(|error| {
            println!("The GPU cannot be used ({error:#}): the CPU answers (as with --backend software).");
            Self::software(detail)
        })
    }

    /// The CPU, drawing as finely as `detail` says.
    pub fn software(detail: Detail) -> Self {
        Self::Software(Box::new(SoftwareStage::new(detail)))
    }

    /// A GPU, likewise.
    pub fn on(gpu: Gpu, detail: Detail) -> anyhow::Result<Self> {
        Ok(Self::Wgpu(Box::new(WgpuStage::new(gpu, detail)?)))
    }

    /// A GPU that culls by itself, with one of the tests.
    ///
    /// # Errors
    /// For any detail but the full one.
    pub fn gpu_driven(gpu: Gpu, test: SweepTest, detail: Detail) -> anyhow::Result<Self> {
        Ok(Self::GpuDriven(Box::new(GpuDrivenStage::new(gpu, test, detail)?)))
    }

    /// Says of new objects which mesh they are instances of, if the stage must know: before the scene is
    /// brought in step with the world.
    pub fn dress(&mut self, world: &mut World) {
        if let Self::GpuDriven(stage) = self {
            stage.dress(world);
        }
    }

    /// Draws as finely as this from now on, if it can choose.
    pub fn set_detail(&mut self, detail: Detail) {
        match self {
            Self::Software(stage) => stage.painter.detail = detail,
            Self::Wgpu(stage) => stage.detail = detail,
            Self::GpuDriven(_) => {}
        }
    }

    /// As `summary.json` calls it.
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Software(_) => "software",
            Self::Wgpu(_) => "wgpu",
            Self::GpuDriven(_) => "gpu-driven",
        }
    }

    /// The graphics adapter, where there is one.
    pub fn adapter(&self) -> Option<String> {
        match self {
            Self::Software(_) => None,
            Self::Wgpu(stage) => Some(stage.gpu().adapter()),
            Self::GpuDriven(stage) => Some(stage.gpu().adapter()),
        }
    }

    /// Whether a recorder listens to the backend, if it is asked anything.
    pub fn listen(&mut self, listen: bool) {
        match self {
            Self::Software(stage) => stage.log().listen(listen),
            Self::Wgpu(stage) => stage.log().listen(listen),
            Self::GpuDriven(_) => {}
        }
    }

    /// Whether the questions of the next frames are kept, to be shown.
    pub fn keep_questions(&mut self, keep: bool) {
        match self {
            Self::Software(stage) => stage.queries.keep(keep),
            Self::Wgpu(stage) => stage.queries.keep(keep),
            Self::GpuDriven(_) => {}
        }
    }

    /// The questions of the last frame, if they were kept.
    pub fn asked(&self) -> &[Asked] {
        match self {
            Self::Software(stage) => stage.queries.asked(),
            Self::Wgpu(stage) => stage.queries.asked(),
            Self::GpuDriven(_) => &[],
        }
    }

    /// Whether the pyramids of the next frames are kept, to be shown.
    pub fn keep_pyramid(&mut self, keep: bool) {
        match self {
            Self::Software(stage) => stage.queries.keep_pyramid(keep),
            Self::Wgpu(stage) => stage.queries.keep_pyramid(keep),
            Self::GpuDriven(_) => {}
        }
    }

    /// The levels of the last frame's pyramid of farthest depths, if it was kept.
    pub fn pyramid(&self) -> &[Level] {
        match self {
            Self::Software(stage) => stage.queries.pyramid(),
            Self::Wgpu(stage) => stage.queries.pyramid(),
            Self::GpuDriven(_) => &[],
        }
    }

    /// Draws a frame without what is hidden.
    pub fn frame(
        &mut self,
        eye: &mut Eye,
        scene: &Scene,
        world: &World,
        view: &View,
    ) -> anyhow::Result<Drawn> {
        match self {
            Self::Software(stage) => stage.frame(eye, scene, world, view),
            Self::Wgpu(stage) => stage.frame(eye, scene, world, view),
            Self::GpuDriven(stage) => stage.frame(eye, scene, world, view),
        }
    }
}
