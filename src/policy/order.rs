//! Which questions may be in flight together (Kovalčík & Tobola 2005, *colliding queries*).
//!
//! A farther box whose screen rectangle meets that of a nearer box still waiting is held back
//! until the nearer one is answered and drawn: what the nearer one hides is then in the depth
//! buffer. Rectangles are compared on a grid of 64 × 64 screen tiles, a bit a tile: a question
//! costs its rows of tiles, not the number of questions in flight. Two rectangles that only share
//! a tile count as meeting, which holds back a little more than needed.

use std::ops::RangeInclusive;

use crate::geom::{PixelRect, Viewport};

/// The tiles of the screen that waiting questions cover.
#[derive(Clone, Debug)]
pub struct ScreenTiles {
    rows: [u64; Self::SIDE],
    width: u32,
    height: u32,
}

impl ScreenTiles {
    /// Tiles along each side of the screen.
    pub const SIDE: usize = 64;

    /// No tile covered.
    pub fn new(viewport: Viewport) -> Self {
        Self { rows: [0; Self::SIDE], width: viewport.width, height: viewport.height }
    }

    /// Uncovers all tiles.
    pub fn clear(&mut self) {
        self.rows.fill(0);
    }

    /// Whether one of a rectangle's tiles is covered.
    pub fn meets(&self, rect: PixelRect) -> bool {
        let (rows, mask) = self.tiles(rect);
        self.rows[rows].iter().any(|row| row & mask != 0)
    }

    /// Covers the tiles of a rectangle; true if one of them was covered before.
    pub fn cover(&mut self, rect: PixelRect) -> bool {
        let (rows, mask) = self.tiles(rect);
        let mut met = false;
        for row in &mut self.rows[rows] {
            met |= *row & mask != 0;
            *row |= mask;
        }
        met
    }

    /// The rows of tiles that a rectangle meets, and its bits in each.
    fn tiles(&self, rect: PixelRect) -> (RangeInclusive<usize>, u64) {
        let (x0, x1) = (tile(rect.x0, self.width), tile(rect.x1.max(1) - 1, self.width));
        let (y0, y1) = (tile(rect.y0, self.height), tile(rect.y1.max(1) - 1, self.height));
        (y0..=y1, (u64::MAX >> (63 - (x1 - x0))) << x0)
    }
}

/// The tile of a pixel column or row.
fn tile(pixel: u32, size: u32) -> usize {
    let tile = u64::from(pixel) * ScreenTiles::SIDE as u64 / u64::from(size.max(1));
    (tile as usize).min(ScreenTiles::SIDE - 1)
}
