//! The driver of one frame for one view: start reading here.
//!
//! A [`Culler`] asks its policy for one action after the other and carries each out on the
//! backend: draws join the render queue, questions flush it first, answers go back to the policy.
//! An answer that does not come is *unknown*, which draws; one that nobody waits for is dropped.

mod drawn;
mod open;
#[cfg(test)]
mod waves;
mod why;
#[cfg(test)]
mod wrap;

use std::time::{Duration, Instant};

use drawn::DrawnList;
use open::{OpenQuestions, Purse};

pub use why::{Holder, Why};

use crate::costs::HostTimes;
use crate::geom::{Frustum, PlaneMask, View};
use crate::policy::{Action, Context, Past, Policy};
use crate::query::{Answer, DrawTime, QueryBackend, Sweep, SweepTest, Wait};
use crate::scene::{ObjectRef, Scene};
use crate::stats::FrameStats;
use crate::tree::{NodeId, Votes};
use crate::{Costs, Error, Latency, Tradeoff};

/// More than the frames of which a depth is kept.
const KEPT_UPDATES: usize = Latency::MOST as usize + 1;

/// What one camera sees: a policy with its history, and the visible list of the last frame.
#[derive(Debug)]
pub struct Culler<P> {
    policy: P,
    /// Speed against accuracy; exact by default.
    pub tradeoff: Tradeoff,
    costs: Costs,
    host: HostTimes,
    frame: u32,
    /// How many times coarser than the view the depth of the last frame was.
    divisor: u32,
    /// The frame whose depth its questions saw, if it was an earlier one.
    past: Option<Past>,
    /// By frame, modulo their number: how many updates the tree had seen.
    updates: [u32; KEPT_UPDATES],
    /// The tradeoff of the last frame, in pixels of its depth.
    applied: Tradeoff,
    /// The scene, and the making of its tree, that the history is about; 0 for none yet.
    scene: (u64, u64),
    drawn: DrawnList,
    votes: Votes,
    open: OpenQuestions,
    /// Whether a view that shows next to nothing of what the last one showed counts as a cut; see
    /// [`Culler::cut`]. Not by default: what was seen long ago and comes back into view is worth more
    /// than a clean start (CHC++ culled a third less of small worlds with it).
    pub detects_cuts: bool,
    /// Whether one was announced.
    expects_cut: bool,
    /// Reused by walks through the tree.
    stack: Vec<(NodeId, PlaneMask)>,
}

impl<P: Policy> Culler<P> {
    /// A view that has seen nothing yet. With [`Scene::adapt`] before the first frame, the tree knows
    /// from the start whether anybody asks about its nodes.
    pub fn new(policy: P) -> Self {
        Self {
            votes: Votes { asks: policy.asks(), ..Votes::default() },
            policy,
            tradeoff: Tradeoff::EXACT,
            costs: Costs::default(),
            host: HostTimes::default(),
            frame: 0,
            divisor: 1,
            past: None,
            updates: [0; KEPT_UPDATES],
            applied: Tradeoff::EXACT,
            scene: (0, 0),
            drawn: DrawnList::default(),
            open: OpenQuestions::default(),
            detects_cuts: false,
            expects_cut: false,
            stack: Vec::new(),
        }
    }

