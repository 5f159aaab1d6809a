//! What the sweeping policies have in common: two phases a frame.
//!
//! First what was visible in the last frame (*V*) is drawn: it is taken for what hides the rest. Then one
//! sweep asks about the rest, object by object, and what it finds is drawn (*U*). What was found visible
//! is the V of the next frame; with *occluder filtering*, those of it that own a sample.
//!
//! Conservative whatever the history: an object is culled only if it meets no frustum, if a sweep of this very
//! frame has not found it, or if nothing of it showed as it was drawn. V decides what comes first, and nothing else: one of it that has
//! moved is drawn where it is now, and one that is gone is left out.
//!
//! *By geometry.* Much is hidden whose box is not: the boxes of large and intricate things show what they
//! do not. Where the backend can tell ([`Action::DrawIfSeen`]), both phases draw from near to far, and each
//! object only if a sample of it passes the depth test behind all before it: of V that is the paper's *O*, of
//! U its *D*. What does not show is culled in this frame, and no part of the next V; so V does not lag
//! behind a fast camera, and nobody need ask for owners or sweep V again.
//!
//! *In parts.* Elsewhere: after a cut V hides little, and nearly everything in the frustum would be found. Where more
//! than half as many objects are found as V has, the nearest of them are drawn first, and the others swept
//! again behind those; several times, if need be, in parts that double. (Ours. Lee et al. name IOC, which sweeps
//! between two depths of its hierarchy.)
//!
//! What hides nothing is no part of V: it is asked about in every frame.

mod counts;
mod dials;

use counts::Counts;

use super::near_first::near_first;
use super::plan::{First, Plan, Targets};
use super::{Action, Answer, Context, Fate, Policy, Ticket};
use crate::dial::Dial;
use crate::query::compact::Compaction;
use crate::query::{SweepTest, Wait};
use crate::scene::{ObjectId, ObjectSet};
use crate::tree::NodeId;
use crate::{Counter, Error};

/// A policy that draws what was visible, sweeps, and draws what is found; see the names for it in
/// [`policy`](super).
#[derive(Clone, Debug)]
pub struct TwoPhase<P> {
    /// Whether an object must own a sample to be drawn first in the next frame; else its box must have
    /// one in sight. On the CPU to find owners costs about what drawing did, and hardly culls more. What is
    /// drawn by geometry is known to have shown: then it makes no difference.
    pub occluder_filtering: bool,
    /// Whether only what shows by its geometry is drawn, in both phases, where the backend can tell
    /// ([`Action::DrawIfSeen`]). Then V is what showed, and nobody need ask for owners or sweep V again.
    pub by_geometry: bool,
    /// In how many parts, at most, many new objects are drawn, each swept behind those before it. By geometry
    /// they need no parts.
    pub parts: u32,
    /// Whether what was visible is drawn from near to far; else by slot, the same in every view.
    pub near_first: bool,
    /// What is asked.
    pub plan: P,
    stage: Stage,
    /// The last sweep, and whether it was answered.
    ticket: Ticket,
    answer: Reply,
    /// What the last sweep found.
    found: ObjectSet,
    first: First,
    targets: Targets,
    /// Found by the last sweep and not drawn yet, nearest first.
    rest: Vec<ObjectId>,
    /// Drawn in the second phase.
    second: Vec<ObjectId>,
    /// By distance, to be sorted.
    order: Vec<(f32, ObjectId)>,
    /// V.
    visible: Vec<ObjectId>,
    parts_left: u32,
    /// Whether everything drawn in this frame is known to have shown something.
    knows: bool,
    compaction: Compaction,
    counts: Counts,
}

/// What the policy does next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    DrawFirst,
    /// Takes in what of the first phase shows.
    SawFirst,
    Sweep,
    /// Waits for the main sweep, or for one behind a part.
    Wait,
    /// Looks at what was found.
    Found,
    /// Draws the nearest of what was found, so many, and goes on with the others.
    DrawPart(usize),
    /// Takes in what of those shows.
    SawPart(usize),
    SweepRest,
    /// The main sweep was lost: draws the groups from this one on, then what is loose.
    DrawLost(usize),
    AskOwners,
    WaitForOwners,
    Remember,
    Done,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reply {
    None,
    Found,
    Lost,
}

/// New objects that are drawn at once in any case; the first part has so many, and each further one
/// twice as many as the one before.
const PART: usize = 16;

impl<P: Plan> Default for TwoPhase<P> {
    fn default() -> Self {
        Self {
            occluder_filtering: false,
            by_geometry: true,
            parts: 8,
            near_first: true,
            plan: P::default(),
            stage: Stage::Done,
            ticket: Ticket(0),
            answer: Reply::None,
            found: ObjectSet::default(),
            first: First::default(),
            targets: Targets::default(),
            rest: Vec::new(),
            second: Vec::new(),
            order: Vec::new(),
            visible: Vec::new(),
            parts_left: 0,
            knows: false,
            compaction: Compaction::default(),
            counts: Counts::default(),
        }
    }
}

