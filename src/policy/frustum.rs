//! View-frustum culling (*VFC*): what does not meet the frustum is not drawn, and nothing is
//! asked.

use super::near_first::near_first;
use super::plan::each_own;
use super::{Action, Answer, Context, Extent, Fate, Policy, Ticket};
use crate::Error;
use crate::dial::{self, Dial};
use crate::scene::ObjectId;
use crate::tree::NodeId;

/// Draws every object whose box meets the view frustum. The driver walks the tree with plane
/// masks inherited down, so this is the whole of it, unless objects are to come in their own order.
#[derive(Clone, Debug, Default)]
pub struct FrustumOnly {
    /// Whether objects are drawn from near to far, each by its own box; else node by node. Of a coarse tree
    /// they then come by slot, of a fine one in an order that hides less than it scatters.
    pub near_first: bool,
    done: bool,
    objects: Vec<ObjectId>,
    /// By distance, to be sorted.
    order: Vec<(f32, ObjectId)>,
    stack: Vec<NodeId>,
}

impl FrustumOnly {
    /// With [`FrustumOnly::near_first`].
    pub fn from_near_to_far() -> Self {
        Self { near_first: true, ..Self::default() }
    }

    /// What meets the frustum, from near to far.
    fn list(&mut self, cx: &Context<'_>) {
        let Self { objects, order, stack, .. } = self;
        let store = cx.scene.objects_store();
        objects.clear();
        stack.push(cx.tree.root());
        while let Some(node) = stack.pop() {
            if cx.tree.count(node) > 0 && cx.frustum.intersects(&cx.tree.bounds(node)) {
                each_own(cx, node, |slot| objects.push(store.id(slot)));
                stack.extend(cx.tree.children(node).into_iter().flatten());
            }
        }
        near_first(cx, objects, order);
    }
}

impl Policy for FrustumOnly {
    fn name(&self) -> &'static str {
        "frustum"
    }

    fn asks(&self) -> bool {
        false
    }

    fn begin(&mut self, _cx: &Context<'_>) {
        self.done = false;
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        if std::mem::replace(&mut self.done, true) {
            Action::Done
        } else if self.near_first {
            self.list(cx);
            Action::DrawObjects(&self.objects)
        } else {
            Action::Draw(cx.tree.root(), Extent::Subtree)
        }
    }

    fn answer(&mut self, _cx: &Context<'_>, _ticket: Ticket, _answer: Answer<'_>) {}

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        if cx.frustum.intersects(&cx.tree.bounds(node)) { Fate::Unasked } else { Fate::Outside }
    }

    fn dials(&self) -> Vec<Dial> {
        vec![Dial::new("near_first", self.near_first, "draw objects from near to far, not node by node")]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "near_first" => self.near_first = dial::switch(key, value)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}
