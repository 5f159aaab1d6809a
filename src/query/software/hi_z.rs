//! The hierarchy over the depth buffer: the farthest and the nearest nearness, sixteen at a time.
//!
//! A node of level 0 is a block and holds the extremes of its sixteen tiles; a node of each further
//! level holds those of 4 × 4 nodes below, up to a single node. The farthest of level 0 are
//! refreshed while drawing, where that lets something be skipped; all else before questions,
//! where something was drawn. Nearness only grows within a frame, so a stale `farthest` is still a
//! lower bound.

use rayon::prelude::*;

use super::depth::Depth;
use super::isa::{Isa, LANES, greatest, least};
use super::layout::{BLOCK_BITS, Block, TILE_BITS};
use super::level::SimdLevel;
use super::simd;

/// In the count of a block's changes: the hierarchy does not know of some of them.
pub(crate) const STALE: u32 = 1 << 31;

/// Blocks from which a refresh is shared among threads.
const SHARED_FROM: usize = 1024;

/// The hierarchy. The last level is a single node.
#[derive(Debug, Default)]
pub(crate) struct HiZ {
    levels: Vec<Level>,
    /// Of each block: changes since its farthest were refreshed, and [`STALE`].
    stale: Vec<u32>,
}

#[derive(Debug, Default)]
struct Level {
    across: usize,
    farthest: Vec<[f32; LANES]>,
    nearest: Vec<[f32; LANES]>,
}

/// What drawing needs of some blocks.
#[derive(Debug)]
pub(crate) struct Base<'a> {
    pub(crate) farthest: &'a mut [[f32; LANES]],
    pub(crate) stale: &'a mut [u32],
}

impl Base<'_> {
    /// Notes a change of a block. The count stays below [`STALE`]: it wraps to a small one.
    #[inline(always)]
    pub(crate) fn note(&mut self, block: usize) {
        self.stale[block] = self.stale[block].wrapping_add(1) | STALE;
    }
}

impl HiZ {
    /// Takes the size of a cleared depth buffer.
    pub(crate) fn reset(&mut self, depth: &Depth, cleared: f32) {
        let (width, height) = (depth.image().width(), depth.image().height());
        let mut count = 0;
        loop {
            let bits = BLOCK_BITS + TILE_BITS * count as u32;
            let [across, down] = [width, height].map(|side| side.div_ceil(1 << bits) as usize);
            if count == self.levels.len() {
                self.levels.push(Level::default());
            }
            let level = &mut self.levels[count];
            level.across = across;
            for values in [&mut level.farthest, &mut level.nearest] {
                values.clear();
                values.resize(across * down, [cleared; LANES]);
            }
            count += 1;
            if across == 1 && down == 1 {
                break;
            }
        }
        self.levels.truncate(count);
        self.stale.clear();
        self.stale.resize(depth.blocks().len(), 0);
        // Children beyond the viewport: they hide nothing, and nothing is before them.
        for l in 0..count {
            let bits = TILE_BITS * (l as u32 + 1);
            let [columns, rows] = [width, height].map(|side| side.div_ceil(1 << bits));
            let level = &mut self.levels[l];
            let down = level.farthest.len() / level.across;
            for node in 0..level.farthest.len() {
                let (x, y) = ((node % level.across) as u32, (node / level.across) as u32);
                if (x + 1) as usize != level.across && (y + 1) as usize != down {
                    continue;
                }
                for lane in 0..LANES as u32 {
                    if 4 * x + lane % 4 >= columns || 4 * y + lane / 4 >= rows {
                        level.farthest[node][lane as usize] = f32::INFINITY;
                        level.nearest[node][lane as usize] = f32::NEG_INFINITY;
                    }
                }
            }
        }
    }

    /// The farthest and the nearest nearness of the children of a node.
    #[inline(always)]
    pub(crate) fn node(&self, level: usize, x: u32, y: u32) -> (&[f32; LANES], &[f32; LANES]) {
        let l = &self.levels[level];
        let i = y as usize * l.across + x as usize;
        (&l.farthest[i], &l.nearest[i])
    }

