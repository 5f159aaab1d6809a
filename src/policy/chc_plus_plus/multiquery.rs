//! One question for several nodes: which nodes to ask about together, and how likely it is that the
//! answer speaks for all of them.
//!
//! A question about a set M of hidden nodes costs one query if all have stayed hidden; else each is
//! asked about again. With `p_keep(i)` the probability that a node which has been hidden for `i`
//! frames stays so:
//!
//! ```text
//! p_fail = 1 − Π p_keep        C = 1 + p_fail · |M|        B = |M|        V = B / C
//! ```
//!
//! M grows, in descending order of `p_keep`, while V rises. The formula charges 1 + p_fail even to a
//! single node, which nobody asks about twice; then, for a low `p_keep`, V would climb with |M|, to
//! one giant query that is bound to fail. So V = 1 for a single node.

/// Where `p_keep` comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepRule {
    /// What was seen over all frames; [`KeepRule::Analytic`] until then.
    Measured,
    /// `0.99 − 0.7 · e^(−i)`.
    Analytic,
}

/// How often nodes that had been hidden for `i` frames stayed hidden.
#[derive(Clone, Debug, Default)]
pub(super) struct KeepRate {
    /// By `i`, as far as was seen: those that stayed hidden (`n_keep`), and all (`n_all`).
    seen: Vec<(u64, u64)>,
}

impl KeepRate {
    /// Frames that are told apart; more count as the most.
    const RANGE: u32 = 64;

    /// A node that had been hidden for `i` frames stayed so, or did not.
    pub(super) fn saw(&mut self, i: u32, kept: bool) {
        let i = i.min(Self::RANGE - 1) as usize;
        if self.seen.len() <= i {
            self.seen.resize(i + 1, (0, 0));
        }
        self.seen[i].0 += u64::from(kept);
        self.seen[i].1 += 1;
    }

    /// The probability that a node which has been hidden for `i` frames stays so. Where nothing was
    /// seen, what was seen of the nearest shorter time holds.
    pub(super) fn p_keep(&self, rule: KeepRule, i: u32) -> f32 {
        let known = self.seen.len().min(i as usize + 1);
        match self.seen[..known].iter().rfind(|(_, all)| *all > 0) {
            Some(&(kept, all)) if rule == KeepRule::Measured => (kept as f64 / all as f64) as f32,
            _ => 0.99 - 0.7 * libm::expf(-(i as f32)),
        }
    }
}

/// How many of the first nodes to ask about together, for `p_keep` in descending order. O(that).
pub(super) fn size(mut p_keep: impl Iterator<Item = f32>) -> usize {
    let Some(mut all_keep) = p_keep.next() else { return 0 };
    let (mut size, mut value) = (1, 1.0);
    for p in p_keep {
        all_keep *= p;
        let benefit = (size + 1) as f32;
        let cost = 1.0 + (1.0 - all_keep) * benefit;
        if benefit / cost <= value {
            break;
        }
        (size, value) = (size + 1, benefit / cost);
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size_of(p_keep: &[f32]) -> usize {
        size(p_keep.iter().copied())
    }

    #[test]
    fn sets_grow_while_their_value_rises() {
        // V: 1; 2 / (1 + 0.19 · 2) = 1.45; 3 / (1 + 0.271 · 3) = 1.65; 4 / (1 + 0.3439 · 4) = 1.68;
        // 5 / (1 + 0.40951 · 5) = 1.64.
        assert_eq!(size_of(&[0.9; 10]), 4);
        assert_eq!(size_of(&[1.0; 50]), 50, "what never fails is asked all together");
        assert_eq!(size_of(&[0.9, 0.9, 0.1]), 2, "the third would spoil it");
        assert_eq!(size_of(&[]), 0);
    }

    #[test]
    fn doomed_nodes_are_asked_about_alone() {
        for p in [0.0, 0.1, 0.29, 0.49, 0.7] {
            assert_eq!(size_of(&[p; 50]), 1, "{p}");
        }
        // 2 / (1 + (1 − p²) · 2) > 1 from p² > ½ on.
        assert_eq!(size_of(&[0.71, 0.71]), 2);
    }

    #[test]
    fn the_greedy_set_is_the_best_prefix_of_its_climb() {
        for p in [0.8f32, 0.9, 0.95, 0.99, 0.999] {
            let value = |n: i32| if n == 1 { 1.0 } else { n as f32 / (1.0 + (1.0 - p.powi(n)) * n as f32) };
            let n = size_of(&[p; 50]) as i32;
            assert!((1..n).all(|m| value(m) < value(m + 1)), "{p}");
            assert!(n == 50 || value(n) >= value(n + 1), "{p}");
        }
    }

    #[test]
    fn the_analytic_rate_is_the_published_one() {
        let rate = KeepRate::default();
        let p = |i| rate.p_keep(KeepRule::Analytic, i);
        assert!((p(0) - 0.29).abs() < 1e-6 && (p(1) - 0.732_48).abs() < 1e-4 && (p(50) - 0.99).abs() < 1e-6);
        assert_eq!(rate.p_keep(KeepRule::Measured, 3), p(3), "nothing was measured yet");
    }

    #[test]
    fn the_measured_rate_is_constant_where_nothing_was_measured() {
        let mut rate = KeepRate::default();
        (0..4).for_each(|n| rate.saw(1, n > 0));
        (0..10).for_each(|n| rate.saw(3, n > 0));
        let p = |i| rate.p_keep(KeepRule::Measured, i);
        assert_eq!([p(1), p(2), p(3), p(4), p(1000)], [0.75, 0.75, 0.9, 0.9, 0.9]);
        assert_eq!(p(0), rate.p_keep(KeepRule::Analytic, 0), "nothing shorter was measured");
        rate.saw(u32::MAX, true);
        assert_eq!(rate.p_keep(KeepRule::Measured, 5000), 1.0);
    }
}
