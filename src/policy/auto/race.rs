//! Which way is fastest: duels between the one in use and the others, by the times that frames took.
//!
//! ```text
//!            the next challenger's turn       it ran 6 frames         the champion ran 4 more
//!  ┌────────┐ ───────────────────▶ ┌───────┐ ────────────────▶ ┌──────┐ ─────────────┐
//!  │ steady │                      │ trial │                   │ back │  who was faster is
//!  └────────┘                      └───────┘                   └──────┘  champion now │
//!      ▲  ▲      it is far slower      │                                              │
//!      │  └────────────────────────────┘                                              │
//!      └──────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! Views and worlds change while a race is on, so times are compared with those of the frames just
//! before and just after. The first frames after a change of ways are not judged: a policy must see the
//! scene before it can cull, and a device's times are those of frames before. A way that lost waits
//! twice as long for its next duel, so that a race costs little where nothing changes.

/// Ways that race against each other, by number.
#[derive(Clone, Debug)]
pub(super) struct Race {
    champion: usize,
    stage: Stage,
    ways: Vec<Record>,
    /// Frames that the champion has run in a row, as far as they count.
    settled: u32,
    /// The champion's time lately, seconds.
    lately: f32,
    /// Duels so far.
    pub(super) duels: u32,
}

/// What is known of a way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Its time over the champion's of then, in its last duel.
    pub(super) ratio: Option<f32>,
    /// Frames until it may challenge.
    wait: u32,
    /// Frames from its next defeat to its next duel.
    patience: u32,
}

#[derive(Clone, Copy, Debug)]
enum Stage {
    Steady,
    Trial { challenger: usize, frames: u32, sum: f32 },
    Back { challenger: usize, frames: u32, sum: f32, trial: f32 },
}

/// Frames of the champion that count before the first duel, and between two of them.
const REST: u32 = 4;
/// Frames of a trial, and those of them that are not judged.
const TRIAL: u32 = 6;
const LEARNING: u32 = 3;
/// Frames of the champion after a trial, and those of them that are not judged.
const BACK: u32 = 4;
const RELEARNING: u32 = 2;
/// A challenger must be so much faster: times are noisy, and a change costs some frames.
const MARGIN: f32 = 0.95;
/// A frame of a trial, but the first, that takes so many times the champion's ends it.
const RUINOUS: f32 = 2.5;
const PATIENCE: u32 = 64;
const MOST_PATIENCE: u32 = 2048;
/// How much a new frame counts in [`Race::lately`].
const WEIGHT: f32 = 0.25;

impl Race {
    /// A race of so many ways. The first is champion until another is faster.
    pub(super) fn new(ways: usize) -> Self {
        let new = Record { ratio: None, wait: 0, patience: PATIENCE };
        Self { champion: 0, stage: Stage::Steady, ways: vec![new; ways], settled: 0, lately: 0.0, duels: 0 }
    }

    /// The way that is in use while nobody challenges it.
    pub(super) fn champion(&self) -> usize {
        self.champion
    }

    /// What is known of the ways.
    pub(super) fn records(&self) -> &[Record] {
        &self.ways
    }

    /// Chooses the way of the next frame, after one that took `last` seconds; None if nobody knows: then
    /// nothing is learnt, and no duel begins. Only ways that are `admitted` challenge. Once a frame.
    pub(super) fn next(&mut self, last: Option<f32>, admitted: impl Fn(usize) -> bool) -> usize {
        self.ways.iter_mut().for_each(|way| way.wait = way.wait.saturating_sub(1));
        let Some(last) = last else { return self.running() };
        match &mut self.stage {
            Stage::Steady => {
                self.lately = match self.settled {
                    // The frames in which it learns.
                    0..RELEARNING => last,
                    _ => self.lately + WEIGHT * (last - self.lately),
                };
                self.settled += 1;
                if self.settled > RELEARNING + REST {
                    self.challenge(admitted);
                }
            }
            Stage::Trial { challenger, frames, sum } => {
                *frames += 1;
                if *frames > LEARNING {
                    *sum += last;
                }
                if *frames > 1 && last > RUINOUS * self.lately {
                    let (challenger, ratio) = (*challenger, last / self.lately);
                    self.defeat(challenger, ratio);
                } else if *frames == TRIAL {
                    let trial = *sum / (TRIAL - LEARNING) as f32;
                    self.stage = Stage::Back { challenger: *challenger, frames: 0, sum: 0.0, trial };
                }
            }
            Stage::Back { challenger, frames, sum, trial } => {
                *frames += 1;
                if *frames > RELEARNING {
                    *sum += last;
                }
                if *frames == BACK {
                    let after = *sum / (BACK - RELEARNING) as f32;
                    let (challenger, ratio) = (*challenger, 2.0 * *trial / (self.lately + after));
                    if ratio < MARGIN {
                        self.victory(challenger, ratio)
                    } else {
                        self.defeat(challenger, ratio)
                    }
                }
            }
        }
        self.running()
    }

