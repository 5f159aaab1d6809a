//! Whether the next frame asks: what asking has cost, against what drawing the whole frustum has.
//!
//! ```text
//!            enough is hidden                   asking is much faster
//!   ┌──────┐ ───────────────▶ ┌─────────────┐ ───────────────────────▶ ┌──────┐
//!   │ shut │                  │    trial    │ in doubt ┌─────────┐     │ open │
//!   │      │                  │ 8 to 48 ask │ ───────▶ │  look   │ ──▶ │      │
//!   └──────┘                  └─────────────┘          │ 3 whole │ ◀── │      │
//!       ▲                                              └─────────┘     └──────┘
//!       └─────────────────────────────────────────────────┘   now and then
//!                       drawing was faster
//! ```
//!
//! Shut, every few frames end with a *probe*, which tells the share of objects that asking could
//! cull. Enough of it makes a *trial*. A policy that has just begun to ask is dearer than it will be:
//! it knows nothing of what is visible, and its tree is coarse. So a trial goes on for as long as its
//! cost falls fast enough to be worth it in the end. What drawing took is known from before the trial,
//! maybe of another view. So a *look* at a few frames drawn whole has the last word, unless asking
//! is much faster; if drawing is faster, the look cost nothing.
//!
//! Open, the gate estimates from the objects in view what drawing all of them would take. The nearer that
//! is to what asking takes, the sooner it looks again.
//!
//! Whatever does not pay is paid for before it is tried again: looks, and trials after the first,
//! take about [`SPEND`] of the time at most. Waits after trials that fail also double. A trial is
//! repeated sooner when half as many objects again are hidden, or when drawing has become dearer than
//! asking was, which a shut gate sees for nothing.

use super::book::Book;
use crate::costs::{FrameCost, KEPT};

/// What a frame does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plan {
    /// Draws what meets the frustum; asks about a few objects afterwards, or nothing.
    Whole { probe: bool },
    /// Asks, as the policy has it; [`Gate::counted`] wants to know how much is in view, or not.
    Ask { count: bool },
}

/// See the module's documentation.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    stage: Stage,
    /// How many stages there have been, and frames.
    stages: u32,
    frames: u32,
    /// The last frames, by number, modulo how many are kept: what a device tells is of one of them.
    runs: [Option<Run>; KEPT],
    book: Book,
    /// Objects in view, when they were last counted.
    in_view: f32,
    failure: Option<Failure>,
    /// Frames to the next trial after one that fails, at least.
    patience: u32,
    /// What the last look took beyond asking, seconds.
    look_lost: f32,
    /// Frames of which nobody knew what they took, before the first of which somebody did.
    blind: u32,
}

#[derive(Clone, Copy, Debug)]
enum Stage {
    Shut {
        until_probe: u32,
        interval: u32,
    },
    Trial {
        asked: u32,
    },
    /// `frames` since it was opened.
    Open {
        until_count: u32,
        frames: u32,
        looks: bool,
    },
    /// `ends_trial`, or is one of an open gate.
    Look {
        drawn: u32,
        ends_trial: bool,
    },
}

/// A frame whose time may still come.
#[derive(Clone, Copy, Debug)]
struct Run {
    frame: u32,
    plan: Plan,
    /// In which stage, and which of the frames of a trial or a look it was, from 1 on.
    stage: u32,
    number: u32,
}

/// A trial that did not pay.
#[derive(Clone, Copy, Debug)]
struct Failure {
    /// How many objects were hidden, once a probe has told.
    hidden: Option<f32>,
    /// Seconds of a frame that asked, or of one drawn whole that was dearer and changed nothing.
    asking: f32,
    /// Frames to the next trial if nothing changes, and frames since this one.
    wait: u32,
    waited: u32,
}

/// Frames of a trial: at least, of which the first half is not judged, and at most; the very first does
/// not count.
const TRIAL: u32 = 8;
const LONGEST_TRIAL: u32 = 48;
/// Two frames of a trial that take so many times what drawing takes end it, and one that takes the square
/// of it.
const RUINOUS: f32 = 3.0;
/// Asking that takes less than this of what drawing took needs no look.
const SURE: f32 = 0.8;
/// Drawing is dearer than asking was: by so much, lest it is noise.
const DEARER: f32 = 1.1;
/// Frames of a look, at least; the first of which the time is known, of the last of these and any after, counts.
const LOOK: u32 = 3;
/// Frames from one count of what is in view to the next: as often, a look can begin.
const COUNT_EVERY: u32 = 8;
/// Frames from opening to the first look, and from one look to the next, at least.
const FIRST_LOOK: u32 = 16;
/// The share of the time that may be spent on finding out.
const SPEND: f32 = 0.02;
/// Frames from the first failed trial to the next, at least.
const PATIENCE: u32 = 8;
const MOST_PATIENCE: u32 = 2048;
/// Frames after which nobody will tell any more what frames take: a device's first times are late.
const BLIND: u32 = 16;
/// What a hidden object costs to draw, to the mean of those drawn: its samples fail the depth test.
const IN_VAIN: f32 = 0.5;
/// Frames that share the question about a visible object: policies skip such questions.
const SKIP: f32 = 4.0;
/// Fewer hidden objects than this are not worth the trouble.
const FEW: f32 = 16.0;

