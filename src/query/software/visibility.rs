//! A second look at a finished frame: which draw calls own samples of it, and which triangle owns
//! each pixel. It rasterises the same triangles again; since the same triangle yields the same
//! bits, a sample is in sight exactly if its nearness is not below the stored one.

use super::SoftwareQueries;
use super::instance::Footprint;
use super::pass::DrawCall;
use super::raster::{ALL_LANES, HALF, Id, LANES, Rows, Sink};
use super::simd::Isa;
use super::vertex::Screen;
use super::waves::{self, MOST_BANDS};
use crate::geom::View;

/// What each pixel shows, row after row from the upper left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisibilityImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The draw call whose triangle is nearest, the first of several at the same nearness;
    /// [`VisibilityImage::NOTHING`] where none is.
    pub call: Vec<u32>,
    /// The triangle, an index into the triangles of the call's level.
    pub triangle: Vec<u32>,
    /// Its nearness.
    pub nearness: Vec<f32>,
    /// A bit a draw call, a row of words a band.
    seen: Vec<u64>,
}

impl VisibilityImage {
    /// In [`VisibilityImage::call`]: a pixel that nothing was drawn on.
    pub const NOTHING: u32 = u32::MAX;

    fn reset(&mut self, width: u32, height: u32) {
        (self.width, self.height) = (width, height);
        let pixels = width as usize * height as usize;
        for ids in [&mut self.call, &mut self.triangle] {
            ids.clear();
            ids.resize(pixels, Self::NOTHING);
        }
        self.nearness.clear();
    }
}

impl SoftwareQueries {
    /// Finds out what `calls`, all that the frame has drawn, show of themselves. `opaque` is what
    /// they are tested against, laid out like the depth buffer; the image is that of the frame's
    /// own depth. Returns a bit a draw call: whether it owns a sample.
    pub(crate) fn look<'a>(
        &mut self,
        view: &View,
        calls: &[DrawCall],
        opaque: &[f32],
        image: &'a mut VisibilityImage,
    ) -> &'a [u64] {
        let (screen, height) = (Screen::new(view), view.viewport().height);
        let hi_z = &self.hi_z;
        self.waves.survey(calls, |call| {
            let mut footprint = Footprint::new(view, &screen, call);
            // Every sample is farther than what is there. What is equally far counts as seen.
            if footprint.rect.is_some_and(|rect| footprint.nearest < hi_z.farthest(&rect)) {
                footprint.rect = None;
            }
            footprint
        });
        image.reset(view.viewport().width, height);
        for y in 0..height {
            image.nearness.extend_from_slice(self.depth.image().row(y));
        }
        let band_rows = waves::band_rows(height);
        let bands = (height as usize).div_ceil(band_rows);
        let words = calls.len().div_ceil(64).max(1);
        image.seen.clear();
        image.seen.resize(words * bands, 0);
        let (width, stride) = (image.width as usize, self.depth.stride());
        let mut call = image.call.chunks_mut(width * band_rows);
        let mut triangle = image.triangle.chunks_mut(width * band_rows);
        let mut seen = image.seen.chunks_mut(words);
        let mut opaque = opaque.chunks(stride * band_rows);
        let mut depth = self.depth.all().chunks(stride * band_rows);
        let mut sinks: [VisibilitySink<'_>; MOST_BANDS] = std::array::from_fn(|band| VisibilitySink {
            opaque: opaque.next().unwrap_or_default(),
            depth: depth.next().unwrap_or_default(),
            call: call.next().unwrap_or_default(),
            triangle: triangle.next().unwrap_or_default(),
            seen: seen.next().unwrap_or_default(),
            width,
            stride,
            rows: Rows {
                first: (band * band_rows) as i32,
                last: ((band + 1) * band_rows).min(height as usize) as i32 - 1,
                last_column: width as i32 - 1,
            },
        });
        self.waves.rasterise(self.simd, screen, calls, band_rows, &mut sinks[..bands]);
        let (all, others) = image.seen.split_at_mut(words);
        for band in others.chunks(words) {
            for (all, band) in all.iter_mut().zip(band) {
                *all |= band;
            }
        }
        all
    }
}

/// Looks at the samples of a band of rows.
struct VisibilitySink<'a> {
    opaque: &'a [f32],
    depth: &'a [f32],
    call: &'a mut [u32],
    triangle: &'a mut [u32],
    seen: &'a mut [u64],
    width: usize,
    stride: usize,
    rows: Rows,
}

impl Sink for VisibilitySink<'_> {
    const WANTS_IDS: bool = true;

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
        id: Id,
    ) {
        let mut covered = I::negative(outside) ^ ALL_LANES;
        while covered != 0 {
            let i = covered.trailing_zeros();
            covered &= covered - 1;
            self.sample(row, column + i as i32, nearness[i as usize], id);
        }
    }

    #[inline(always)]
    fn pair<I: Isa>(
        &mut self,
        row: i32,
        column: i32,
        outside: &[i32; LANES],
        nearness: &[f32; LANES],
        id: Id,
    ) {
        let mut covered = I::negative(outside) ^ ALL_LANES;
        while covered != 0 {
            let i = covered.trailing_zeros() as usize;
            covered &= covered - 1;
            self.sample(row + (i / HALF) as i32, column + (i % HALF) as i32, nearness[i], id);
        }
    }

    #[inline(always)]
    fn sample(&mut self, row: i32, column: i32, nearness: f32, id: Id) {
        let row = (row - self.rows.first) as usize;
        let stored = row * self.stride + column as usize;
        if nearness >= self.opaque[stored] {
            self.seen[id.call as usize / 64] |= 1 << (id.call % 64);
        }
        if nearness >= self.depth[stored] {
            let pixel = row * self.width + column as usize;
            let kept = (self.call[pixel], self.triangle[pixel]);
            // The order of rasterisation depends on the number of threads; the least id does not.
            if (id.call, id.triangle) < kept {
                (self.call[pixel], self.triangle[pixel]) = (id.call, id.triangle);
            }
        }
    }
}
