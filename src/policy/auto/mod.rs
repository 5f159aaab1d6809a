//! The policy that picks a policy: whichever is fastest in this scene, on this machine, now.
//!
//! It begins with groups and rays ([`Hroc`]), which need no frame to learn. Other ways of culling race against it, a few frames at a time ([`race`]), and the fastest is
//! kept: the frustum alone, if too little is hidden for asking to pay; on a device a pyramid, which is built
//! quickly and lets more through. Who races depends on what the scene shows ([`signs`]): where things move, policies
//! that test each mover apart (*hybrid*, *roc*) come in. Whoever asks node by node is left out: in no world of
//! `docs/measurements/hroc.md` was it the fastest, on either backend, and to find that out takes many frames, as
//! it must see nodes before it can cull.
//!
//! Times arrive recorded, as [`Costs::last_frame`](crate::Costs::last_frame): the same times and answers,
//! the same choices. On a device that does not say how long it draws, groups and rays stay.
//!
//! Conservative whenever its ways are: a frame is one way's alone, and none of them trusts what it saw
//! when it was last in use.
//!
//! [`race`]: race::Race
//! [`signs`]: signs::Signs

mod race;
mod signs;

use std::fmt::Write;

use super::{Action, Answer, Context, Fate, FrustumOnly, HiZ, Hroc, Hybrid, Policy, Roc, Ticket};
use crate::dial::{self, Dial};
use crate::tree::{NodeId, Votes};
use crate::{Counter, Error};
use race::Race;
use signs::Signs;

/// Picks among the other policies; see the module's documentation.
#[derive(Clone, Debug)]
pub struct Auto {
    /// Whether others may take the place of the way that it begins with.
    pub race: bool,
    ways: Ways,
    running: usize,
    contest: Race,
    signs: Signs,
    /// Objects in the scene, and those drawn in the last frame of which that is known.
    objects: usize,
    drawn: u32,
}

/// The ways, by number; the first is where a race begins, and then they challenge in this order.
#[derive(Clone, Debug)]
struct Ways {
    hroc: Hroc,
    frustum: FrustumOnly,
    hybrid: Hybrid,
    roc: Roc,
    hi_z: HiZ,
}

const HROC: usize = 0;
const FRUSTUM: usize = 1;
const HYBRID: usize = 2;
const ROC: usize = 3;
const HI_Z: usize = 4;
/// By number: what counters call a way, which says how many frames were its.
const KEYS: [&str; 5] = ["auto_hroc", "auto_frustum", "auto_hybrid", "auto_roc", "auto_hi_z"];
/// The share of the objects that move from which movers are tested apart.
const MOVERS: f32 = 0.01;

impl Default for Ways {
    fn default() -> Self {
        Self {
            hroc: Hroc::default(),
            // The tree has become fine for those who ask.
            frustum: FrustumOnly::from_near_to_far(),
            hybrid: Hybrid::default(),
            roc: Roc::default(),
            hi_z: HiZ::default(),
        }
    }
}

impl Ways {
    fn get(&self, way: usize) -> &dyn Policy {
        match way {
            HROC => &self.hroc,
            FRUSTUM => &self.frustum,
            HYBRID => &self.hybrid,
            ROC => &self.roc,
            _ => &self.hi_z,
        }
    }

    fn get_mut(&mut self, way: usize) -> &mut dyn Policy {
        match way {
            HROC => &mut self.hroc,
            FRUSTUM => &mut self.frustum,
            HYBRID => &mut self.hybrid,
            ROC => &mut self.roc,
            _ => &mut self.hi_z,
        }
    }
}

/// Who may challenge, and how long each learns.
struct Field {
    /// Whether objects move.
    moves: bool,
    /// Whether a device draws and answers.
    device: bool,
}

impl race::Ways for Field {
    fn admits(&self, way: usize) -> bool {
        match way {
            HYBRID | ROC => self.moves,
            // Where the CPU answers, a pyramid was never faster than rays.
            HI_Z => self.device,
            _ => true,
        }
    }