impl Default for Gate {
    fn default() -> Self {
        Self {
            stage: Stage::Shut { until_probe: 0, interval: 1 },
            stages: 0,
            frames: 0,
            runs: [None; KEPT],
            book: Book::default(),
            in_view: 0.0,
            failure: None,
            patience: PATIENCE,
            look_lost: 0.0,
            blind: 0,
        }
    }
}

impl Gate {
    /// What the next frame does, given what an earlier one took. Once a frame.
    pub(super) fn plan(&mut self, known: Option<FrameCost>) -> Plan {
        self.frames = self.frames.wrapping_add(1);
        if let Some(cost) = known {
            let frame = self.frames.wrapping_sub(cost.ago);
            let run = self.runs[frame as usize % KEPT].filter(|run| run.frame == frame);
            if let Some(Run { plan, stage, number, .. }) = run {
                let is_of_stage = stage == self.stages;
                let is_look = matches!(self.stage, Stage::Look { .. });
                let is_verdict = is_of_stage && is_look && number >= LOOK;
                self.book.enter(plan, cost, is_verdict);
                if is_of_stage {
                    self.judge(cost, number);
                }
            }
        }
        let plan = if self.is_blind(known) { Plan::Ask { count: false } } else { self.advance() };
        let number = match self.stage {
            Stage::Trial { asked: number } | Stage::Look { drawn: number, .. } => number,
            Stage::Shut { .. } | Stage::Open { .. } => 0,
        };
        let run = Run { frame: self.frames, plan, stage: self.stages, number };
        self.runs[run.frame as usize % KEPT] = Some(run);
        plan
    }

    /// What a probe found: the share of the objects in view that are hidden, 0 to 1. `question` is
    /// what a question costs, in objects drawn; `most` the most frames to the next probe.
    pub(super) fn probed(&mut self, share: f32, in_view: f32, question: f32, most: u32) {
        let Stage::Shut { interval, .. } = self.stage else { return };
        self.in_view = in_view;
        let hidden = share * in_view;
        let pays = hidden >= FEW && share * IN_VAIN > (1.0 - share) * question / SKIP;
        let is_dearer = self.drawing_is_dearer();
        let is_news = match &mut self.failure {
            None => true,
            Some(Failure { hidden: before, wait, waited, .. }) => {
                let before = *before.get_or_insert(hidden);
                is_dearer || waited >= wait || hidden > 1.5 * before + FEW
            }
        };
        if pays && is_news {
            self.book.asking.clear();
            self.enter(Stage::Trial { asked: 0 });
        } else {
            if let (true, Some(failure), Some(lately)) =
                (is_dearer, &mut self.failure, self.book.drawing_all.lately())
            {
                // No news any more.
                failure.asking = failure.asking.max(lately);
            }
            let interval = (2 * interval).min(most.max(1));
            self.stage = Stage::Shut { until_probe: interval - 1, interval };
        }
    }

    /// How many objects are in view of a frame that asks.
    pub(super) fn counted(&mut self, objects: f32) {
        self.in_view = objects;
        let Stage::Open { frames, looks, .. } = &mut self.stage else { return };
        let (Some(asking), Some(whole)) = (self.book.asking.lately(), self.book.whole_now(objects)) else {
            return;
        };
        // What the last one took must be paid for, and what the next one will take.
        let price = (LOOK as f32 * (whole - asking)).max(self.look_lost);
        *looks = *frames >= FIRST_LOOK && *frames as f32 * SPEND * asking >= price;
    }

