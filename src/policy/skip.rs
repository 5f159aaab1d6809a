//! For how long a leaf that is visible goes unasked.
//!
//! The 2005 paper says only that nodes seen visible in several recent frames are queried less
//! often. Asking about a leaf of `n` objects every `t` frames costs `q / t` a frame, where `q` is
//! the cost of a question in objects drawn in vain ([`Costs`], [`IN_VAIN`]). Such a leaf becomes
//! hidden with probability `p` a frame, and stays so for `s` frames on the mean. Of those frames it
//! is drawn in vain until the next question, a part `m = 1 − s (1 − (1 − 1/s)ᵗ) / t`, if hidden
//! spells are without memory, and asked about in all others, since only an answer of this very frame
//! can cull it. So a frame costs
//!
//! ```text
//! q / t  +  p s (n m + q (1 − m))
//! ```
//!
//! and the `t` is taken for which that is least. `q`, `p` and `s` are seen; `p` by the *visible
//! share* of the leaf's box, the dual answer: a leaf of which half is visible will hardly be hidden
//! in the next frame, one of which a hundredth is visible may well be.

use crate::Error;
use crate::costs::Costs;
use crate::dial;
use crate::query::Answer;
use crate::tree::NodeId;

/// How many frames a visible leaf goes unasked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// As many as pay, from the costs and the turnover seen.
    Auto,
    /// `min(k, n)` after `k` consecutive visible answers; 0 asks every frame.
    AtMost(u32),
}

/// A leaf of which something was visible, as it was last asked about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) node: NodeId,
    pub(super) objects: usize,
    /// Consecutive visible answers.
    pub(super) streak: u32,
    pub(super) share: Share,
}

impl Skip {
    pub(super) fn parse(key: &str, value: &str) -> Result<Self, Error> {
        match value.trim() {
            "auto" => Ok(Self::Auto),
            number => dial::number(key, number, 0..=1000).map(Self::AtMost).map_err(|_| Error::Dial {
                key: key.to_owned(),
                value: value.to_owned(),
                why: "it takes auto, or 0 to 1000".to_owned(),
            }),
        }
    }

    pub(super) fn name(self) -> String {
        match self {
            Self::Auto => "auto".to_owned(),
            Self::AtMost(n) => n.to_string(),
        }
    }

    /// Frames for which a leaf now goes unasked.
    pub(super) fn frames(self, leaf: Seen, costs: &Costs, turnover: &Turnover) -> u32 {
        match self {
            Self::AtMost(n) => leaf.streak.min(n),
            Self::Auto => {
                let question = costs.question() / IN_VAIN;
                let every = turnover.best_interval(leaf.share, leaf.objects, question);
                // A leaf that has only just become visible may as soon be hidden again.
                let trust = (1 << leaf.streak.min(5)) - 1;
                let skip = (every - 1).min(trust);
                // Leaves that became visible together must not all be asked about together: up to
                // a third is taken off, by node.
                skip - (leaf.node.index.wrapping_mul(0x9E37_79B1) >> 16) % (skip / 3 + 1)
            }
        }
    }
}

/// The visible share of a box, in powers of two: 0 for more than a half, 1 for more than a
/// quarter, and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share(u8);

impl Share {
    const COUNT: usize = 8;

    /// Of an answer. A question that was not needed, or went unanswered, counts as wholly visible.
    pub(super) fn of(answer: Answer<'_>) -> Self {
        match answer {
            Answer::Dual { visible, total } if visible > 0 => {
                // A backend that counts more visible samples than there are has no share to tell.
                let halvings = (total / visible).checked_ilog2().unwrap_or(0);
                Self(halvings.min(Self::COUNT as u32 - 1) as u8)
            }
            _ => Self(0),
        }
    }
}

/// What drawing an object in vain is taken to cost, to the mean of those drawn. By the clock it is
/// a quarter to two thirds, on the demos: the samples of a hidden object fail the depth test. But
/// the clock does not see all that an app pays for an object, and near its least the cost of asking
/// and drawing together hardly changes: with 1, 2, 4 and 8 here, 2500 still teapots took 0.92,
/// 0.92, 0.90 and 0.90 of the old algorithm's time, and drew 0.95, 0.93, 0.88 and 0.86 of its
/// objects.
const IN_VAIN: f32 = 4.0;

