//! What comes into view is taken as visible, unasked, if such nodes are seldom hidden. Ours.
//!
//! After a quick turn nothing is remembered of what has come into view. The published rule asks about every
//! node on the way down, and most inner ones are visible. Here such a node is opened unasked if it is hidden
//! with a probability `p`, by the measure of those of its coverage of the screen, so low that asking about its
//! `c` children costs less than asking about it first: `p c < 1`. A leaf is drawn unasked where `p` is below
//! 0.35, and asked about one to three frames later. No answer hides them, so nothing can be lost.

use super::super::Context;
use super::super::odds::Class;
use crate::tree::NodeId;

/// Leaves that are hidden with a lesser probability are drawn unasked when they come into view.
const SELDOM: f32 = 0.35;

/// Whether a node of which nothing is known is taken as visible, `hidden` being the probability that it is not:
/// an inner one if it is cheaper to ask about its children than about it first.
#[inline]
pub(super) fn is_visible(cx: &Context<'_>, node: NodeId, class: Class, hidden: f32) -> bool {
    if class.is_leaf {
        return hidden < SELDOM;
    }
    let children = cx.tree.children(node).into_iter().flatten();
    hidden * (children.filter(|&child| cx.tree.count(child) > 0).count() as f32) < 1.0
}
