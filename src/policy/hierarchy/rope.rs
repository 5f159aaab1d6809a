//! Visibility propagation: what a node's neighbours, seen before it, say of it.
//!
//! A *rope* leads from a face of a node's cell to the smallest node beyond it whose cell contains
//! the face. On a tree that changes, ropes are not stored but found: up to the first ancestor that
//! the face's side divides, and down again, O(depth).
//!
//! # When a cell is hidden
//!
//! *Claim.* Let a node's cell lie beyond the near plane. Let each of its faces that may be turned to
//! the viewer be contained in closed cells that are *hidden*: their
//! questions, in this frame, were about the whole cell and found no sample visible. Then the node's
//! cell is hidden, if a question about it would allow for no more error
//! ([`uncertainty`]) than those questions had room for.
//!
//! *Proof.* Let geometry of the node own a sample S. By the proof of [`Proxy`](crate::geom::Proxy), S
//! lies within reach r of the exact projection of a point g of the cell, and is stored no nearer
//! than N(g) + ε. The line from the viewer to g enters the cell at a point q of such a face: it has
//! the same projection, is no farther than g, and, like the whole cell, lies beyond the near plane.
//! q belongs to a hidden cell, whose own r and ε are no less. So S lies within *its* reach of q:
//! its proxy covers S, with a nearness of at least N(q) + ε ≥ N(g) + ε. The answer says that
//! something nearer than that was stored at S, in this frame; depth that has been drawn only gets
//! nearer. So S belongs to something else. A cell found hidden in this way can bear witness like one
//! that was asked about, with the least error allowed for on the way; and so can one without objects,
//! which nobody asks about, through the faces that the line entered *it* by.
//!
//! *Where it would not hold, nothing is concluded.* A question about a tight box, or a settled
//! node's, says nothing of the rest of the cell; a straddle child's cell is not its own; nothing is
//! known beyond the root; an answer that a
//! [`Tradeoff`](crate::Tradeoff) made hidden is not; one of an earlier frame is about occluders that
//! may have left. What moves needs no rule of its own: the cell is a part of space, whoever is in it.

use glam::Vec4;

use super::super::Context;
use super::record::{Class, Records};
use crate::geom::{Aabb, uncertainty};
use crate::tree::{NodeId, Tree};

/// What a node's neighbours say of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It is hidden: the errors that this holds for.
    Hidden([f64; 3]),
    /// It is taken as visible: all that could hide it is visible as a whole.
    Visible,
}

/// One face of a cell.
#[derive(Clone, Copy, Debug)]
struct Face {
    axis: usize,
    /// Whether it is the face at the greatest coordinate.
    high: bool,
    /// The face as a flat box.
    sheet: Aabb,
}

/// Cells without objects that a line of sight may cross from the one that speaks for it.
const MAX_EMPTY: u32 = 3;

/// A step of the coarsest grid that vertices are snapped to. A proxy's reach has room for two of
/// them, and a question that counts snaps nothing but the geometry.
const SPARE_PIXELS: f64 = 1.0 / 16.0;

/// Asks the neighbours of a node about it: all of them must agree. None if they do not.
/// O(depth), and O(nodes at the faces) where the neighbours are finer than the node.
pub(super) fn ask_neighbours(cx: &Context<'_>, records: &Records, node: NodeId) -> Option<Verdict> {
    let verdict = beyond_faces(cx, records, node, MAX_EMPTY)?;
    match verdict {
        Verdict::Hidden(within) => {
            let own = uncertainty(&cx.tree.cell(node), cx.view)?;
            let spare = [SPARE_PIXELS, SPARE_PIXELS, 0.0];
            (0..3).all(|i| own[i] <= within[i] + spare[i]).then_some(verdict)
        }
        // Whatever a node holds hides a part of what is behind it: an inner node is opened.
        Verdict::Visible => cx.tree.is_leaf(node).then_some(verdict),
    }
}

/// What is known of the space beyond all faces of a cell that may be turned to the viewer.
fn beyond_faces(cx: &Context<'_>, records: &Records, node: NodeId, empty: u32) -> Option<Verdict> {
    let mut said = None;
    for face in faces(&cx.tree.cell(node), cx.view.eye()) {
        let beyond = rope(cx.tree, node, &face)?;
        said = Some(agree(said, known(cx, records, beyond, &face, empty)?)?);
    }
    said
}

