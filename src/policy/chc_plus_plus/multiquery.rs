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
//!
//! *Groups* (ours). If more than [`EACH`] nodes fail together, they are asked about in `g = ⌈√|M|⌉` groups,
//! and only those of a group that fails one by one:
//!
//! ```text
//! C = 1 + p_fail · g + |M| · (1 − (Π p_keep)^(1/g))
//! ```

use super::super::odds::{COVERAGES, Class};

/// Where `p_keep` comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepRule {
    /// What was seen over all frames; [`KeepRule::Analytic`] until then.
    Measured,
    /// `0.99 − 0.7 · e^(−i)`.
    Analytic,
}

/// Nodes of a multiquery up to which all are repeated one by one: groups would save nothing.
pub(super) const EACH: usize = 4;

/// Into how many groups the nodes of a multiquery are put that failed.
pub(super) fn groups(nodes: usize) -> usize {
    (nodes as f32).sqrt().ceil() as usize
}

/// How often nodes that had been hidden for `i` frames stayed hidden.
#[derive(Clone, Debug, Default)]
pub(super) struct KeepRate {
    /// By `i`, as far as was seen: those that stayed hidden (`n_keep`), and all (`n_all`).
    seen: Vec<Seen>,
    /// The same of nodes that are alike; see [`Alike::row`].
    alike: Vec<Vec<Seen>>,
}

type Seen = (u64, u64);

/// Hidden nodes that are alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alike {
    pub(super) class: Class,
    /// Whether they were visible before they were hidden.
    pub(super) was_visible: bool,
}

impl Alike {
    fn row(self) -> usize {
        let Class { is_leaf, coverage, .. } = self.class;
        4 * coverage as usize + 2 * usize::from(is_leaf) + usize::from(self.was_visible)
    }
}

impl KeepRate {
    /// Frames that are told apart; more count as the most.
    const RANGE: u32 = 64;

    /// Nodes that are alike, from which on they speak for themselves.
    const ENOUGH: u64 = 32;

    /// A node that had been hidden for `i` frames stayed so, or did not.
    pub(super) fn saw(&mut self, i: u32, alike: Alike, kept: bool) {
        let i = i.min(Self::RANGE - 1) as usize;
        self.alike.resize(4 * COVERAGES, Vec::new());
        for seen in [&mut self.seen, &mut self.alike[alike.row()]] {
            if seen.len() <= i {
                seen.resize(i + 1, (0, 0));
            }
            seen[i].0 += u64::from(kept);
            seen[i].1 += 1;
        }
    }

    /// The probability that a node which has been hidden for `i` frames stays so. Where nothing was
    /// seen, what was seen of the nearest shorter time holds.
    pub(super) fn p_keep(&self, rule: KeepRule, i: u32, alike: Alike) -> f32 {
        let alike = self.alike.get(alike.row()).and_then(|seen| seen.get(i.min(Self::RANGE - 1) as usize));
        let known = self.seen.len().min(i as usize + 1);
        let any = || self.seen[..known].iter().rfind(|(_, all)| *all > 0);
        match alike.filter(|(_, all)| *all >= Self::ENOUGH).or_else(any) {
            Some(&(kept, all)) if rule == KeepRule::Measured => (kept as f64 / all as f64) as f32,
            _ => 0.99 - 0.7 * libm::expf(-(i as f32)),
        }
    }
}

/// How many of the first nodes to ask about together, for `p_keep` in descending order; with groups or
/// without. O(that).
pub(super) fn size(mut p_keep: impl Iterator<Item = f32>, regroup: bool) -> usize {
    let Some(mut all_keep) = p_keep.next() else { return 0 };
    let (mut size, mut value) = (1, 1.0);
    for p in p_keep {
        all_keep *= p;
        let benefit = (size + 1) as f32;
        let cost = match size + 1 {
            nodes if regroup && nodes > EACH => {
                let groups = groups(nodes) as f32;
                1.0 + (1.0 - all_keep) * groups + benefit * (1.0 - libm::powf(all_keep, 1.0 / groups))
            }
            _ => 1.0 + (1.0 - all_keep) * benefit,
        };
        if benefit / cost <= value {
            break;
        }
        (size, value) = (size + 1, benefit / cost);
    }
    size
}

#[cfg(test)]
mod tests {
    use super::super::super::odds::Kind;
    use super::*;

    const ALIKE: Alike =
        Alike { class: Class { kind: Kind::Hidden, is_leaf: true, coverage: 3 }, was_visible: false };

    fn size_of(p_keep: &[f32]) -> usize {
        size(p_keep.iter().copied(), false)
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
    fn groups_make_larger_sets_worth_a_question() {
        let both = |p: f32| [false, true].map(|regroup| size([p; 100].into_iter(), regroup));
        assert_eq!(both(0.9), [4, 4], "too fickle for groups");
        // |M| = 10: 10 / (1 + 0.096 · 10) = 5.1; 25 / (1 + 0.222 · 5 + 25 · 0.049) = 7.5.
        let [each, grouped] = both(0.99);
        assert!((9..=11).contains(&each) && (16..=30).contains(&grouped), "{each} {grouped}");
        assert!((0..=70).all(|p| both(p as f32 / 100.0) == [1, 1]), "the doomed are still asked alone");
    }

    #[test]
    fn those_that_are_alike_speak_for_themselves_when_they_are_many() {
        let mut rate = KeepRate::default();
        let others = Alike { was_visible: true, ..ALIKE };
        (0..100).for_each(|n| rate.saw(5, ALIKE, n >= 2));
        (0..20).for_each(|_| rate.saw(5, others, false));
        let p = |rate: &KeepRate, alike| rate.p_keep(KeepRule::Measured, 5, alike);
        assert_eq!((p(&rate, ALIKE), p(&rate, others)), (0.98, 98.0 / 120.0));
        (0..20).for_each(|_| rate.saw(5, others, false));
        assert_eq!((p(&rate, ALIKE), p(&rate, others)), (0.98, 0.0));
    }

    #[test]
    fn the_analytic_rate_is_the_published_one() {
        let rate = KeepRate::default();
        let p = |i| rate.p_keep(KeepRule::Analytic, i, ALIKE);
        assert!((p(0) - 0.29).abs() < 1e-6 && (p(1) - 0.732_48).abs() < 1e-4 && (p(50) - 0.99).abs() < 1e-6);
        assert_eq!(rate.p_keep(KeepRule::Measured, 3, ALIKE), p(3), "nothing was measured yet");
    }

    #[test]
    fn the_measured_rate_is_constant_where_nothing_was_measured() {
        let mut rate = KeepRate::default();
        (0..4).for_each(|n| rate.saw(1, ALIKE, n > 0));
        (0..10).for_each(|n| rate.saw(3, ALIKE, n > 0));
        let p = |i| rate.p_keep(KeepRule::Measured, i, ALIKE);
        assert_eq!([p(1), p(2), p(3), p(4), p(1000)], [0.75, 0.75, 0.9, 0.9, 0.9]);
        assert_eq!(p(0), rate.p_keep(KeepRule::Analytic, 0, ALIKE), "nothing shorter was measured");
        rate.saw(u32::MAX, ALIKE, true);
        assert_eq!(rate.p_keep(KeepRule::Measured, 5000, ALIKE), 1.0);
    }
}
