//! When a visible leaf is asked about again.
//!
//! Every `n_av` frames. Leaves that became visible together would then be asked about together, for
//! ever. So when a leaf turns visible, its first question comes after a random `0 < r < n_av` frames.

use crate::tree::NodeId;

/// Frames from an answer to the next question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sampling {
    /// At least 1 frame; 0 counts as 1.
    pub(super) n_av: u32,
    pub(super) randomised: bool,
}

impl Sampling {
    /// Frames for which a leaf goes unasked that was found visible in this frame.
    pub(super) fn term(self, node: NodeId, frame: u32, turned_visible: bool) -> u32 {
        if turned_visible && self.randomised && self.n_av >= 2 {
            dice(node, frame) % (self.n_av - 1)
        } else {
            self.n_av.saturating_sub(1)
        }
    }
}

/// Frames for which a leaf goes unasked that was drawn on a guess: one to three, fewer than `n_av`.
pub(super) fn soon(node: NodeId, frame: u32, n_av: u32) -> u32 {
    dice(node, frame) % n_av.clamp(1, 3)
}

/// As good as random, and the same whatever order the answers come in (SplitMix64).
fn dice(node: NodeId, frame: u32) -> u32 {
    let mut x = (u64::from(frame) << 32 | u64::from(node.index)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    (x >> 32 ^ x) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(n_av: u32, randomised: bool, turned_visible: bool) -> Vec<u32> {
        let sampling = Sampling { n_av, randomised };
        let nodes = (0..1000).map(|index| NodeId { index, identity: 0 });
        nodes.map(|node| sampling.term(node, 77, turned_visible)).collect()
    }

    #[test]
    fn first_questions_are_spread_evenly_and_the_others_regular() {
        let first = terms(10, true, true);
        // Asked after r = 1 to 9 frames: unasked for 0 to 8.
        for term in 0..9 {
            let share = first.iter().filter(|&&t| t == term).count();
            assert!((70..150).contains(&share), "{term}: {share}");
        }
        assert!(first.iter().all(|&t| t < 9));
        assert!(terms(10, true, false).iter().all(|&t| t == 9));
        assert!(terms(10, false, true).iter().all(|&t| t == 9));
    }

    #[test]
    fn short_intervals_leave_nothing_to_chance() {
        for n_av in [0, 1, 2] {
            assert!(terms(n_av, true, true).iter().all(|&t| t == 0), "{n_av}");
        }
        assert!(terms(0, false, true).iter().all(|&t| t == 0));
    }
}
