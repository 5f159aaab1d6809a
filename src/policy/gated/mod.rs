//! A gate before any policy: it asks where asking pays, and else draws what meets the frustum.
//!
//! After the aim of *NOHC* (Guthe, Balázs & Klein, *Near Optimal Hierarchical Culling: Performance
//! Driven Use of Hardware Occlusion Queries*, 2006): occlusion culling should never be slower than
//! view-frustum culling. The paper weighs each node's question, and so does the policy
//! [`Nohc`](super::Nohc). What no node can know is what all questions together cost: the walk
//! through a fine tree, the waiting, the changes of state. The gate weighs that, for the whole view:
//! what frames took that asked, against what frames took, or would take, that draw everything
//! in the frustum (`gate.rs`). Both are measured; times arrive as
//! [`Costs::last_frame`](crate::Costs::last_frame), recorded, so the gate stays a deterministic machine.
//!
//! *Shut*, a frame is what [`FrustumOnly`](super::FrustumOnly) makes of it, and the tree stays as
//! coarse as for that. Every few frames a *probe* asks about some objects, picked at random, when the
//! frame is complete (`probe.rs`). The time between probes doubles up to [`Gated::probe`] frames, so
//! hidden objects in earnest numbers are noticed within so many, and asked about from the next
//! frame on. *Open*, the policy does as it likes.
//!
//! Conservative, since it only draws more: a frame that does not ask draws whatever meets the frustum.
//!
//! A device without a clock tells nothing ([`DrawTime::Unknown`](crate::query::DrawTime::Unknown)):
//! after some frames the gate opens for good.

mod book;
mod gate;
mod probe;
#[cfg(test)]
mod replay;

use std::slice;

use super::{Action, Answer, Context, Extent, Fate, FrustumOnly, Policy, Recording, Ticket};
use crate::dial::{self, Dial};
use crate::query::{Wait, Want};
use crate::scene::ObjectId;
use crate::tree::{NodeId, Votes};
use crate::{Counter, Error};
use gate::{Gate, Plan};
use probe::Probe;

const SWITCH: &[(&str, bool)] = &[("on", true), ("off", false)];

/// A policy behind a gate; see the module's documentation. It has the policy's name and dials, and two
/// dials more. A policy that asks nothing is left as it is.
#[derive(Clone, Debug)]
pub struct Gated<P> {
    /// Whether there is a gate; without, it is the policy itself.
    pub gate: bool,
    /// Frames from one probe to the next, at most; 0 counts as 1.
    pub probe: u32,
    policy: P,
    state: Gate,
    sample: Probe,
    frame: Frame,
    /// Objects in view of the last probe.
    in_view: f32,
    /// Whether the last frame had a probe, for [`Policy::counters`].
    probed: bool,
}

/// What is left of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frame {
    /// The policy's own.
    Open,
    /// Drawn whole: everything is still to be drawn.
    Draw {
        probe: bool,
    },
    /// This question of the probe comes next.
    Ask(usize),
    /// All are asked: their answers are weighed next.
    Weigh,
    Done,
}

impl<P: Policy> Gated<P> {
    /// A gate before a policy.
    pub fn new(policy: P) -> Self {
        Self {
            gate: true,
            probe: 32,
            policy,
            state: Gate::default(),
            sample: Probe::default(),
            frame: Frame::Done,
            in_view: 0.0,
            probed: false,
        }
    }

    /// The policy behind the gate.
    pub fn inner(&self) -> &P {
        &self.policy
    }

    /// Whether there is something to decide, and a way to find out.
    fn has_gate(&self) -> bool {
        self.gate && self.can_be_gated()
    }

    /// A probe's answers are awaited.
    fn can_be_gated(&self) -> bool {
        self.policy.asks() && self.policy.needs_blocking()
    }

    fn own_dials(&self) -> Vec<Dial> {
        vec![
            Dial::choice("gate", self.gate, SWITCH, "draw the whole frustum where asking does not pay"),
            Dial::new("probe", self.probe, "frames from one probe of a shut gate to the next, at most"),
        ]
    }
}

