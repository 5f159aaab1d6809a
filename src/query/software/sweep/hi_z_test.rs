//! Hi-Z test (Rákos 2010): a rectangle and its nearest point against at most four texels.
//!
//! The level is ⌈log₂ d⌉, d from the first to the last pixel of the rectangle's longer side: pixels no
//! farther apart than a texel is wide lie in at most two texels a side. The published code takes one level
//! less, where they may lie in three, and looks at the first and the last of them.
//!
//! What passes [`SweepTest::Raster`](crate::query::SweepTest::Raster) passes here: a sample of the proxy
//! that is in sight lies in the rectangle, is no nearer than the nearest point, and its stored depth is
//! no farther than the farthest of its texel.

use super::super::DepthImage;
use super::hi_z_build::Pyramid;
use crate::geom::{PixelRect, Proxy};

impl Pyramid {
    /// Whether the rectangle of a proxy may have a sample in sight.
    pub(crate) fn passes(&self, depth: DepthImage<'_>, proxy: &Proxy) -> bool {
        let PixelRect { x0, y0, x1, y1 } = proxy.rect;
        let (x1, y1) = (x1.min(depth.width()), y1.min(depth.height()));
        if x0 >= x1 || y0 >= y1 {
            return false;
        }
        let level = level_for((x1 - x0).max(y1 - y0));
        let (first, last) = ([x0, y0].map(|v| v >> level), [x1 - 1, y1 - 1].map(|v| v >> level));
        let farthest = |x, y| match level {
            0 => depth.at(x, y),
            _ => self.levels()[level as usize - 1].at(x, y),
        };
        [[first[0], first[1]], [last[0], first[1]], [first[0], last[1]], last]
            .into_iter()
            .any(|[x, y]| proxy.nearest >= farthest(x, y))
    }
}

/// The lowest level at which so many pixels in a row lie in at most two texels.
fn level_for(pixels: u32) -> u32 {
    (pixels - 1).next_power_of_two().trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_lies_in_at_most_two_texels_a_side_and_no_level_lower_would_do() {
        for pixels in 1..300_u32 {
            let level = level_for(pixels);
            let texels =
                |level: u32| (0..512).map(|at| ((at + pixels - 1) >> level) - (at >> level) + 1).max();
            assert!(texels(level) <= Some(2), "{pixels} pixels at level {level}");
            assert!(level == 0 || texels(level - 1) > Some(2), "{pixels} pixels fit level {}", level - 1);
        }
    }
}