    fn running(&self) -> usize {
        match self.stage {
            Stage::Trial { challenger, .. } => challenger,
            _ => self.champion,
        }
    }

    /// Lets the first of those challenge who have waited long enough; who never has goes first.
    fn challenge(&mut self, admitted: impl Fn(usize) -> bool) {
        let may = |&n: &usize| n != self.champion && self.ways[n].wait == 0 && admitted(n);
        let challengers = (0..self.ways.len()).filter(may);
        if let Some(challenger) = challengers.min_by_key(|&n| (self.ways[n].ratio.is_some(), n)) {
            self.duels += 1;
            self.stage = Stage::Trial { challenger, frames: 0, sum: 0.0 };
        }
    }

    fn defeat(&mut self, challenger: usize, ratio: f32) {
        let way = &mut self.ways[challenger];
        (way.ratio, way.wait) = (Some(ratio), way.patience);
        way.patience = (2 * way.patience).min(MOST_PATIENCE);
        self.settle();
    }

    fn victory(&mut self, challenger: usize, ratio: f32) {
        let old = std::mem::replace(&mut self.champion, challenger);
        let wait = PATIENCE;
        self.ways[old] = Record { ratio: Some(1.0 / ratio), wait, patience: 2 * wait };
        // The others lost against another one: their ratios are to the new champion's time now.
        for (n, way) in self.ways.iter_mut().enumerate().filter(|&(n, _)| n != old) {
            way.ratio = if n == challenger { None } else { way.ratio.map(|before| before / ratio) };
        }
        self.settle();
    }

    fn settle(&mut self) {
        (self.stage, self.settled) = (Stage::Steady, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a race in which each way takes a time a frame, and returns who ran how often.
    fn run(race: &mut Race, frames: usize, time: impl Fn(usize, usize) -> f32) -> Vec<usize> {
        let mut ran = vec![0; race.ways.len()];
        let mut last = None;
        for frame in 0..frames {
            let way = race.next(last, |_| true);
            ran[way] += 1;
            last = Some(time(way, frame));
        }
        ran
    }

    #[test]
    fn the_fastest_wins_and_the_others_seldom_run() {
        let mut race = Race::new(4);
        let ran = run(&mut race, 1000, |way, _| [4.0, 3.0, 2.0, 2.5][way]);
        assert_eq!(race.champion(), 2);
        assert!(ran[2] > 850, "{ran:?}");
        let ratios: Vec<_> = race.records().iter().map(|record| record.ratio).collect();
        assert_eq!(ratios[2], None);
        assert!(ratios[3].is_some_and(|ratio| (ratio - 1.25).abs() < 0.01), "{ratios:?}");
    }

    #[test]
    fn what_grows_dearer_for_all_is_no_ones_merit() {
        // The view wanders into a dearer place: each frame takes a twentieth more than the one before.
        let mut race = Race::new(2);
        run(&mut race, 100, |_, frame| 1.05f32.powi(frame as i32));
        assert_eq!(race.champion(), 0);
    }

    #[test]
    fn a_ruinous_trial_is_short() {
        let mut race = Race::new(2);
        let ran = run(&mut race, 60, |way, _| [1.0, 10.0][way]);
        assert!(ran[1] <= 2, "{ran:?}");
    }

    #[test]
    fn a_champion_that_falls_behind_is_found_out() {
        let mut race = Race::new(2);
        run(&mut race, 200, |way, _| [1.0, 2.0][way]);
        assert_eq!(race.champion(), 0);
        let mut frames = 0;
        let mut last = None;
        while race.champion() == 0 {
            let way = race.next(last, |_| true);
            last = Some([3.0, 2.0][way]);
            frames += 1;
            assert!(frames < 600, "nobody noticed");
        }
    }

    #[test]
    fn without_times_nothing_happens() {
        let mut race = Race::new(3);
        assert!((0..100).all(|_| race.next(None, |_| true) == 0));
        assert_eq!(race.duels, 0);
    }

    #[test]
    fn who_is_not_admitted_does_not_run() {
        let mut race = Race::new(3);
        let mut last = None;
        for _ in 0..500 {
            let way = race.next(last, |way| way != 1);
            assert_ne!(way, 1);
            last = Some([3.0, 1.0, 2.0][way]);
        }
        assert_eq!(race.champion(), 2);
    }
}
