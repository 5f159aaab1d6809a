//! Proxies made on the device, from boxes: the stage before all tests of a sweep.
//!
//! # Why they hold, in f32
//!
//! The construction is that of `geom/proxy.rs`: half spaces whose constants are taken from all eight
//! corners, so that any slope gives a valid bound, pushed outward by how far a sample may lie from the
//! hull. There the corners are nearly exact; here they are evaluated in f32, and that joins the
//! bounds. All of it is written for arithmetic that rounds to either neighbour (an error of 2u,
//! u = 2⁻²⁴), fuses, and flushes what is below the least normal number.
//!
//! *Clip coordinates.* The matrix is rounded once, and four products are added up: less than 10u of
//! the sum of magnitudes, which `View::clip_error` holds 16 times u of. So δ, which there is two of
//! that bound, is [three and a quarter](super::view) here: the third for the corners, with 6u of room
//! for sums like w − z, and the quarter for the rounding of the bounds themselves. `TINY` is more than
//! anything that is flushed.
//!
//! *On the screen.* A point of the geometry that shows lies in the viewport, or within snapping of
//! it, and so errs by (δ_x + |X|δ_w)/w with |X| ≤ 1. A corner may lie far beside it, where its own
//! error grows with |X|: so `moved` takes the farthest corner instead. A division errs by 2.5 units
//! in the last place, and what follows by two roundings more: below 12u of a corner's distance from the
//! centre, and some roundings with the rectangle; 32u are added to the 8u that the rasteriser gets.
//!
//! *Nearness.* As above with the greatest |N| of a corner, and 7u of it for division and product; the
//! nearest point's own sum takes 4u more: 32u, with the 17u of `geom/project.rs`.
//!
//! *Constants.* Distances along an edge, and heights over a plane, are sums of two products of
//! corners relative to the rectangle: less than 8u of the sum of magnitudes, of which twice as much is
//! added. A function's value at a pixel errs by less than 12u of |a|W + |b|H + |c| when evaluated
//! (`pack.rs`), and by as much again here, when c is put together: 24u are added.
//!
//! A plane is left out where it may fall below the cleared depth, judged by its value without what
//! was added: leaving it out only loosens the proxy. Boxes beyond 10⁹, and views that bring such boxes
//! beyond 10¹⁵, are not asked about, so nothing overflows up to the division; after it, what lies
//! more than 10⁸ pixels out is not asked about either.
//!
//! Against the proxies of the CPU these are a little larger and nearer, and usually hold them; they
//! hold the geometry always. `tests/gpu/sweep.rs` measures by how much.

use wgpu::{BindGroup, Buffer, BufferBinding, Device, ShaderModule};

use super::asked::Asked;
use super::enclose::Nodes;
use super::stage::Stage;
use crate::query::gpu::clock::Tape;

/// The pass.
#[derive(Debug)]
pub(in crate::query::gpu) struct Project(Stage);

impl Project {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true), (3, true)];
        Self(Stage::new(device, module, ("tercet project", "project"), buffers))
    }

    /// Binds a view, for this stage and those of the tree.
    pub(super) fn bind(&self, device: &Device, view: &Buffer) -> BindGroup {
        self.0.bind(device, view, None)
    }

    /// Records the making of proxies and first verdicts of the boxes at some slots.
    pub(in crate::query::gpu) fn record(
        &self,
        tape: &mut Tape<'_>,
        view: &BindGroup,
        boxes: BufferBinding<'_>,
        slots: BufferBinding<'_>,
        asked: &Asked,
    ) {
        let buffers = [(0, boxes), (1, slots), (2, asked.proxies()), (3, asked.verdicts())];
        self.0.record(tape, view, &buffers, asked.count());
    }
}

/// The same of a tree's objects: nothing is made below nodes that have no rectangle.
#[derive(Debug)]
pub(super) struct ProjectBelow(Stage);

impl ProjectBelow {
    pub(super) fn new(device: &Device, module: &ShaderModule) -> Self {
        let buffers = &[(0, false), (1, false), (2, true), (3, true), (4, false), (5, false)];
        Self(Stage::new(device, module, ("tercet project below", "project_below"), buffers))
    }

    /// Records it: of the boxes at `slots`, below `nodes` that have been placed; those at `wanted` places, so many.
    pub(super) fn record(
        &self,
        tape: &mut Tape<'_>,
        view: &BindGroup,
        (boxes, slots): (BufferBinding<'_>, BufferBinding<'_>),
        nodes: &Nodes,
        asked: &Asked,
        (wanted, count): (BufferBinding<'_>, u32),
    ) {
        let buffers = [
            (0, boxes),
            (1, slots),
            (2, asked.proxies()),
            (3, asked.verdicts()),
            (4, nodes.all()),
            (5, wanted),
        ];
        self.0.record(tape, view, &buffers, count);
    }
}