/// Frames from question to question that are considered.
const INTERVALS: [u32; 10] = [1, 2, 3, 4, 6, 8, 12, 16, 23, 31];

/// How often leaves become hidden and visible again, as seen lately.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turnover {
    /// Of leaves that were visible: those hidden now, by the share last seen, and the frames since.
    hidden: [f32; Share::COUNT],
    frames: [f32; Share::COUNT],
    /// Of leaves that were hidden: those visible now, and those asked about.
    shown: f32,
    asked: f32,
    /// The mean hidden spell, and for each interval the part of it that goes unnoticed.
    spell: f32,
    unnoticed: [f32; INTERVALS.len()],
}

impl Default for Turnover {
    /// One leaf in eight, after one frame.
    fn default() -> Self {
        Self {
            hidden: [1.0; Share::COUNT],
            frames: [8.0; Share::COUNT],
            shown: 1.0,
            asked: 8.0,
            spell: 0.0,
            unnoticed: [0.0; INTERVALS.len()],
        }
    }
}

impl Turnover {
    /// What a frame leaves of the ones before it.
    const FADE: f32 = 0.9;

    /// Starts a frame.
    pub(super) fn begin(&mut self) {
        let visible = self.hidden.iter_mut().chain(&mut self.frames);
        visible.chain([&mut self.shown, &mut self.asked]).for_each(|sum| *sum *= Self::FADE);
        self.spell = (self.asked + 0.08) / (self.shown + 0.01);
        for (unnoticed, t) in self.unnoticed.iter_mut().zip(INTERVALS) {
            // In f64: for long spells it is a small difference of numbers near 1.
            let (spell, t) = (f64::from(self.spell.max(1.0)), f64::from(t));
            let ended = 1.0 - (1.0 - 1.0 / spell).powf(t);
            *unnoticed = (1.0 - spell * ended / t).max(0.0) as f32;
        }
    }

    /// Of a leaf of which `share` was visible `frames` ago, nothing is visible now, or something.
    pub(super) fn was_visible(&mut self, share: Share, frames: u32, is_hidden: bool) {
        // One that was out of view for long was not visible all the while.
        self.frames[share.0 as usize] += frames.clamp(1, INTERVALS[INTERVALS.len() - 1]) as f32;
        self.hidden[share.0 as usize] += f32::from(u8::from(is_hidden));
    }

    /// Of a leaf that was hidden in the last frame, nothing is visible now, or something.
    pub(super) fn was_hidden(&mut self, is_hidden: bool) {
        self.asked += 1.0;
        self.shown += f32::from(u8::from(!is_hidden));
    }

    /// The probability a frame, greater than 0: where nothing has been seen lately, one in eight.
    fn rate(&self, share: Share) -> f32 {
        (self.hidden[share.0 as usize] + 0.01) / (self.frames[share.0 as usize] + 0.08)
    }

