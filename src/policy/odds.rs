//! How likely a node is to be hidden, from what was seen of nodes like it: of the same memory, and of
//! about the same coverage of the screen.

use super::Context;
use crate::geom::Proxy;

/// What is remembered of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// It was hidden in the last frame.
    Hidden,
    /// It was visible in the last frame.
    Visible,
    /// It was hidden when it was last looked at, before it went out of view, or below a hidden node.
    OnceHidden,
    /// The same, and it was visible.
    OnceVisible,
    /// Nothing.
    New,
}

/// Nodes that are taken to be alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Class {
    pub(super) kind: Kind,
    /// Whether it is asked about and drawn as one.
    pub(super) is_leaf: bool,
    /// Of the screen, the rectangles around the node's boxes cover a quarter or more: 0; a sixteenth: 1;
    /// and so on.
    pub(super) coverage: u8,
}

/// By class, what was seen lately.
#[derive(Clone, Debug)]
pub(super) struct Odds {
    /// Nodes that were found hidden, and frames in which they might have been.
    seen: [[(f32, f32); COVERAGES]; 2 * BELIEFS.len()],
}

/// Coverages that are told apart.
pub(super) const COVERAGES: usize = 10;
/// What a frame leaves of those before it. A class that nobody asks about any more is forgotten, and
/// so asked about again.
const FADE: f32 = 0.98;
/// As if so many nodes of each class had been seen before any was, and so many of them hidden.
const PRIOR: f32 = 4.0;
const BELIEFS: [f32; 5] = [0.9, 0.05, 0.7, 0.4, 0.5];

impl Default for Odds {
    fn default() -> Self {
        Self { seen: [[(0.0, 0.0); COVERAGES]; 2 * BELIEFS.len()] }
    }
}

impl Class {
    /// Of a node, by the boxes that a question about it asks.
    pub(super) fn new(cx: &Context<'_>, (kind, is_leaf): (Kind, bool), boxes: &[Proxy]) -> Self {
        let viewport = cx.view.viewport();
        let screen = viewport.width.max(1) as f32 * viewport.height.max(1) as f32;
        let quarters = -0.5 * (boxes.iter().map(area).sum::<f32>() / screen).max(f32::MIN_POSITIVE).log2();
        Self { kind, is_leaf, coverage: quarters.clamp(0.0, (COVERAGES - 1) as f32) as u8 }
    }

    fn row(self) -> usize {
        2 * self.kind as usize + usize::from(self.is_leaf)
    }
}

/// Pixels of the rectangle around a proxy.
pub(super) fn area(proxy: &Proxy) -> f32 {
    let rect = proxy.rect;
    rect.x1.saturating_sub(rect.x0) as f32 * rect.y1.saturating_sub(rect.y0) as f32
}

impl Odds {
    /// Starts a frame.
    pub(super) fn begin(&mut self) {
        for (hidden, frames) in self.seen.iter_mut().flatten() {
            (*hidden, *frames) = (*hidden * FADE, *frames * FADE);
        }
    }

    /// A node was found hidden, or visible, so many frames after the last time.
    pub(super) fn saw(&mut self, class: Class, frames: u32, is_hidden: bool) {
        let seen = &mut self.seen[class.row()][class.coverage as usize];
        seen.0 += f32::from(u8::from(is_hidden));
        seen.1 += frames.max(1) as f32;
    }

    /// The probability that a node is hidden which was last asked about so many frames ago.
    pub(super) fn hidden(&self, class: Class, frames: u32) -> f32 {
        let (hidden, all) = self.seen[class.row()][class.coverage as usize];
        let rate = (hidden + PRIOR * BELIEFS[class.kind as usize]) / (all + PRIOR);
        1.0 - libm::powf(1.0 - rate.min(1.0), frames.max(1) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEW: Class = Class { kind: Kind::New, is_leaf: false, coverage: 3 };

    #[test]
    fn odds_follow_what_is_seen_and_are_forgotten() {
        let mut odds = Odds::default();
        assert_eq!(odds.hidden(NEW, 1), 0.5);
        for _ in 0..100 {
            odds.begin();
            (0..10).for_each(|i| odds.saw(NEW, 1, i < 2));
        }
        assert!((odds.hidden(NEW, 1) - 0.2).abs() < 0.01, "{}", odds.hidden(NEW, 1));
        assert_eq!(odds.hidden(Class { coverage: 4, ..NEW }, 1), 0.5, "another class");
        assert_eq!(odds.hidden(Class { is_leaf: true, ..NEW }, 1), 0.5, "and another");
        (0..1000).for_each(|_| odds.begin());
        assert!((odds.hidden(NEW, 1) - 0.5).abs() < 0.01);
    }

    #[test]
    fn odds_grow_with_the_time_that_nobody_looked() {
        let mut odds = Odds::default();
        let class = Class { kind: Kind::Visible, is_leaf: true, coverage: 5 };
        (0..1000).for_each(|i| odds.saw(class, 10, i < 200));
        let rate = odds.hidden(class, 1);
        assert!((rate - 0.02).abs() < 0.001, "200 in 10 000 frames: {rate}");
        assert!((odds.hidden(class, 10) - (1.0 - 0.98f32.powi(10))).abs() < 0.01);
        assert_eq!(odds.hidden(class, 0), rate);
    }
}
