//! Which questions may be in flight together (Kovalčík & Tobola 2005, *colliding queries*).
//!
//! A farther box whose screen rectangle meets that of a nearer box still waiting is held back
//! until the nearer one is answered and drawn: what the nearer one hides is then in the depth
//! buffer. Rectangles are compared on a grid of 64 × 64 screen tiles, a bit a tile: a question
//! costs its rows of tiles, not the number of questions in flight. Two rectangles that only share
//! a tile count as meeting, which holds back a little more than needed.
//!
//! A node that was hidden in the last frame is expected to be hidden again, and would add nothing
//! to the depth buffer: it waits for others, but nothing waits for it (ours).

use crate::geom::{PixelRect, Viewport};

/// The first and last tiles that a rectangle meets, across and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileRect {
    x: [u8; 2],
    y: [u8; 2],
}

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

    /// The tiles that a rectangle meets.
    pub fn of(&self, rect: PixelRect) -> TileRect {
        let across = |x| tile(x, self.width);
        let down = |y| tile(y, self.height);
        TileRect {
            x: [across(rect.x0), across(rect.x1.max(rect.x0 + 1) - 1)],
            y: [down(rect.y0), down(rect.y1.max(rect.y0 + 1) - 1)],
        }
    }

    /// Whether one of these tiles is covered.
    pub fn meets(&self, tiles: TileRect) -> bool {
        let mask = tiles.mask();
        self.rows[tiles.rows()].iter().any(|row| row & mask != 0)
    }

    /// Covers tiles; true if one of them was covered before.
    pub fn cover(&mut self, tiles: TileRect) -> bool {
        let mask = tiles.mask();
        let mut met = 0;
        for row in &mut self.rows[tiles.rows()] {
            met |= *row & mask;
            *row |= mask;
        }
        met != 0
    }
}

impl TileRect {
    fn rows(self) -> std::ops::RangeInclusive<usize> {
        self.y[0] as usize..=self.y[1] as usize
    }

    /// Its bits in each of its rows.
    fn mask(self) -> u64 {
        (u64::MAX >> (63 - (self.x[1] - self.x[0]))) << self.x[0]
    }
}

/// The tile of a pixel column or row.
fn tile(pixel: u32, size: u32) -> u8 {
    let tile = u64::from(pixel) * ScreenTiles::SIDE as u64 / u64::from(size.max(1));
    tile.min(ScreenTiles::SIDE as u64 - 1) as u8
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
            prop_assert!(!tiles.cover(tiles.of(a)));
            let meets = tiles.meets(tiles.of(b));
            prop_assert_eq!(meets, tiles.clone().cover(tiles.of(b)));
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
            assert!(!tiles.cover(tiles.of(all)));
            let corner = PixelRect { x0: width - 1, y0: height - 1, x1: width, y1: height };
            assert!(tiles.meets(tiles.of(corner)));
            tiles.clear();
            assert!(!tiles.meets(tiles.of(all)));
        }
    }
}