impl<P: Plan> Policy for TwoPhase<P> {
    fn name(&self) -> &'static str {
        P::NAME
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn asks_owners(&self) -> bool {
        self.occluder_filtering
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.counts = Counts::default();
        self.second.clear();
        self.rest.clear();
        self.knows = self.by_geometry;
        let First { objects, set, .. } = &mut self.first;
        objects.clear();
        set.clear();
        for &id in &self.visible {
            let slot = cx.scene.objects_store().slot(id);
            let bounds = slot.and_then(|slot| cx.tree.aabb_of(slot));
            if bounds.is_some_and(|bounds| cx.frustum.intersects(&bounds)) {
                objects.push(id);
                set.insert(id);
            }
        }
        self.counts.first = objects.len() as u32;
        if self.near_first {
            near_first(cx, &mut self.first.objects, &mut self.order);
        }
        self.stage = Stage::DrawFirst;
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        loop {
            match self.stage {
                Stage::DrawFirst if self.knows => {
                    self.stage = Stage::SawFirst;
                    let ticket = self.new_ticket();
                    return Action::DrawIfSeen { ticket, objects: &self.first.objects };
                }
                Stage::DrawFirst => {
                    self.stage = Stage::Sweep;
                    return Action::DrawObjects(&self.first.objects);
                }
                Stage::SawFirst | Stage::SawPart(_) if self.answer == Reply::None => {
                    return Action::Wait(Wait::Block);
                }
                Stage::SawFirst => {
                    self.knows = self.answer == Reply::Found;
                    if self.knows {
                        self.first.objects.retain(|&id| self.found.contains(id));
                        self.counts.left_out = self.counts.first - self.first.objects.len() as u32;
                    }
                    self.stage = Stage::Sweep;
                }
                Stage::Sweep => {
                    self.first.retest = !self.occluder_filtering && !self.knows;
                    self.targets.groups.clear();
                    self.targets.loose.clear();
                    self.plan.plan(cx, &self.first, &mut self.targets);
                    self.counts.groups = self.targets.groups.len() as u32;
                    self.counts.loose = self.targets.loose.len() as u32;
                    if self.counts.groups + self.counts.loose == 0 {
                        self.stage = Stage::AskOwners;
                        continue;
                    }
                    self.stage = Stage::Wait;
                    // Rays without groups: nothing but loose objects.
                    let test = if self.counts.groups > 0 { P::TEST } else { alone(P::TEST) };
                    let ticket = self.new_sweep();
                    let Targets { groups, loose } = &self.targets;
                    return Action::Sweep { ticket, groups, loose, test };
                }
                Stage::Wait => {
                    self.stage = Stage::Found;
                    return Action::Wait(Wait::Block);
                }
                Stage::Found => self.look_at_found(cx),
                Stage::DrawPart(0) => self.stage = Stage::AskOwners,
                Stage::DrawPart(count) if self.knows => {
                    self.stage = Stage::SawPart(count);
                    let ticket = self.new_ticket();
                    return Action::DrawIfSeen { ticket, objects: &self.rest[..count] };
                }
                Stage::SawPart(count) => {
                    self.knows = self.answer == Reply::Found;
                    let store = cx.scene.objects_store();
                    let (knows, found) = (self.knows, &self.found);
                    // No answer speaks of what hides nothing: it is drawn.
                    let is_drawn =
                        |id: &ObjectId| !knows || found.contains(*id) || !store.is_occluder(id.slot() as u32);
                    let before = self.second.len();
                    self.second.extend(self.rest.drain(..count).filter(is_drawn));
                    self.counts.left_out += (count - (self.second.len() - before)) as u32;
                    self.stage = if self.rest.is_empty() { Stage::AskOwners } else { Stage::SweepRest };
                }
                Stage::DrawPart(count) if count == self.rest.len() => {
                    self.second.extend_from_slice(&self.rest);
                    self.stage = Stage::AskOwners;
                    return Action::DrawObjects(&self.rest);
                }
                Stage::DrawPart(count) => {
                    self.second.extend(self.rest.drain(..count));
                    self.stage = Stage::SweepRest;
                    let drawn = self.second.len();
                    return Action::DrawObjects(&self.second[drawn - count..]);
                }
                Stage::SweepRest => {
                    self.stage = Stage::Wait;
                    let ticket = self.new_sweep();
                    // Groups find out at once what has become hidden as a whole.
                    let (groups, loose, test) = match P::TEST {
                        SweepTest::Rays if self.counts.groups > 0 => {
                            (&self.targets.groups[..], &self.targets.loose[..], P::TEST)
                        }
                        _ => (&[][..], &self.rest[..], alone(P::TEST)),
                    };
                    return Action::Sweep { ticket, groups, loose, test };
                }
                Stage::DrawLost(group) => {
                    if let Some(&node) = self.targets.groups.get(group) {
                        self.stage = Stage::DrawLost(group + 1);
                        return Action::Draw(node, super::Extent::Subtree);
                    }
                    self.stage = Stage::AskOwners;
                    return Action::DrawObjects(&self.targets.loose);
                }
                Stage::AskOwners => {
                    self.remember(cx);
                    if self.knows || !self.occluder_filtering || self.visible.is_empty() {
                        self.stage = Stage::Done;
                        continue;
                    }
                    self.stage = Stage::WaitForOwners;
                    let ticket = self.new_sweep();
                    let test = SweepTest::Owners;
                    return Action::Sweep { ticket, groups: &[], loose: &self.visible, test };
                }
                Stage::WaitForOwners => {
                    self.stage = Stage::Remember;
                    return Action::Wait(Wait::Block);
                }
                Stage::Remember => {
                    // All of it, if nobody knows.
                    if self.answer == Reply::Found {
                        let before = self.visible.len();
                        self.visible.retain(|&id| self.found.contains(id));
                        self.counts.left_out += (before - self.visible.len()) as u32;
                    }
                    self.stage = Stage::Done;
                }
                Stage::Done => return Action::Done,
            }
        }
    }