/// Both of two verdicts, if they are the same.
fn agree(one: Option<Verdict>, other: Verdict) -> Option<Verdict> {
    match (one, other) {
        (None, verdict) => Some(verdict),
        (Some(Verdict::Hidden(a)), Verdict::Hidden(b)) => {
            Some(Verdict::Hidden([0, 1, 2].map(|i| f64::min(a[i], b[i]))))
        }
        (Some(Verdict::Visible), Verdict::Visible) => Some(Verdict::Visible),
        _ => None,
    }
}

/// The faces that may be turned to the viewer. One that is seen nearly edge on counts, on whichever
/// side the rounding puts the eye.
fn faces(cell: &Aabb, eye: Vec4) -> impl Iterator<Item = Face> {
    const MARGIN: f32 = 1e-4;
    (0..6).filter_map(move |i| {
        let (axis, high) = (i / 2, i % 2 == 1);
        let at = if high { cell.max[axis] } else { cell.min[axis] };
        let (outward, scale) = match eye.w {
            0.0 => (eye[axis], 1.0),
            _ => (eye[axis] - at, eye[axis].abs() + at.abs()),
        };
        let outward = if high { outward } else { -outward };
        let mut sheet = *cell;
        (sheet.min[axis], sheet.max[axis]) = (at, at);
        // Not a number, at the ends of f32, counts as turned.
        let turned_away = outward < -MARGIN * scale;
        (!turned_away).then_some(Face { axis, high, sheet })
    })
}

/// The smallest node beyond a face whose cell contains it. None beyond the root, and below a
/// straddle child.
fn rope(tree: &Tree, node: NodeId, face: &Face) -> Option<NodeId> {
    let mut beyond = None;
    let mut at = node;
    while let Some(parent) = tree.parent(at) {
        let [low, high, _] = tree.children(parent)?;
        if at != low && at != high {
            return None;
        }
        let other = if face.high { high } else { low };
        // The plane is this face's if it is the side of the half that the way came from.
        if beyond.is_none() && at != other && divides(tree, low, high, face) {
            beyond = Some(other);
        }
        at = parent;
    }
    let mut beyond = beyond?;
    while let Some([low, high, _]) = tree.children(beyond) {
        let holds = |child: NodeId| tree.cell(child).contains(&face.sheet);
        beyond = match (holds(low), holds(high)) {
            (true, _) => low,
            (_, true) => high,
            _ => break,
        };
    }
    Some(beyond)
}

/// Whether the plane between two halves is the one that a face lies in.
fn divides(tree: &Tree, low: NodeId, high: NodeId, face: &Face) -> bool {
    let plane = tree.cell(low).max[face.axis];
    plane == tree.cell(high).min[face.axis] && plane == face.sheet.min[face.axis]
}

/// What is known in this frame of the space just beyond a face: by the node there, by the parts of
/// it that touch the face, by the ancestor at which the frame's traversal ended, or, beyond a cell
/// without objects, by that one's neighbours.
fn known(cx: &Context<'_>, records: &Records, beyond: NodeId, face: &Face, empty: u32) -> Option<Verdict> {
    let stopped_above = || {
        let above = std::iter::successors(cx.tree.parent(beyond), |&n| cx.tree.parent(n));
        above.filter_map(|n| records.of(n, cx.frame)).next().filter(|r| !r.opened)
    };
    let Some(record) = records.of(beyond, cx.frame).or_else(stopped_above) else {
        let crossed = cx.tree.count(beyond) == 0 && empty > 0;
        return if crossed { beyond_faces(cx, records, beyond, empty - 1) } else { None };
    };
    match record.class {
        Class::Invisible => record.hidden_within.map(Verdict::Hidden),
        Class::Visible => (record.asked && !record.propagated).then_some(Verdict::Visible),
        Class::Partial if !record.opened => None,
        Class::Partial => {
            let [low, high, _] = cx.tree.children(beyond)?;
            // A half that only touches the face's border need not agree, but is asked, too.
            let touching = [low, high].into_iter().filter(|&c| cx.tree.cell(c).intersects(&face.sheet));
            let mut said = None;
            for half in touching {
                said = Some(agree(said, known(cx, records, half, face, empty)?)?);
            }
            said
        }
    }
}
