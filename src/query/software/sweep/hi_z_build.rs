//! Hi-Z build (Rákos 2010): a pyramid of the farthest nearness, each texel that of four below.
//!
//! A level is half as wide and high as the one below, rounded *up*: so the last texel of an odd side is
//! that of the last column, row or corner alone, and nothing is left out. The published code rounds
//! down and folds the rest in, under a condition on the wrong size.
//!
//! Nearness grows toward the viewer under either depth direction: the farthest is always the least.

use rayon::prelude::*;

use super::super::DepthImage;

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
    pub(crate) fn build(&mut self, depth: DepthImage<'_>) {
        let (mut width, mut height) = (depth.width(), depth.height());
        let mut count = 0;
        while width > 1 || height > 1 {
            let below = [width, height];
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            if count == self.levels.len() {
                self.levels.push(PyramidLevel::default());
            }
            let (done, rest) = self.levels.split_at_mut(count);
            let level = &mut rest[0];
            (level.width, level.height) = (width, height);
            level.farthest.resize(width as usize * height as usize, 0.0);
            match done.last() {
                None => level.fold(below, |x, y| depth.at(x, y)),
                Some(done) => level.fold(below, |x, y| done.at(x, y)),
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

    /// Takes the least of each four texels of the level below, of this size.
    fn fold(&mut self, [below_width, below_height]: [u32; 2], below: impl Fn(u32, u32) -> f32 + Sync) {
        let row = |(y, row): (usize, &mut [f32])| {
            let (y0, y1) = (2 * y as u32, (2 * y as u32 + 1).min(below_height - 1));
            for (x, texel) in row.iter_mut().enumerate() {
                let (x0, x1) = (2 * x as u32, (2 * x as u32 + 1).min(below_width - 1));
                *texel = below(x0, y0).min(below(x1, y0)).min(below(x0, y1).min(below(x1, y1)));
            }
        };
        let width = self.width as usize;
        if self.farthest.len() < SHARED_FROM {
            self.farthest.chunks_mut(width).enumerate().for_each(row);
        } else {
            self.farthest.par_chunks_mut(width).enumerate().with_min_len(16).for_each(row);
        }
    }
}
