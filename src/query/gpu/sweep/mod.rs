//! Sweeps on the device: which of many objects may own a sample of what would be drawn now?
//!
//! ```text
//!   boxes, by slot ──project──▶ a proxy and a verdict each ──raster, or pyramid and hi_z──▶ verdicts
//!
//!   the tree's nodes ──enclose──▶ a rectangle each ──enlist──▶ groups ──rays──▶ their objects' verdicts
//! ```
//!
//! `SweepTest::Rays` casts rays into groups, and draws what is loose as `Raster` does; on a device that
//! cannot bind the whole tree it is answered as `Raster` is, which finds the same. `Owners` reads the app's
//! item buffer ([`GpuQueries::target_ids`](super::GpuQueries::target_ids)); without one it is not known,
//! which draws.
//!
//! | file | |
//! |---|---|
//! | `array`, `stage` | arrays on the device that grow, and what all stages have in common |
//! | `boxes`, `mirror` | the objects' boxes on the device, uploaded by what has changed |
//! | `view`, `project` | a view's uniforms, and proxies from boxes |
//! | `asked` | proxies and verdicts |
//! | `raster` | the test of ROC: draw the proxies |
//! | `flat`, `enclose`, `placed` | the tree on the device, and where its nodes and objects lie on the screen |
//! | `rays` | the test of HROC: draw groups, and send rays down the tree |
//! | `grove` | what sweeps by rays keep for a frame |
//! | `pyramid`, `hi_z` | the test of Rákos 2010: compare with the farthest depth around |
//! | `owners` | who owns a sample, by an item buffer |
//! | `answer`, `swept` | sweeps of a policy: one read-back each |
//! | `looks`, `targets` | those that look at boxes, and what they look at |
//! | `inspect` | what the device has made, to look at |

pub(super) mod answer;
pub(super) mod array;
pub(super) mod asked;
pub(super) mod boxes;
pub(super) mod enclose;
pub(super) mod flat;
mod grove;
mod hi_z;
mod inspect;
mod looks;
pub(super) mod mirror;
pub(super) mod owners;
pub(super) mod placed;
pub(super) mod project;
pub(super) mod pyramid;
pub(super) mod raster;
pub(super) mod rays;
pub(super) mod stage;
mod swept;
mod targets;
pub(super) mod view;

use wgpu::{BindGroup, Buffer, Device, TextureView};

pub use inspect::Level;

use super::bind::{self, DepthAs, Layouts};
use super::clock::Tape;
use super::counter::compiled;
use super::guard::{failed, guarded};
use super::rectangles::{Draws, Of};
use super::shaders::Shaders;
use crate::Error;
use crate::geom::Viewport;
use asked::Asked;
use hi_z::HiZ;
pub(super) use project::Project;
use pyramid::Pyramid;
use raster::Raster;
use rays::Rays;
use stage::STAGES;
pub(super) use stage::{LANES, compute, grid};

/// The passes, for targets with one sample a pixel or with several.
#[derive(Debug)]
pub(super) struct Passes {
    /// What all but `project` bind of the frame.
    frame: Layouts,
    pub(super) project: Project,
    pub(super) raster: Raster,
    /// Made when first needed.
    rays: Option<Rays>,
    pub(super) pyramid: Pyramid,
    pub(super) hi_z: HiZ,
}

/// What the passes bind of a frame: to make proxies, and to look at depth.
#[derive(Debug)]
pub(super) struct Bound {
    pub(super) view: BindGroup,
    pub(super) frame: BindGroup,
}

impl Passes {
    pub(super) fn new(device: &Device, shaders: &Shaders, multisampled: bool) -> Result<Self, Error> {
        let limits = device.limits();
        if limits.max_storage_buffers_per_shader_stage < 4 || limits.max_compute_workgroups_per_dimension == 0
        {
            return Err(failed("it has no compute shaders with four storage buffers: sweeps need them"));
        }
        guarded(device, || {
            let depth = DepthAs::texture(multisampled);
            let module = |shader: &super::Shader| compiled(device, shader.source(multisampled));
            Self {
                frame: Layouts::new(device, STAGES, &[], depth),
                project: Project::new(device, &compiled(device, &shaders.project)),
                raster: Raster::new(device, &module(&shaders.sweep_raster), depth, Of::Proxies),
                rays: None,
                pyramid: Pyramid::new(device, &module(&shaders.build_pyramid), depth),
                hi_z: HiZ::new(device, &module(&shaders.sweep_hi_z), depth),
            }
        })
    }

    /// The pass that casts rays.
    pub(super) fn rays(
        &mut self,
        device: &Device,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<&mut Rays, Error> {
        match &mut self.rays {
            Some(rays) => Ok(rays),
            none => Ok(none.insert(guarded(device, || {
                let module = compiled(device, shaders.sweep_rays.source(multisampled));
                Rays::new(device, &module, DepthAs::texture(multisampled))
            })?)),
        }
    }

    /// Binds a view's and a frame's uniforms, and its depth.
    pub(super) fn bind(&self, device: &Device, view: &Buffer, frame: &Buffer, depth: &TextureView) -> Bound {
        Bound {
            view: self.project.bind(device, view),
            frame: bind::frame(device, &self.frame.frame, frame, Some(depth)),
        }
    }

    /// Records the test of proxies, by the pyramid if that is asked for and can be had.
    pub(super) fn record_test(
        &mut self,
        tape: &mut Tape<'_>,
        bound: &Bound,
        asked: &Asked,
        viewport: Viewport,
        by_pyramid: bool,
    ) {
        if by_pyramid && self.pyramid.resize(tape.device, viewport) {
            self.pyramid.record(tape, &bound.frame);
            self.hi_z.record(tape, &bound.frame, asked, &self.pyramid);
        } else {
            let instances = (asked.instances(), Draws::Count(asked.count()));
            self.raster.record(tape, &bound.frame, asked, instances, viewport);
        }
    }
}
