//! The ways of counting, behind one door.

use wgpu::{
    BindGroup, Buffer, CommandEncoder, Device, ShaderModule, ShaderModuleDescriptor, ShaderSource,
    TextureView,
};

use super::batch::Batch;
use super::bind::{self, Bound, Layouts};
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
    /// As [`Counting::Workgroups`], but the least and greatest depth of each 8 × 8 pixels is
    /// gathered first, so that most of a large box is decided without looking at its samples. It
    /// pays when a wave asks about more samples than the viewport has.
    Blocks,
}

impl Counting {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Fragments, Self::Workgroups, Self::Blocks];

    /// Whether a device can count in this way.
    pub fn is_supported(self, device: &Device) -> bool {
        let limits = device.limits();
        let has = |buffers| limits.max_storage_buffers_per_shader_stage >= buffers;
        let computes = limits.max_compute_invocations_per_workgroup >= CountWorkgroups::INVOCATIONS
            && limits.max_compute_workgroups_per_dimension > 0;
        match self {
            Self::Fragments => has(2),
            Self::Workgroups => has(3) && computes,
            Self::Blocks => has(4) && computes,
        }
    }

    /// The way that is best for policies that ask in waves, of those that a device supports.
    pub fn best(device: &Device) -> Option<Self> {
        [Self::Workgroups, Self::Fragments].into_iter().find(|counting| counting.is_supported(device))
    }
}

/// Pipelines of one way of counting, for targets with one sample a pixel or with several.
#[derive(Debug)]
pub(super) struct Counter {
    layouts: Layouts,
    pass: Pass,
}

#[derive(Debug)]
enum Pass {
    Fragments(CountFragments),
    Workgroups(CountWorkgroups),
    Blocks(GatherBlocks, CountWorkgroups),
}

impl Counter {
    pub(super) fn new(
        device: &Device,
        counting: Counting,
        shaders: &Shaders,
        multisampled: bool,
    ) -> Result<Self, Error> {
        if !counting.is_supported(device) {
            return Err(failed(format!("its limits do not allow for counting in {counting:?}")));
        }
        guarded(device, || {
            let module = compiled(device, shaders.source(counting, multisampled));
            let layouts = |stages, buffers: &[_]| Layouts::new(device, stages, buffers, multisampled);
            match counting {
                Counting::Fragments => {
                    let layouts = layouts(CountFragments::STAGES, CountFragments::BUFFERS);
                    let pass = Pass::Fragments(CountFragments::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
                Counting::Workgroups => {
                    let layouts = layouts(CountWorkgroups::STAGES, CountWorkgroups::BUFFERS);
                    let pass = Pass::Workgroups(CountWorkgroups::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
                Counting::Blocks => {
                    let buffers = [CountWorkgroups::BUFFERS, &[(gather_blocks::BINDING, false)]].concat();
                    let layouts = layouts(CountWorkgroups::STAGES, &buffers);
                    let gather = compiled(device, shaders.gather_blocks_source(multisampled));
                    let gather = GatherBlocks::new(device, &gather, multisampled);
                    let pass = Pass::Blocks(gather, CountWorkgroups::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
            }
        })
    }

    /// Binds a frame's view and depth.
    pub(super) fn bind_frame(&self, device: &Device, uniforms: &Buffer, depth: &TextureView) -> BindGroup {
        bind::frame(device, &self.layouts.frame, uniforms, depth)
    }

    /// Records the counting of a batch, from zeroed counts to the copy that can be read. `drawn`
    /// says whether the depth may have changed since the last time in this frame.
    pub(super) fn record(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        frame: &BindGroup,
        batch: &Batch,
        (viewport, drawn): (Viewport, bool),
    ) {
        batch.clear_counts(encoder);
        if !batch.questions.proxies.is_empty() {
            let bind = |buffers: &[_]| bind::storage(device, &self.layouts.batch, buffers);
            match &mut self.pass {
                Pass::Fragments(pass) => {
                    let bindings = bind(&batch.bindings(false));
                    pass.record(device, encoder, &Bound { frame, batch: &bindings }, batch, viewport);
                }
                Pass::Workgroups(pass) => {
                    let bindings = bind(&batch.bindings(true));
                    pass.record(encoder, &Bound { frame, batch: &bindings }, batch);
                }
                Pass::Blocks(gather, pass) => {
                    gather.resize(device, viewport);
                    if drawn {
                        gather.record(encoder, frame);
                    }
                    let mut buffers = batch.bindings(true);
                    buffers.extend(gather.binding().map(|blocks| (gather_blocks::BINDING, blocks)));
                    let bindings = bind(&buffers);
                    pass.record(encoder, &Bound { frame, batch: &bindings }, batch);
                }
            }
        }
        batch.copy_counts(encoder);
    }
}

fn compiled(device: &Device, source: &str) -> ShaderModule {
    let source = ShaderSource::Wgsl(source.into());
    device.create_shader_module(ShaderModuleDescriptor { label: Some("tercet count"), source })
}
