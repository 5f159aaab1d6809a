//! The boxes of the objects, sixteen to a block, each coordinate contiguous.
//!
//! A node's objects fill a *run*: a power of two of consecutive blocks, dense from the front.
//! Lanes past the end hold the empty box, which is neutral under union and outside every
//! frustum, so that loops over a run need no tail.

use crate::geom::Aabb;

/// Objects a block: one 512-bit register a coordinate.
pub const LANES: usize = 16;

/// No object, no node, no block.
pub(crate) const NONE: u32 = u32::MAX;

/// Sixteen boxes as six rows of coordinates, and whose they are.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Block {
    /// Least x, least y, least z.
    pub min: [[f32; LANES]; 3],
    /// Greatest x, greatest y, greatest z.
    pub max: [[f32; LANES]; 3],
    /// Object slots; `u32::MAX` in lanes that hold no object.
    pub slots: [u32; LANES],
}

impl Block {
    const EMPTY: Self =
        Self { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3], slots: [NONE; LANES] };

    /// The box of one lane.
    pub fn aabb(&self, lane: usize) -> Aabb {
        Aabb::new(self.min.map(|row| row[lane]).into(), self.max.map(|row| row[lane]).into())
    }

    fn put(&mut self, lane: usize, slot: u32, aabb: &Aabb) {
        for axis in 0..3 {
            self.min[axis][lane] = aabb.min[axis];
            self.max[axis][lane] = aabb.max[axis];
        }
        self.slots[lane] = slot;
    }

    /// The box around all lanes. Four partial results keep the compiler free to vectorise.
    fn bounds(&self) -> Aabb {
        let mut all = Aabb::EMPTY;
        for axis in 0..3 {
            all.min[axis] = fold_rows(&self.min[axis], f32::INFINITY, f32::min);
            all.max[axis] = fold_rows(&self.max[axis], f32::NEG_INFINITY, f32::max);
        }
        all
    }
}

fn fold_rows(row: &[f32; LANES], start: f32, f: impl Fn(f32, f32) -> f32) -> f32 {
    let mut part = [start; 4];
    for chunk in row.chunks_exact(4) {
        for (p, &x) in part.iter_mut().zip(chunk) {
            *p = f(*p, x);
        }
    }
    f(f(part[0], part[1]), f(part[2], part[3]))
}

/// A node's share of the arena.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    first: u32,
    /// The run has `1 << class` blocks.
    class: u8,
    /// Objects in it.
    pub(crate) len: u32,
}

impl Run {
    /// A run without any block.
    pub(crate) const EMPTY: Self = Self { first: NONE, class: 0, len: 0 };

    fn capacity(self) -> u32 {
        if self.first == NONE { 0 } else { (LANES as u32) << self.class }
    }

    /// Blocks that hold objects.
    fn used(self) -> std::ops::Range<usize> {
        if self.len == 0 {
            return 0..0;
        }
        let first = self.first as usize;
        first..first + (self.len as usize).div_ceil(LANES)
    }

    fn location(self, index: u32) -> u32 {
        self.first * LANES as u32 + index
    }
}

/// The arena of blocks, with the way from an object to its lane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    /// The node that each block belongs to.
    owner: Vec<u32>,
    /// First blocks of the free runs, by class.
    free: Vec<Vec<u32>>,
    /// Block × 16 + lane of each object slot; [`NONE`] for one that is not in the tree.
    location: Vec<u32>,
}

impl Blocks {
    /// The blocks of a run that hold objects.
    pub(crate) fn of(&self, run: Run) -> &[Block] {
        &self.blocks[run.used()]
    }

    /// The node that holds an object, if the tree does.
    pub(crate) fn owner_of(&self, slot: u32) -> Option<u32> {
        let location = self.location(slot)?;
        Some(self.owner[location / LANES])
    }

    /// The box of an object, if the tree holds it.
    pub(crate) fn aabb_of(&self, slot: u32) -> Option<Aabb> {
        let location = self.location(slot)?;
        Some(self.blocks[location / LANES].aabb(location % LANES))
    }

