//! For how many frames nodes have been hidden. A guess at how long they will stay so rests on it, and
//! nothing else: no node is culled by it.

use crate::tree::NodeId;

/// By node index.
#[derive(Clone, Debug, Default)]
pub(super) struct Spells(Vec<Spell>);

#[derive(Clone, Copy, Debug, Default)]
struct Spell {
    identity: u32,
    /// The first frame, and the last one seen; 0 for never.
    first: u32,
    last: u32,
    /// Whether it began when the node had been visible: such a node may well be visible again.
    was_visible: bool,
}

impl Spells {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// A node is hidden in this frame. If that begins a spell, `was_visible` says whether something of
    /// it was seen before. O(1).
    pub(super) fn is_hidden(&mut self, node: NodeId, frame: u32, was_visible: bool) {
        if self.0.len() <= node.index() {
            self.0.resize(node.index() + 1, Spell::default());
        }
        let spell = &mut self.0[node.index()];
        let goes_on = spell.goes_on(node, frame) || spell.last == frame;
        let (first, was_visible) =
            if goes_on { (spell.first, spell.was_visible) } else { (frame, was_visible) };
        *spell = Spell { identity: node.identity(), first, last: frame, was_visible };
    }

    /// For how many frames a node had been hidden when this one began, 0 if it was not hidden in the last
    /// frame; and whether it was visible before that.
    pub(super) fn frames(&self, node: NodeId, frame: u32) -> (u32, bool) {
        let spell = self.0.get(node.index()).filter(|spell| spell.goes_on(node, frame));
        spell.map_or((0, false), |spell| (frame.wrapping_sub(spell.first), spell.was_visible))
    }
}

impl Spell {
    fn goes_on(&self, node: NodeId, frame: u32) -> bool {
        self.identity == node.identity() && self.last != 0 && self.last == frame.wrapping_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spells_are_counted_and_broken() {
        let node = NodeId { index: 3, identity: 7 };
        let mut spells = Spells::default();
        assert_eq!(spells.frames(node, 1), (0, false));
        spells.is_hidden(node, 1, true);
        assert_eq!(spells.frames(node, 2), (1, true));
        (2..=5).for_each(|frame| spells.is_hidden(node, frame, false));
        assert_eq!(spells.frames(node, 6), (5, true));
        assert_eq!(spells.frames(node, 7).0, 0, "it was not hidden in frame 6");
        spells.is_hidden(node, 9, false);
        assert_eq!(spells.frames(node, 10), (1, false), "a new spell");
        assert_eq!(spells.frames(NodeId { index: 3, identity: 8 }, 10).0, 0, "another node");
        spells.clear();
        assert_eq!(spells.frames(node, 10).0, 0);
    }
}
