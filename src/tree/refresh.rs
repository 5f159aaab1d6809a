//! Taking the movers' new boxes over into the blocks, and finding who has left its cell.
//!
//! Block by block, each by itself: all sixteen boxes are gathered anew (most of a block that has a
//! mover are movers), turned into rows, and compared with the cell as they pass. Then, in the
//! order of the blocks, nodes are marked and movers gathered at the front of their runs.

use pulp::NullaryFnOnce;

use super::Tree;
use super::block::{Block, LANES};
use super::blocks::{Blocks, NONE, News};
use super::gather::{ByFours, Gather, Site, Words};
use super::hull::Hull;
use super::node::Nodes;
use super::refit::CONTENT;
use crate::query::software::prefetch;

/// Blocks that are asked of memory ahead of their turn.
const AHEAD: usize = 4;

/// Arenas of fewer blocks are near enough as it is: about what the second cache holds.
const FAR: usize = 2048;

/// Stale blocks from which they are shared among threads: below, waking another takes longer.
const SHARED_FROM: usize = 8192;

/// Updates after which a run that moves looks whether its movers still do.
const REVIEW: u32 = 64;

impl Tree {
    /// Brings the blocks in step with the boxes, marks the nodes of those that changed, and lists
    /// the objects that have left. O(blocks with moved objects), and a look at a byte for every
    /// block without, unless none has any.
    pub(super) fn refresh(&mut self) {
        self.blocks.stale.take(&mut self.stale);
        if self.stale.is_empty() {
            return;
        }
        let mut stale = std::mem::take(&mut self.stale);
        self.renew(&stale);
        let mut touched = std::mem::take(&mut self.touched);
        if touched.len() < stale.len() {
            touched.resize(stale.len(), (NONE, 0));
        }
        let (mut last, mut moved, mut count) = (NONE, 0, 0);
        for &block in &stale {
            let news = self.blocks.news[block as usize];
            let node = self.blocks.owner[block as usize];
            // Where a node's blocks end is hard to foretell: no branch.
            count += usize::from(node != last);
            moved = u32::from(news.count) + if node == last { moved } else { 0 };
            last = node;
            touched[count - 1] = (node, moved);
            if news.out | news.again != 0 {
                self.list_leavers(block as usize, node);
                self.gather_movers(block as usize, node);
            }
        }
        for &(node, moved) in &touched[..count] {
            self.note_moved(node, moved);
        }
        stale.clear();
        (self.stale, self.touched) = (stale, touched);
    }

    /// Renews blocks, given in their order.
    fn renew(&mut self, stale: &[u32]) {
        let Blocks { blocks, hulls, news, owner, known, .. } = &mut self.blocks;
        let around = Around { nodes: &self.nodes, owner, known, is_far: blocks.len() >= FAR };
        Stretch { first: 0, stale, blocks, hulls, news }.renew(&around);
    }

    fn list_leavers(&mut self, block: usize, node: u32) {
        let mut out = self.blocks.news[block].out;
        if out == 0 {
            return;
        }
        let divided = !self.nodes.is_leaf(node);
        // Whoever leaves is replaced by the last of the run.
        let last = self.nodes.run[node as usize].used().end - 1;
        ask_for(&self.blocks.blocks[last]);
        let block = &self.blocks.blocks[block];
        while out != 0 {
            let lane = out.trailing_zeros() as usize % LANES;
            out &= out - 1;
            if !(divided && self.nodes.keeps(node, &block.aabb(lane))) {
                self.leavers.push(block.slots[lane]);
            }
        }
    }

    /// Brings the objects that have moved twice in a row to the front of their run.
    fn gather_movers(&mut self, block: usize, node: u32) {
        let run = &mut self.nodes.run[node as usize];
        // Others may have been brought there since the block was renewed.
        let mut again = self.blocks.news[block].again & run.not_in_front(block);
        let first = run.index(block * LANES);
        while again != 0 {
            let lane = again.trailing_zeros();
            again &= again - 1;
            self.blocks.promote(run, first + lane);
        }
    }