    /// Draws one frame of the scene, without what is hidden.
    ///
    /// `draw` is called with the objects to draw, several times a frame: each call is a pass of
    /// its own, and no state survives from one to the next. Objects that are no occluders come in
    /// the last call. No object is handed out twice.
    ///
    /// Some policies draw what may be hidden only if something of it shows ([`Action::DrawIfSeen`]), where the
    /// backend can tell. Then `draw` is called for objects, too, of which nothing shows: they leave no trace,
    /// and are not among the [`Culler::visible`].
    ///
    /// # Errors
    /// [`Error::PendingEdits`] if the scene was edited since its last update;
    /// [`Error::CannotBlock`] if the policy needs answers that the backend cannot wait for; and
    /// what the backend reports. If asking failed, the frame is complete all the same: whatever has
    /// no answer is drawn. If drawing failed, it is not. In both cases the visible list starts anew.
    pub fn frame<B: QueryBackend>(
        &mut self,
        scene: &Scene,
        view: &View,
        queries: &mut B,
        draw: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<FrameStats, Error> {
        let result = self.try_frame(scene, view, queries, draw);
        if result.is_err() {
            self.drawn.forget();
            // They are of the frame before.
            self.costs = self.costs.without_last();
        }
        result
    }

    fn try_frame<B: QueryBackend>(
        &mut self,
        scene: &Scene,
        view: &View,
        queries: &mut B,
        mut draw: impl FnMut(&mut B::Pass, &[ObjectRef]),
    ) -> Result<FrameStats, Error> {
        let start = Instant::now();
        scene.check_updated()?;
        if self.policy.needs_blocking() && !queries.can_block() {
            return Err(Error::CannotBlock { policy: self.policy.name(), backend: queries.name() });
        }
        let is_other = self.scene != scene.id();
        if is_other {
            if self.scene.0 != scene.id().0 {
                self.drawn.forget();
            }
            self.scene = scene.id();
            self.policy.reset();
        }
        self.divisor = if queries.owns_depth() { self.tradeoff.resolution_divisor.max(1) } else { 1 };
        let view = &view.coarsened(self.divisor);
        let frustum = Frustum::new(view);
        let is_announced = std::mem::take(&mut self.expects_cut);
        let is_cut = is_announced || self.detects_cuts && self.drawn.is_cut(scene, &frustum);
        if is_cut {
            self.policy.cut();
        }
        self.count_frame();
        self.open.clear();
        self.drawn.begin(scene, self.frame);
        self.drawn.owned = self.policy.asks_owners();
        self.applied = self.tradeoff.at_resolution(self.divisor);
        let tradeoff = &self.applied;
        // What was seen from elsewhere, or of another scene, says nothing of this frame.
        let late = if is_cut || is_other { 0 } else { tradeoff.latency.frames() };
        self.past = match late {
            0 => queries.begin(view).map(|()| None)?,
            _ => queries.begin_late(view, late)?.map(|past| {
                let then = self.frame.wrapping_sub(late) as usize % KEPT_UPDATES;
                let updates = scene.tree().tick().wrapping_sub(self.updates[then]);
                Past::new(past, view, tradeoff.swept.then_some(updates))
            }),
        };
        self.updates[self.frame as usize % KEPT_UPDATES] = scene.tree().tick();
        let mut purse = Purse::new(tradeoff.budget, start);
        let (frame, costs) = (self.frame, self.costs);
        let (tree, past) = (scene.tree(), self.past.as_ref());
        let cx = Context { scene, tree, view, frustum: &frustum, frame, tradeoff, costs, past };
        let mut stats = FrameStats { cuts: is_cut.into(), ..FrameStats::default() };
        // Questions that have been waited for.
        let mut awaited = 0;
        // What asking reports. Nothing more is asked then, and all that is open is unknown.
        let mut failure = None;
        let draw_time = queries.draw_time();
        if let DrawTime::Device { times, .. } = draw_time {
            (stats.device_draw, stats.awaited_draw) = (times.total, times.awaited);
        }
        for &slot in scene.objects_store().always() {
            self.drawn.queue(scene, slot);
        }
        self.policy.begin(&cx);
        loop {
            match self.policy.next(&cx) {
                Action::Draw(node, extent) => {
                    self.drawn.queue_node(scene, &cx, &mut self.stack, node, extent)
                }
                Action::DrawObjects(objects) => self.drawn.queue_objects(scene, objects),
                Action::DrawIfSeen { ticket, objects } if self.divisor == 1 && queries.draws_if_seen() => {
                    let ticket = self.open.ask(ticket);
                    self.drawn.flush(queries, &mut draw, &mut stats)?;
                    self.drawn.draw_if_seen(scene, ticket, objects, queries, &mut draw, &mut stats)?;
                }
                Action::DrawIfSeen { ticket, objects } => {
                    self.drawn.queue_objects(scene, objects);
                    self.policy.answer(&cx, ticket, Answer::Unknown);
                }
                Action::Ask { ticket, boxes, want } => {
                    let ticket = self.open.ask(ticket);
                    if !purse.pays(boxes) {
                        stats.refused += 1;
                        continue;
                    }
                    if self.drawn.flush(queries, &mut draw, &mut stats)? || stats.queries == 0 {
                        // From drawing to asking, and back before the next draw.
                        stats.state_changes += 2;
                    }
                    stats.queries += 1;
                    stats.query_boxes += boxes.len() as u32;
                    stats.query += attempt(&mut failure, || queries.ask(ticket, boxes, want));
                }
                Action::Sweep { ticket, groups, loose, test } => {
                    let ticket = self.open.ask(ticket);
                    if !purse.pays(&[]) {
                        stats.refused += 1;
                        continue;
                    }
                    if self.drawn.flush(queries, &mut draw, &mut stats)? || stats.queries == 0 {
                        stats.state_changes += 2;
                    }
                    stats.queries += 1;
                    stats.query_boxes += (groups.len() + loose.len()) as u32;
                    if test == SweepTest::Owners {
                        self.drawn.ask_owners(ticket, loose);
                    }
                    let sweep = Sweep { scene, view, frustum: &frustum, groups, loose, test };
                    stats.query += attempt(&mut failure, || queries.sweep(ticket, &sweep));
                }
                Action::Wait(wait) => {
                    if wait == Wait::Block {
                        // A draw that answers by itself keeps nobody waiting.
                        stats.waves += u32::from(stats.queries > awaited);
                        awaited = stats.queries;
                    }
                    let (policy, open, drawn) = (&mut self.policy, &mut self.open, &mut self.drawn);
                    stats.wait += attempt(&mut failure, || {
                        queries.answers(wait, |ticket, answer| {
                            if let Some(asked) = open.close(ticket) {
                                drawn.settle(ticket, answer);
                                policy.answer(&cx, asked, answer);
                            }
                        })
                    });
                    if wait == Wait::Block || failure.is_some() {
                        drawn.settle_all();
                        open.lost().for_each(|asked| policy.answer(&cx, asked, Answer::Unknown));
                    }
                }
                Action::Done => break,
            }
        }
        self.drawn.settle_all();
        self.drawn.flush(queries, &mut draw, &mut stats)?;
        self.drawn.flush_last(queries, &mut draw, &mut stats)?;
        // Also if asking failed: what was drawn is to be seen.
        let ended = queries.end();
        if let Some(error) = failure {
            return Err(error);
        }
        ended?;
        // Votes that nobody took before are out of date.
        self.votes.clear();
        self.policy.vote(&mut self.votes);
        self.votes.asks = self.policy.asks();
        stats.drawn = self.drawn.visible.len() as u32 - self.drawn.unowned;
        stats.left_out = self.drawn.left_out() + self.drawn.unowned;
        stats.policy = start.elapsed().saturating_sub(stats.draw + stats.query + stats.wait);
        let told = |frame| queries.device_times(frame);
        self.costs.record((self.frame, &stats), draw_time, &mut self.host, told);
        // Drawing that is not told apart from waiting would make questions look dear. So would a few
        // questions of a policy that does not ask about nodes, in a frame that it spends otherwise.
        if draw_time != DrawTime::Unknown && self.votes.asks {
            self.costs.learn(&stats);
        }
        self.votes.costs = self.costs;
        Ok(stats)
    }

    /// Frame 0 is never drawn: it stands for "never". After 2³² − 1 frames the numbers begin again, and with
    /// them all memories: what was noted in the frame that had this number before is not of this one.
    fn count_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            self.frame = 1;
            self.policy.reset();
            self.drawn.forget();
        }
    }
}

