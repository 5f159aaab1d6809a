//! The render queue of a frame, and the lists of what was drawn.

use super::timed;
use crate::Error;
use crate::geom::{Frustum, PlaneMask};
use crate::policy::{Context, Extent};
use crate::query::{Answer, QueryBackend, Ticket};
use crate::scene::{ObjectId, ObjectRef, ObjectSet, Scene};
use crate::stats::FrameStats;
use crate::tree::NodeId;

/// The render queue, and the lists of what it has drawn.
#[derive(Debug, Default)]
pub(super) struct DrawnList {
    /// To be drawn with the next flush.
    queue: Vec<ObjectRef>,
    /// No occluders: to be drawn last.
    last: Vec<ObjectRef>,
    /// Drawn if something of them shows; nobody knows yet.
    tried: Vec<ObjectRef>,
    /// The question that says it.
    attempt: Option<Ticket>,
    /// Of which nothing showed. Depth only grows nearer, so nothing will.
    hidden: ObjectSet,
    /// The last question about who owns a sample of what was drawn, and whom it is about.
    inquiry: Option<Ticket>,
    asked: ObjectSet,
    /// How many of those drawn own none.
    pub(super) unowned: u32,
    pub(super) visible: Vec<ObjectRef>,
    pub(super) entered: Vec<ObjectRef>,
    previous: Vec<ObjectRef>,
    /// By slot: which object was last drawn, and in which frame.
    last_drawn: Vec<(u32, u32)>,
    frame: u32,
    /// Whether the backend is to know whose draws are whose.
    pub(super) owned: bool,
}

impl DrawnList {
    /// Whether next to nothing of what was drawn in the last frame is in view now. O(1): a few objects
    /// speak for all.
    pub(super) fn is_cut(&self, scene: &Scene, frustum: &Frustum) -> bool {
        let step = self.visible.len().div_ceil(CUT_SAMPLES).max(1);
        let (mut seen, mut still) = (0, 0);
        for object in self.visible.iter().step_by(step) {
            // What is drawn always, or is gone, says nothing about the view.
            if let Some(aabb) = scene.object(object.id).and_then(|object| object.bounds) {
                seen += 1;
                still += usize::from(frustum.intersects(&aabb));
            }
        }
        seen >= CUT_SAMPLES / 4 && still * CUT_SHARE < seen
    }

    /// Starts anew: everything drawn next has entered, and nothing has left.
    pub(super) fn forget(&mut self) {
        self.visible.clear();
        self.previous.clear();
        self.entered.clear();
        self.last_drawn.clear();
    }

    pub(super) fn begin(&mut self, scene: &Scene, frame: u32) {
        self.frame = frame;
        self.queue.clear();
        self.last.clear();
        self.tried.clear();
        (self.attempt, self.inquiry) = (None, None);
        self.unowned = 0;
        self.hidden.clear();
        self.entered.clear();
        std::mem::swap(&mut self.visible, &mut self.previous);
        self.visible.clear();
        let bound = scene.slot_bound().max(self.last_drawn.len());
        self.last_drawn.resize(bound, (0, 0));
    }

    /// Queues an object, unless it was queued in this frame before, or is known to show nothing.
    pub(super) fn queue(&mut self, scene: &Scene, slot: u32) {
        let store = scene.objects_store();
        let object = store.object(slot);
        if !self.hidden.contains(object.id) && self.note(object) {
            let list = if store.is_occluder(slot) { &mut self.queue } else { &mut self.last };
            list.push(object);
        }
    }

    /// Notes that an object is drawn in this frame; false if that was known.
    fn note(&mut self, object: ObjectRef) -> bool {
        let last = &mut self.last_drawn[object.id.slot()];
        let (generation, frame) = std::mem::replace(last, (object.id.generation(), self.frame));
        if frame == self.frame {
            return false;
        }
        if generation != object.id.generation() || frame == 0 || frame != self.frame.wrapping_sub(1) {
            self.entered.push(object);
        }
        true
    }

    /// Draws those of which something shows, of the objects that were not drawn before. Which ones these
    /// are is known when the answer comes. What hides nothing is queued.
    pub(super) fn draw_if_seen<B: QueryBackend>(
        &mut self,
        scene: &Scene,
        ticket: Ticket,
        objects: &[ObjectId],
        queries: &mut B,
        draw: &mut impl FnMut(&mut B::Pass, &[ObjectRef]),
        stats: &mut FrameStats,
    ) -> Result<(), Error> {
        self.settle_all();
        let store = scene.objects_store();
        for slot in objects.iter().filter_map(|&id| store.slot(id)) {
            if !store.is_occluder(slot) {
                self.queue(scene, slot);
            } else if !self.has(store.id(slot)) && !self.hidden.contains(store.id(slot)) {
                self.tried.push(store.object(slot));
            }
        }
        self.attempt = Some(ticket);
        stats.draw += timed(|| queries.draw_if_seen(ticket, &self.tried, &mut *draw))?;
        Ok(())
    }