    fn answer(&mut self, _cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        if ticket != self.ticket || self.answer != Reply::None {
            return;
        }
        self.answer = match answer {
            Answer::Swept(found) => {
                self.found.assign(found.words().iter().copied());
                Reply::Found
            }
            _ => Reply::Lost,
        };
    }

    fn reset(&mut self) {
        self.visible.clear();
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        if cx.frustum.intersects(&cx.tree.bounds(node)) { Fate::Swept } else { Fate::Outside }
    }

    fn counters(&self) -> Vec<Counter> {
        let mut counters = self.counts.list();
        counters.extend(self.plan.counters());
        counters
    }

    fn dials(&self) -> Vec<Dial> {
        dials::of(self)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        dials::set(self, key, value)
    }
}

impl<P: Plan> TwoPhase<P> {
    fn new_ticket(&mut self) -> Ticket {
        self.ticket = Ticket(self.ticket.0.wrapping_add(1));
        self.answer = Reply::None;
        self.ticket
    }

    fn new_sweep(&mut self) -> Ticket {
        self.counts.sweeps += 1;
        self.new_ticket()
    }

    /// Decides what to draw of what the last sweep found.
    fn look_at_found(&mut self, cx: &Context<'_>) {
        let is_main = self.second.is_empty() && self.rest.is_empty();
        if self.answer != Reply::Found {
            self.stage = if is_main { Stage::DrawLost(0) } else { Stage::DrawPart(self.rest.len()) };
            return;
        }
        if is_main {
            self.compaction.list(cx.scene, &self.found, &mut self.rest);
            self.rest.retain(|&id| !self.first.set.contains(id));
            if self.first.retest {
                self.first.objects.retain(|&id| self.found.contains(id));
            }
        } else {
            self.rest.retain(|&id| self.found.contains(id));
        }
        if is_main {
            // Most of what is visible is in the depth already: there is little to win.
            let is_usual = self.rest.len() <= self.first.objects.len() / 2;
            // By geometry, each is tested behind all before it.
            self.parts_left = if is_usual || self.knows { 1 } else { self.parts };
            near_first(cx, &mut self.rest, &mut self.order);
        }
        self.parts_left -= 1;
        let part = PART.max(self.second.len());
        let all = self.rest.len();
        self.stage = Stage::DrawPart(if self.parts_left == 0 { all } else { part.min(all) });
    }

    /// The V of the next frame: what was drawn, and is still visible if that was asked, as far as it hides
    /// anything. By slot: what lies at the same depth does not flicker.
    fn remember(&mut self, cx: &Context<'_>) {
        self.counts.found = self.second.len() as u32;
        self.visible.clear();
        let drawn = self.first.objects.iter().chain(&self.second);
        self.visible.extend(drawn.filter(|id| cx.scene.objects_store().is_occluder(id.slot() as u32)));
        self.visible.sort_unstable();
    }
}

/// How objects are tested that have no group.
const fn alone(test: SweepTest) -> SweepTest {
    match test {
        SweepTest::HiZ => SweepTest::HiZ,
        _ => SweepTest::Raster,
    }
}
