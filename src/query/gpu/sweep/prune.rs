//! Before closer tests: what the pyramid shows to be hidden, and a few samples to be seen, nobody need look
//! at sample by sample. What stays open is listed, with the part of its rectangle that does.
//!
//! *Seen* is who has a sample in sight, by the closer test's own rule: small rectangles are looked at pixel by
//! pixel, by the invocation that has the proxy in its registers, of large ones some pixels.
//! *Hidden* is what no closer test can find: a sample of a proxy is in sight if its entry is not farther than
//! what is stored there; in a part of its rectangle no entry is nearer than the least of what its planes come to at the
//! part's corners, and no sample that is stored is farther than what the texels hold that hold the part. A part
//! beside the outline, by its edges at the corners, has no sample at all. A node's rectangle is taken as a whole,
//! at its nearest point.
//!
//! A plane at a corner is evaluated in f32 as it is at a sample, and is raised by the same bound for that
//! (`pack.rs`, `project.rs`): so what is hidden here does hide every sample of the object. Where rounding alone decides, the
//! closer test might still have found a sample; else it finds the very same.
//!
//! A tree's object or node that is hidden gets an empty rectangle: depth only grows nearer. Mostly next to
//! nothing is left to be looked at; the pyramid takes about what drawing one rectangle over the whole screen
//! does.

use wgpu::{BindGroup, BufferBinding, Device, ShaderModule};

use super::asked::Asked;
use super::placed::PlacedTree;
use super::pyramid::{self, Pyramid};
use super::stage::Stage;
use crate::query::gpu::bind::DepthAs;
use crate::query::gpu::clock::Tape;
use crate::query::gpu::rectangles::List;

/// The passes: over proxies, over those of a tree, and over its nodes.
#[derive(Debug)]
pub(in crate::query::gpu) struct Prune {
    proxies: Stage,
    placed: Stage,
    nodes: Stage,
}

impl Prune {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let listing = &[(0, true), (2, true), (pyramid::BINDING, false), (4, true)];
        let looking = &[(0, true), (2, true), (pyramid::BINDING, false), (5, false)];
        let nodes = &[(1, true), (pyramid::BINDING, false)];
        Self {
            proxies: Stage::on_texture(device, module, ("tercet prune", "prune_proxies"), listing, depth),
            placed: Stage::on_texture(
                device,
                module,
                ("tercet prune placed", "prune_placed"),
                looking,
                depth,
            ),
            nodes: Stage::on_texture(device, module, ("tercet prune nodes", "prune_nodes"), nodes, depth),
        }
    }

    /// Records the pruning of proxies that nothing is known of yet, by a pyramid that has been built, and the
    /// listing of those that stay open.
    pub(super) fn proxies(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        (asked, open): (&Asked, &List),
        pyramid: &Pyramid,
    ) {
        let Some(levels) = pyramid.binding() else { return };
        open.clear(tape.encoder);
        let buffers =
            [(0, asked.proxies()), (2, asked.verdicts()), (pyramid::BINDING, levels), (4, open.all())];
        self.proxies.record(tape, frame, &buffers, asked.count());
    }

    /// Records that of a tree's objects at `wanted` places, so many; nothing is listed.
    pub(super) fn placed(
        &self,
        tape: &mut Tape<'_>,
        frame: &BindGroup,
        tree: &PlacedTree,
        pyramid: &Pyramid,
        (wanted, count): (BufferBinding<'_>, u32),
    ) {
        let Some(levels) = pyramid.binding() else { return };
        let objects = &tree.objects;
        let buffers =
            [(0, objects.proxies()), (2, objects.verdicts()), (pyramid::BINDING, levels), (5, wanted)];
        self.placed.record(tape, frame, &buffers, count);
    }

    /// Records that of its nodes.
    pub(super) fn nodes(&self, tape: &mut Tape<'_>, frame: &BindGroup, tree: &PlacedTree, pyramid: &Pyramid) {
        let Some(levels) = pyramid.binding() else { return };
        let buffers = [(1, tree.nodes.all()), (pyramid::BINDING, levels)];
        self.nodes.record(tape, frame, &buffers, tree.nodes.count());
    }
}
