//! What pipelines draw, and what each needs for it.

use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, PrimitiveTopology, VertexBufferLayout};

use super::Shading;
use super::vertices::{BOXES, CORNERS, IDS, INSTANCES, SLOTS, VERTICES};

/// What a pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    /// Surfaces, shaded.
    Lit,
    /// The same, after so many look-ups in a texture: 1 or more.
    LookUps(u32),
    /// Surfaces in their own colours.
    Unlit,
    /// Surfaces without their colours.
    Depth,
    /// Every layer of surfaces, into the colour alone.
    Layers,
    /// Edges of boxes where nothing is nearer.
    Edges,
    /// Edges of boxes, whatever is nearer.
    XRayEdges,
    /// Polygons on the screen.
    Polygons,
    /// Lines on the screen.
    Borders,
}

/// Where the transform and the colour of a surface's instance are, and its id if it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Source {
    /// In a vertex buffer, of what one call draws.
    Instances,
    /// The same, and its id in another one: what writes the depth writes the item buffer too.
    Identified,
    /// In a storage buffer, of all objects by slot; the vertex buffer has slots.
    Slots,
}

/// What a kind needs.
pub(super) struct Recipe {
    /// The vertex stage, and the fragment stage if there is a target for it.
    pub(super) stages: [&'static str; 2],
    pub(super) buffers: Vec<VertexBufferLayout<'static>>,
    pub(super) topology: PrimitiveTopology,
    pub(super) blend: Option<BlendState>,
    pub(super) draws_color: bool,
    pub(super) draws_ids: bool,
    pub(super) depth: Depth,
}

/// What becomes of the depth. As near as what is there passes.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Depth {
    TestedAndWritten,
    Tested,
    Ignored,
}

impl Kind {
    /// What surfaces are drawn with, one after the other.
    pub(super) fn of(shading: Shading, has_color: bool, look_ups: u32) -> impl Iterator<Item = Self> {
        let (first, second) = match shading {
            _ if !has_color => (Self::Depth, None),
            Shading::Lit if look_ups > 0 => (Self::LookUps(look_ups), None),
            Shading::Lit => (Self::Lit, None),
            Shading::Unlit => (Self::Unlit, None),
            Shading::Overdraw => (Self::Depth, Some(Self::Layers)),
        };
        std::iter::once(first).chain(second)
    }

    pub(super) fn is_surface(self) -> bool {
        !matches!(self, Self::Edges | Self::XRayEdges | Self::Polygons | Self::Borders)
    }

    pub(super) fn recipe(self, source: Source) -> Recipe {
        let draws_ids = source == Source::Identified;
        let surfaces = |vertex: [&'static str; 3], fragment: [&'static str; 2]| Recipe {
            stages: [vertex[source as usize], fragment[usize::from(draws_ids)]],
            buffers: match source {
                Source::Instances => vec![VERTICES, INSTANCES],
                Source::Identified => vec![VERTICES, INSTANCES, IDS],
                Source::Slots => vec![VERTICES, SLOTS],
            },
            topology: PrimitiveTopology::TriangleList,
            blend: None,
            draws_color: true,
            draws_ids,
            depth: Depth::TestedAndWritten,
        };
        let overlays = |stage, buffer, topology, depth| Recipe {
            stages: [stage, "plain"],
            buffers: vec![buffer],
            topology,
            blend: Some(BlendState::ALPHA_BLENDING),
            draws_color: true,
            draws_ids: false,
            depth,
        };
        let edges = |depth| overlays("box_edge", BOXES, PrimitiveTopology::LineList, depth);
        let on_screen = |topology| overlays("corner", CORNERS, topology, Depth::Ignored);
        match self {
            Self::Lit => surfaces(SURFACE, LIT),
            Self::LookUps(_) => surfaces(SURFACE, LIT_BY_LOOK_UPS),
            Self::Unlit => surfaces(SURFACE, UNLIT),
            Self::Depth => Recipe { draws_color: false, ..surfaces(PLACE, NO_COLOR) },
            // It ignores the depth, so it would write whoever comes last.
            Self::Layers => Recipe {
                blend: Some(ADDED),
                draws_ids: false,
                depth: Depth::Ignored,
                ..surfaces(PLACE, ["layer"; 2])
            },
            Self::Edges => edges(Depth::Tested),
            Self::XRayEdges => edges(Depth::Ignored),
            Self::Polygons => on_screen(PrimitiveTopology::TriangleList),
            Self::Borders => on_screen(PrimitiveTopology::LineList),
        }
    }
}

/// Vertex stages, by [`Source`].
const SURFACE: [&str; 3] = ["surface", "surface_with_id", "surface_by_slot"];
const PLACE: [&str; 3] = ["place", "place_with_id", "place_by_slot"];

/// Fragment stages, without ids and with them.
const LIT: [&str; 2] = ["lit", "lit_with_id"];
const LIT_BY_LOOK_UPS: [&str; 2] = ["lit_by_look_ups", "lit_by_look_ups_with_id"];
const UNLIT: [&str; 2] = ["unlit", "unlit_with_id"];
const NO_COLOR: [&str; 2] = ["nothing", "id_alone"];

const ADDED: BlendState = {
    let sum = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    BlendState { color: sum, alpha: sum }
};
