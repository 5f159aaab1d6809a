//! Whether the next frame asks: what asking has cost, against what drawing the whole frustum has.
//!
//! ```text
//!            enough is hidden                asking was faster
//!   ┌──────┐ ───────────────▶ ┌─────────┐ ───────────────────▶ ┌────────┐ in doubt ┌────────┐
//!   │ shut │                  │ trial   │                      │ open   │ ───────▶ │ look   │
//!   │      │ ◀─────────────── │ 8 asked │                      │        │ ◀─────── │ 4 whole│
//!   └──────┘  asking was not  └─────────┘                      └────────┘          └────────┘
//!       ▲                                                          drawing was faster  │
//!       └───────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! Shut, every few frames end with a *probe*, which tells the share of objects that asking could
//! cull. A trial that failed is repeated when half as many again are hidden, or after a wait that
//! doubles each time. Open, the gate knows what an object cost when all were drawn, and counts
//! those in view: only where the two ways come near each other does it look again. So both ways
//! of finding out are as rare as they are dear.

use crate::costs::FrameCost;

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
    /// What the last frame was; None before the first.
    last: Option<Plan>,
    book: Book,
    /// Objects in view, when they were last counted.
    in_view: f32,
    failure: Option<Failure>,
    /// Frames to the next trial after one that fails.
    patience: u32,
    /// Frames to the next look after one that changes nothing.
    look_every: u32,
    /// Frames of which nobody knew what they took, before the first of which somebody did.
    blind: u32,
}

#[derive(Clone, Copy, Debug)]
enum Stage {
    Shut { until_probe: u32, interval: u32 },
    Trial { asked: u32 },
    Open { until_count: u32, until_look: u32, in_doubt: bool },
    Look { drawn: u32 },
}

/// A trial that did not pay.
#[derive(Clone, Copy, Debug)]
struct Failure {
    /// How many objects were hidden, once a probe has told.
    hidden: Option<f32>,
    /// Frames to the next trial if nothing changes.
    wait: u32,
}

/// Frames of a trial: the first half is not judged, in which the policy learns.
const TRIAL: u32 = 8;
/// A frame of a trial that takes so many times what drawing takes ends it.
const RUINOUS: f32 = 3.0;
/// Frames of a look; the last one counts. A device's times are those of frames before.
const LOOK: u32 = 3;
/// Frames from one count of what is in view to the next.
const COUNT_EVERY: u32 = 8;
/// Frames from opening to the first look.
const FIRST_LOOK: u32 = 32;
const LAST_LOOK: u32 = 512;
/// Drawing that would take more than so many times what asking takes is not tried.
const DOUBT: f32 = 1.25;
/// Frames from the first failed trial to the next.
const PATIENCE: u32 = 64;
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
            last: None,
            book: Book::default(),
            in_view: 0.0,
            failure: None,
            patience: PATIENCE,
            look_every: FIRST_LOOK,
            blind: 0,
        }
    }
}

impl Gate {
    /// What the next frame does, after one that took `last`. Once a frame.
    pub(super) fn plan(&mut self, last: Option<FrameCost>) -> Plan {
        if let (Some(cost), Some(plan)) = (last, self.last) {
            self.book.enter(plan, cost, matches!(self.stage, Stage::Look { drawn: LOOK }));
            self.judge(cost);
        }
        let plan = if self.is_blind(last) { Plan::Ask { count: false } } else { self.advance() };
        self.last = Some(plan);
        plan
    }

    /// What a probe found: the share of the objects in view that are hidden, 0 to 1. `question` is
    /// what a question costs, in objects drawn; `most` the most frames to the next probe.
    pub(super) fn probed(&mut self, share: f32, in_view: f32, question: f32, most: u32) {
        let Stage::Shut { interval, .. } = self.stage else { return };
        self.in_view = in_view;
        let hidden = share * in_view;
        let pays = hidden >= FEW && share * IN_VAIN > (1.0 - share) * question / SKIP;
        let is_news = match &mut self.failure {
            None => true,
            Some(Failure { hidden: before, wait }) => {
                let before = *before.get_or_insert(hidden);
                *wait == 0 || hidden > 1.5 * before + FEW
            }
        };
        self.stage = if pays && is_news {
            self.book.asking = None;
            Stage::Trial { asked: 0 }
        } else {
            let interval = (2 * interval).min(most.max(1));
            Stage::Shut { until_probe: interval - 1, interval }
        };
    }