    /// Marks a node in which so many objects have moved.
    fn note_moved(&mut self, node: u32, moved: u32) {
        self.touch(node, CONTENT);
        let n = node as usize;
        // A third at rest: the others gather anew.
        if is_review(node, self.tick) && 3 * moved < 2 * self.nodes.run[n].active {
            self.nodes.run[n].active = 0;
        }
        if self.nodes.retry_at[n] > 0 {
            // What could not be separated may be by now: every move brings the next try nearer.
            self.nodes.retry_at[n] = self.nodes.retry_at[n].saturating_sub(moved);
            if self.nodes.is_leaf(node)
                && self.nodes.run[n].len >= self.build_from().max(self.nodes.retry_at[n])
            {
                self.crowded.push(node);
            }
        }
    }
}

/// In turns, so that no update has to look at all runs.
fn is_review(node: u32, tick: u32) -> bool {
    tick.wrapping_add(node).is_multiple_of(REVIEW)
}

/// What renewing only reads.
#[derive(Clone, Copy)]
struct Around<'a> {
    nodes: &'a Nodes,
    /// Of each block.
    owner: &'a [u32],
    known: &'a [Words],
    /// Whether memory has to be asked ahead.
    is_far: bool,
}

/// A stretch of the arena, and the stale blocks in it, in their order.
struct Stretch<'a> {
    /// The block that the slices begin with.
    first: usize,
    stale: &'a [u32],
    blocks: &'a mut [Block],
    hulls: &'a mut [Hull],
    news: &'a mut [News],
}

impl Stretch<'_> {
    /// Renews its stale blocks: of many, the halves on two threads. Each block is by itself, so
    /// the result is the same.
    fn renew(mut self, around: &Around<'_>) {
        if self.stale.len() >= SHARED_FROM && rayon::current_num_threads() > 1 {
            let (low, high) = self.halves();
            rayon::join(|| low.renew(around), || high.renew(around));
            return;
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(wide) = pulp::x86::V4::try_new() {
            return wide.vectorize(Renew { gather: wide, stretch: self, around });
        }
        Renew { gather: ByFours, stretch: self, around }.call();
    }

    /// Cut where half of the stale blocks are.
    fn halves(&mut self) -> (Stretch<'_>, Stretch<'_>) {
        let (low, high) = self.stale.split_at(self.stale.len() / 2);
        let from = high.first().map_or(self.first, |&block| block as usize);
        let (blocks, upper_blocks) = self.blocks.split_at_mut(from - self.first);
        let (hulls, upper_hulls) = self.hulls.split_at_mut(from - self.first);
        let (news, upper_news) = self.news.split_at_mut(from - self.first);
        (
            Stretch { first: self.first, stale: low, blocks, hulls, news },
            Stretch { first: from, stale: high, blocks: upper_blocks, hulls: upper_hulls, news: upper_news },
        )
    }
}

/// The renewing of stale blocks, to be compiled for each kind of registers.
struct Renew<'a, G> {
    gather: G,
    stretch: Stretch<'a>,
    around: &'a Around<'a>,
}

impl<G: Gather> NullaryFnOnce for Renew<'_, G> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { gather, stretch, around } = self;
        let Stretch { first, stale, blocks, hulls, news } = stretch;
        let Around { nodes, owner, known, is_far } = *around;
        for (i, &block) in stale.iter().enumerate() {
            if is_far {
                let later = |ahead: usize| stale.get(i + ahead).map(|&later| later as usize - first);
                if let Some(later) = later(2 * AHEAD) {
                    ask_for(&blocks[later]);
                }
                if let Some(later) = later(AHEAD) {
                    ask_for_boxes(known, &blocks[later]);
                }
            }
            let at = block as usize - first;
            let node = owner[block as usize];
            let n = node as usize;
            let site = Site { cell: nodes.cell[n], straddled: nodes.straddled[n] };
            let found = gather.renew(&mut blocks[at], known, &site);
            hulls[at] = found.hull;
            // A leaf at the root holds what there is; in an inner node, all that move are looked at.
            let out = match (nodes.is_leaf(node), node) {
                (false, _) => found.moved,
                (true, 0) => 0,
                (true, _) => found.out,
            };
            let count = found.moved.count_ones() as u16;
            let again = found.moved & news[at].moved & nodes.run[n].not_in_front(block as usize);
            news[at] = News { count, moved: found.moved, again, out };
        }
    }
}

