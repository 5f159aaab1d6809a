//! For how long a leaf that is visible goes unasked.
//!
//! The 2005 paper says only that nodes seen visible in several recent frames are queried less
//! often. Asking about a leaf of `n` objects every `t` frames costs `q / t` a frame, where `q` is
//! the cost of a question in hidden objects drawn ([`Costs`]). If such a leaf becomes hidden with
//! probability `p` a frame, it is then drawn in vain for `t / 2` frames on average, which costs
//! `n p t / 2` a frame. The sum is least at `t = √(2 q / (n p))`. Both `q` and `p` are seen.

use crate::Error;
use crate::costs::Costs;
use crate::dial;
use crate::tree::NodeId;

/// How many frames a visible leaf goes unasked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// As many as pay, from the costs and the turnover seen.
    Auto,
    /// `min(k, n)` after `k` consecutive visible answers; 0 asks every frame.
    AtMost(u32),
}

impl Skip {
    /// Frames that [`Skip::Auto`] skips at most. What a vote says must not grow old.
    const MOST: u32 = 12;

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

    /// Frames to skip after `streak` consecutive visible answers about a leaf of `objects`.
    pub(super) fn frames(
        self,
        node: NodeId,
        streak: u32,
        objects: usize,
        costs: &Costs,
        seen: &Turnover,
    ) -> u32 {
        match self {
            Self::AtMost(n) => streak.min(n),
            Self::Auto => {
                let every = (2.0 * costs.question() / (objects.max(1) as f32 * seen.rate())).sqrt();
                let skip = (every as u32).saturating_sub(1).min(Self::MOST).min(streak);
                // Leaves that became visible together must not all be asked about together: up to
                // a third is taken off, by node.
                skip - (node.index().wrapping_mul(0x9E37_79B1) >> 16) as u32 % (skip / 3 + 1)
            }
        }
    }
}

/// How often leaves that are visible become hidden, as seen lately.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turnover {
    hidden: f32,
    frames: f32,
}

impl Default for Turnover {
    fn default() -> Self {
        Self { hidden: 1.0, frames: 8.0 }
    }
}

impl Turnover {
    /// What a frame leaves of the ones before it.
    const FADE: f32 = 0.9;

    /// To be called once a frame.
    pub(super) fn fade(&mut self) {
        self.hidden *= Self::FADE;
        self.frames *= Self::FADE;
    }

    /// A leaf that was visible `frames` ago, when last asked about, is `hidden` now, or not.
    pub(super) fn note(&mut self, frames: u32, hidden: bool) {
        self.frames += frames.max(1) as f32;
        self.hidden += f32::from(u8::from(hidden));
    }

    /// The probability a frame, greater than 0. One more of each has been seen, as it were.
    fn rate(&self) -> f32 {
        (self.hidden + 0.125) / (self.frames + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::tree::{Tree, TreeConfig};
    use glam::Vec3;

    fn root() -> NodeId {
        let mut tree = Tree::new(TreeConfig::default());
        tree.insert(0, &Aabb::from_center(Vec3::ZERO, Vec3::ONE));
        tree.update();
        tree.root()
    }

    fn turnover(hidden: u32, of: u32) -> Turnover {
        let mut seen = Turnover::default();
        for _ in 0..100 {
            seen.fade();
            (0..of).for_each(|i| seen.note(1, i < hidden));
        }
        seen
    }

    #[test]
    fn skips_are_those_of_least_cost() {
        let frames = |objects, question, seen: &Turnover| {
            Skip::Auto.frames(root(), u32::MAX, objects, &Costs::of(question), seen)
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
    fn a_streak_must_grow_first() {
        let (costs, seen) = (Costs::of(100.0), turnover(0, 1000));
        for streak in 0..4 {
            assert!(Skip::Auto.frames(root(), streak, 1, &costs, &seen) <= streak);
            assert_eq!(Skip::AtMost(2).frames(root(), streak, 1, &costs, &seen), streak.min(2));
        }
    }
}
