//! The boxes of the objects: by slot, as the app gave them, and in blocks of sixteen by node.
//!
//! ```text
//!   known[slot]  ◀── written by edits, in the app's order     (half a line of memory an edit)
//!      │ refresh: block by block, the lanes that moved
//!      ▼
//!   blocks[run of a node]  ──▶ read by questions, refits and builds, in the tree's order
//! ```
//!
//! A node's objects fill a *run* of consecutive blocks, dense from the front. Lanes past the end
//! hold the empty box, so that loops over a run need no tail. An edit touches six lines of memory
//! in a block but one in `known`: so edits go there, and the blocks follow once an update.
//!
//! Objects that keep moving gather at the front of their run, so that most blocks are of movers
//! alone or of objects that stand still: the latter are not touched.

use glam::Vec4;

use super::block::{Block, LANES, lanes};
use super::gather::Words;
use super::hull::Hull;
use super::runs::{FreeRuns, Run};
use super::stale::Stale;
use crate::geom::Aabb;
use crate::query::software::prefetch;

/// No object, no node, no block.
pub(crate) const NONE: u32 = u32::MAX;
/// An object that has a box, but no lane yet.
const WAITING: u32 = u32::MAX - 1;

/// The arena of blocks, with the way from an object to its lane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocks {
    pub(super) blocks: Vec<Block>,
    /// The box around each block.
    pub(super) hulls: Vec<Hull>,
    /// The node that each block belongs to.
    pub(super) owner: Vec<u32>,
    /// The blocks of which any object has a new box since the last refresh.
    pub(super) stale: Stale,
    /// What the last refresh of each block found.
    pub(super) news: Vec<News>,
    pub(super) free: FreeRuns,
    /// By object slot; the last is none's, and no box.
    pub(super) known: Vec<Known>,
}

/// What the refresh of a block found: a bit for each lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct News {
    /// How many have moved.
    pub(super) count: u16,
    /// It moved.
    pub(super) moved: u16,
    /// It moved, and had the time before, but is not in front of its run.
    pub(super) again: u16,
    /// Its node may not hold it any more.
    pub(super) out: u16,
}

/// What is known of an object: its newest box, and where it is (block × 16 + lane; [`NONE`] for an object
/// that is not in the tree, or [`WAITING`]).
type Known = Words;

/// The newest boxes, taken apart: what is written to one of the arrays cannot change where the others
/// are, and a loop need not look.
pub(crate) struct Newest<'a> {
    known: &'a mut [Known],
    stale: &'a mut [u8],
}

impl Newest<'_> {
    /// Slots that there may be.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.known.len()
    }

    /// Those below a slot.
    #[inline(always)]
    pub(crate) fn up_to(self, slot: usize) -> Self {
        Self { known: &mut self.known[..slot], ..self }
    }

    /// Notes the new box of an object that has a lane; false for another one. O(1).
    #[inline(always)]
    pub(crate) fn set(&mut self, slot: u32, aabb: &Aabb) -> bool {
        let Some(known) = self.known.get_mut(slot as usize) else { return false };
        // Neither NONE nor WAITING is in a block.
        let Some(stale) = self.stale.get_mut(known.location as usize / LANES) else { return false };
        known.aabb = *aabb;
        *stale = 1;
        true
    }
}

/// The newest boxes, with the objects' tags.
#[derive(Clone, Copy)]
pub(crate) struct Tagged<'a>(&'a [Known]);

impl Tagged<'_> {
    /// Slots that are asked of memory ahead of their turn, should it come: a page of memory, for within one
    /// the machine asks ahead by itself.
    const AHEAD: usize = 4096 / size_of::<Known>();

    /// Whether an object has this tag, which is not 0, and this box. O(1), without a branch for each
    /// coordinate.
    #[inline(always)]
    pub(crate) fn has(self, slot: u32, tag: u32, aabb: &Aabb) -> bool {
        // The middle coordinates are there twice, so that each half is a load.
        let halves = |Aabb { min, max }: Aabb| {
            [Vec4::new(min.x, min.y, min.z, max.x), Vec4::new(min.z, max.x, max.y, max.z)]
        };
        prefetch(self.0.get((slot as usize).wrapping_add(Self::AHEAD)).unwrap_or(&Known::NOTHING));
        self.0.get(slot as usize).is_some_and(|known| {
            let ([a, b], [c, d]) = (halves(known.aabb), halves(*aabb));
            known.tag == tag && (a.cmpeq(c) & b.cmpeq(d)).all()
        })
    }
}

impl Blocks {
    /// The blocks of a run that hold objects, with a bit for each lane that does.
    #[inline(always)]
    pub(crate) fn of(&self, run: Run) -> impl Iterator<Item = (&Block, u16)> {
        let mut left = run.len as usize;
        self.blocks[run.used()].iter().map(move |block| {
            let held = if left < LANES { (1 << left) - 1 } else { u16::MAX };
            left = left.saturating_sub(LANES);
            (block, held)
        })
    }

    /// The node that holds an object, if one does.
    pub(crate) fn owner_of(&self, slot: u32) -> Option<u32> {
        let location = self.location(slot)?;
        Some(self.owner[location / LANES])
    }