    /// Whether the next frame asks, as far as is known.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.stage, Stage::Trial { .. } | Stage::Open { .. } | Stage::Look { .. })
            || self.blind > BLIND
    }

    /// Where a device never says how long it draws, nothing can be weighed.
    fn is_blind(&mut self, last: Option<FrameCost>) -> bool {
        match last {
            Some(_) => self.blind = 0,
            None if self.book.is_empty() && self.frames > 1 => self.blind = (self.blind + 1).min(BLIND + 1),
            None => {}
        }
        self.blind > BLIND
    }

    /// Whether a gate that is shut sees frames that take longer than asking did. The more trials have
    /// failed, the longer that must have been ago.
    fn drawing_is_dearer(&self) -> bool {
        self.failure.is_some_and(|Failure { asking, wait, waited, .. }| {
            let all = &self.book.drawing_all;
            waited >= wait / 8
                && all.is_settled()
                && all.lately().is_some_and(|lately| lately > DEARER * asking)
        })
    }

    fn enter(&mut self, stage: Stage) {
        self.stages = self.stages.wrapping_add(1);
        self.stage = stage;
    }

    /// Ends a trial or a look, of which so many frames are known.
    fn judge(&mut self, last: FrameCost, number: u32) {
        match self.stage {
            Stage::Trial { .. } if number > 0 => self.judge_trial(number, last),
            Stage::Look { ends_trial, .. } if number >= LOOK => {
                let asking = self.book.asking.lately().unwrap_or(0.0);
                if asking > last.total {
                    // What the next trial would lose, until it is so small a part of the time.
                    let lost = TRIAL as f32 * (asking - last.total) / (SPEND * last.total);
                    self.shut(asking, if ends_trial { lost as u32 } else { 0 });
                } else {
                    self.open(LOOK as f32 * (last.total - asking));
                }
            }
            _ => {}
        }
    }

    fn judge_trial(&mut self, asked: u32, last: FrameCost) {
        let (Some(whole), Some(asking)) = (self.book.whole(self.in_view), self.book.asking.lately()) else {
            return;
        };
        if asked == 1 {
            // It builds what all later ones use.
            return self.book.asking.clear();
        }
        let goes_on = match self.book.asking.trend() {
            // One such frame may have been held up.
            None => {
                let is_ruinous = asking > RUINOUS * whole && asked > 2;
                !is_ruinous && last.total < RUINOUS * RUINOUS * whole
            }
            Some(_) if asking < SURE * whole => return self.open(0.0),
            Some(trend) => {
                let in_the_end = asking * trend.powi(LONGEST_TRIAL.saturating_sub(asked) as i32);
                asking > whole && in_the_end < whole
            }
        };
        if !goes_on {
            self.enter(Stage::Look { drawn: 0, ends_trial: true });
        }
    }

    /// After a look that lost so many seconds.
    fn open(&mut self, lost: f32) {
        if self.failure.take().is_some() {
            self.patience = (self.patience / 2).max(PATIENCE);
        }
        self.look_lost = lost;
        self.enter(Stage::Open { until_count: 0, frames: 0, looks: false });
    }

    /// Asking takes so many seconds a frame; so many frames pass at least before it is tried again.
    fn shut(&mut self, asking: f32, wait: u32) {
        let wait = wait.clamp(self.patience, MOST_PATIENCE);
        self.failure = Some(Failure { hidden: None, asking, wait, waited: 0 });
        self.patience = (2 * self.patience).min(MOST_PATIENCE);
        self.book.drawing_all.clear();
        self.enter(Stage::Shut { until_probe: 0, interval: 1 });
    }

    fn advance(&mut self) -> Plan {
        let is_dearer = self.drawing_is_dearer();
        match &mut self.stage {
            Stage::Shut { until_probe, .. } => {
                if let Some(Failure { wait, waited, .. }) = &mut self.failure {
                    *waited = waited.saturating_add(1);
                    if waited == wait || is_dearer {
                        *until_probe = 0;
                    }
                }
                let probe = *until_probe == 0;
                *until_probe = until_probe.saturating_sub(1);
                Plan::Whole { probe }
            }
            // It is not known yet what there is to beat.
            Stage::Trial { asked: 0 } if self.book.whole(1.0).is_none() => Plan::Whole { probe: false },
            Stage::Trial { asked } => {
                *asked += 1;
                Plan::Ask { count: false }
            }
            Stage::Open { looks: true, .. } => {
                self.enter(Stage::Look { drawn: 1, ends_trial: false });
                Plan::Whole { probe: false }
            }
            Stage::Open { until_count, frames, .. } => {
                *frames += 1;
                let count = *until_count == 0;
                *until_count = until_count.checked_sub(1).unwrap_or(COUNT_EVERY - 1);
                Plan::Ask { count }
            }
            Stage::Look { drawn, .. } => {
                *drawn += 1;
                Plan::Whole { probe: false }
            }
        }
    }
}
