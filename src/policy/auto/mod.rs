//! The policy that picks a policy: whichever is fastest in this scene, on this machine, now.
//!
//! It begins with dual queries behind a gate ([`Gated`]): nothing but the frustum, until a probe finds
//! that enough is hidden. From then on other ways of culling race against it, a few frames at a time
//! ([`race`]), and the fastest is kept. Who races depends on what the scene shows ([`signs`]): where
//! things move, movers are swept apart (*hybrid*), where nothing does, all goes by groups (*hroc*).
//!
//! Times arrive recorded, as [`Costs::last_frame`](crate::Costs::last_frame): the same times and answers,
//! the same choices. On a device that does not say how long it draws, dual queries stay.
//!
//! Conservative whenever its ways are: a frame is one way's alone, and none of them trusts what it saw
//! when it was last in use.
//!
//! [`race`]: race::Race
//! [`signs`]: signs::Signs

mod race;
mod signs;

use std::fmt::Write;

use super::{
    Action, Answer, ChcPlusPlus, Context, DualQuery, Fate, Gated, HiZ, Hroc, Hybrid, Policy, Ticket,
};
use crate::dial::{self, Dial};
use crate::tree::{NodeId, Votes};
use crate::{Counter, Error};
use race::Race;
use signs::Signs;

/// Picks among dual queries, CHC++ and raster culling; see the module's documentation.
#[derive(Clone, Debug)]
pub struct Auto {
    /// Whether others may take the place of dual queries.
    pub race: bool,
    ways: Ways,
    running: usize,
    contest: Race,
    signs: Signs,
    /// Objects in the scene, and those drawn in the last frame of which that is known.
    objects: usize,
    drawn: u32,
}

/// The ways, by number; the first is where a race begins.
#[derive(Clone, Debug, Default)]
struct Ways {
    dual_query: Gate,
    hroc: Hroc,
    hybrid: Hybrid,
    chc_plus_plus: ChcPlusPlus,
    hi_z: HiZ,
}

/// Dual queries, and the frustum alone where they do not pay.
#[derive(Clone, Debug)]
struct Gate(Gated<DualQuery>);

impl Default for Gate {
    fn default() -> Self {
        Self(Gated::new(DualQuery::default()))
    }
}

const DUAL_QUERY: usize = 0;
const HROC: usize = 1;
const HYBRID: usize = 2;
const CHC_PLUS_PLUS: usize = 3;
/// By number: what counters call a way, which says how many frames were its.
const KEYS: [&str; 5] = ["auto_dual_query", "auto_hroc", "auto_hybrid", "auto_chc_plus_plus", "auto_hi_z"];
/// The dials of the gate, which are this policy's as well.
const GATE: [&str; 2] = ["gate", "probe"];
/// The share of the objects that move from which movers are swept apart.
const MOVERS: f32 = 0.01;

impl Ways {
    fn get(&self, way: usize) -> &dyn Policy {
        match way {
            DUAL_QUERY => &self.dual_query.0,
            HROC => &self.hroc,
            HYBRID => &self.hybrid,
            CHC_PLUS_PLUS => &self.chc_plus_plus,
            _ => &self.hi_z,
        }
    }

    fn get_mut(&mut self, way: usize) -> &mut dyn Policy {
        match way {
            DUAL_QUERY => &mut self.dual_query.0,
            HROC => &mut self.hroc,
            HYBRID => &mut self.hybrid,
            CHC_PLUS_PLUS => &mut self.chc_plus_plus,
            _ => &mut self.hi_z,
        }
    }
}

impl Default for Auto {
    fn default() -> Self {
        Self {
            race: true,
            ways: Ways::default(),
            running: DUAL_QUERY,
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

    /// Who may challenge: who fits what moves, if there is anything to gain.
    fn admits(&self, way: usize) -> bool {
        // While the gate is on trial, nobody disturbs it.
        let is_open = self.ways.dual_query.0.has_opened();
        let moves = self.signs.moving >= MOVERS;
        (is_open || self.contest.champion() != DUAL_QUERY)
            && match way {
                HROC => !moves,
                HYBRID => moves,
                _ => true,
            }
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
        let before = self.running;
        if self.race {
            let admitted: [bool; KEYS.len()] = std::array::from_fn(|way| self.admits(way));
            self.running = self.contest.next(last.map(|last| last.total), |way| admitted[way]);
        }
        // A way must not take another's frame for its own.
        let costs = if before == self.running { cx.costs } else { cx.costs.without_last() };
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
        self.running = DUAL_QUERY;
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
        let _ = match (others.is_empty(), self.ways.dual_query.0.asks()) {
            (false, _) => write!(text, "{}", others.join(", ")),
            (true, true) => write!(text, "no other has been tried yet"),
            (true, false) => write!(text, "too little is hidden for asking to pay, so the frustum is drawn"),
        };
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
        let mut dials = vec![Dial::new(
            "race",
            self.race,
            "let other ways than dual queries show whether they are faster",
        )];
        let gate = self.ways.dual_query.0.dials();
        dials.extend(gate.into_iter().filter(|dial| GATE.contains(&dial.key)));
        dials
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "race" => {
                self.race = dial::number(key, value, false..=true)?;
                if !self.race {
                    self.running = DUAL_QUERY;
                }
            }
            key if GATE.contains(&key) => self.ways.dual_query.0.set(key, value)?,
            _ => return Err(dial::unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}