impl<P: Policy> Policy for Gated<P> {
    fn name(&self) -> &'static str {
        self.policy.name()
    }

    fn needs_blocking(&self) -> bool {
        self.policy.needs_blocking()
    }

    /// A gate that has never been open leaves the tree coarse.
    fn asks(&self) -> bool {
        self.policy.asks() && (!self.has_gate() || self.state.is_open())
    }

    fn asks_owners(&self) -> bool {
        self.policy.asks_owners() && (!self.has_gate() || self.state.is_open())
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.probed = false;
        let plan = match self.has_gate() {
            true => self.state.plan(cx.costs.last_frame()),
            false => Plan::Ask { count: false },
        };
        self.frame = match plan {
            Plan::Whole { probe } => Frame::Draw { probe },
            Plan::Ask { count } => {
                if count {
                    let in_view = self.sample.count(cx);
                    self.state.counted(in_view);
                }
                self.policy.begin(cx);
                Frame::Open
            }
        };
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        match self.frame {
            Frame::Open => self.policy.next(cx),
            Frame::Draw { probe } => {
                self.frame = if probe { Frame::Ask(0) } else { Frame::Done };
                Action::Draw(cx.tree.root(), Extent::Subtree)
            }
            Frame::Ask(number) => {
                if number == 0 {
                    self.probed = true;
                    self.in_view = self.sample.pick(cx);
                }
                match self.sample.proxies.get(number) {
                    Some(proxy) => {
                        self.frame = Frame::Ask(number + 1);
                        let ticket = Ticket(number as u32);
                        Action::Ask { ticket, boxes: slice::from_ref(proxy), want: Want::Any }
                    }
                    None => {
                        self.frame = Frame::Weigh;
                        Action::Wait(Wait::Block)
                    }
                }
            }
            Frame::Weigh => {
                let share = self.sample.share();
                self.state.probed(share, self.in_view, cx.costs.question(), self.probe);
                self.frame = Frame::Done;
                Action::Done
            }
            Frame::Done => Action::Done,
        }
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        if self.frame == Frame::Open {
            self.policy.answer(cx, ticket, answer);
        } else if !answer.is_visible(0) {
            self.sample.found_hidden();
        }
    }

    fn reset(&mut self) {
        self.policy.reset();
        self.state = Gate::default();
    }

    /// What asking costs is the same elsewhere.
    fn cut(&mut self) {
        self.policy.cut();
    }

    fn vote(&mut self, votes: &mut Votes) {
        if self.frame == Frame::Open {
            self.policy.vote(votes);
        }
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        match self.frame {
            Frame::Open => self.policy.fate(cx, node),
            _ => FrustumOnly::default().fate(cx, node),
        }
    }

    fn counters(&self) -> Vec<Counter> {
        if !self.has_gate() {
            return self.policy.counters();
        }
        let is_shut = self.frame != Frame::Open;
        let mut counters = self.policy.counters();
        if is_shut {
            // Those of an earlier frame.
            counters.iter_mut().for_each(|counter| counter.count = 0);
        }
        counters.push(Counter { key: "gated_frames", count: is_shut.into() });
        counters.push(Counter { key: "probes", count: self.probed.into() });
        counters
    }

    fn explanation(&self) -> Option<String> {
        self.policy.explanation()
    }

    fn wants_recorded(&self) -> Option<Recording> {
        self.policy.wants_recorded()
    }

    fn give_recorded(&mut self, visible: &[ObjectId]) {
        self.policy.give_recorded(visible);
    }

    fn dials(&self) -> Vec<Dial> {
        let own = if self.can_be_gated() { self.own_dials() } else { Vec::new() };
        self.policy.dials().into_iter().chain(own).collect()
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        if self.policy.dials().iter().any(|dial| dial.key == key) {
            return self.policy.set(key, value);
        }
        match key {
            "gate" if self.can_be_gated() => self.gate = dial::choice(key, value, SWITCH)?,
            "probe" if self.can_be_gated() => self.probe = dial::number(key, value, 1..=10_000)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}
