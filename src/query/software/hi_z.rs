//! The hierarchy over the depth buffer: per tile the farthest and the nearest nearness.
//!
//! Level 0 has tiles of [`TILE_WIDTH`] × [`TILE_HEIGHT`] pixels, each further level halves both
//! counts and rounds them up, so the last row and column of an odd size fold into a parent of
//! their own. Tiles are refreshed lazily, before questions, where something was drawn. Nearness
//! only grows within a frame, so a stale `farthest` is still a lower bound.

use rayon::prelude::*;

use super::depth::Depth;
use super::raster::LANES;
use super::simd::{self, SimdLevel};
use crate::geom::PixelRect;

/// Pixels a tile, across: one block of lanes.
pub(crate) const TILE_WIDTH: u32 = LANES as u32;
/// Pixels a tile, down.
pub(crate) const TILE_HEIGHT: u32 = 8;

/// Touched tiles from which a refresh is shared among threads.
const SHARED_FROM: u32 = 1024;

/// The hierarchy. The last level is a single tile.
#[derive(Debug, Default)]
pub(crate) struct HiZ {
    levels: Vec<Level>,
    dirty: bool,
}

#[derive(Debug, Default)]
struct Level {
    width: usize,
    height: usize,
    farthest: Vec<f32>,
    nearest: Vec<f32>,
    /// A bit a tile, by rows of whole words.
    dirty: Vec<u64>,
}

impl Level {
    fn reset(&mut self, width: usize, height: usize, cleared: f32) {
        (self.width, self.height) = (width, height);
        for (values, value) in [(&mut self.farthest, cleared), (&mut self.nearest, cleared)] {
            values.clear();
            values.resize(width * height, value);
        }
        self.dirty.clear();
        self.dirty.resize(self.words() * height, 0);
    }

    fn words(&self) -> usize {
        self.width.div_ceil(64)
    }

    /// The number of dirty tiles.
    fn touched(&self) -> u32 {
        self.dirty.iter().map(|word| word.count_ones()).sum()
    }

    fn mark(&mut self, x: usize, y: usize) {
        let word = y * self.words() + x / 64;
        self.dirty[word] |= 1 << (x % 64);
    }
}

impl HiZ {
    /// Takes the size of a cleared depth buffer.
    pub(crate) fn reset(&mut self, width: u32, height: u32, cleared: f32) {
        let (mut w, mut h) = (width.div_ceil(TILE_WIDTH) as usize, height.div_ceil(TILE_HEIGHT) as usize);
        let mut count = 0;
        loop {
            if count == self.levels.len() {
                self.levels.push(Level::default());
            }
            self.levels[count].reset(w, h, cleared);
            count += 1;
            if w == 1 && h == 1 {
                break;
            }
            (w, h) = (w.div_ceil(2), h.div_ceil(2));
        }
        self.levels.truncate(count);
        self.dirty = false;
    }

    /// The farthest and the nearest nearness in a tile.
    #[inline(always)]
    pub(crate) fn tile(&self, level: usize, x: u32, y: u32) -> (f32, f32) {
        let l = &self.levels[level];
        let i = y as usize * l.width + x as usize;
        (l.farthest[i], l.nearest[i])
    }

    pub(crate) fn bytes(&self) -> usize {
        let level = |l: &Level| (l.farthest.capacity() + l.nearest.capacity()) * 4 + l.dirty.capacity() * 8;
        self.levels.iter().map(level).sum()
    }

    /// The lowest level where a rectangle meets at most 2 × 2 tiles, and those tiles, ends
    /// included. The rectangle is not empty.
    #[inline(always)]
    pub(crate) fn cover(&self, rect: &PixelRect) -> (usize, [u32; 2], [u32; 2]) {
        let first = [rect.x0 / TILE_WIDTH, rect.y0 / TILE_HEIGHT];
        let last = [(rect.x1 - 1) / TILE_WIDTH, (rect.y1 - 1) / TILE_HEIGHT];
        let mut level = 0;
        while (last[0] >> level) - (first[0] >> level) > 1 || (last[1] >> level) - (first[1] >> level) > 1 {
            level += 1;
        }
        (level, first.map(|v| v >> level), last.map(|v| v >> level))
    }

