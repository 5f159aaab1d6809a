//! The depth buffer and its sink.

use super::raster::{HALF, Id, LANES, Rows, Sink};
use super::simd::Isa;

/// Nearness of every pixel, row by row. A row has room for a block that starts at any column.
#[derive(Debug, Default)]
pub(crate) struct Depth {
    width: u32,
    height: u32,
    stride: usize,
    nearness: Vec<f32>,
}

impl Depth {
    /// Takes a size and clears.
    pub(crate) fn reset(&mut self, width: u32, height: u32, cleared: f32) {
        self.width = width;
        self.height = height;
        self.stride = (width as usize).next_multiple_of(LANES) + LANES;
        self.nearness.clear();
        self.nearness.resize(self.stride * height as usize, cleared);
    }

    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    pub(crate) fn all(&self) -> &[f32] {
        &self.nearness
    }

    pub(crate) fn image(&self) -> DepthImage<'_> {
        DepthImage { depth: self }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.nearness.capacity() * size_of::<f32>()
    }

    /// One sink a band of rows, from the top; fewer bands than `N` leave empty sinks.
    pub(crate) fn sinks<const N: usize>(&mut self, band_rows: usize) -> [DepthSink<'_>; N] {
        let (stride, last_column, height) = (self.stride, self.width as i32 - 1, self.height as i32);
        let mut bands = self.nearness.chunks_mut(stride * band_rows);
        std::array::from_fn(|band| {
            let first = (band * band_rows) as i32;
            let last = (first + band_rows as i32).min(height) - 1;
            DepthSink {
                nearness: bands.next().unwrap_or_default(),
                stride,
                rows: Rows { first, last, last_column },
            }
        })
    }
}

/// The depth of a frame, to read. Cleared pixels hold
/// [`DepthDirection::cleared`](crate::geom::DepthDirection::cleared).
#[derive(Clone, Copy, Debug)]
pub struct DepthImage<'a> {
    depth: &'a Depth,
}

impl<'a> DepthImage<'a> {
    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.depth.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.depth.height
    }

    /// The nearness of a row's pixels, from the left; row 0 is the uppermost.
    pub fn row(&self, y: u32) -> &'a [f32] {
        &self.depth.nearness[y as usize * self.depth.stride..][..self.depth.width as usize]
    }
}

/// Keeps the greatest nearness of a band of rows.
#[derive(Debug)]
pub(crate) struct DepthSink<'a> {
    nearness: &'a mut [f32],
    stride: usize,
    rows: Rows,
}

impl Sink for DepthSink<'_> {
    const WANTS_IDS: bool = false;

    #[inline(always)]
    fn rows(&self) -> Rows {
        self.rows
    }

    #[inline(always)]
    fn block<I: Isa>(
        &mut self,
        row: i32,
        column: i32,
        outside: &[i32; LANES],
        nearness: &[f32; LANES],
        _: Id,
    ) {
        let start = (row - self.rows.first) as usize * self.stride + column as usize;
        let Some(kept) = self.nearness[start..].first_chunk_mut::<LANES>() else { return };
        let mut covered = [0.0_f32; LANES];
        for i in 0..LANES {
            covered[i] = masked(nearness[i], outside[i]);
        }
        I::keep_greatest(kept, &covered);
    }

    #[inline(always)]
    fn pair<I: Isa>(
        &mut self,
        row: i32,
        column: i32,
        outside: &[i32; LANES],
        nearness: &[f32; LANES],
        _: Id,
    ) {
        let start = (row - self.rows.first) as usize * self.stride + column as usize;
        let mut covered = [0.0_f32; LANES];
        for i in 0..LANES {
            covered[i] = masked(nearness[i], outside[i]);
        }
        // A row has room for a block at any column, so what is left of the band reaches beyond
        // `stride` unless the upper row is its last.
        let Some((upper, rest)) = self.nearness[start..].split_first_chunk_mut::<HALF>() else { return };
        let mut none = [0.0_f32; HALF];
        let lower = rest.get_mut(self.stride - HALF..).and_then(|rest| rest.first_chunk_mut::<HALF>());
        let lower = lower.unwrap_or(&mut none);
        let mut kept = [0.0_f32; LANES];
        kept[..HALF].copy_from_slice(upper);
        kept[HALF..].copy_from_slice(lower);
        I::keep_greatest(&mut kept, &covered);
        upper.copy_from_slice(&kept[..HALF]);
        lower.copy_from_slice(&kept[HALF..]);
    }

    #[inline(always)]
    fn sample(&mut self, row: i32, column: i32, nearness: f32, _: Id) {
        let kept = &mut self.nearness[(row - self.rows.first) as usize * self.stride + column as usize];
        // Stored in any case: which one is nearer cannot be foretold.
        *kept = if nearness > *kept { nearness } else { *kept };
    }
}

/// A nearness, or minus infinity if `outside` is negative. In bits, for want of branches.
#[inline(always)]
fn masked(nearness: f32, outside: i32) -> f32 {
    let mask = (outside >> 31) as u32;
    f32::from_bits((nearness.to_bits() & !mask) | (f32::NEG_INFINITY.to_bits() & mask))
}