impl<P> Culler<P> {
    /// Says that the next frame has nothing to do with those before: another place, another time.
    /// What they showed is forgotten, so that the next frame is as dear as a first one, and no dearer: it
    /// looks at no more nodes, asks no more and draws no more. `chc++` and `auto` keep what they have learned of
    /// worlds in general: the former may then ask about the same nodes in other multiqueries, the latter in
    /// another way than a first frame.
    /// Nothing is ever lost without it. A jump that leaves next to nothing of the last frame in view can be
    /// found without being announced ([`Culler::detects_cuts`]).
    pub fn cut(&mut self) {
        self.expects_cut = true;
    }

    /// The objects drawn in the last frame, in the order of drawing; without those that were tried and showed nothing,
    /// and with those that own no sample in the end ([`FrameStats::left_out`] counts both).
    pub fn visible(&self) -> &[ObjectRef] {
        &self.drawn.visible
    }

    /// Those of them that the frame before had not drawn.
    pub fn entered(&self) -> &[ObjectRef] {
        &self.drawn.entered
    }

    /// What the frame before had drawn and the last one has not; removed objects included.
    pub fn left(&self) -> impl Iterator<Item = ObjectRef> {
        self.drawn.left()
    }

    /// What asking and drawing cost in the last frames.
    pub fn costs(&self) -> Costs {
        self.costs
    }

    /// Whether a cut was announced that no frame has followed yet.
    #[cfg(feature = "record")]
    pub(crate) fn expects_cut(&self) -> bool {
        self.expects_cut
    }

    /// Puts recorded costs in the place of measured ones.
    #[cfg(feature = "record")]
    pub(crate) fn set_costs(&mut self, costs: Costs) {
        self.costs = costs;
    }

    /// How many times coarser than the view the depth of the last frame was.
    pub(crate) fn divisor(&self) -> u32 {
        self.divisor
    }

    /// Whether the last frame's questions saw the depth of an earlier one.
    pub(crate) fn was_late(&self) -> bool {
        self.past.is_some()
    }

    /// The policy, to read.
    pub fn policy(&self) -> &P {
        &self.policy
    }

    /// The policy, to set its dials.
    pub fn policy_mut(&mut self) -> &mut P {
        &mut self.policy
    }
}

/// A view that votes on the tree's shape; see [`Scene::adapt`].
pub trait Voter {
    /// Its answers in the last frame, if they have not been taken yet.
    fn votes(&self) -> &Votes;

    /// The same, to empty.
    fn votes_mut(&mut self) -> &mut Votes;
}

impl<P> Voter for Culler<P> {
    fn votes(&self) -> &Votes {
        &self.votes
    }

    fn votes_mut(&mut self) -> &mut Votes {
        &mut self.votes
    }
}

/// Runs something unless something has failed before, and returns the time that it took.
fn attempt(failure: &mut Option<Error>, f: impl FnOnce() -> Result<(), Error>) -> Duration {
    if failure.is_some() {
        return Duration::ZERO;
    }
    timed(f).unwrap_or_else(|error| {
        *failure = Some(error);
        Duration::ZERO
    })
}

/// Runs something and returns the time that it took.
fn timed<E>(f: impl FnOnce() -> Result<(), E>) -> Result<Duration, E> {
    let start = Instant::now();
    f()?;
    Ok(start.elapsed())
}