    pub(crate) fn bytes(&self) -> usize {
        let level = |l: &Level| (l.farthest.capacity() + l.nearest.capacity()) * size_of::<[f32; LANES]>();
        self.levels.iter().map(level).sum::<usize>() + self.stale.capacity() * size_of::<u32>()
    }

    pub(crate) fn base(&mut self) -> Base<'_> {
        Base { farthest: &mut self.levels[0].farthest, stale: &mut self.stale }
    }

    /// The farthest of the tiles of every block.
    pub(crate) fn farthest(&self) -> &[[f32; LANES]] {
        &self.levels[0].farthest
    }

    /// The nearest of the tiles of every block.
    pub(crate) fn nearest(&self) -> &[[f32; LANES]] {
        &self.levels[0].nearest
    }

    /// Brings everything up to date. O(changed blocks), and a look at one word a block.
    pub(crate) fn refresh(&mut self, simd: SimdLevel, depth: &Depth) {
        let base = &mut self.levels[0];
        let across = base.across;
        let rows = |row: usize, farthest, nearest, stale: &[u32]| {
            let blocks = &depth.blocks()[row * across..][..across];
            simd::fold_row(simd, Row { blocks, farthest, nearest, stale });
        };
        let least_rows = if self.stale.len() < SHARED_FROM { usize::MAX } else { 8 };
        (
            base.farthest.par_chunks_mut(across),
            base.nearest.par_chunks_mut(across),
            self.stale.par_chunks(across),
        )
            .into_par_iter()
            .enumerate()
            .with_min_len(least_rows)
            .for_each(|(row, (farthest, nearest, stale))| rows(row, farthest, nearest, stale));
        for (block, stale) in self.stale.iter_mut().enumerate() {
            if std::mem::take(stale) & STALE == 0 {
                continue;
            }
            let (mut x, mut y) = ((block % across) as u32, (block / across) as u32);
            for level in 1..self.levels.len() {
                let (below, above) = self.levels.split_at_mut(level);
                let (below, above) = (&below[level - 1], &mut above[0]);
                let node = y as usize * below.across + x as usize;
                let far = least(&below.farthest[node]);
                let near = greatest(&below.nearest[node]);
                let lane = ((y & 3) << 2 | (x & 3)) as usize;
                (x, y) = (x >> TILE_BITS, y >> TILE_BITS);
                let node = y as usize * above.across + x as usize;
                let unchanged = above.farthest[node][lane] == far && above.nearest[node][lane] == near;
                (above.farthest[node][lane], above.nearest[node][lane]) = (far, near);
                if unchanged {
                    break;
                }
            }
        }
    }
}

/// A row of blocks and its nodes.
pub(crate) struct Row<'a> {
    blocks: &'a [Block],
    farthest: &'a mut [[f32; LANES]],
    nearest: &'a mut [[f32; LANES]],
    stale: &'a [u32],
}

