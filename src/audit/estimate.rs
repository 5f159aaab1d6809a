//! What the checked frames say of all frames.
//!
//! Whether a frame lost something, and how much of its picture is wrong, are numbers from 0 to 1. For the
//! mean of n independent ones, however they are distributed, Hoeffding (1963, theorem 1) bounds how
//! far the mean x that was seen lies from the true one, μ: a mean as small as x, or as large, comes with a
//! probability of at most exp(−n·D(x‖μ)), where D(x‖μ) = x·ln(x/μ) + (1−x)·ln((1−x)/(1−μ)). The ends of
//! [`Share`] are the μ at which that is 1/20. Where nothing was seen (x = 0) the upper end is
//! 1 − 20^(−1/n), just below 3/n: the *rule of three*.
//!
//! The price of asking nothing of the distribution is width: ten frames that are a little wrong do not show
//! that none is wrong altogether. So one thing is asked of it: that no frame has [`BEYOND`] times as
//! many wrong pixels as the worst that was checked, if that has any. Shares of that are numbers from 0
//! to 1 again. And frames are not quite independent: neighbours look alike.
//! Frames that are checked a second apart say more than as many in a row, for which the interval is
//! too narrow.

use std::collections::BTreeMap;
use std::fmt;

use super::{Audit, Blame};

/// The probability that the truth lies beyond one end of an interval, at most; the same for the other.
const DOUBT: f64 = 0.05;

/// How much worse a frame may be than the worst that was checked.
const BEYOND: f64 = 10.0;

/// A mean of what lies between 0 and 1, and where the true one lies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Share {
    /// The mean of the checked frames.
    pub mean: f64,
    /// The mean of all frames is below this in one of twenty such runs at most.
    pub low: f64,
    /// The mean of all frames is above this in one of twenty such runs at most.
    pub high: f64,
}

/// The running estimate of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Frames checked so far.
    pub frames: u32,
    /// The share of frames in which an object was lost.
    pub lossy_frames: Share,
    /// The share of a frame's pixels that are wrong; `low` and `high` hold as long as no frame is ten times
    /// as wrong as the worst that was checked.
    pub wrong_share: Share,
    /// The same in the worst of the checked frames.
    pub worst_wrong_share: f64,
    /// False culls in all checked frames; an object that is lost in two counts twice.
    pub lost: u64,
    /// False culls in the worst of them.
    pub worst_lost: u32,
}

/// The sums behind an estimate.
#[derive(Debug, Default)]
pub(super) struct Tally {
    frames: u32,
    lossy: u32,
    wrong: f64,
    worst_wrong_share: f64,
    lost: u64,
    worst_lost: u32,
    blamed: BTreeMap<Blame, u64>,
}

impl Tally {
    /// Takes a checked frame.
    pub(super) fn add(&mut self, audit: &Audit) {
        let lost = audit.lost.len() as u32;
        self.frames += 1;
        self.lossy += u32::from(lost > 0);
        self.wrong += audit.wrong_share();
        self.worst_wrong_share = self.worst_wrong_share.max(audit.wrong_share());
        self.lost += u64::from(lost);
        self.worst_lost = self.worst_lost.max(lost);
        for lost in &audit.lost {
            *self.blamed.entry(lost.blame).or_default() += 1;
        }
    }

    /// False culls by what is to blame.
    pub(super) fn blamed(&self) -> impl Iterator<Item = (Blame, u64)> {
        self.blamed.iter().map(|(&blame, &lost)| (blame, lost))
    }

    /// What they come to.
    pub(super) fn estimate(&self) -> Estimate {
        Estimate {
            frames: self.frames,
            lossy_frames: Share::of(f64::from(self.lossy), self.frames),
            wrong_share: match (BEYOND * self.worst_wrong_share).min(1.0) {
                0.0 => Share::of(self.wrong, self.frames),
                most => Share::of(self.wrong / most, self.frames).times(most),
            },
            worst_wrong_share: self.worst_wrong_share,
            lost: self.lost,
            worst_lost: self.worst_lost,
        }
    }
}

impl Estimate {
    /// False culls a frame. Zero before the first.
    pub fn lost_per_frame(&self) -> f64 {
        self.lost as f64 / f64::from(self.frames.max(1))
    }
}

impl Share {
    /// From the sum of `n` numbers between 0 and 1.
    fn of(sum: f64, n: u32) -> Self {
        let n = f64::from(n);
        let mean = (sum / n.max(1.0)).clamp(0.0, 1.0);
        let is_beyond = |bound: f64| n * divergence(mean, bound) > -DOUBT.ln();
        Self { mean, low: farthest(mean, 0.0, is_beyond), high: farthest(mean, 1.0, is_beyond) }
    }
}

impl Share {
    fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, low: self.low * factor, high: self.high * factor }
    }
}

/// D(x‖μ), with 0·ln 0 = 0.
fn divergence(x: f64, mu: f64) -> f64 {
    let term = |x: f64, mu: f64| if x == 0.0 { 0.0 } else { x * (x / mu).ln() };
    term(x, mu) + term(1.0 - x, 1.0 - mu)
}

