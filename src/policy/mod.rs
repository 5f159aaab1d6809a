//! What to ask: one paper a file, each a pure, deterministic state machine.
//!
//! A policy draws nothing and waits for nothing. It reads the tree and its own history, and says
//! one [`Action`] at a time: draw this, ask that, wait, done. The driver
//! ([`Culler`](crate::Culler)) carries it out on whatever backend there is. So each policy runs on
//! each backend, is tested without one, and a recorded frame replays bit for bit.

mod auto;
mod chc;
mod chc_plus_plus;
mod coherence;
mod dual_query;
mod fate;
mod front;
mod frustum;
mod gated;
mod hi_z;
mod hierarchy;
mod history;
mod hroc;
mod hybrid;
mod in_flight;
mod near_first;
mod nohc;
mod none;
mod odds;
mod order;
mod past;
mod plan;
mod recorded;
mod roc;
mod skip;
mod statistical;
mod stop_and_wait;
mod two_phase;
mod waves;

pub use auto::Auto;
pub use chc::Chc;
pub use chc_plus_plus::{ChcPlusPlus, KeepRule};
pub use dual_query::{DualQuery, Order};
pub use fate::{Fate, Samples};
pub use frustum::FrustumOnly;
pub use gated::Gated;
pub use hi_z::{EveryRectangle, HiZ};
pub use hierarchy::{Coherence, Hierarchy};
pub use history::{History, NodeState};
pub use hroc::{Groups, Hroc};
pub use hybrid::{Hybrid, MoversApart};
pub use nohc::Nohc;
pub use none::DrawAll;
pub use order::ScreenTiles;
pub use past::Past;
pub use plan::{First, Plan, Targets};
pub use recorded::{Recorded, Recording};
pub use roc::{EveryBox, Roc};
pub use skip::{Share, Skip};
pub use statistical::Statistical;
pub use stop_and_wait::StopAndWait;
pub use two_phase::TwoPhase;

use crate::dial::{self, Dial};
use crate::geom::{Aabb, Frustum, Proxy, Question, View};
use crate::query::{Answer, SweepTest, Ticket, Want};
use crate::scene::{ObjectId, Scene};
use crate::tree::{NodeId, Tree, Votes};
use crate::{Costs, Counter, Error, Tradeoff};

/// What a policy may look at.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// What is there: who stands behind the tree's slots.
    pub scene: &'a Scene,
    /// Where things are: the scene's tree.
    pub tree: &'a Tree,
    /// The camera.
    pub view: &'a View,
    /// Its frustum.
    pub frustum: &'a Frustum,
    /// Frames of this view so far, from 1.
    pub frame: u32,
    /// Speed against accuracy.
    pub tradeoff: &'a Tradeoff,
    /// What asking and drawing cost in this view's last frames.
    pub costs: Costs,
    /// The frame whose depth questions see, if it is an earlier one.
    pub past: Option<&'a Past>,
}

impl Context<'_> {
    /// What asking about a node comes to: [`Context::question_about`] its own box.
    pub fn question(&self, node: NodeId) -> Question {
        self.question_about(node, &self.tree.query_box(node))
    }

    /// What asking about a box comes to that holds something of a node: a policy makes all its
    /// questions here.
    pub fn question_about(&self, node: NodeId, aabb: &Aabb) -> Question {
        match self.past {
            None => Question::new(aabb, self.view),
            Some(past) => past.question(self.tree, node, aabb),
        }
    }
}

/// Which objects of a node are meant. Only those that meet the frustum are drawn, unless it says
/// otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The node's own.
    Own,
    /// The node's own and all below.
    Subtree,
    /// As [`Extent::Subtree`], but whether they meet the frustum or not.
    Everything,
}

/// How long the driver is to wait for answers.
pub use crate::query::Wait;

