//! For how long a leaf that is visible goes unasked.
//!
//! The 2005 paper says only that nodes seen visible in several recent frames are queried less
//! often. Asking about a leaf of `n` objects every `t` frames costs `q / t` a frame, where `q` is
//! the cost of a question in hidden objects drawn ([`Costs`]). If such a leaf becomes hidden with
//! probability `p` a frame, it is then drawn in vain for `t / 2` frames on average, which costs
//! `n p t / 2` a frame. The sum is least at `t = √(2 q / (n p))`.
//!
//! `q` and `p` are seen. `p` is seen by the *visible share* of the leaf's box, the dual answer: a
//! leaf of which half is visible will hardly be hidden in the next frame, one of which a hundredth
//! is visible may well be.

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
    /// Frames that [`Skip::Auto`] skips at most.
    const MOST: u32 = 30;

    pub(super) fn parse(key: &str, value: &str) -> Result<Self, Error> {
        match value.trim() {
            "auto" => Ok(Self::Auto),
            number => dial::number(key, number, 0..=1000).map(Self::AtMost),
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
                let p = turnover.rate(leaf.share);
                let every = (2.0 * costs.question() / (leaf.objects.max(1) as f32 * p)).sqrt();
                // A leaf that has only just become visible may as soon be hidden again.
                let trust = (1 << leaf.streak.min(5)) - 1;
                let skip = (every as u32).saturating_sub(1).min(Self::MOST).min(trust);
                // Leaves that became visible together must not all be asked about together: up to
                // a third is taken off, by node.
                skip - (leaf.node.index().wrapping_mul(0x9E37_79B1) >> 16) as u32 % (skip / 3 + 1)
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
                Self((total / visible).ilog2().min(Self::COUNT as u32 - 1) as u8)
            }
            _ => Self(0),
        }
    }
}

/// How often leaves that are visible become hidden, as seen lately, by the share last seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turnover {
    hidden: [f32; Share::COUNT],
    frames: [f32; Share::COUNT],
}

impl Default for Turnover {
    /// One leaf in eight, after one frame.
    fn default() -> Self {
        Self { hidden: [1.0; Share::COUNT], frames: [8.0; Share::COUNT] }
    }
}

impl Turnover {
    /// What a frame leaves of the ones before it.
    const FADE: f32 = 0.9;

    /// To be called once a frame.
    pub(super) fn fade(&mut self) {
        self.hidden.iter_mut().chain(&mut self.frames).for_each(|sum| *sum *= Self::FADE);
    }

    /// Of a leaf of which `share` was visible `frames` ago, nothing is visible now, or something.
    pub(super) fn note(&mut self, share: Share, frames: u32, hidden: bool) {
        self.frames[share.0 as usize] += frames.max(1) as f32;
        self.hidden[share.0 as usize] += f32::from(u8::from(hidden));
    }

    /// The probability a frame, greater than 0: where nothing has been seen lately, one in eight.
    fn rate(&self, share: Share) -> f32 {
        (self.hidden[share.0 as usize] + 0.01) / (self.frames[share.0 as usize] + 0.08)
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

    fn turnover(hidden: u32, of: u32) -> Turnover {
        let mut seen = Turnover::default();
        for _ in 0..100 {
            seen.fade();
            (0..of).for_each(|i| seen.note(Share(0), 1, i < hidden));
        }
        seen
    }

    #[test]
    fn skips_are_those_of_least_cost() {
        let frames = |objects, question, seen: &Turnover| {
            Skip::Auto.frames(leaf(objects, u32::MAX), &Costs::of(question), seen)
        };
        // √(2 · 1 / (1 · 0.02)) = 10 frames from question to question; a third may be taken off.
        let rare = turnover(20, 1000);
        assert!((6..=9).contains(&frames(1, 1.0, &rare)), "{}", frames(1, 1.0, &rare));
        assert!(frames(16, 1.0, &rare) <= 2, "a full leaf is asked about more often");
        assert_eq!(frames(1, 0.01, &rare), 0, "questions that cost nothing are asked every frame");
        assert_eq!(frames(1, 1.0, &turnover(900, 1000)), 0, "what changes every frame is asked every frame");
        assert!(frames(1, 256.0, &turnover(0, 1000)) <= Skip::MOST);
    }

    #[test]
    fn what_is_hardly_visible_is_asked_about_more_often() {
        let mut seen = turnover(0, 1000);
        let hardly = Share::of(Answer::Dual { visible: 3, total: 1000 });
        (0..500).for_each(|i| seen.note(hardly, 1, i % 4 == 0));
        let frames = |share| Skip::Auto.frames(Seen { share, ..leaf(1, 9) }, &Costs::of(1.0), &seen);
        let wholly = Share::of(Answer::Dual { visible: 900, total: 1000 });
        assert!(frames(hardly) <= 2 && frames(wholly) >= 20, "{} {}", frames(hardly), frames(wholly));
    }

    #[test]
    fn trust_must_grow_first() {
        let (costs, seen) = (Costs::of(100.0), turnover(0, 1000));
        for streak in 0..4 {
            assert!(Skip::Auto.frames(leaf(1, streak), &costs, &seen) < 1 << streak);
            assert_eq!(Skip::AtMost(2).frames(leaf(1, streak), &costs, &seen), streak.min(2));
        }
    }
}
