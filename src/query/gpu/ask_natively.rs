//! Native occlusion queries: the rectangles of a question's proxies, drawn between the beginning
//! and the end of a query. They promise no more than whether some sample passes, so they answer
//! [`Want::Any`](crate::query::Want::Any) alone.
//!
//! # Never less visible than a count
//!
//! A fragment's depth is the proxy's entry depth at the pixel's centre, for all samples, and the
//! depth test is inclusive: what the counting shaders compare by hand. Two things differ. A format
//! of 24 bits may be fixed point: what was stored as k units was read back within half a unit of
//! 2⁻²⁴, and the written depth is brought to whole units, in any direction. So nearness is raised by
//! two such units ([`slack`]), and lies beyond k however it is rounded. And a depth must lie in
//! [0, 1]: nearer ones are clamped, and what is stored is no nearer than that; those beyond the
//! cleared depth are left out, as nothing is stored there.
//!
//! A planar depth, which could be tested before the shader runs, would not do: the vertices of an
//! outline are snapped, which moves a tilted plane by far more than the bound in `pack.rs`. (A
//! rectangle at the depth of the nearest point would hold, but find visible much that is hidden.)
//!
//! Written depth is also what makes it dear: the test waits for the shader. On a software adapter
//! these queries take 1 to 4 times as long as common ones around the boxes' own triangles, and counts
//! a half or less (docs/measurements/queries.md). They are for devices where counting is slow.

use std::ops::Range;

use wgpu::{
    BindGroup, CompareFunction, DepthStencilState, Device, FragmentState, MultisampleState, PrimitiveState,
    PrimitiveTopology, QuerySet, RenderPassDepthStencilAttachment, RenderPassDescriptor, RenderPipeline,
    RenderPipelineDescriptor, ShaderModule, ShaderStages, TextureFormat, TextureView, VertexState,
};

use super::batch::Batch;
use super::bind::{self, Bound, DepthAs, Layouts};
use super::clock::{Purpose, Tape};
use super::pack::PackedProxy;
use crate::geom::{DepthDirection, DepthFormat, View, Viewport};

/// What is added to the nearness of boxes that are asked about natively; see the module.
pub(super) fn slack(format: DepthFormat) -> f32 {
    match format {
        DepthFormat::Depth32Float => 0.0,
        DepthFormat::Depth24Plus => 2.0 / 16_777_216.0,
    }
}

/// The pass.
#[derive(Debug)]
pub(super) struct AskNatively {
    pub(super) layouts: Layouts,
    module: ShaderModule,
    /// One for each kind of target that there was.
    pipelines: Vec<(Target, RenderPipeline)>,
}

/// What a pipeline depends on.
type Target = (TextureFormat, DepthDirection, u32);

impl AskNatively {
    pub(super) fn new(device: &Device, module: ShaderModule) -> Self {
        let buffers = &[(bind::PROXIES, false)];
        let layouts = Layouts::new(device, ShaderStages::VERTEX_FRAGMENT, buffers, DepthAs::Attachment);
        Self { layouts, module, pipelines: Vec::new() }
    }

    /// Records the queries of a batch, and the way of their results into memory that can be read.
    pub(super) fn record(
        &mut self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        batch: &Batch,
        (view, depth): (&View, &TextureView),
    ) {
        let bindings = bind::storage(tape.device, &self.layouts.batch, &batch.native_bindings());
        let bound = Bound { frame, batch: &bindings };
        let pipeline = self.pipeline(tape.device, view, depth);
        for (set, queries) in batch.query_sets() {
            pass(tape, pipeline, &bound, batch, (view.viewport(), depth), (set, queries));
        }
        batch.resolve_queries(tape.encoder);
    }

    fn pipeline(&mut self, device: &Device, view: &View, depth: &TextureView) -> &RenderPipeline {
        let target = (depth.texture().format(), view.depth(), view.samples());
        let found = self.pipelines.iter().position(|(had, _)| *had == target);
        let index = found.unwrap_or_else(|| {
            self.pipelines.push((target, pipeline(device, &self.layouts, &self.module, target)));
            self.pipelines.len() - 1
        });
        &self.pipelines[index].1
    }
}

/// The queries of one set: a pass has no more.
fn pass(
    tape: &mut Tape<'_>,
    pipeline: &RenderPipeline,
    bound: &Bound<'_>,
    batch: &Batch,
    (viewport, depth): (Viewport, &TextureView),
    (set, queries): (&QuerySet, &[Range<u32>]),
) {
    // Neither depth nor stencil is written to.
    let attachment = RenderPassDepthStencilAttachment { view: depth, depth_ops: None, stencil_ops: None };
    let descriptor = RenderPassDescriptor {
        label: Some("tercet native queries"),
        depth_stencil_attachment: Some(attachment),
        occlusion_query_set: Some(set),
        ..Default::default()
    };
    let mut pass = tape.render_pass(Purpose::Question, descriptor);
    let Viewport { x, y, width, height } = viewport;
    pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bound.frame, &[]);
    pass.set_bind_group(1, bound.batch, &[]);
    pass.set_vertex_buffer(0, batch.drawn.slice(..));
    for (query, boxes) in (0..).zip(queries) {
        pass.begin_occlusion_query(query);
        pass.draw(0..4, boxes.clone());
        pass.end_occlusion_query();
    }
}

fn pipeline(
    device: &Device,
    layouts: &Layouts,
    module: &ShaderModule,
    (format, direction, samples): Target,
) -> RenderPipeline {
    let depth_compare = match direction {
        DepthDirection::Reversed => CompareFunction::GreaterEqual,
        DepthDirection::Standard => CompareFunction::LessEqual,
    };
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("tercet native queries"),
        layout: Some(&layouts.pipeline),
        vertex: VertexState {
            module,
            entry_point: Some("rectangle"),
            compilation_options: Default::default(),
            buffers: &[Some(PackedProxy::LAYOUT)],
        },
        primitive: PrimitiveState { topology: PrimitiveTopology::TriangleStrip, ..Default::default() },
        depth_stencil: Some(DepthStencilState {
            format,
            depth_write_enabled: Some(false),
            depth_compare: Some(depth_compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: MultisampleState { count: samples, ..Default::default() },
        fragment: Some(FragmentState {
            module,
            entry_point: Some("sight"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}
