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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rect() -> impl Strategy<Value = PixelRect> {
        (0u32..1000, 0u32..700, 1u32..300, 1u32..300).prop_map(|(x0, y0, w, h)| PixelRect {
            x0,
            y0,
            x1: (x0 + w).min(1000),
            y1: (y0 + h).min(700),
        })
    }

    fn share_a_pixel(a: PixelRect, b: PixelRect) -> bool {
        a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1
    }

    proptest! {
        /// Rectangles that share a pixel always meet; those two tiles apart never do.
        #[test]
        fn meeting_is_conservative_and_tight(a in rect(), b in rect()) {
            let mut tiles = ScreenTiles::new(Viewport::new(1000, 700));
            prop_assert!(!tiles.cover(a));
            let meets = tiles.meets(b);
            prop_assert_eq!(meets, tiles.clone().cover(b));
            if share_a_pixel(a, b) {
                prop_assert!(meets);
            }
            let wide = PixelRect {
                x0: a.x0.saturating_sub(32),
                y0: a.y0.saturating_sub(32),
                x1: a.x1 + 32,
                y1: a.y1 + 32,
            };
            if !share_a_pixel(wide, b) {
                prop_assert!(!meets);
            }
        }
    }

    #[test]
    fn every_viewport_has_its_tiles() {
        for (width, height) in [(1, 1), (1, 16_384), (63, 65), (16_384, 16_384)] {
            let mut tiles = ScreenTiles::new(Viewport::new(width, height));
            let all = PixelRect { x0: 0, y0: 0, x1: width, y1: height };
            assert!(!tiles.cover(all));
            let corner = PixelRect { x0: width - 1, y0: height - 1, x1: width, y1: height };
            assert!(tiles.meets(corner));
            tiles.clear();
            assert!(!tiles.meets(all));
        }
    }
}