/// What a policy wants next.
#[derive(Debug)]
pub enum Action<'p> {
    /// Draw objects of a node. Draws join the render queue, which is flushed just before questions
    /// go out.
    Draw(NodeId, Extent),
    /// Draw these objects.
    DrawObjects(&'p [ObjectId]),
    /// Draw those of these objects of which something shows, by their geometry
    /// ([`QueryBackend::draw_if_seen`](crate::query::QueryBackend::draw_if_seen)). Answered by
    /// [`Answer::Swept`] with those that are drawn; by [`Answer::Unknown`] if all of them are: at once if the
    /// backend cannot tell, or if depth is coarser than the picture, so that thin things would slip through.
    /// What hides nothing is drawn last, in any case, and is in no answer.
    DrawIfSeen {
        /// Names the attempt in its answer.
        ticket: Ticket,
        /// The objects, in the order of drawing.
        objects: &'p [ObjectId],
    },
    /// Ask about boxes.
    Ask {
        /// Names the question in its answer.
        ticket: Ticket,
        /// The boxes; exactly one for [`Want::Dual`].
        boxes: &'p [Proxy],
        /// What to find out.
        want: Want,
    },
    /// Ask about many objects at once: those at and below groups, and loose ones; see
    /// [`Sweep`](crate::query::Sweep).
    Sweep {
        /// Names the question in its answer.
        ticket: Ticket,
        /// Nodes, none of them below another.
        groups: &'p [NodeId],
        /// Objects that are tested by themselves.
        loose: &'p [ObjectId],
        /// How to test.
        test: SweepTest,
    },
    /// Deliver answers to what was asked.
    Wait(Wait),
    /// The frame is complete.
    Done,
}

/// An occlusion-culling algorithm for one view.
pub trait Policy: Send + Sync {
    /// The name that `--policy` takes.
    fn name(&self) -> &'static str;

    /// Whether it needs the answers to its questions within the frame.
    fn needs_blocking(&self) -> bool {
        false
    }

    /// Whether it asks about nodes: only then are fine leaves worth their upkeep.
    fn asks(&self) -> bool {
        true
    }

    /// Whether it will ask which of the drawn objects own samples ([`SweepTest::Owners`]): what it
    /// draws is then drawn so that this can be told.
    fn asks_owners(&self) -> bool {
        false
    }

    /// Starts a frame.
    fn begin(&mut self, cx: &Context<'_>);

    /// The next action. After [`Action::Done`] it is not called again before the next frame.
    fn next(&mut self, cx: &Context<'_>) -> Action<'_>;

    /// Takes an answer to a question of this frame.
    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>);

    /// Forgets all history: for another scene.
    fn reset(&mut self) {}

    /// Forgets what earlier frames showed: the next one has nothing to do with them.
    fn cut(&mut self) {
        self.reset();
    }

    /// The dual answers of the frame, for the tree's adaptation; it may add none.
    fn vote(&mut self, _votes: &mut Votes) {}

    /// What became of a node in the last frame, read off what the policy remembers: `cx` is that
    /// frame's. It is for pictures and explanations, and costs nothing until somebody asks.
    fn fate(&self, _cx: &Context<'_>, _node: NodeId) -> Fate {
        Fate::Unknown
    }

    /// What it counted of the last frame, for statistics: the same keys every frame, zeros
    /// included. Nothing is put together until somebody asks.
    fn counters(&self) -> Vec<Counter> {
        Vec::new()
    }

    /// Why it does what it does at present, in a sentence, if there is a choice that it has made: for
    /// statistics and windows. Nothing is put together until somebody asks.
    fn explanation(&self) -> Option<String> {
        None
    }

    /// What it must be given before each frame, if it is a reference ([`Recorded`]).
    fn wants_recorded(&self) -> Option<Recording> {
        None
    }

    /// Takes what a reference draws in the next frame; others ignore it.
    fn give_recorded(&mut self, _visible: &[ObjectId]) {}

    /// Its dials.
    fn dials(&self) -> Vec<Dial> {
        Vec::new()
    }

    /// Sets a dial by name.
    ///
    /// # Errors
    /// [`Error::Dial`] for a name or value that does not exist, naming those that do.
    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        Err(dial::unknown(key, value, &self.dials()))
    }
}