    /// Overwrites the box of an object that the tree holds. O(1).
    pub(crate) fn set(&mut self, slot: u32, aabb: &Aabb) {
        if let Some(location) = self.location(slot) {
            self.blocks[location / LANES].put(location % LANES, slot, aabb);
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
        if slot as usize >= self.location.len() {
            self.location.resize(slot as usize + 1, NONE);
        }
        self.location[slot as usize] = location;
    }

    /// Takes an object out of its run; the last one of the run takes its lane. Amortised O(1).
    pub(crate) fn remove(&mut self, run: &mut Run, node: u32, slot: u32) {
        let Some(hole) = self.location(slot) else { return };
        run.len -= 1;
        let last = run.location(run.len) as usize;
        let (last_block, last_lane) = (last / LANES, last % LANES);
        if hole != last {
            let mover = self.blocks[last_block].slots[last_lane];
            let aabb = self.blocks[last_block].aabb(last_lane);
            self.blocks[hole / LANES].put(hole % LANES, mover, &aabb);
            self.location[mover as usize] = hole as u32;
        }
        self.blocks[last_block].put(last_lane, NONE, &Aabb::EMPTY);
        self.location[slot as usize] = NONE;
        if run.len == 0 {
            self.release(run);
        } else if run.class > 0 && run.len * 4 <= run.capacity() {
            self.resize(run, node, run.class - 1);
        }
    }

    /// Makes room for `count` objects in a run.
    pub(crate) fn reserve(&mut self, run: &mut Run, node: u32, count: u32) {
        if count > run.capacity() {
            let class = count.div_ceil(LANES as u32).next_power_of_two().trailing_zeros() as u8;
            self.resize(run, node, class);
        }
    }

    /// Moves a run to one of `1 << class` blocks, which must hold its objects.
    fn resize(&mut self, run: &mut Run, node: u32, class: u8) {
        let first = self.take_free(class, node);
        for (i, block) in run.used().enumerate() {
            self.blocks[first as usize + i] = self.blocks[block];
            for lane in 0..LANES {
                let slot = self.blocks[block].slots[lane];
                if slot != NONE {
                    self.location[slot as usize] = (first + i as u32) * LANES as u32 + lane as u32;
                }
            }
        }
        let len = run.len;
        self.release(run);
        *run = Run { first, class, len };
    }

    /// Gives a run's blocks back. The locations of its objects are the caller's business.
    pub(crate) fn release(&mut self, run: &mut Run) {
        if run.first != NONE {
            self.blocks[run.used()].fill(Block::EMPTY);
            self.free[run.class as usize].push(run.first);
        }
        *run = Run::EMPTY;
    }

    /// Hands a run's blocks to another node, as when the root grows.
    pub(crate) fn set_owner(&mut self, run: Run, node: u32) {
        if run.first != NONE {
            let first = run.first as usize;
            self.owner[first..first + (1 << run.class)].fill(node);
        }
    }

    /// The box around a run.
    pub(crate) fn bounds(&self, run: Run) -> Aabb {
        self.of(run).iter().fold(Aabb::EMPTY, |all, block| all.union(&block.bounds()))
    }

    /// The objects of a run, with their boxes, in storage order.
    pub(crate) fn items(&self, run: Run) -> impl Iterator<Item = (u32, Aabb)> {
        self.of(run).iter().flat_map(|block| {
            (0..LANES).map(|lane| (block.slots[lane], block.aabb(lane))).take_while(|(slot, _)| *slot != NONE)
        })
    }

    /// Memory held, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
            + self.owner.capacity() * size_of::<u32>()
            + self.location.capacity() * size_of::<u32>()
            + self.free.iter().map(|f| f.capacity() * size_of::<u32>()).sum::<usize>()
    }

    fn location(&self, slot: u32) -> Option<usize> {
        self.location.get(slot as usize).filter(|&&l| l != NONE).map(|&l| l as usize)
    }

    fn take_free(&mut self, class: u8, node: u32) -> u32 {
        let class = class as usize;
        if class >= self.free.len() {
            self.free.resize_with(class + 1, Vec::new);
        }
        let blocks = 1 << class;
        let first = self.free[class].pop().unwrap_or_else(|| {
            let first = self.blocks.len() as u32;
            self.blocks.resize(self.blocks.len() + blocks, Block::EMPTY);
            self.owner.resize(self.blocks.len(), NONE);
            first
        });
        self.owner[first as usize..first as usize + blocks].fill(node);
        first
    }
}