/// Folds the pixels of the blocks that changed.
#[inline(always)]
pub(crate) fn fold_row<I: Isa>(row: Row<'_>) {
    for (block, pixels) in row.blocks.iter().enumerate() {
        if row.stale[block] & STALE == 0 {
            continue;
        }
        row.farthest[block] = I::store_f(I::least(&pixels.0));
        let nearest = I::greatest(&pixels.0);
        // Pixels beyond the viewport are infinitely near: they must not count.
        if I::gt_f(nearest, I::splat_f(f32::MAX)) == 0 {
            row.nearest[block] = I::store_f(nearest);
            continue;
        }
        let seen = pixels.0.map(|tile| tile.map(|n| if n == f32::INFINITY { f32::NEG_INFINITY } else { n }));
        row.nearest[block] = I::store_f(I::greatest(&seen));
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{BLOCK, within};
    use super::super::sink::{Id, Sink};
    use super::*;
    use crate::geom::PixelRect;
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    const SIZES: [(u32, u32); 8] =
        [(1, 1), (1, 33), (33, 1), (16, 16), (17, 9), (65, 3), (160, 90), (1023, 767)];

    /// The first node and child, of any level, that does not hold the extremes of its pixels.
    fn wrong_child(hi_z: &HiZ, depth: &Depth) -> Option<(usize, usize, usize)> {
        let (width, height) = (depth.image().width(), depth.image().height());
        for (l, level) in hi_z.levels.iter().enumerate() {
            let side = 1 << (TILE_BITS * (l as u32 + 1));
            for node in 0..level.farthest.len() {
                for lane in 0..LANES {
                    let x = (4 * (node % level.across) + lane % 4) as u32 * side;
                    let y = (4 * (node / level.across) + lane / 4) as u32 * side;
                    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
                    for y in y..(y + side).min(height) {
                        for x in x..(x + side).min(width) {
                            let n = depth.image().at(x, y);
                            (low, high) = (low.min(n), high.max(n));
                        }
                    }
                    if (level.farthest[node][lane], level.nearest[node][lane]) != (low, high) {
                        return Some((l, node, lane));
                    }
                }
            }
        }
        None
    }

    fn scatter(depth: &mut Depth, hi_z: &mut HiZ, dice: &mut ChaCha8Rng, rect: PixelRect) {
        let mut sinks: Vec<_> = depth.sinks(hi_z).collect();
        for _ in 0..rect.area().min(2000) {
            let (x, y) = (dice.random_range(rect.x0..rect.x1), dice.random_range(rect.y0..rect.y1));
            let sink = sinks.iter_mut().find(|sink| y as i32 <= sink.rows().last).expect("a band");
            let block = sink.rows().block(x as i32, y as i32);
            let (tile, lane) = within(x, y);
            let at = (block * LANES + tile) * LANES + lane;
            sink.sample(at, dice.random_range(0.0..1.0), Id::default());
        }
    }

    fn cleared(width: u32, height: u32) -> (Depth, HiZ) {
        let (mut depth, mut hi_z) = (Depth::default(), HiZ::default());
        depth.reset(width, height, 0.0);
        depth.settle();
        hi_z.reset(&depth, 0.0);
        (depth, hi_z)
    }

    #[test]
    fn nodes_hold_the_extremes_of_their_pixels_at_odd_sizes() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        for (width, height) in SIZES {
            let (mut depth, mut hi_z) = cleared(width, height);
            for simd in SimdLevel::ALL {
                let (x0, y0) = (dice.random_range(0..width), dice.random_range(0..height));
                let rect = PixelRect {
                    x0,
                    y0,
                    x1: dice.random_range(x0..width) + 1,
                    y1: dice.random_range(y0..height) + 1,
                };
                for rect in [rect, PixelRect { x0: width - 1, y0: height - 1, x1: width, y1: height }] {
                    scatter(&mut depth, &mut hi_z, &mut dice, rect);
                    hi_z.refresh(simd, &depth);
                    assert_eq!(wrong_child(&hi_z, &depth), None, "{width}×{height}");
                }
            }
            assert_eq!(hi_z.levels.last().expect("a level").farthest.len(), 1);
            assert!(BLOCK as u32 * 4_u32.pow(hi_z.levels.len() as u32 - 1) >= width.max(height));
        }
    }

    #[test]
    fn a_block_that_was_not_refreshed_is_found() {
        let mut dice = ChaCha8Rng::seed_from_u64(2);
        let (mut depth, mut hi_z) = cleared(100, 60);
        scatter(&mut depth, &mut hi_z, &mut dice, PixelRect { x0: 90, y0: 50, x1: 100, y1: 60 });
        assert!(wrong_child(&hi_z, &depth).is_some());
        hi_z.refresh(SimdLevel::Portable, &depth);
        assert!(wrong_child(&hi_z, &depth).is_none());
    }
}