/// Asks for a block that is to come.
#[inline(always)]
fn ask_for(block: &Block) {
    prefetch(&block.slots);
    block.min.iter().chain(&block.max).for_each(prefetch);
}

/// Asks for the boxes of a block that has been asked for: otherwise two lines of memory would have to be
/// waited for one after the other, that of the slots, then those of their boxes.
#[inline(always)]
fn ask_for_boxes(known: &[Words], block: &Block) {
    for &slot in &block.slots {
        prefetch(known.get(slot as usize).unwrap_or(&Words::NOTHING));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geom::Aabb;
    use crate::tree::TreeConfig;

    fn at(slot: u32, shift: f32) -> Aabb {
        let center = Vec3::new((slot * 7 % 31) as f32, (slot * 11 % 29) as f32, (slot * 13 % 37) as f32);
        Aabb::from_center(center + shift, Vec3::splat(0.25))
    }

    /// So many frames in which every tenth object moves, from the given one on.
    fn play(tree: &mut Tree, first: u32, frames: u32) {
        for frame in 0..frames {
            for slot in (first..300).step_by(10) {
                tree.set_bounds(slot, &at(slot, 0.1 * (1 + frame % 2) as f32));
            }
            tree.update();
            tree.validate().expect("a valid tree");
        }
    }

    fn front(tree: &Tree, count: usize) -> Vec<u32> {
        let mut slots: Vec<u32> = tree.own_objects(tree.root()).map(|(slot, _)| slot).collect();
        slots.truncate(count);
        slots.sort_unstable();
        slots
    }

    #[test]
    fn a_new_box_follows_its_object_to_another_block() {
        let mut tree = Tree::new(TreeConfig::default());
        (0..40).for_each(|slot| tree.insert(slot, &at(slot, 0.0)));
        tree.update();
        tree.set_bounds(39, &at(39, 0.2));
        tree.remove(0);
        tree.update();
        tree.validate().expect("a valid tree");
        assert_eq!(tree.aabb_of(39), Some(at(39, 0.2)));
    }

    #[test]
    fn who_comes_on_the_move_stands_in_front() {
        let mut tree = Tree::new(TreeConfig::default());
        (0..32).for_each(|slot| tree.insert(slot, &at(slot, 0.0)));
        tree.update();
        for slot in 32..70 {
            tree.blocks.announce(slot, &at(slot, 0.0));
            tree.blocks.push_moving(&mut tree.nodes.run[0], 0, slot, &at(slot, 0.0));
        }
        let run = tree.nodes.run[0];
        assert_eq!((run.active, run.len), (38, 70));
        assert_eq!(front(&tree, 38), (32..70).collect::<Vec<_>>());
        let all = tree.own_objects(tree.root()).map(|(slot, aabb)| (aabb, tree.aabb_of(slot)));
        let around = all.fold(Aabb::EMPTY, |around, (held, known)| {
            assert_eq!(Some(held), known);
            around.union(&held)
        });
        assert_eq!(tree.blocks.around(run), around);
    }

    #[test]
    fn movers_gather_at_the_front_of_their_run() {
        let mut tree = Tree::new(TreeConfig::default());
        (0..300).for_each(|slot| tree.insert(slot, &at(slot, 0.0)));
        tree.update();
        play(&mut tree, 0, 3);
        assert_eq!(tree.nodes.run[0].active, 30);
        assert_eq!(front(&tree, 30), (0..300).step_by(10).collect::<Vec<_>>());
        tree.remove(20);
        assert_eq!(tree.nodes.run[0].active, 29, "another one has taken its place");
        // Those that have come to rest are found out, and others take their places.
        play(&mut tree, 5, 3 * REVIEW);
        assert_eq!(front(&tree, 30), (5..300).step_by(10).collect::<Vec<_>>());
    }
}
