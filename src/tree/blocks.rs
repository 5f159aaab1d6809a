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

use super::block::{Block, LANES};
use super::runs::{FreeRuns, Run};
use crate::geom::Aabb;

/// No object, no node, no block.
pub(crate) const NONE: u32 = u32::MAX;
/// An object that has a box, but no lane yet.
const WAITING: u32 = u32::MAX - 1;

/// Blocks that are skipped at once where nothing has moved.
const REGION: usize = 64;

/// The arena of blocks, with the way from an object to its lane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    /// The node that each block belongs to.
    owner: Vec<u32>,
    /// A bit for each lane whose object has a new box since the last refresh.
    moved: Vec<u16>,
    /// Whether there is any such bit.
    stale: bool,
    free: FreeRuns,
    /// By object slot.
    known: Vec<Known>,
}

/// What is known of an object. Half a line of memory, so that it never lies in two.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Known {
    /// Its newest box.
    aabb: Aabb,
    /// Block × 16 + lane; [`NONE`] for an object that is not in the tree, or [`WAITING`].
    location: u32,
}

impl Known {
    const NOTHING: Self = Self { aabb: Aabb::EMPTY, location: NONE };
}

impl Blocks {
    /// The blocks of a run that hold objects.
    pub(crate) fn of(&self, run: Run) -> &[Block] {
        &self.blocks[run.used()]
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
        if s >= self.known.len() {
            grow(&mut self.known, s + 1, Known::NOTHING);
        }
        self.known[s] = Known { aabb: *aabb, location: WAITING };
    }

    /// Whether an object has a box, but no lane yet.
    pub(crate) fn is_waiting(&self, slot: u32) -> bool {
        self.known.get(slot as usize).is_some_and(|known| known.location == WAITING)
    }

    /// Forgets an object that waits for its lane.
    pub(crate) fn renounce(&mut self, slot: u32) {
        self.known[slot as usize].location = NONE;
    }

    /// Notes the new box of an object that the tree knows. O(1), and no block is touched.
    #[inline]
    pub(crate) fn set(&mut self, slot: u32, aabb: &Aabb) {
        let Some(known) = self.known.get_mut(slot as usize) else { return };
        let location = known.location;
        if location == NONE {
            return;
        }
        known.aabb = *aabb;
        if location != WAITING {
            self.mark(location as usize);
        }
    }

    /// Adds an object to a run. Amortised O(1).
    pub(crate) fn push(&mut self, run: &mut Run, node: u32, slot: u32, aabb: &Aabb) {
        if run.len == run.capacity() {
            self.reserve(run, node, run.len + 1);
        }
        let location = run.location(run.len);
        run.len += 1;
        self.blocks[location as usize / LANES].put(location as usize % LANES, slot, aabb);
        self.known[slot as usize].location = location;
    }

    /// Takes an object out of its run; the last one of the run takes its lane. Amortised O(1).
    pub(crate) fn remove(&mut self, run: &mut Run, node: u32, slot: u32) {
        let Some(hole) = self.location(slot) else { return };
        run.len -= 1;
        let last = run.location(run.len) as usize;
        let (last_block, last_lane) = (last / LANES, last % LANES);
        // What the last one has still to be refreshed by goes with it.
        let stale = self.moved[last_block] & (1 << last_lane) != 0;
        self.moved[hole / LANES] &= !(1 << (hole % LANES));
        self.moved[last_block] &= !(1 << last_lane);
        if hole != last {
            let mover = self.blocks[last_block].slots[last_lane];
            let aabb = self.blocks[last_block].aabb(last_lane);
            self.blocks[hole / LANES].put(hole % LANES, mover, &aabb);
            self.known[mover as usize].location = hole as u32;
            if stale {
                self.mark(hole);
            }
        }
        self.blocks[last_block].put(last_lane, NONE, &Aabb::EMPTY);
        self.known[slot as usize].location = NONE;
        if run.len == 0 {
            self.release(run);
        } else if run.is_sparse() {
            self.resize(run, node, Run::class_for(2 * run.len));
        }
    }

