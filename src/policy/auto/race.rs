//! Which way is fastest: duels between the one in use and the others, by the times that frames took.
//!
//! ```text
//!            the next challenger's turn         two of three rounds are one's
//!  ┌────────┐ ───────────────────▶ ┌───────────────────────┐ ────────────────┐
//!  │ steady │                      │ challenger ◀▶ champion │  whose they are │
//!  └────────┘                      └───────────────────────┘  is champion now │
//!      ▲  it is far slower: it lost    │                                      │
//!      └───────────────────────────────┴──────────────────────────────────────┘
//! ```
//!
//! Views and worlds change while a race is on, so the two take turns, a frame each where that does, and a
//! challenger's frame is compared with what lies between the champion's just before and just after it. Three rounds are
//! fought, of which the middle one counts: two suffice if they agree. Frames in which a way learns are not
//! judged, nor those whose time a device tells too late ([`Ways`]).
//!
//! What it takes to find out is bounded: a duel begins only if those before it have cost no more than
//! [`SHARE`] of all the time so far. A way that lost waits, twice as long each time,
//! and less if it was close.

/// What a race must know of its ways.
pub(super) trait Ways {
    /// Whether it may challenge now.
    fn admits(&self, way: usize) -> bool;

    /// Its frames that are not judged when it is tried, and in later rounds or when it comes back.
    fn learns(&self, way: usize) -> [u32; 2];
}

/// Ways that race against each other, by number.
#[derive(Clone, Debug)]
pub(super) struct Race {
    champion: usize,
    duel: Option<Duel>,
    ways: Vec<Record>,
    /// Frames that the champion has run in a row.
    settled: u32,
    /// The time of its last judged frame, seconds.
    before: f32,
    /// Seconds of all frames, and what challengers took more than the champion would have.
    all: f64,
    lost: f64,
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
    /// Frames from its next defeat to its next duel, if that is a clear one.
    patience: f32,
}

/// A challenger's turns and the champion's.
#[derive(Clone, Copy, Debug)]
struct Duel {
    challenger: usize,
    /// Frames of the turn under way.
    frames: u32,
    turn: Turn,
    /// The challenger's time of this round, seconds, and how many frames after the champion's.
    time: f32,
    after: u32,
    ratios: [f32; ROUNDS],
    fought: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    Challenger,
    Champion,
}

/// Frames of the champion before the first duel, and between two of them.
const REST: u32 = 4;
/// Of which the middle one counts.
const ROUNDS: usize = 3;
/// Frames until a device tells what a frame took.
const LATE: u32 = 3;
/// A challenger must be so much faster: times are noisy, and a change costs some frames.
const MARGIN: f32 = 0.95;
/// A judged frame that takes so many times the champion's ends a duel.
const RUINOUS: f32 = 1.75;
/// Of all time, what losers may take more than the champion would have, beside
/// [`ADVANCE`] of its frames.
const SHARE: f64 = 0.03;
const ADVANCE: f64 = 1.5;
/// By how much a loser's time must be the longer for it to wait out its patience.
const FAR_SLOWER: f32 = 0.5;
const PATIENCE: f32 = 64.0;
const MOST_PATIENCE: f32 = 1024.0;
/// Frames until an old champion may challenge the new one: times are noisy, and views turn.
const REMATCH: u32 = 12;

impl Race {
    /// A race of so many ways. The first is champion until another is faster.
    pub(super) fn new(ways: usize) -> Self {
        let new = Record { ratio: None, wait: 0, patience: PATIENCE };
        Self {
            champion: 0,
            duel: None,
            ways: vec![new; ways],
            settled: 0,
            before: 0.0,
            all: 0.0,
            lost: 0.0,
            duels: 0,
        }
    }

    /// The way that is in use while nobody challenges it.
    pub(super) fn champion(&self) -> usize {
        self.champion
    }

    /// What is known of the ways.
    pub(super) fn records(&self) -> &[Record] {
        &self.ways
    }