impl Policy for Box<dyn Policy> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn needs_blocking(&self) -> bool {
        (**self).needs_blocking()
    }

    fn asks(&self) -> bool {
        (**self).asks()
    }

    fn asks_owners(&self) -> bool {
        (**self).asks_owners()
    }

    fn begin(&mut self, cx: &Context<'_>) {
        (**self).begin(cx);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        (**self).next(cx)
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        (**self).answer(cx, ticket, answer);
    }

    fn reset(&mut self) {
        (**self).reset();
    }

    fn cut(&mut self) {
        (**self).cut();
    }

    fn vote(&mut self, votes: &mut Votes) {
        (**self).vote(votes);
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        (**self).fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        (**self).counters()
    }

    fn explanation(&self) -> Option<String> {
        (**self).explanation()
    }

    fn wants_recorded(&self) -> Option<Recording> {
        (**self).wants_recorded()
    }

    fn give_recorded(&mut self, visible: &[ObjectId]) {
        (**self).give_recorded(visible);
    }

    fn dials(&self) -> Vec<Dial> {
        (**self).dials()
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        (**self).set(key, value)
    }
}

/// The names that [`by_name`] knows.
pub const NAMES: &[&str] = &[
    "none",
    "frustum",
    "statistical",
    "dual-query",
    "chc",
    "chc++",
    "nohc",
    "stop-and-wait",
    "hierarchy-a",
    "hierarchy-b",
    "hierarchy-c",
    "hierarchy-d",
    "roc",
    "hroc",
    "hi-z",
    "hybrid",
    "auto",
    "opt",
    "exact",
];

/// A policy by the name that `--policy` takes, with its default dials.
///
/// # Errors
/// [`Error::UnknownPolicy`], naming those there are.
pub fn by_name(name: &str) -> Result<Box<dyn Policy>, Error> {
    Ok(match name {
        "none" => Box::new(DrawAll::default()),
        "frustum" => Box::new(FrustumOnly::default()),
        "dual-query" => Box::new(DualQuery::default()),
        "chc" => Box::new(Chc::default()),
        "chc++" => Box::new(ChcPlusPlus::default()),
        "nohc" => Box::new(Nohc::default()),
        "statistical" => Box::new(Statistical::default()),
        "stop-and-wait" => Box::new(StopAndWait::default()),
        "hierarchy-a" => Box::new(Hierarchy::new(Coherence::Classical)),
        "hierarchy-b" => Box::new(Hierarchy::new(Coherence::Updating)),
        "hierarchy-c" => Box::new(Hierarchy::new(Coherence::Propagating)),
        "hierarchy-d" => Box::new(Hierarchy::new(Coherence::Conservative)),
        "roc" => Box::new(Roc::default()),
        "hroc" => Box::new(Hroc::default()),
        "hi-z" => Box::new(HiZ::default()),
        "hybrid" => Box::new(Hybrid::default()),
        "auto" => Box::new(Auto::default()),
        "opt" => Box::new(Recorded::new(Recording::StopAndWait)),
        "exact" => Box::new(Recorded::new(Recording::ExactSet)),
        _ => return Err(Error::UnknownPolicy { name: name.to_owned(), known: NAMES.join(", ") }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dial::DialKind;

    #[test]
    fn all_switches_are_set_in_one_way() {
        let mut switches = 0;
        for name in NAMES {
            let mut policy = by_name(name).expect("a policy of that name");
            for Dial { key, value, .. } in policy.dials().into_iter().filter(|it| it.kind == DialKind::Switch)
            {
                switches += 1;
                let other = if value == "true" { "false" } else { "true" };
                policy.set(key, &format!(" {other} ")).expect("a value that it takes");
                assert!(policy.dials().iter().any(|dial| dial.key == key && dial.value == other), "{name}");
                let error = policy.set(key, "on").expect_err("no value that it takes").to_string();
                assert_eq!(error, format!("cannot set {key}=on: it takes one of: true, false"), "{name}");
            }
        }
        assert!(switches > 12, "{switches}");
    }
}
