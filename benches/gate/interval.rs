//! A ratio of times, and how certain it is.

use std::fmt;

use statrs::distribution::{Binomial, DiscreteCDF};

/// The probability that an interval holds the truth.
const CONFIDENCE: f64 = 0.95;
/// Pairs a block: the frames from one probe to the next.
const BLOCK: usize = 32;

/// One way's time over another's, of frames in pairs.
pub struct Ratio {
    pairs: Median,
    blocks: Median,
}

/// A median, and an interval for it by ranks: whatever the distribution.
struct Median {
    of: usize,
    median: f64,
    low: f64,
    high: f64,
}

impl Ratio {
    /// Of pairs of times, in their order; none of fewer pairs than a block has.
    pub fn of(pairs: &[(f64, f64)]) -> Option<Self> {
        if pairs.len() < BLOCK {
            return None;
        }
        let sum = |block: &[(f64, f64)]| {
            block.iter().map(|pair| pair.0).sum::<f64>() / block.iter().map(|pair| pair.1).sum::<f64>()
        };
        Some(Self {
            pairs: Median::new(pairs.iter().map(|(a, b)| a / b).collect()),
            blocks: Median::new(pairs.chunks_exact(BLOCK).map(sum).collect()),
        })
    }

    /// Whether the interval of the blocks lies below a bound.
    pub fn verdict(&self, most: f64) -> &'static str {
        match &self.blocks {
            blocks if blocks.high <= most => "yes",
            blocks if blocks.low > most => "**no**",
            _ => "not certain",
        }
    }
}

impl Median {
    fn new(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let of = values.len();
        // How many of the values lie below the true median.
        let below = Binomial::new(0.5, of as u64).expect("a fair coin");
        let rank = |probability| (below.inverse_cdf(probability) as usize).min(of - 1);
        let (low, high) = (rank(0.5 - 0.5 * CONFIDENCE).saturating_sub(1), rank(0.5 + 0.5 * CONFIDENCE));
        Self { of, median: values[of / 2], low: values[low], high: values[high] }
    }
}

impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} | {}", self.pairs, self.blocks)
    }
}

impl fmt::Display for Median {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { of, median, low, high } = self;
        write!(f, "{median:.3} ({low:.3} to {high:.3}), n = {of}")
    }
}
