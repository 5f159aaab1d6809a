//! Rectangles of pixels.

/// A rectangle of whole pixels of the viewport, half open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl PixelRect {
    /// Columns.
    pub const fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// How many pixels.
    pub const fn area(&self) -> u64 {
        self.width() as u64 * self.height() as u64
    }

    /// Whether a pixel is one of them.
    pub const fn contains(&self, x: u32, y: u32) -> bool {
        self.x0 <= x && x < self.x1 && self.y0 <= y && y < self.y1
    }
}