    /// What sweeps draw first is what they drew last.
    fn learns(&self, way: usize) -> [u32; 2] {
        if way == FRUSTUM { [0, 0] } else { [1, 0] }
    }
}

impl Default for Auto {
    fn default() -> Self {
        Self {
            race: true,
            ways: Ways::default(),
            running: HROC,
            contest: Race::new(KEYS.len()),
            signs: Signs::default(),
            objects: 0,
            drawn: 0,
        }
    }
}

impl Auto {
    /// The name of the way that the last frame went.
    pub fn way(&self) -> &'static str {
        self.running().name()
    }

    fn running(&self) -> &dyn Policy {
        self.ways.get(self.running)
    }
}

impl Policy for Auto {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn asks(&self) -> bool {
        self.running().asks()
    }

    fn asks_owners(&self) -> bool {
        self.running().asks_owners()
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.signs.look(cx);
        self.objects = cx.scene.len();
        let last = cx.costs.last_frame();
        self.drawn = last.map_or(self.drawn, |last| last.drawn);
        if self.race {
            let device = last.is_some_and(|last| last.ago > 1);
            let field = Field { moves: self.signs.moving >= MOVERS, device };
            self.running = self.contest.next(last.map(|last| (last.total, last.ago)), &field);
        }
        // The frame that is told of may have been another way's.
        let costs = cx.costs.without_last();
        self.ways.get_mut(self.running).begin(&Context { costs, ..*cx });
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        self.ways.get_mut(self.running).next(cx)
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        self.ways.get_mut(self.running).answer(cx, ticket, answer);
    }

    fn reset(&mut self) {
        (0..KEYS.len()).for_each(|way| self.ways.get_mut(way).reset());
        self.running = HROC;
        self.contest = Race::new(KEYS.len());
        self.signs = Signs::default();
    }

    fn cut(&mut self) {
        (0..KEYS.len()).for_each(|way| self.ways.get_mut(way).cut());
    }

    fn vote(&mut self, votes: &mut Votes) {
        self.ways.get_mut(self.running).vote(votes);
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        self.running().fate(cx, node)
    }

    fn counters(&self) -> Vec<Counter> {
        let ran = |(way, key)| Counter { key, count: u32::from(way == self.running) };
        let mut counters: Vec<Counter> = KEYS.into_iter().enumerate().map(ran).collect();
        counters.push(Counter { key: "duels", count: self.contest.duels });
        counters
    }

    fn explanation(&self) -> Option<String> {
        let champion = self.contest.champion();
        let mut text = format!("{}: ", self.ways.get(champion).name());
        let others: Vec<String> = (0..KEYS.len())
            .filter_map(|way| Some((self.ways.get(way).name(), self.contest.records()[way].ratio?)))
            .map(|(name, ratio)| format!("{name} took {ratio:.2} × its time"))
            .collect();
        if others.is_empty() {
            text += "no other has been tried yet";
        }
        text += &others.join(", ");
        if champion == FRUSTUM {
            text += "; too little is hidden for asking to pay";
        }
        let in_view = self.signs.in_view * self.objects as f32;
        let hidden = (1.0 - self.drawn as f32 / in_view.max(1.0)).clamp(0.0, 1.0);
        let percent = |share: f32| (100.0 * share).round();
        let _ = write!(
            text,
            "; about {} % of what is in view was culled, and {} % of all moves",
            percent(hidden),
            percent(self.signs.moving)
        );
        Some(text)
    }

    fn dials(&self) -> Vec<Dial> {
        vec![Dial::new("race", self.race, "let other ways than groups and rays show whether they are faster")]
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "race" => {
                self.race = dial::switch(key, value)?;
                if !self.race {
                    (self.running, self.contest) = (HROC, Race::new(KEYS.len()));
                }
            }
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}