/// Where it begins to hold between `from` and `to`, rounded toward `to`.
fn farthest(from: f64, to: f64, is_beyond: impl Fn(f64) -> bool) -> f64 {
    let (mut within, mut beyond) = (from, to);
    for _ in 0..64 {
        let middle = 0.5 * (within + beyond);
        if is_beyond(middle) { beyond = middle } else { within = middle }
    }
    beyond
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} % ({} to {} %)", percent(self.mean), percent(self.low), percent(self.high))
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.frames, self.lost) {
            (0, _) => write!(f, "no frame was checked yet"),
            (frames, 0) => {
                let high = percent(self.lossy_frames.high);
                write!(f, "{frames} frames checked, nothing lost: at most {high} % of frames lose something")
            }
            (frames, lost) => write!(
                f,
                "{frames} frames checked, {lost} false culls in {} of frames; pixels wrong: {}, {} % at worst",
                self.lossy_frames,
                self.wrong_share,
                percent(self.worst_wrong_share)
            ),
        }
    }
}

/// A share in per cent, as short as it can be read: two digits that say something.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if p >= 10.0 => format!("{p:.0}"),
        p if p >= 1.0 => format!("{p:.1}"),
        0.0 => "0".to_owned(),
        p if p < 1e-4 => "<0.0001".to_owned(),
        p => format!("{p:.*}", (1.0 - p.log10().floor()) as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_lost_is_the_rule_of_three() {
        for n in [1, 10, 100, 1000] {
            let share = Share::of(0.0, n);
            assert_eq!((share.mean, share.low), (0.0, 0.0));
            assert!((share.high - (1.0 - 0.05f64.powf(1.0 / f64::from(n)))).abs() < 1e-12);
            assert!(share.high <= 3.0 / f64::from(n) && (n < 10 || share.high > 2.5 / f64::from(n)));
        }
    }

    #[test]
    fn before_the_first_frame_nothing_is_known() {
        assert_eq!(Share::of(0.0, 0), Share { mean: 0.0, low: 0.0, high: 1.0 });
        assert_eq!(Tally::default().estimate().to_string(), "no frame was checked yet");
    }

    #[test]
    fn the_ends_lie_where_the_bound_is_a_twentieth() {
        for (sum, n) in [(1.0, 8), (0.25, 40), (30.0, 60), (60.0, 60)] {
            let share = Share::of(sum, n);
            assert!(share.low <= share.mean && share.mean <= share.high);
            for end in [share.low, share.high].into_iter().filter(|end| (1e-9..0.999_999).contains(end)) {
                let p = (-f64::from(n) * divergence(share.mean, end)).exp();
                assert!((p - 0.05).abs() < 1e-6, "{sum} of {n}: {p} at {end}");
            }
        }
        assert!((Share::of(60.0, 60).low - 0.05f64.powf(1.0 / 60.0)).abs() < 1e-12);
    }

    /// Coins of a known bias, every outcome weighed by its probability: an end fails no more often than it
    /// says.
    #[test]
    fn intervals_hold_as_often_as_they_say() {
        let (n, p) = (12u32, 0.2f64);
        let (mut below, mut above, mut weight) = (0.0, 0.0, (1.0 - p).powi(12));
        for k in 0..=n {
            let share = Share::of(f64::from(k), n);
            below += if p < share.low { weight } else { 0.0 };
            above += if p > share.high { weight } else { 0.0 };
            weight *= f64::from(n - k) / f64::from(k + 1) * p / (1.0 - p);
        }
        assert!(below <= 0.05 && above <= 0.05 && below + above > 0.0, "{below}, {above}");
    }

    #[test]
    fn sums_are_means_and_worsts() {
        let mut tally = Tally::default();
        for wrong_pixels in [0, 10, 20, 0] {
            tally.add(&Audit { pixels: 100, wrong_pixels, ..Audit::default() });
        }
        let estimate = tally.estimate();
        assert_eq!((estimate.frames, estimate.lost, estimate.worst_lost), (4, 0, 0));
        assert!((estimate.wrong_share.mean - 0.075).abs() < 1e-12 && estimate.worst_wrong_share == 0.2);
        assert_eq!(estimate.lost_per_frame(), 0.0);
        // No frame is wrong by more than all of its pixels; if the worst is wrong by 1 %, by more than 10 %.
        assert_eq!(estimate.wrong_share, Share::of(0.1 + 0.2, 4));
        let mut tally = Tally::default();
        for wrong_pixels in [0, 5, 10, 0] {
            tally.add(&Audit { pixels: 1000, wrong_pixels, ..Audit::default() });
        }
        let share = tally.estimate().wrong_share;
        assert!(
            (share.mean - 0.00375).abs() < 1e-12 && (share.high - 0.1 * Share::of(0.15, 4).high).abs() < 1e-9
        );
    }

    #[test]
    fn shares_read_well() {
        let shares = [0.0, 1e-9, 0.000_012_34, 0.0456, 0.0099, 0.5].map(percent);
        assert_eq!(shares, ["0", "<0.0001", "0.0012", "4.6", "0.99", "50"]);
    }
}
