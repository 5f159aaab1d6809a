//! What the paper says of CHC++, and the same here.

use super::Outcome;
use super::algorithms::{CHC, NOHC, OPT, PLUS_PLUS, VFC};
use support::lockstep::Measured;

/// A figure that the paper gives, as a ratio of two algorithms.
pub struct Claim {
    /// In words.
    pub what: &'static str,
    /// In the paper.
    pub paper: &'static str,
    /// Indices of the algorithms: the first over the second.
    of: (usize, usize),
    figure: Figure,
}

/// What is compared.
#[derive(Clone, Copy)]
enum Figure {
    /// The median of the ratios frame by frame.
    Time,
    /// The mean a frame.
    Mean(fn(&Measured) -> f64),
}

const QUESTIONS: Figure = Figure::Mean(|m| m.summary.queries.mean);
const STATE_CHANGES: Figure = Figure::Mean(|m| m.summary.state_changes.mean);

/// In the order of the page.
pub const CLAIMS: [Claim; 6] = [
    Claim { what: "questions, CHC / CHC++", paper: "up to 10", of: (CHC, PLUS_PLUS), figure: QUESTIONS },
    Claim {
        what: "state changes, CHC / CHC++",
        paper: "up to 100",
        of: (CHC, PLUS_PLUS),
        figure: STATE_CHANGES,
    },
    Claim { what: "time, CHC / CHC++", paper: "up to 2", of: (CHC, PLUS_PLUS), figure: Figure::Time },
    Claim {
        what: "time, CHC++ / OPT",
        paper: "a few percent above 1",
        of: (PLUS_PLUS, OPT),
        figure: Figure::Time,
    },
    Claim { what: "time, NOHC / CHC++", paper: "about 1.5", of: (NOHC, PLUS_PLUS), figure: Figure::Time },
    Claim { what: "time, VFC / CHC++", paper: "–", of: (VFC, PLUS_PLUS), figure: Figure::Time },
];

impl Claim {
    /// The ratio here; none where there is nothing to divide by.
    pub fn here(&self, outcome: &Outcome) -> Option<f64> {
        let (over, under) = (&outcome.lanes[self.of.0], &outcome.lanes[self.of.1]);
        match self.figure {
            Figure::Time => Some(over.time_over(under.times())),
            Figure::Mean(of) => (of(under) > 0.0).then(|| of(over) / of(under)),
        }
    }
}