    /// Makes room for `count` objects in a run.
    pub(crate) fn reserve(&mut self, run: &mut Run, node: u32, count: u32) {
        if count > run.capacity() {
            self.resize(run, node, Run::class_for(count));
        }
    }

    /// Gives a run's blocks back. The locations of its objects are the caller's business.
    pub(crate) fn release(&mut self, run: &mut Run) {
        self.blocks[run.used()].fill(Block::EMPTY);
        self.moved[run.used()].fill(0);
        self.free.put(*run);
        *run = Run::EMPTY;
    }

    /// Hands a run's blocks to another node, as when the root grows.
    pub(crate) fn set_owner(&mut self, run: Run, node: u32) {
        self.owner[run.all()].fill(node);
    }

    /// The objects of a run, with their boxes, in storage order.
    pub(crate) fn items(&self, run: Run) -> impl Iterator<Item = (u32, Aabb)> {
        self.of(run).iter().flat_map(|block| {
            (0..LANES).map(|lane| (block.slots[lane], block.aabb(lane))).take_while(|(slot, _)| *slot != NONE)
        })
    }

    /// Brings the blocks in step with the boxes, and tells of each that changed whose it is, and how
    /// many of its objects moved. O(moved objects), and
    /// a look at two bytes for every sixteen that have not, unless none has.
    pub(super) fn refresh(&mut self, mut changed: impl FnMut(u32, u32)) {
        if !std::mem::take(&mut self.stale) {
            return;
        }
        for (region, moved) in self.moved.chunks_mut(REGION).enumerate() {
            if moved.iter().fold(0, |any, m| any | m) == 0 {
                continue;
            }
            let first = region * REGION;
            let owners = &self.owner[first..];
            for ((block, moved), &owner) in self.blocks[first..].iter_mut().zip(moved).zip(owners) {
                let mut rest = std::mem::take(moved);
                if rest == 0 {
                    continue;
                }
                changed(owner, rest.count_ones());
                if rest == u16::MAX {
                    // All of them: no looking for the next one.
                    for lane in 0..LANES {
                        block.set(lane, &self.known[block.slots[lane] as usize].aabb);
                    }
                    continue;
                }
                while rest != 0 {
                    let lane = rest.trailing_zeros() as usize % LANES;
                    rest &= rest - 1;
                    block.set(lane, &self.known[block.slots[lane] as usize].aabb);
                }
            }
        }
    }

    /// Memory held, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let block = size_of::<Block>() + size_of::<u32>() + size_of::<u16>();
        self.blocks.capacity() * block + self.known.capacity() * size_of::<Known>() + self.free.bytes()
    }

    #[inline]
    fn mark(&mut self, location: usize) {
        let block = location / LANES;
        self.moved[block] |= 1 << (location % LANES);
        self.stale = true;
    }

    fn location(&self, slot: u32) -> Option<usize> {
        self.known.get(slot as usize).map(|known| known.location as usize).filter(|&l| l < WAITING as usize)
    }

    /// Moves a run to one of another class, which must hold its objects.
    fn resize(&mut self, run: &mut Run, node: u32, class: u8) {
        let mut new = self.take_free(class, node);
        new.len = run.len;
        for (from, to) in run.used().zip(new.all()) {
            self.blocks[to] = self.blocks[from];
            self.moved[to] = self.moved[from];
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
            grow(&mut self.owner, total, NONE);
            grow(&mut self.moved, total, 0);
            run
        });
        self.owner[run.all()].fill(node);
        run
    }
}

/// Lengthens an array, with an eighth to spare: doubling would leave a third of the memory unused.
pub(super) fn grow<T: Clone>(array: &mut Vec<T>, len: usize, value: T) {
    if len > array.capacity() {
        array.reserve_exact(len + len / 8 - array.len());
    }
    array.resize(len, value);
}