    /// How many objects are in view of a frame that asks.
    pub(super) fn counted(&mut self, objects: f32) {
        self.in_view = objects;
        let Stage::Open { in_doubt, until_look, .. } = &mut self.stage else { return };
        let (Some(asking), Some(whole)) = (self.book.asking, self.book.whole(objects)) else { return };
        *in_doubt = whole < DOUBT * asking;
        if whole < asking {
            *until_look = (*until_look).min(FIRST_LOOK / 2);
        }
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
            None if self.book.is_empty() && self.last.is_some() => {
                self.blind = (self.blind + 1).min(BLIND + 1)
            }
            None => {}
        }
        self.blind > BLIND
    }

    /// Ends a trial or a look.
    fn judge(&mut self, last: FrameCost) {
        match self.stage {
            Stage::Trial { asked } if asked > 0 => {
                let (Some(whole), Some(asking)) = (self.book.whole(self.in_view), self.book.asking) else {
                    return;
                };
                if asked == TRIAL / 2 {
                    self.book.asking = None;
                } else if asked >= TRIAL && asking < whole {
                    self.failure = None;
                    self.patience = PATIENCE;
                    self.look_every = FIRST_LOOK;
                    self.open();
                } else if asked >= TRIAL || asked > 1 && last.total > RUINOUS * whole {
                    self.shut();
                }
            }
            Stage::Look { drawn: LOOK } => {
                if self.book.asking.is_some_and(|asking| asking > last.total) {
                    self.shut();
                } else {
                    self.look_every = (2 * self.look_every).min(LAST_LOOK);
                    self.open();
                }
            }
            _ => {}
        }
    }

    fn open(&mut self) {
        self.stage = Stage::Open { until_count: 0, until_look: self.look_every, in_doubt: false };
    }

    fn shut(&mut self) {
        self.failure = Some(Failure { hidden: None, wait: self.patience });
        self.patience = (2 * self.patience).min(MOST_PATIENCE);
        self.stage = Stage::Shut { until_probe: 0, interval: 1 };
    }

    fn advance(&mut self) -> Plan {
        match &mut self.stage {
            Stage::Shut { until_probe, .. } => {
                if let Some(Failure { wait, .. }) = &mut self.failure {
                    *wait = wait.saturating_sub(1);
                }
                let probe = *until_probe == 0;
                *until_probe = until_probe.saturating_sub(1);
                Plan::Whole { probe }
            }
            // It is not known yet what there is to beat.
            Stage::Trial { asked: 0 } if self.book.object.is_none() => Plan::Whole { probe: false },
            Stage::Trial { asked } => {
                *asked += 1;
                Plan::Ask { count: false }
            }
            Stage::Open { until_look: 0, in_doubt: true, .. } => {
                self.stage = Stage::Look { drawn: 1 };
                Plan::Whole { probe: false }
            }
            Stage::Open { until_count, until_look, .. } => {
                *until_look = until_look.saturating_sub(1);
                let count = *until_count == 0;
                *until_count = until_count.checked_sub(1).unwrap_or(COUNT_EVERY - 1);
                Plan::Ask { count }
            }
            Stage::Look { drawn } => {
                *drawn += 1;
                Plan::Whole { probe: false }
            }
        }
    }
}

/// What frames took.
#[derive(Clone, Debug, Default)]
struct Book {
    /// Of a frame drawn whole, seconds an object.
    object: Option<f32>,
    /// Of a frame that asks, seconds.
    asking: Option<f32>,
    /// Of the drawing of a frame that asks, seconds an object: lately, and when [`Book::object`]
    /// was still new. The first over the second says how much dearer objects have become since.
    drawing: Option<f32>,
    drawing_then: Option<f32>,
}

impl Book {
    fn is_empty(&self) -> bool {
        self.object.is_none() && self.asking.is_none()
    }

    fn enter(&mut self, plan: Plan, cost: FrameCost, is_verdict: bool) {
        let each = |seconds: f32| seconds / cost.drawn.max(1) as f32;
        match plan {
            // A probe is no part of drawing; and the first frame, which has one, is like no other.
            Plan::Whole { probe: true } => {}
            Plan::Whole { probe: false } => {
                let before = self.object.filter(|_| !is_verdict);
                self.object = Some(smooth(before, each(cost.total)));
                (self.drawing, self.drawing_then) = (None, None);
            }
            Plan::Ask { .. } => {
                self.asking = Some(smooth(self.asking, cost.total));
                let drawing = smooth(self.drawing, each(cost.draw));
                self.drawing = Some(drawing);
                self.drawing_then.get_or_insert(drawing);
            }
        }
    }

    /// What a frame would take that draws so many objects and asks nothing, seconds.
    fn whole(&self, objects: f32) -> Option<f32> {
        let dearer = match (self.drawing, self.drawing_then) {
            (Some(now), Some(then)) if then > 0.0 => (now / then).clamp(0.25, 4.0),
            _ => 1.0,
        };
        Some(self.object? * objects * dearer)
    }
}

fn smooth(before: Option<f32>, now: f32) -> f32 {
    const WEIGHT: f32 = 0.25;
    before.map_or(now, |before| before + WEIGHT * (now - before))
}
