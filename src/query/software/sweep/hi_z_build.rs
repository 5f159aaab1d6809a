//! Hi-Z build (Rákos 2010): a pyramid of the farthest nearness, each texel that of four below.
//!
//! A level is half as wide and high as the one below, rounded *up*: so the last texel of an odd side is
//! that of the last column, row or corner alone, and nothing is left out. The published code rounds
//! down and folds the rest in, under a condition on the wrong size.
//!
//! Nearness grows toward the viewer under either depth direction: the farthest is always the least.

use rayon::prelude::*;

use super::super::depth::Depth;
use super::super::layout::{BLOCK, BLOCK_BITS, TILE, within};

/// Texels from which the rows of a level are shared among threads.
const SHARED_FROM: usize = 1 << 16;

/// The pyramid over a depth buffer. Level 0, the buffer itself, is not kept.
#[derive(Clone, Debug, Default)]
pub struct Pyramid {
    /// From level 1, half the size, to the single texel; none for a buffer of one pixel.
    levels: Vec<PyramidLevel>,
}

/// A level of the pyramid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PyramidLevel {
    /// Texels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The farthest nearness of each texel's pixels, row by row from the upper left corner.
    pub farthest: Vec<f32>,
}

impl Pyramid {
    /// The levels, from level 1; to look at.
    pub fn levels(&self) -> &[PyramidLevel] {
        &self.levels
    }

    /// Builds all levels. O(pixels).
    pub(crate) fn build(&mut self, depth: &Depth) {
        let (mut width, mut height) = (depth.image().width(), depth.image().height());
        let mut count = 0;
        while width > 1 || height > 1 {
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            if count == self.levels.len() {
                self.levels.push(PyramidLevel::default());
            }
            let (done, rest) = self.levels.split_at_mut(count);
            let level = &mut rest[0];
            (level.width, level.height) = (width, height);
            level.farthest.resize(width as usize * height as usize, 0.0);
            match done.last() {
                None => level.fold_pixels(depth),
                Some(below) => level.fold(below),
            }
            count += 1;
        }
        self.levels.truncate(count);
    }
}

impl PyramidLevel {
    /// A texel.
    pub fn at(&self, x: u32, y: u32) -> f32 {
        self.farthest[(y * self.width + x) as usize]
    }

    /// Takes the least of each four pixels, as the depth buffer lies. Pixels beyond the viewport are
    /// infinitely near: the least is that of the others.
    fn fold_pixels(&mut self, depth: &Depth) {
        self.rows(|y, row| {
            let blocks = &depth.blocks()[((2 * y) >> BLOCK_BITS) * depth.across()..];
            for (block, texels) in blocks.iter().zip(row.chunks_mut(BLOCK as usize / 2)) {
                for (x, texel) in texels.iter_mut().enumerate() {
                    let (tile, lane) = within(2 * x as u32, 2 * y as u32);
                    let pixels = &block.0[tile];
                    let pair = |lane: usize| pixels[lane].min(pixels[lane + 1]);
                    *texel = pair(lane).min(pair(lane + TILE as usize));
                }
            }
        });
    }

    /// Takes the least of each four texels of the level below.
    fn fold(&mut self, below: &Self) {
        let (width, last) = (below.width as usize, below.height as usize - 1);
        self.rows(|y, row| {
            let line = |y: usize| &below.farthest[y.min(last) * width..][..width];
            let (upper, lower) = (line(2 * y).chunks(2), line(2 * y + 1).chunks(2));
            for (texel, (upper, lower)) in row.iter_mut().zip(upper.zip(lower)) {
                *texel = upper.iter().chain(lower).copied().fold(f32::INFINITY, f32::min);
            }
        });
    }

    /// Fills its rows, on several threads if there is much to do.
    fn rows(&mut self, fill: impl Fn(usize, &mut [f32]) + Sync) {
        let (width, fill) = (self.width as usize, |(y, row): (usize, &mut [f32])| fill(y, row));
        if self.farthest.len() < SHARED_FROM {
            self.farthest.chunks_mut(width).enumerate().for_each(fill);
        } else {
            self.farthest.par_chunks_mut(width).enumerate().with_min_len(16).for_each(fill);
        }
    }
}
