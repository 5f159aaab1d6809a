//! An earlier frame, whose finished depth questions are put to.

use crate::geom::{Aabb, Frustum, PlaneMask, Question, View};
use crate::tree::{NodeId, Tree};

/// The frame that late questions see ([`Latency::Late`](crate::Latency)).
#[derive(Clone, Debug)]
pub struct Past {
    view: View,
    frustum: Frustum,
    /// By how much boxes are enlarged, metres, and how many updates of the tree ago it was; None where they
    /// are not.
    swept: Option<(f32, u32)>,
}

impl Past {
    /// The frame of a view, before that of `now`. `swept`, the updates of the tree since, enlarges boxes by
    /// the way that the eye has gone, and has what moved since drawn unasked: seen from there, an object that
    /// goes away is hidden by itself.
    pub(crate) fn new(view: View, now: &View, swept: Option<u32>) -> Self {
        // An orthographic view has no eye: only how it looks counts.
        let way = (now.eye() - view.eye()).truncate().length();
        let frustum = Frustum::new(&view);
        Self { view, frustum, swept: swept.map(|updates| (way, updates)) }
    }

    /// What asking about a box of a node comes to.
    pub(super) fn question(&self, tree: &Tree, node: NodeId, aabb: &Aabb) -> Question {
        let aabb = match self.swept {
            Some((_, updates)) if tree.has_moved_within(node, updates) => return Question::Visible,
            Some((way, _)) => aabb.inflated(way),
            None => *aabb,
        };
        // Of what lies outside that view nothing is known.
        if self.frustum.classify(&aabb, PlaneMask::ALL) != Some(PlaneMask::NONE) {
            return Question::Visible;
        }
        match Question::new(&aabb, &self.view) {
            // Between the samples of that frame, but maybe not of this one.
            Question::Outside => Question::Visible,
            question => question,
        }
    }
}