    /// Chooses the way of the next frame, after one that took `last` seconds, which a device may tell
    /// `late`; None if nobody knows: then nothing is learnt, and no duel begins. Once a frame.
    pub(super) fn next(&mut self, last: Option<f32>, late: bool, ways: &impl Ways) -> usize {
        self.ways.iter_mut().for_each(|way| way.wait = way.wait.saturating_sub(1));
        let Some(last) = last else { return self.running() };
        self.all += f64::from(last);
        let late = if late { LATE } else { 0 };
        match self.duel {
            None => {
                self.before = last;
                self.settled += 1;
                if self.settled > ways.learns(self.champion)[1] + late + REST && self.can_afford() {
                    self.challenge(ways);
                }
            }
            Some(duel) => self.fight(duel, last, late, ways),
        }
        self.running()
    }

    fn running(&self) -> usize {
        match self.duel {
            Some(Duel { turn: Turn::Challenger, challenger, .. }) => challenger,
            _ => self.champion,
        }
    }

    fn can_afford(&self) -> bool {
        self.lost <= SHARE * self.all + ADVANCE * f64::from(self.before)
    }

    /// Lets the first of those challenge who have waited long enough; who never has goes first.
    fn challenge(&mut self, ways: &impl Ways) {
        let may = |&n: &usize| n != self.champion && self.ways[n].wait == 0 && ways.admits(n);
        let challengers = (0..self.ways.len()).filter(may);
        if let Some(challenger) = challengers.min_by_key(|&n| (self.ways[n].ratio.is_some(), n)) {
            self.duels += 1;
            let turn = Turn::Challenger;
            self.duel = Some(Duel {
                challenger,
                frames: 0,
                turn,
                time: 0.0,
                after: 0,
                ratios: [0.0; ROUNDS],
                fought: 0,
            });
        }
    }

    /// Takes over a frame of a duel.
    fn fight(&mut self, mut duel: Duel, last: f32, late: u32, ways: &impl Ways) {
        duel.frames += 1;
        match duel.turn {
            Turn::Challenger => {
                self.lost += f64::from((last - self.before).max(0.0));
                let ratio = last / self.before;
                let learns = ways.learns(duel.challenger)[usize::from(duel.fought > 0)];
                if duel.frames > learns + late {
                    if ratio > RUINOUS {
                        return self.defeat(duel.challenger, ratio);
                    }
                    (duel.time, duel.after) = (last, duel.frames);
                    (duel.turn, duel.frames) = (Turn::Champion, 0);
                }
            }
            Turn::Champion if duel.frames > ways.learns(self.champion)[1] + late => {
                let share = duel.after as f32 / (duel.after + duel.frames) as f32;
                let meanwhile = self.before + share * (last - self.before);
                duel.ratios[duel.fought] = duel.time / meanwhile;
                duel.fought += 1;
                self.before = last;
                let fought = &mut duel.ratios[..duel.fought];
                let won = fought.iter().filter(|&&ratio| ratio < MARGIN).count();
                if won > ROUNDS / 2 || duel.fought - won > ROUNDS / 2 {
                    fought.sort_unstable_by(f32::total_cmp);
                    let ratio = fought[if won > ROUNDS / 2 { won - 1 } else { won }];
                    return self.end(duel.challenger, ratio);
                }
                (duel.turn, duel.frames) = (Turn::Challenger, 0);
            }
            Turn::Champion => {}
        }
        self.duel = Some(duel);
    }

    fn end(&mut self, challenger: usize, ratio: f32) {
        if ratio < MARGIN { self.victory(challenger, ratio) } else { self.defeat(challenger, ratio) }
    }

    fn defeat(&mut self, challenger: usize, ratio: f32) {
        let way = &mut self.ways[challenger];
        // Who lost by little may soon be the better one.
        let by = ((ratio - MARGIN) / FAR_SLOWER).clamp(0.125, 1.0);
        (way.ratio, way.wait) = (Some(ratio), (way.patience * by) as u32);
        way.patience = (way.patience * (1.0 + by)).min(MOST_PATIENCE);
        self.settle();
    }

