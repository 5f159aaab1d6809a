//! Sweeps on the device: which of many objects may own a sample of what would be drawn now?
//!
//! ```text
//!   boxes, by slot ──project──▶ a proxy and a verdict each ──pyramid──┬─ hi_z ────────────────▶ verdicts
//!                                                                     └─ prune ──▶ raster ───▶ verdicts
//!
//!   the tree's nodes ──enclose, prune──▶ a rectangle each ──enlist──┬─ groups ──▶ rays ──────▶ their objects'
//!                                                                   └─ loose ───▶ raster ────▶ verdicts
//! ```
//!
//! `SweepTest::Rays` casts rays into groups, and draws what is loose as `Raster` does; on a device that
//! cannot bind the whole tree, and where the groups have few objects
//! ([`GpuConfig::rays_from`](super::GpuConfig::rays_from)), it is answered as `Raster` is, which finds the same. `Owners` reads the app's
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
//! | `prune` | the same before the other two, part by part: what it shows to be hidden is not looked at closely |
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
mod prune;
pub(super) mod pyramid;
pub(super) mod raster;
pub(super) mod rays;
pub(super) mod stage;
mod swept;
mod targets;
pub(super) mod view;

use wgpu::{BindGroup, Buffer, BufferBinding, Device, TextureView};

pub use inspect::Level;

use super::bind::{self, DepthAs, Layouts};
use super::clock::Tape;
use super::counter::compiled;
use super::guard::{failed, guarded};
use super::rectangles::{Instances, List, Of};
use super::shaders::Shaders;
use crate::Error;
use crate::geom::Viewport;
use crate::query::SweepTest;
use asked::Asked;
use hi_z::HiZ;
use placed::PlacedTree;
pub(super) use project::Project;
use prune::Prune;
use pyramid::Pyramid;
use raster::Raster;
use rays::{Lists, Rays};
use stage::STAGES;
pub(super) use stage::{LANES, compute, grid};

/// The passes, for targets with one sample a pixel or with several.
#[derive(Debug)]
pub(super) struct Passes {
    /// What all but `project` bind of the frame.
    frame: Layouts,
    pub(super) project: Project,
    pub(super) raster: Raster,
    /// The same of what the device lists.
    listed: Raster,
    /// Made when first needed.
    rays: Option<Rays>,
    pub(super) pyramid: Pyramid,
    pub(super) hi_z: HiZ,
    prune: Prune,
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
            let raster = module(&shaders.sweep_raster);
            Self {
                frame: Layouts::new(device, STAGES, &[], depth),
                project: Project::new(device, &compiled(device, &shaders.project)),
                raster: Raster::new(device, &raster, depth, Of::Proxies),
                listed: Raster::new(device, &raster, depth, Of::List),
                rays: None,
                pyramid: Pyramid::new(device, &module(&shaders.build_pyramid), depth),
                hi_z: HiZ::new(device, &module(&shaders.sweep_hi_z), depth),
                prune: Prune::new(device, &module(&shaders.prune), depth),
            }
        })
    }

    /// Sees to it that there is the pass that casts rays.
    pub(super) fn open_rays(
        &mut self,
        device: &Device,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<(), Error> {
        if self.rays.is_none() {
            self.rays = Some(guarded(device, || {
                let module = compiled(device, shaders.sweep_rays.source(multisampled));
                Rays::new(device, &module, DepthAs::texture(multisampled))
            })?);
        }
        Ok(())
    }

    /// Records the casting of rays into listed groups, if there is the pass, and the test of objects that are
    /// listed beside them.
    pub(super) fn look_below(
        &mut self,
        tape: &mut Tape<'_>,
        bound: &Bound,
        tree: &PlacedTree,
        lists: &Lists,
        viewport: Viewport,
    ) {
        if let Some(rays) = &mut self.rays {
            rays.record(tape, &bound.frame, tree, &lists.groups, viewport);
        }
        let loose = Instances::Listed(&lists.loose);
        self.listed.record(tape, &bound.frame, &tree.objects, loose, viewport);
    }

    /// Binds a view's and a frame's uniforms, and its depth.
    pub(super) fn bind(&self, device: &Device, view: &Buffer, frame: &Buffer, depth: &TextureView) -> Bound {
        Bound {
            view: self.project.bind(device, view),
            frame: bind::frame(device, &self.frame.frame, frame, Some(depth)),
        }
    }

    /// Records the building of the pyramid of what has been drawn so far; false where the device cannot bind
    /// one so large.
    pub(super) fn build_pyramid(&mut self, tape: &mut Tape<'_>, bound: &Bound, viewport: Viewport) -> bool {
        let fits = self.pyramid.resize(tape.device, viewport);
        if fits {
            self.pyramid.record(tape, &bound.frame);
        }
        fits
    }

    /// Records the leaving out of a tree's nodes that the pyramid, which has been built, shows to be hidden.
    pub(super) fn prune_nodes(&self, tape: &mut Tape<'_>, bound: &Bound, tree: &PlacedTree) {
        self.prune.nodes(tape, &bound.frame, tree, &self.pyramid);
    }

    /// The same of its objects, and of those that a few samples show to be seen.
    pub(super) fn prune_objects(
        &self,
        tape: &mut Tape<'_>,
        bound: &Bound,
        tree: &PlacedTree,
        wanted: (BufferBinding<'_>, u32),
    ) {
        self.prune.placed(tape, &bound.frame, tree, &self.pyramid, wanted);
    }

    /// Records the test of proxies; with the pyramid, if it has been built: `open` is then the list of those that
    /// must be looked at closely.
    pub(super) fn record_test(
        &mut self,
        tape: &mut Tape<'_>,
        bound: &Bound,
        (asked, open): (&Asked, &List),
        viewport: Viewport,
        (test, has_pyramid): (SweepTest, bool),
    ) {
        if has_pyramid && test == SweepTest::HiZ {
            return self.hi_z.record(tape, &bound.frame, asked, &self.pyramid);
        }
        if has_pyramid {
            self.prune.proxies(tape, &bound.frame, (asked, open), &self.pyramid);
            return self.listed.record(tape, &bound.frame, asked, Instances::Listed(open), viewport);
        }
        let all = Instances::Proxies(asked.instances(), asked.count());
        self.raster.record(tape, &bound.frame, asked, all, viewport);
    }
}
