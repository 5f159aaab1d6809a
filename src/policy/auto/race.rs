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
//! judged ([`Ways`]), unless they are far too dear.
//!
//! A device tells some frames later what a frame took. Each time is held against the frame that it is of, and
//! nobody waits for it: the duel goes on meanwhile.
//!
//! What it takes to find out is bounded: a duel begins only if those before it have cost no more than
//! [`SHARE`] of all the time so far. A way that lost waits, twice as long each time,
//! and less if it was close. Rivals, who were nearly as fast, have a share of their own: they go first, and need not
//! wait where the champion has become much dearer.

use crate::costs::KEPT;

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
    /// Frames that the champion has run in a row of which the time is known.
    settled: u32,
    /// The time of its last judged frame, seconds, and which frame that was.
    before: f32,
    before_at: u32,
    /// What it took when it was crowned, or when its rivals were last called; and its frames in a row that took
    /// far more.
    crowned: Option<f32>,
    dear: u32,
    /// Seconds of all frames, and what challengers took more than the champion would have: rivals, and others.
    all: f64,
    lost: [f64; 2],
    /// Duels so far.
    pub(super) duels: u32,
    /// Frames so far.
    frame: u32,
    /// The last of them, by number, modulo how many are kept.
    runs: [Option<Run>; KEPT],
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
    turn: Turn,
    /// Frames of the turn under way.
    frames: u32,
    round: usize,
    /// By round: the challenger's judged frame, and its time in seconds.
    times: [Option<(u32, f32)>; MOST_ROUNDS],
    /// Of the rounds of which both times are known.
    ratios: [f32; ROUNDS],
    fought: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    Challenger,
    Champion,
}

/// A frame whose time may still come.
#[derive(Clone, Copy, Debug)]
struct Run {
    frame: u32,
    way: usize,
    /// In which duel, whose turn and in which round; None for the champion alone.
    duel: Option<(u32, Turn, usize)>,
    is_judged: bool,
}

/// Frames of the champion before the first duel, and between two of them.
const REST: u32 = 4;
/// Of which the middle one counts.
const ROUNDS: usize = 3;
/// Times may be lost on their way: then there are more rounds, up to so many.
const MOST_ROUNDS: usize = 6;
/// A challenger must be so much faster: times are noisy, and a change costs some frames.
const MARGIN: f32 = 0.95;
/// A judged frame that takes so many times the champion's ends a duel.
const RUINOUS: f32 = 1.75;
/// And so does one in which the challenger learns.
const HOPELESS: f32 = 4.0;
/// Of all time, what losers may take more than the champion would have, beside
/// [`ADVANCE`] of its frames.
const SHARE: f64 = 0.03;
const ADVANCE: f64 = 1.5;
/// By how much a loser's time must be the longer for it to wait out its patience.
const FAR_SLOWER: f32 = 0.5;
const PATIENCE: f32 = 64.0;
const MOST_PATIENCE: f32 = 1024.0;
/// Frames until an old champion may challenge the new one: times are noisy, and views turn.
const REMATCH: u32 = 6;
/// A rival's time over the champion's, at most.
const RIVAL: f32 = 1.5;
/// A champion that takes so many times what it took when it was crowned, so many frames in a row, is challenged by
/// its rivals at once.
const DEARER: f32 = 1.5;
const DEAR_FRAMES: u32 = 2;