    /// A lower bound of the nearness in a rectangle: exact for its tiles if nothing was drawn
    /// since the last [`HiZ::refresh`], and true in any case.
    pub(crate) fn farthest(&self, rect: &PixelRect) -> f32 {
        let (level, first, last) = self.cover(rect);
        let mut farthest = f32::INFINITY;
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                farthest = farthest.min(self.tile(level, x, y).0);
            }
        }
        farthest
    }

    /// Notes that pixels of a rectangle, which is not empty, may have changed.
    pub(crate) fn touch(&mut self, rect: &PixelRect) {
        self.dirty = true;
        let level = &mut self.levels[0];
        let words = level.words();
        let (x0, x1) = ((rect.x0 / TILE_WIDTH) as usize, ((rect.x1 - 1) / TILE_WIDTH) as usize);
        for y in rect.y0 / TILE_HEIGHT..=(rect.y1 - 1) / TILE_HEIGHT {
            let row = &mut level.dirty[y as usize * words..][..words];
            for (word, bits) in row.iter_mut().enumerate().take(x1 / 64 + 1).skip(x0 / 64) {
                let from = if word == x0 / 64 { x0 % 64 } else { 0 };
                let to = if word == x1 / 64 { x1 % 64 } else { 63 };
                *bits |= (u64::MAX >> (63 - to)) & (u64::MAX << from);
            }
        }
    }

    /// Brings the touched tiles up to date. O(touched tiles), and a look at one bit a tile.
    pub(crate) fn refresh(&mut self, simd: SimdLevel, depth: &Depth) {
        if !std::mem::take(&mut self.dirty) {
            return;
        }
        let image = depth.image();
        let base = &mut self.levels[0];
        let (width, words) = (base.width, base.words());
        let fold = |row: usize, farthest: &mut [f32], nearest: &mut [f32], dirty: &[u64]| {
            let first = row * TILE_HEIGHT as usize;
            let rows = (image.height() as usize - first).min(TILE_HEIGHT as usize);
            let pixels = &depth.all()[first * depth.stride()..][..rows * depth.stride()];
            let (stride, width) = (depth.stride(), image.width() as usize);
            simd::fold_tiles(simd, TileRow { pixels, stride, width, dirty, farthest, nearest });
        };
        let least_rows = if base.touched() < SHARED_FROM { usize::MAX } else { 1 };
        (
            base.farthest.par_chunks_mut(width),
            base.nearest.par_chunks_mut(width),
            base.dirty.par_chunks(words),
        )
            .into_par_iter()
            .enumerate()
            .with_min_len(least_rows)
            .for_each(|(row, (farthest, nearest, dirty))| fold(row, farthest, nearest, dirty));
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            fold_level(&mut below[level - 1], &mut above[0]);
        }
        if let Some(top) = self.levels.last_mut() {
            top.dirty.fill(0);
        }
    }
}

/// Folds the touched tiles of a level into the level above, and clears their bits.
fn fold_level(below: &mut Level, above: &mut Level) {
    let words = below.words();
    for word in 0..below.dirty.len() {
        let mut bits = std::mem::take(&mut below.dirty[word]);
        let (y, x0) = (word / words, word % words * 64);
        while bits != 0 {
            let x = x0 + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            above.mark(x / 2, y / 2);
        }
    }
    let words = above.words();
    for word in 0..above.dirty.len() {
        let mut bits = above.dirty[word];
        let (y, x0) = (word / words, word % words * 64);
        while bits != 0 {
            let x = x0 + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let (mut farthest, mut nearest) = (f32::INFINITY, f32::NEG_INFINITY);
            for cy in 2 * y..(2 * y + 2).min(below.height) {
                for cx in 2 * x..(2 * x + 2).min(below.width) {
                    farthest = farthest.min(below.farthest[cy * below.width + cx]);
                    nearest = nearest.max(below.nearest[cy * below.width + cx]);
                }
            }
            above.farthest[y * above.width + x] = farthest;
            above.nearest[y * above.width + x] = nearest;
        }
    }
}

/// A row of level-0 tiles and the pixels under it.
pub(crate) struct TileRow<'a> {
    pixels: &'a [f32],
    stride: usize,
    /// Pixels of a row that count; the rest is padding.
    width: usize,
    dirty: &'a [u64],
    farthest: &'a mut [f32],
    nearest: &'a mut [f32],
}

