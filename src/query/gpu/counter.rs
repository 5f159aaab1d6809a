//! The ways of counting, behind one door.

use wgpu::{BindGroup, Buffer, CommandEncoder, Device, ShaderModuleDescriptor, ShaderSource, TextureView};

use super::batch::Batch;
use super::bind::{self, Bound, Layouts};
use super::count_fragments::CountFragments;
use super::count_workgroups::CountWorkgroups;
use super::guard::{failed, guarded};
use super::shaders::Shaders;
use crate::Error;
use crate::geom::Viewport;

/// How samples are counted. All give the same counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Counting {
    /// In a fragment shader, with an atomic addition a fragment. Works wherever fragment shaders
    /// can write to buffers.
    Fragments,
    /// In a compute shader, a workgroup for each 64 × 64 pixels of a box, which adds up by itself.
    Workgroups,
}

impl Counting {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Fragments, Self::Workgroups];

    /// Whether a device can count in this way.
    pub fn is_supported(self, device: &Device) -> bool {
        let limits = device.limits();
        match self {
            Self::Fragments => limits.max_storage_buffers_per_shader_stage >= 2,
            Self::Workgroups => {
                limits.max_storage_buffers_per_shader_stage >= 3
                    && limits.max_compute_invocations_per_workgroup >= CountWorkgroups::INVOCATIONS
                    && limits.max_compute_workgroups_per_dimension > 0
            }
        }
    }

    /// The fastest that a device supports, if any.
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
            let source = ShaderSource::Wgsl(shaders.source(counting, multisampled).into());
            let module =
                device.create_shader_module(ShaderModuleDescriptor { label: Some("tercet count"), source });
            match counting {
                Counting::Fragments => {
                    let layouts = Layouts::new(device, CountFragments::STAGES, &[false, true], multisampled);
                    let pass = Pass::Fragments(CountFragments::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
                Counting::Workgroups => {
                    let layouts =
                        Layouts::new(device, CountWorkgroups::STAGES, &[false, true, false], multisampled);
                    let pass = Pass::Workgroups(CountWorkgroups::new(device, &layouts, &module));
                    Self { layouts, pass }
                }
            }
        })
    }

    /// Binds a frame's view and depth.
    pub(super) fn bind_frame(&self, device: &Device, uniforms: &Buffer, depth: &TextureView) -> BindGroup {
        bind::frame(device, &self.layouts.frame, uniforms, depth)
    }

    /// Records the counting of a batch, from zeroed counts to the copy that can be read.
    pub(super) fn record(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        frame: &BindGroup,
        batch: &Batch,
        viewport: Viewport,
    ) {
        batch.clear_counts(encoder);
        if !batch.questions.proxies.is_empty() {
            let layout = &self.layouts.batch;
            match &mut self.pass {
                Pass::Fragments(pass) => {
                    let bindings = CountFragments::bindings(layout, device, batch);
                    pass.record(device, encoder, &Bound { frame, batch: &bindings }, batch, viewport);
                }
                Pass::Workgroups(pass) => {
                    let bindings = CountWorkgroups::bindings(layout, device, batch);
                    pass.record(encoder, &Bound { frame, batch: &bindings }, batch);
                }
            }
        }
        batch.copy_counts(encoder);
    }
}