impl Record {
    /// Whether it was nearly as fast as the champion: to try it again costs little.
    fn is_rival(&self) -> bool {
        self.ratio.is_some_and(|ratio| ratio < RIVAL)
    }
}

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
            before_at: 0,
            crowned: None,
            dear: 0,
            all: 0.0,
            lost: [0.0; 2],
            duels: 0,
            frame: 0,
            runs: [None; KEPT],
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

    /// Chooses the way of the next frame, given what an earlier one took in seconds, and how many frames ago
    /// that was; None if nobody knows: then nothing is learnt. Once a frame.
    pub(super) fn next(&mut self, known: Option<(f32, u32)>, ways: &impl Ways) -> usize {
        self.frame = self.frame.wrapping_add(1);
        self.ways.iter_mut().for_each(|way| way.wait = way.wait.saturating_sub(1));
        if let Some((time, ago)) = known {
            let frame = self.frame.wrapping_sub(ago);
            let run = self.runs[frame as usize % KEPT].take_if(|run| run.frame == frame);
            if let Some(run) = run {
                self.take(run, time);
                if self.duel.is_none() && self.settled > ways.learns(self.champion)[1] + REST {
                    self.challenge(ways);
                }
            }
        }
        let run = self.run(ways);
        self.runs[run.frame as usize % KEPT] = Some(run);
        run.way
    }

    /// Whether there is still something left for rivals, or for the others.
    fn can_afford(&self, others: bool) -> bool {
        self.lost[usize::from(others)] <= SHARE * self.all + ADVANCE * f64::from(self.before)
    }

    /// Lets the first of those challenge who have waited long enough: rivals, who were nearly as fast, then those
    /// who never have.
    fn challenge(&mut self, ways: &impl Ways) {
        let can_afford = [false, true].map(|others| self.can_afford(others));
        let may = |&n: &usize| {
            let way = &self.ways[n];
            n != self.champion && way.wait == 0 && ways.admits(n) && can_afford[usize::from(!way.is_rival())]
        };
        let challengers = (0..self.ways.len()).filter(may);
        let order = |&n: &usize| match &self.ways[n] {
            way if way.is_rival() => (0, n),
            Record { ratio: None, .. } => (1, n),
            _ => (2, n),
        };
        if let Some(challenger) = challengers.min_by_key(order) {
            self.duels += 1;
            self.duel = Some(Duel {
                challenger,
                turn: Turn::Challenger,
                frames: 0,
                round: 0,
                times: [None; MOST_ROUNDS],
                ratios: [0.0; ROUNDS],
                fought: 0,
            });
        }
    }

    /// Whose the next frame is.
    fn run(&mut self, ways: &impl Ways) -> Run {
        let (frame, champion) = (self.frame, self.champion);
        let Some(duel) = &mut self.duel else {
            return Run { frame, way: champion, duel: None, is_judged: true };
        };
        duel.frames += 1;
        let of = (self.duels, duel.turn, duel.round);
        let (way, learns) = match duel.turn {
            Turn::Challenger => (duel.challenger, ways.learns(duel.challenger)[usize::from(duel.round > 0)]),
            // Times of enough rounds are on their way: the champion runs until they come, or never will.
            Turn::Champion if duel.round >= ROUNDS && duel.frames <= KEPT as u32 => (champion, KEPT as u32),
            Turn::Champion => (champion, ways.learns(champion)[1]),
        };
        let is_judged = duel.frames > learns;
        if is_judged {
            duel.frames = 0;
            match duel.turn {
                Turn::Challenger => duel.turn = Turn::Champion,
                Turn::Champion => {
                    duel.round += 1;
                    // After enough of them it stays the champion's turn for a while.
                    duel.turn = if duel.round == ROUNDS { Turn::Champion } else { Turn::Challenger };
                }
            }
        }
        let (is_over, challenger) = (duel.round >= MOST_ROUNDS, duel.challenger);
        let run = Run { frame, way, duel: Some(of), is_judged };
        if is_over {
            // So many times were lost that nobody won.
            self.put_off(challenger, 0.5);
        }
        run
    }

    /// Takes over what a frame took.
    fn take(&mut self, run: Run, time: f32) {
        self.all += f64::from(time);
        if run.way != self.champion {
            let others = usize::from(!self.ways[run.way].is_rival());
            self.lost[others] += f64::from((time - self.before).max(0.0));
        }
        let Some((number, turn, round)) = run.duel else {
            if run.way == self.champion {
                self.settled += 1;
                (self.before, self.before_at) = (time, run.frame);
                let crowned = *self.crowned.get_or_insert(time);
                self.dear = if time > DEARER * crowned { self.dear + 1 } else { 0 };
                if self.dear >= DEAR_FRAMES {
                    (self.crowned, self.dear) = (Some(time), 0);
                    self.ways.iter_mut().filter(|way| way.is_rival()).for_each(|way| way.wait = 0);
                }
            }
            return;
        };
        let Some(duel) = self.duel.as_mut().filter(|_| number == self.duels) else { return };
        let ratio = time / self.before;
        match turn {
            Turn::Challenger if ratio > if run.is_judged { RUINOUS } else { HOPELESS } => {
                self.defeat(run.way, ratio);
            }
            Turn::Challenger if run.is_judged => duel.times[round] = Some((run.frame, time)),
            Turn::Champion if run.is_judged => {
                let (before, before_at) = (self.before, self.before_at);
                (self.before, self.before_at) = (time, run.frame);
                let Some((at, theirs)) = duel.times[round] else { return };
                let since = |frame: u32| frame.wrapping_sub(before_at) as f32;
                let meanwhile = before + since(at) / since(run.frame) * (time - before);
                duel.ratios[duel.fought] = theirs / meanwhile;
                duel.fought += 1;
                let fought = &mut duel.ratios[..duel.fought];
                let won = fought.iter().filter(|&&ratio| ratio < MARGIN).count();
                if won > ROUNDS / 2 || duel.fought - won > ROUNDS / 2 {
                    fought.sort_unstable_by(f32::total_cmp);
                    let ratio = fought[if won > ROUNDS / 2 { won - 1 } else { won }];
                    let challenger = duel.challenger;
                    self.end(challenger, ratio);
                }
            }
            _ => {}
        }
    }

    fn end(&mut self, challenger: usize, ratio: f32) {
        if ratio < MARGIN { self.victory(challenger, ratio) } else { self.defeat(challenger, ratio) }
    }

    fn defeat(&mut self, challenger: usize, ratio: f32) {
        self.ways[challenger].ratio = Some(ratio);
        // Who lost by little may soon be the better one.
        self.put_off(challenger, ((ratio - MARGIN) / FAR_SLOWER).clamp(0.125, 1.0));
    }

    /// Ends a duel: the challenger waits for a part of its patience, which grows.
    fn put_off(&mut self, challenger: usize, part: f32) {
        let way = &mut self.ways[challenger];
        way.wait = (way.patience * part) as u32;
        way.patience = (way.patience * (1.0 + part)).min(MOST_PATIENCE);
        self.settle();
    }

    fn victory(&mut self, challenger: usize, ratio: f32) {
        let old = std::mem::replace(&mut self.champion, challenger);
        (self.crowned, self.dear) = (None, 0);
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
mod tests;