/// Folds the pixels of the touched tiles of a row.
#[inline(always)]
pub(crate) fn fold_tiles(row: TileRow<'_>) {
    for (word, &bits) in row.dirty.iter().enumerate() {
        let mut bits = bits;
        while bits != 0 {
            let tile = word * 64 + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let mut low = [f32::INFINITY; LANES];
            let mut high = [f32::NEG_INFINITY; LANES];
            for pixels in row.pixels.chunks_exact(row.stride) {
                let Some(block) = pixels[tile * LANES..].first_chunk::<LANES>() else { continue };
                for i in 0..LANES {
                    low[i] = if block[i] < low[i] { block[i] } else { low[i] };
                    high[i] = if block[i] > high[i] { block[i] } else { high[i] };
                }
            }
            let columns = (row.width - tile * LANES).min(LANES);
            row.farthest[tile] = low[..columns].iter().fold(f32::INFINITY, |a, &b| a.min(b));
            row.nearest[tile] = high[..columns].iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::raster::{Id, Sink};
    use super::*;
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    const SIZES: [(u32, u32); 8] =
        [(1, 1), (1, 33), (33, 1), (16, 8), (17, 9), (17, 3), (160, 90), (1023, 767)];

    /// The first tile of any level that does not hold the extremes of its pixels.
    fn wrong_tile(hi_z: &HiZ, depth: &Depth) -> Option<(usize, u32, u32)> {
        let (width, height) = (depth.image().width(), depth.image().height());
        for (l, level) in hi_z.levels.iter().enumerate() {
            for y in 0..level.height as u32 {
                for x in 0..level.width as u32 {
                    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
                    for row in (y * TILE_HEIGHT) << l..(((y + 1) * TILE_HEIGHT) << l).min(height) {
                        let columns = ((x * TILE_WIDTH) << l) as usize
                            ..(((x + 1) * TILE_WIDTH) << l).min(width) as usize;
                        for &n in &depth.image().row(row)[columns] {
                            (low, high) = (low.min(n), high.max(n));
                        }
                    }
                    if hi_z.tile(l, x, y) != (low, high) {
                        return Some((l, x, y));
                    }
                }
            }
        }
        None
    }

    fn scatter(depth: &mut Depth, dice: &mut ChaCha8Rng, rect: PixelRect) {
        let [mut sink] = depth.sinks::<1>(depth.image().height() as usize);
        for _ in 0..rect.area().min(2000) {
            let (x, y) = (dice.random_range(rect.x0..rect.x1), dice.random_range(rect.y0..rect.y1));
            sink.sample(y as i32, x as i32, dice.random_range(0.0..1.0), Id::default());
        }
    }

    #[test]
    fn tiles_hold_the_extremes_of_their_pixels_at_odd_sizes() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        for (width, height) in SIZES {
            let (mut depth, mut hi_z) = (Depth::default(), HiZ::default());
            depth.reset(width, height, 0.0);
            hi_z.reset(width, height, 0.0);
            for simd in [SimdLevel::Scalar, SimdLevel::Avx2, SimdLevel::Avx512] {
                let (x0, y0) = (dice.random_range(0..width), dice.random_range(0..height));
                let rect = PixelRect {
                    x0,
                    y0,
                    x1: dice.random_range(x0..width) + 1,
                    y1: dice.random_range(y0..height) + 1,
                };
                for rect in [rect, PixelRect { x0: width - 1, y0: height - 1, x1: width, y1: height }] {
                    scatter(&mut depth, &mut dice, rect);
                    hi_z.touch(&rect);
                    hi_z.refresh(simd, &depth);
                    assert_eq!(wrong_tile(&hi_z, &depth), None, "{width}×{height}");
                }
            }
            let top = hi_z.levels.last().expect("a level");
            assert_eq!((top.width, top.height), (1, 1));
        }
    }

    #[test]
    fn a_tile_that_was_not_refreshed_is_found() {
        let mut dice = ChaCha8Rng::seed_from_u64(2);
        let (mut depth, mut hi_z) = (Depth::default(), HiZ::default());
        depth.reset(100, 60, 0.0);
        hi_z.reset(100, 60, 0.0);
        scatter(&mut depth, &mut dice, PixelRect { x0: 90, y0: 50, x1: 100, y1: 60 });
        hi_z.refresh(SimdLevel::Scalar, &depth);
        assert!(wrong_tile(&hi_z, &depth).is_some());
    }

    #[test]
    fn a_rectangle_meets_at_most_four_tiles_of_the_level_found() {
        let mut dice = ChaCha8Rng::seed_from_u64(3);
        for (width, height) in SIZES {
            let mut hi_z = HiZ::default();
            hi_z.reset(width, height, 0.0);
            for _ in 0..200 {
                let (x0, y0) = (dice.random_range(0..width), dice.random_range(0..height));
                let (x1, y1) = (dice.random_range(x0..width) + 1, dice.random_range(y0..height) + 1);
                let (level, first, last) = hi_z.cover(&PixelRect { x0, y0, x1, y1 });
                assert!(last[0] - first[0] <= 1 && last[1] - first[1] <= 1);
                let (w, h) = (TILE_WIDTH << level, TILE_HEIGHT << level);
                assert!(first[0] * w <= x0 && x1 <= (last[0] + 1) * w);
                assert!(first[1] * h <= y0 && y1 <= (last[1] + 1) * h);
                assert!((last[0] as usize) < hi_z.levels[level].width);
                assert!((last[1] as usize) < hi_z.levels[level].height);
            }
        }
    }
}