    /// The newest box of an object, if the tree knows it.
    pub(crate) fn aabb_of(&self, slot: u32) -> Option<Aabb> {
        self.known.get(slot as usize).filter(|known| known.location != NONE).map(|known| known.aabb)
    }

    /// Takes an object's box; its lane is given later.
    pub(crate) fn announce(&mut self, slot: u32, aabb: &Aabb) {
        let s = slot as usize;
        if s + 1 >= self.known.len() {
            grow(&mut self.known, s + 2, Known::NOTHING);
        }
        self.known[s] = Known::new(aabb, WAITING);
    }

    /// Whether an object has a box, but no lane yet.
    pub(crate) fn is_waiting(&self, slot: u32) -> bool {
        self.known.get(slot as usize).is_some_and(|known| known.location == WAITING)
    }

    /// Forgets an object that waits for its lane.
    pub(crate) fn renounce(&mut self, slot: u32) {
        self.known[slot as usize].location = NONE;
    }

    /// Gives an object that the tree knows a tag.
    pub(crate) fn set_tag(&mut self, slot: u32, tag: u32) {
        if let Some(known) = self.known.get_mut(slot as usize) {
            known.tag = tag;
        }
    }

    /// The newest boxes, to look at many.
    pub(crate) fn tagged(&self) -> Tagged<'_> {
        Tagged(&self.known)
    }

    /// Notes the new box of an object that the tree knows. O(1), and no block is touched.
    pub(crate) fn set(&mut self, slot: u32, aabb: &Aabb) {
        let Some(known) = self.known.get_mut(slot as usize) else { return };
        if known.location == NONE {
            return;
        }
        known.aabb = *aabb;
        if known.location != WAITING {
            self.stale.mark(known.location as usize / LANES);
        }
    }

    /// The newest boxes, to note many.
    #[inline(always)]
    pub(crate) fn newest(&mut self) -> Newest<'_> {
        Newest { known: &mut self.known, stale: self.stale.bytes_mut() }
    }

    /// Adds an object to a run. Amortised O(1).
    pub(crate) fn push(&mut self, run: &mut Run, node: u32, slot: u32, aabb: &Aabb) {
        if run.len == run.capacity() {
            self.reserve(run, node, run.len + 1);
        }
        let location = run.location(run.len);
        run.len += 1;
        self.put(location, slot, aabb);
        self.hulls[location / LANES].unite(&Hull::around(aabb));
    }

    /// The same for an object that moves: it takes the lane behind the last of those, and what stood there
    /// goes to the end.
    pub(crate) fn push_moving(&mut self, run: &mut Run, node: u32, slot: u32, aabb: &Aabb) {
        if run.len < LANES as u32 {
            // Movers need not be together before there are two blocks.
            return self.push(run, node, slot, aabb);
        }
        if run.active == run.len {
            self.push(run, node, slot, aabb);
        } else {
            let (still, still_aabb) = self.item(run.location(run.active));
            self.push(run, node, still, &still_aabb);
            // The run may have gone elsewhere for it.
            let (at, end) = (run.location(run.active), run.location(run.len - 1));
            self.follow(at, end);
            self.news[end / LANES].moved &= !(1 << (end % LANES));
            self.put(at, slot, aabb);
            self.measure(at / LANES);
        }
        run.active += 1;
    }

    /// Takes an object out of its run; the last mover takes its lane, if it was one, and the last
    /// object of the run the lane that is left. Amortised O(1).
    pub(crate) fn remove(&mut self, run: &mut Run, node: u32, slot: u32) {
        let Some(mut hole) = self.location(slot) else { return };
        if hole < run.location(run.active) {
            run.active -= 1;
            hole = self.fill_hole(hole, run.location(run.active));
        }
        run.len -= 1;
        hole = self.fill_hole(hole, run.location(run.len));
        self.blocks[hole / LANES].put(hole % LANES, NONE, &Aabb::EMPTY);
        self.measure(hole / LANES);
        self.known[slot as usize].location = NONE;
        if run.len == 0 {
            self.release(run);
        } else if run.is_sparse() {
            self.resize(run, node, Run::class_for(2 * run.len));
        }
    }

    /// Makes an object of a run, by its index there, one of the movers at its front.
    pub(super) fn promote(&mut self, run: &mut Run, index: u32) {
        let (from, to) = (run.location(index), run.location(run.active));
        run.active += 1;
        if from == to {
            return;
        }
        let (mover, still) = (self.item(from), self.item(to));
        self.put(to, mover.0, &mover.1);
        self.put(from, still.0, &still.1);
        self.news[from / LANES].moved &= !(1 << (from % LANES));
        self.measure(to / LANES);
        self.measure(from / LANES);
        self.follow(from, to);
        self.follow(to, from);
    }

    /// Makes room for `count` objects in a run.
    pub(crate) fn reserve(&mut self, run: &mut Run, node: u32, count: u32) {
        if count > run.capacity() {
            self.resize(run, node, Run::class_for(count));
        }
    }

    /// Sees to it that there is room for as many blocks as objects on the move will come to take, so
    /// that no later update stops to move the arena.
    pub(crate) fn leave_room(&mut self) {
        let more = self.blocks.len().div_ceil(4);
        self.blocks.reserve_exact(more);
        self.hulls.reserve_exact(more);
        self.owner.reserve_exact(more);
        self.stale.reserve(more);
        self.news.reserve_exact(more);
    }

    /// Gives a run's blocks back. The locations of its objects are the caller's business.
    pub(crate) fn release(&mut self, run: &mut Run) {
        self.blocks[run.used()].fill(Block::EMPTY);
        self.hulls[run.used()].fill(Hull::EMPTY);
        // Of a block that has run empty too: what it was told before was its node's business.
        self.stale.clear(run.all());
        self.news[run.all()].fill(News::default());
        self.free.put(*run);
        *run = Run::EMPTY;
    }

    /// Hands a run's blocks to another node, as when the root grows.
    pub(crate) fn set_owner(&mut self, run: Run, node: u32) {
        self.owner[run.all()].fill(node);
    }

    /// The objects of a run, with their boxes, in storage order.
    pub(crate) fn items(&self, run: Run) -> impl Iterator<Item = (u32, Aabb)> {
        self.of(run).flat_map(|(block, held)| lanes(held).map(|lane| (block.slots[lane], block.aabb(lane))))
    }

    /// The box around the objects of a run.
    #[inline(always)]
    pub(super) fn around(&self, run: Run) -> Aabb {
        // By turns in two, so that one union need not wait for the other.
        let (mut all, mut other) = (Hull::EMPTY, Hull::EMPTY);
        let (pairs, last) = self.hulls[run.used()].as_chunks::<2>();
        for [one, two] in pairs {
            all.unite(one);
            other.unite(two);
        }
        last.iter().for_each(|hull| all.unite(hull));
        all.unite(&other);
        all.aabb()
    }

    /// Memory held, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let block = size_of::<Block>() + size_of::<Hull>() + size_of::<u32>() + size_of::<News>();
        self.blocks.capacity() * block
            + self.stale.bytes()
            + self.known.capacity() * size_of::<Known>()
            + self.free.bytes()
    }

    fn item(&self, location: usize) -> (u32, Aabb) {
        let (block, lane) = (&self.blocks[location / LANES], location % LANES);
        (block.slots[lane], block.aabb(lane))
    }

    fn put(&mut self, location: usize, slot: u32, aabb: &Aabb) {
        self.blocks[location / LANES].put(location % LANES, slot, aabb);
        self.known[slot as usize].location = location as u32;
    }

    /// Moves an object to the lane of one that is gone; returns the lane that it leaves.
    fn fill_hole(&mut self, hole: usize, from: usize) -> usize {
        if hole != from {
            let (slot, aabb) = self.item(from);
            self.put(hole, slot, &aabb);
            self.measure(hole / LANES);
            self.follow(from, hole);
        }
        from
    }

    /// What an object has still to be refreshed by goes with it.
    fn follow(&mut self, from: usize, to: usize) {
        self.stale.follow(from / LANES, to / LANES);
    }

    fn measure(&mut self, block: usize) {
        self.hulls[block] = self.blocks[block].hull();
    }

    fn location(&self, slot: u32) -> Option<usize> {
        self.known.get(slot as usize).map(|known| known.location as usize).filter(|&l| l < WAITING as usize)
    }

    /// Moves a run to one of another class, which must hold its objects.
    fn resize(&mut self, run: &mut Run, node: u32, class: u8) {
        let mut new = self.take_free(class, node);
        new.len = run.len;
        new.active = run.active;
        for (from, to) in run.used().zip(new.all()) {
            self.blocks[to] = self.blocks[from];
            self.hulls[to] = self.hulls[from];
            self.stale.follow(from, to);
            self.news[to] = self.news[from];
            for (lane, &slot) in self.blocks[to].slots.iter().enumerate() {
                if slot != NONE {
                    self.known[slot as usize].location = (to * LANES + lane) as u32;
                }
            }
        }
        self.release(run);
        *run = new;
    }

    fn take_free(&mut self, class: u8, node: u32) -> Run {
        let run = self.free.take(class).unwrap_or_else(|| {
            let run = Run::new(self.blocks.len() as u32, class);
            let total = run.all().end;
            grow(&mut self.blocks, total, Block::EMPTY);
            grow(&mut self.hulls, total, Hull::EMPTY);
            grow(&mut self.owner, total, NONE);
            self.stale.set_len(total);
            grow(&mut self.news, total, News::default());
            run
        });
        self.owner[run.all()].fill(node);
        run
    }
}

/// An array that grows has room for this part of it to spare: with twice the room, as is usual, a third
/// of the memory would lie unused.
const SPARE: usize = 8;

/// Lengthens an array, with some room to spare.
pub(crate) fn grow<T: Clone>(array: &mut Vec<T>, len: usize, value: T) {
    if len > array.capacity() {
        array.reserve_exact(len + len / SPARE - array.len());
    }
    array.resize(len, value);
}