    fn victory(&mut self, challenger: usize, ratio: f32) {
        let old = std::mem::replace(&mut self.champion, challenger);
        self.ways[old] = Record { ratio: Some(1.0 / ratio), wait: REMATCH, patience: PATIENCE };
        // The others lost against another one: their ratios are to the new champion's time now.
        for (n, way) in self.ways.iter_mut().enumerate().filter(|&(n, _)| n != old) {
            way.ratio = if n == challenger { None } else { way.ratio.map(|before| before / ratio) };
        }
        self.settle();
    }

    fn settle(&mut self) {
        (self.duel, self.settled) = (None, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All but one are admitted.
    struct But(usize);

    impl Ways for But {
        fn admits(&self, way: usize) -> bool {
            way != self.0
        }

        fn learns(&self, way: usize) -> [u32; 2] {
            if way.is_multiple_of(2) { [0, 0] } else { [3, 1] }
        }
    }

    const ALL: But = But(usize::MAX);

    /// Runs a race in which each way takes a time a frame, and returns who ran how often.
    fn run(race: &mut Race, frames: usize, time: impl Fn(usize, usize) -> f32) -> Vec<usize> {
        let mut ran = vec![0; race.ways.len()];
        let mut last = None;
        for frame in 0..frames {
            let way = race.next(last, false, &ALL);
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
        // The view wanders into a dearer place, and out of it: a tenth a frame, and one in three differs.
        for growth in [1.1f32, 0.91] {
            let mut race = Race::new(2);
            run(&mut race, 100, |_, frame| {
                growth.powi(frame as i32) * if frame % 3 == 0 { 1.04 } else { 1.0 }
            });
            assert_eq!(race.champion(), 0);
        }
    }

    #[test]
    fn a_ruinous_challenger_runs_once() {
        let mut race = Race::new(3);
        let ran = run(&mut race, 60, |way, _| [1.0, 1.0, 10.0][way]);
        assert_eq!(ran[2], 1, "{ran:?}");
    }

    #[test]
    fn trials_take_no_more_than_their_share() {
        let times = [1.0, 1.5, 1.6, 1.5, 1.7, 1.5];
        for frames in [60, 600, 6000] {
            let mut race = Race::new(times.len());
            let ran = run(&mut race, frames, |way, _| times[way]);
            let all: f32 = ran.iter().zip(times).map(|(&frames, time)| frames as f32 * time).sum();
            // One duel may begin while there is still something left.
            let most = frames as f32 * 1.03 + 1.5 + 6.0 * 0.7;
            assert!(all < most && ran[1] > 0, "{all} of {frames}: {ran:?}");
        }
    }

    #[test]
    fn what_a_device_tells_late_is_not_taken_for_anothers() {
        let times = [3.0, 2.0, 4.0];
        let (mut race, mut ran) = (Race::new(3), vec![0; 4]);
        for _ in 0..300 {
            // What is told is the time of three frames ago.
            let told = times[ran[ran.len() - 3]];
            ran.push(race.next(Some(told), true, &ALL));
        }
        assert_eq!(race.champion(), 1, "{ran:?}");
        let last = ran[ran.len() - 100..].iter().filter(|&&way| way == 1).count();
        assert!(last > 80, "{ran:?}");
    }

    #[test]
    fn a_champion_that_falls_behind_is_found_out() {
        let mut race = Race::new(2);
        run(&mut race, 200, |way, _| [1.0, 2.0][way]);
        assert_eq!(race.champion(), 0);
        let mut frames = 0;
        let mut last = None;
        while race.champion() == 0 {
            let way = race.next(last, false, &ALL);
            last = Some([3.0, 2.0][way]);
            frames += 1;
            assert!(frames < 600, "nobody noticed");
        }
    }

    #[test]
    fn without_times_nothing_happens() {
        let mut race = Race::new(3);
        assert!((0..100).all(|_| race.next(None, false, &ALL) == 0));
        assert_eq!(race.duels, 0);
    }

    #[test]
    fn who_is_not_admitted_does_not_run() {
        let mut race = Race::new(3);
        let mut last = None;
        for _ in 0..500 {
            let way = race.next(last, false, &But(1));
            assert_ne!(way, 1);
            last = Some([3.0, 1.0, 2.0][way]);
        }
        assert_eq!(race.champion(), 2);
    }
}
