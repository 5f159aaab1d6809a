//! The ways of counting, behind one door.

use wgpu::{
    BindGroup, Buffer, Device, Features, ShaderModule, ShaderModuleDescriptor, ShaderSource, TextureView,
};

use super::batch::Batch;
use super::bind::{self, Bound, DepthAs, Layouts};
use super::clock::Tape;
use super::count_fragments::CountFragments;
use super::count_workgroups::CountWorkgroups;
use super::gather_blocks::{self, GatherBlocks};
use super::guard::{failed, guarded};
use super::shaders::Shaders;
use crate::Error;
use crate::geom::Viewport;

/// How samples are counted. All give answers of the same quality; the module says which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Counting {
    /// In a fragment shader, with an atomic addition a fragment. Works wherever fragment shaders
    /// can write to buffers.
    Fragments,
    /// In a compute shader, a workgroup for each 64 × 64 pixels of a box, which adds up by itself.
    Workgroups,
    /// As [`Counting::Workgroups`], but the lanes of a subgroup add up among themselves before they
    /// touch the workgroup's memory, which they do once a subgroup instead of once a lane. The
    /// device needs [`Features::SUBGROUP`]. It is as fast as without on lavapipe, a CPU, and has
    /// been measured nowhere else; it is preferred because it asks for less.
    Subgroups,
    /// As [`Counting::Workgroups`], but the least and greatest depth of each 8 × 8 pixels is
    /// gathered first, so that most of a large box is decided without looking at its samples.
    Blocks,
}

impl Counting {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Fragments, Self::Workgroups, Self::Subgroups, Self::Blocks];

    /// Whether a device can count in this way.
    pub fn is_supported(self, device: &Device) -> bool {
        let limits = device.limits();
        let has = |buffers| limits.max_storage_buffers_per_shader_stage >= buffers;
        let computes = limits.max_compute_invocations_per_workgroup >= CountWorkgroups::INVOCATIONS
            && limits.max_compute_workgroups_per_dimension > 0;
        match self {
            Self::Fragments => has(2),
            Self::Workgroups => has(3) && computes,
            Self::Subgroups => has(3) && computes && device.features().contains(Features::SUBGROUP),
            Self::Blocks => has(4) && computes,
        }
    }
}

/// The ways of counting in use: one for questions about few pixels, and one for many.
#[derive(Debug)]
pub(super) struct Counters {
    few: Counter,
    many: Option<Counter>,
}

impl Counters {
    /// With one way of counting, or with the best that the device supports.
    pub(super) fn new(
        device: &Device,
        counting: Option<Counting>,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<Self, Error> {
        let new = |counting| Counter::new(device, counting, shaders, multisampled);
        if let Some(counting) = counting {
            return Ok(Self { few: new(counting)?, many: None });
        }
        let few = [Counting::Subgroups, Counting::Workgroups, Counting::Fragments]
            .into_iter()
            .find(|counting| counting.is_supported(device))
            .ok_or_else(|| failed("it has no storage buffers in shaders: use the software backend"))?;
        let many = Counting::Blocks.is_supported(device).then_some(Counting::Blocks);
        Ok(Self { few: new(few)?, many: many.map(new).transpose()? })
    }

    /// Binds a frame's view and depth, for both.
    pub(super) fn bind_frame(&self, device: &Device, uniforms: &Buffer, depth: &TextureView) -> BindGroup {
        bind::frame(device, &self.few.layouts.frame, uniforms, Some(depth))
    }

    /// To be called when the depth may have changed.
    pub(super) fn depth_changed(&mut self) {
        for counter in [Some(&mut self.few), self.many.as_mut()].into_iter().flatten() {
            if let Pass::Blocks { stale, .. } = &mut counter.pass {
                *stale = true;
            }
        }
    }

    /// Records the counting of a batch, from zeroed counts to the copy that can be read.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        batch: &Batch,
        viewport: Viewport,
    ) {
        batch.clear_counts(tape.encoder);
        if !batch.questions.proxies.is_empty() {
            // Gathering looks at each pixel of the viewport, at less than half the cost of counting.
            let pixels = u64::from(viewport.width) * u64::from(viewport.height);
            let counter = match &mut self.many {
                Some(many) if 2 * batch.questions.pixels >= pixels => many,
                _ => &mut self.few,
            };
            counter.record(tape, frame, batch, viewport);
        }
        batch.copy_counts(tape.encoder);
    }
}

/// Pipelines of one way of counting, for targets with one sample a pixel or with several.
#[derive(Debug)]
struct Counter {
    layouts: Layouts,
    pass: Pass,
}

#[derive(Debug)]
enum Pass {
    Fragments(CountFragments),
    Workgroups(CountWorkgroups),
    Blocks {
        gather: GatherBlocks,
        count: CountWorkgroups,
        /// Whether the depth may have changed since blocks were gathered.
        stale: bool,
    },
}

impl Counter {
    fn new(
        device: &Device,
        counting: Counting,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<Self, Error> {
        if !counting.is_supported(device) {
            return Err(failed(format!("its limits or features do not allow for counting in {counting:?}")));
        }
        guarded(device, || {
            let module = compiled(device, shaders.source(counting, multisampled));
            let depth = DepthAs::texture(multisampled);
            let layouts = |stages, buffers: &[_]| Layouts::new(device, stages, buffers, depth);
            match counting {
                Counting::Fragments => {
                    let layouts = layouts(CountFragments::STAGES, CountFragments::BUFFERS);
                    let pass = Pass::Fragments(CountFragments::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
                Counting::Workgroups | Counting::Subgroups => {
                    let layouts = layouts(CountWorkgroups::STAGES, CountWorkgroups::BUFFERS);
                    let pass = Pass::Workgroups(CountWorkgroups::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
                Counting::Blocks => {
                    let buffers = [CountWorkgroups::BUFFERS, &[(gather_blocks::BINDING, false)]].concat();
                    let layouts = layouts(CountWorkgroups::STAGES, &buffers);
                    let gather = compiled(device, shaders.gather_blocks_source(multisampled));
                    let gather = GatherBlocks::new(device, &gather, depth);
                    let count = CountWorkgroups::new(device, &layouts, &module);
                    Self { layouts, pass: Pass::Blocks { gather, count, stale: true } }
                }
            }
        })
    }

    fn record(&mut self, tape: &mut Tape<'_>, frame: &BindGroup, batch: &Batch, viewport: Viewport) {
        let device = tape.device;
        let bind = |buffers: &[_]| bind::storage(device, &self.layouts.batch, buffers);
        match &mut self.pass {
            Pass::Fragments(pass) => {
                let bindings = bind(&batch.bindings(false));
                pass.record(tape, &Bound { frame, batch: &bindings }, batch, viewport);
            }
            Pass::Workgroups(pass) => {
                let bindings = bind(&batch.bindings(true));
                pass.record(tape, &Bound { frame, batch: &bindings }, batch);
            }
            Pass::Blocks { gather, count, stale } => {
                gather.resize(device, viewport);
                if std::mem::take(stale) {
                    gather.record(tape, frame);
                }
                let mut buffers = batch.bindings(true);
                buffers.extend(gather.binding().map(|blocks| (gather_blocks::BINDING, blocks)));
                let bindings = bind(&buffers);
                count.record(tape, &Bound { frame, batch: &bindings }, batch);
            }
        }
    }
}

pub(super) fn compiled(device: &Device, source: &str) -> ShaderModule {
    let source = ShaderSource::Wgsl(source.into());
    device.create_shader_module(ShaderModuleDescriptor { label: Some("tercet count"), source })
}