    /// A question goes to the backend: which of these objects own a sample of what was drawn?
    pub(super) fn ask_owners(&mut self, ticket: Ticket, objects: &[ObjectId]) {
        self.inquiry = Some(ticket);
        self.asked.clear();
        for &id in objects {
            self.asked.insert(id);
        }
    }

    /// How many were tried in this frame, and showed nothing.
    pub(super) fn left_out(&self) -> u32 {
        self.hidden.len() as u32
    }

    /// Takes the answer to an attempt to draw, or to who owns what was drawn, if it is one.
    pub(super) fn settle(&mut self, ticket: Ticket, answer: Answer<'_>) {
        if self.attempt == Some(ticket) {
            if let Answer::Swept(found) = answer {
                for object in self.tried.extract_if(.., |object| !found.contains(object.id)) {
                    self.hidden.insert(object.id);
                }
            }
            self.settle_all();
        } else if let (true, Answer::Swept(owners)) = (self.inquiry == Some(ticket), answer) {
            let owns_none =
                |object: &&ObjectRef| self.asked.contains(object.id) && !owners.contains(object.id);
            self.unowned = self.visible.iter().filter(owns_none).count() as u32;
        }
    }

    /// What nobody knows of counts as drawn.
    pub(super) fn settle_all(&mut self) {
        self.attempt = None;
        let mut tried = std::mem::take(&mut self.tried);
        for object in tried.drain(..) {
            if self.note(object) {
                self.visible.push(object);
            }
        }
        self.tried = tried;
    }

    pub(super) fn queue_objects(&mut self, scene: &Scene, objects: &[ObjectId]) {
        for &id in objects {
            if let Some(slot) = scene.objects_store().slot(id) {
                self.queue(scene, slot);
            }
        }
    }

    pub(super) fn queue_node(
        &mut self,
        scene: &Scene,
        cx: &Context<'_>,
        stack: &mut Vec<(NodeId, PlaneMask)>,
        node: NodeId,
        extent: Extent,
    ) {
        let planes = if extent == Extent::Everything { PlaneMask::NONE } else { PlaneMask::ALL };
        stack.push((node, planes));
        while let Some((node, mask)) = stack.pop() {
            if cx.tree.count(node) == 0 {
                continue;
            }
            let Some(mask) = cx.frustum.classify(&cx.tree.bounds(node), mask) else { continue };
            for (block, lane) in cx.tree.own_inside(node, cx.frustum, mask) {
                self.queue(scene, block.slots[lane]);
            }
            if extent != Extent::Own {
                let children = cx.tree.children(node).into_iter().flatten();
                stack.extend(children.map(|child| (child, mask)));
            }
        }
    }

    /// Draws what is queued; true if there was something.
    pub(super) fn flush<B: QueryBackend>(
        &mut self,
        queries: &mut B,
        draw: &mut impl FnMut(&mut B::Pass, &[ObjectRef]),
        stats: &mut FrameStats,
    ) -> Result<bool, Error> {
        if self.queue.is_empty() {
            return Ok(false);
        }
        stats.draw += timed(|| match self.owned {
            true => queries.draw_objects(&self.queue, &mut *draw),
            false => queries.draw(|pass| draw(pass, &self.queue)),
        })?;
        self.visible.append(&mut self.queue);
        Ok(true)
    }

    /// Draws what hides nothing, after everything else.
    pub(super) fn flush_last<B: QueryBackend>(
        &mut self,
        queries: &mut B,
        draw: &mut impl FnMut(&mut B::Pass, &[ObjectRef]),
        stats: &mut FrameStats,
    ) -> Result<bool, Error> {
        std::mem::swap(&mut self.queue, &mut self.last);
        self.flush(queries, draw, stats)
    }

    pub(super) fn left(&self) -> impl Iterator<Item = ObjectRef> {
        self.previous.iter().copied().filter(|object| !self.has(object.id))
    }

    /// Whether an object was drawn in the last frame.
    pub(super) fn has(&self, id: ObjectId) -> bool {
        self.last_drawn.get(id.slot()) == Some(&(id.generation(), self.frame))
    }
}

/// Objects of the last frame that are looked at for a cut.
const CUT_SAMPLES: usize = 64;
/// A cut leaves less than one in so many of them in view.
const CUT_SHARE: usize = 16;