    /// The interval from question to question that costs least; see the module's documentation.
    fn best_interval(&self, share: Share, objects: usize, question: f32) -> u32 {
        let (n, hidden) = (objects.max(1) as f32, self.rate(share) * self.spell);
        let cost = |(t, m): (u32, f32)| question / t as f32 + hidden * (n * m + question * (1.0 - m));
        let all = INTERVALS.into_iter().zip(self.unnoticed);
        let best = all.map(|pair| (cost(pair), pair.0)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(1, |(_, t)| t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::tree::{Tree, TreeConfig};
    use glam::Vec3;

    fn leaf(objects: usize, streak: u32) -> Seen {
        let mut tree = Tree::new(TreeConfig::default());
        tree.insert(0, &Aabb::from_center(Vec3::ZERO, Vec3::ONE));
        tree.update();
        Seen { node: tree.root(), objects, streak, share: Share(0) }
    }

    /// Of `of` visible leaves a frame, `hidden` become hidden; hidden ones stay so for `spell`.
    fn turnover(hidden: u32, of: u32, spell: u32) -> Turnover {
        let mut seen = Turnover::default();
        for _ in 0..100 {
            (0..of).for_each(|i| seen.was_visible(Share(0), 1, i < hidden));
            (0..of).for_each(|i| seen.was_hidden(!i.is_multiple_of(spell)));
            seen.begin();
        }
        seen
    }

    #[test]
    fn skips_are_those_of_least_cost() {
        let frames = |objects, question, seen: &Turnover| {
            Skip::Auto.frames(leaf(objects, u32::MAX), &Costs::of(IN_VAIN * question), seen)
        };
        // Long spells: about √(2 · 0.5 / (1.5 · 0.02)) = 6 frames; a third may be taken off.
        let rare = turnover(20, 1000, 100);
        assert!((3..=7).contains(&frames(2, 0.5, &rare)), "{}", frames(2, 0.5, &rare));
        assert!(frames(16, 1.0, &rare) <= 3, "a full leaf is asked about more often");
        assert!(frames(2, 1.0, &turnover(20, 1000, 4)) >= 20, "spells too short to be worth a question");
        assert_eq!(frames(1, 0.004, &rare), 0, "questions that cost nothing are asked every frame");
        assert_eq!(frames(8, 1.0, &turnover(900, 1000, 100)), 0, "what hides often is asked every frame");
        assert!(frames(1, 2.0, &rare) >= 20, "a question that costs more than it can save");
    }

    #[test]
    fn what_is_hardly_visible_is_asked_about_more_often() {
        let mut seen = turnover(0, 1000, 100);
        let hardly = Share::of(Answer::Dual { visible: 3, total: 1000 });
        (0..500).for_each(|i| seen.was_visible(hardly, 1, i % 4 == 0));
        let frames =
            |share| Skip::Auto.frames(Seen { share, ..leaf(1, 9) }, &Costs::of(IN_VAIN * 0.5), &seen);
        let wholly = Share::of(Answer::Dual { visible: 900, total: 1000 });
        assert!(frames(hardly) <= 2 && frames(wholly) >= 20, "{} {}", frames(hardly), frames(wholly));
    }

    #[test]
    fn long_spells_are_told_apart_from_endless_ones() {
        let every = |spell: f32| {
            let mut seen = turnover(20, 1000, 100);
            (seen.asked, seen.shown) = (spell, 1.0);
            seen.begin();
            seen.best_interval(Share(0), 2, 0.06)
        };
        assert_eq!((every(1e3), every(1e5), every(1e7)), (2, 2, 2));
    }

    #[test]
    fn leaves_do_not_all_come_due_together() {
        let mut tree = Tree::new(TreeConfig { bulk_leaf: 1, unasked_leaf: 1, ..TreeConfig::default() });
        (0..64).for_each(|i| tree.insert(i, &Aabb::from_center(Vec3::X * 3.0 * i as f32, Vec3::ONE)));
        tree.update();
        let (costs, seen) = (Costs::of(100.0), turnover(0, 1000, 100));
        let mut skips: Vec<u32> = tree
            .nodes()
            .map(|n| Skip::Auto.frames(Seen { node: n.id, ..leaf(1, 9) }, &costs, &seen))
            .collect();
        skips.sort_unstable();
        skips.dedup();
        assert!(skips.len() >= 8 && skips[0] >= 20 && skips[skips.len() - 1] <= 30, "{skips:?}");
    }

    #[test]
    fn a_count_that_cannot_be_has_no_share() {
        assert_eq!(Share::of(Answer::Dual { visible: 3, total: 0 }), Share(0));
        assert_eq!(Share::of(Answer::Dual { visible: 1, total: 1000 }), Share(7));
    }

    #[test]
    fn trust_must_grow_first() {
        let (costs, seen) = (Costs::of(100.0), turnover(0, 1000, 100));
        for streak in 0..4 {
            assert!(Skip::Auto.frames(leaf(1, streak), &costs, &seen) < 1 << streak);
            assert_eq!(Skip::AtMost(2).frames(leaf(1, streak), &costs, &seen), streak.min(2));
        }
    }
}
