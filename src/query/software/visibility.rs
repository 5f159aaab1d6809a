//! A second look at a finished frame: which draw calls own samples of it, and which triangle owns
//! each pixel. It rasterises the same triangles again; since the same triangle yields the same
//! bits, a sample is in sight exactly if its nearness is not below the stored one.

use rayon::prelude::*;

use super::SoftwareQueries;
use super::isa::{Isa, LANES, Mask};
use super::layout::{BLOCK_BITS, BLOCK_PIXELS, Block, within};
use super::pass::DrawCall;
use super::sink::{Id, Rows, Sink};
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
    /// Call and triangle of each pixel, as the depth buffer lies.
    owners: Vec<Owner>,
    /// A bit a draw call, a row of words a band.
    seen: Vec<u64>,
}

/// A draw call and a triangle of it.
type Owner = (u32, u32);

impl VisibilityImage {
    /// In [`VisibilityImage::call`]: a pixel that nothing was drawn on.
    pub const NOTHING: u32 = u32::MAX;
}

/// What is drawn later is tested against: the depth of a moment, and the farthest of its tiles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot {
    blocks: Vec<Block>,
    farthest: Vec<[f32; LANES]>,
}

impl SoftwareQueries {
    /// Takes the depth as it is now.
    pub(crate) fn keep(&mut self, snapshot: &mut Snapshot) {
        self.depth.settle();
        self.hi_z.refresh(self.simd, &self.depth);
        snapshot.blocks.clear();
        snapshot.blocks.extend_from_slice(self.depth.blocks());
        snapshot.farthest.clear();
        snapshot.farthest.extend_from_slice(self.hi_z.farthest());
    }

    /// Finds out what `calls`, all that the frame has drawn, show of themselves. `opaque` is what
    /// they are tested against; the image is that of the frame's own depth. Returns a bit a draw
    /// call: whether it owns a sample.
    pub(crate) fn look<'a>(
        &mut self,
        view: &View,
        calls: &[DrawCall],
        opaque: &Snapshot,
        image: &'a mut VisibilityImage,
    ) -> &'a [u64] {
        let many = self.depth.blocks_a_band();
        let words = calls.len().div_ceil(64).max(1);
        image.owners.clear();
        image.owners.resize(
            self.depth.blocks().len() * BLOCK_PIXELS,
            (VisibilityImage::NOTHING, VisibilityImage::NOTHING),
        );
        image.seen.clear();
        image.seen.resize(words * (self.depth.rows().len() + 1), 0);
        let (all, by_band) = image.seen.split_at_mut(words);
        let frame = opaque.blocks.par_chunks(many).zip(opaque.farthest.par_chunks(many));
        let marks = image.owners.par_chunks_mut(many * BLOCK_PIXELS).zip(by_band.par_chunks_mut(words));
        let bands = frame.zip(marks).zip(self.depth.blocks().par_chunks(many)).zip(self.depth.rows());
        let sinks = bands.map(|((((opaque, farthest), (owners, seen)), depth), rows)| VisibilitySink {
            opaque,
            farthest,
            depth,
            owners,
            seen,
            rows,
        });
        self.bands.rasterise(self.simd, view, calls, sinks);
        for band in by_band.chunks(words) {
            for (all, band) in all.iter_mut().zip(band) {
                *all |= band;
            }
        }
        self.unfold(image);
        &image.seen[..words]
    }

    /// Fills the image's rows.
    fn unfold(&self, image: &mut VisibilityImage) {
        let depth = self.depth.image();
        (image.width, image.height) = (depth.width(), depth.height());
        image.call.clear();
        image.triangle.clear();
        image.nearness.clear();
        for y in 0..image.height {
            image.nearness.extend(depth.row(y));
            let row = (y >> BLOCK_BITS) as usize * self.depth.across();
            let owners = (0..image.width).map(|x| {
                let (tile, lane) = within(x, y);
                let block = row + (x >> BLOCK_BITS) as usize;
                image.owners[block * BLOCK_PIXELS + tile * LANES + lane]
            });
            for (call, triangle) in owners {
                image.call.push(call);
                image.triangle.push(triangle);
            }
        }
    }
}

/// Looks at the samples of a band of rows.
struct VisibilitySink<'a> {
    opaque: &'a [Block],
    farthest: &'a [[f32; LANES]],
    depth: &'a [Block],
    owners: &'a mut [Owner],
    seen: &'a mut [u64],
    rows: Rows,
}

impl Sink for VisibilitySink<'_> {
    const WANTS_IDS: bool = true;

    #[inline(always)]
    fn rows(&self) -> Rows {
        self.rows
    }

    #[inline(always)]
    fn hides_tiles<I: Isa>(&mut self, block: usize, tiles: Mask, nearest: I::F) -> bool {
        tiles & self.open_tiles::<I>(block, nearest) == 0
    }

    /// Those where not everything is nearer. What is equally far counts as seen.
    #[inline(always)]
    fn open_tiles<I: Isa>(&mut self, block: usize, greatest: I::F) -> Mask {
        I::ge_f(greatest, I::load_f(&self.farthest[block]))
    }

    #[inline(always)]
    fn tile<I: Isa>(&mut self, block: usize, tile: usize, mut covered: Mask, nearness: I::F, id: Id) {
        let nearness = I::store_f(nearness);
        while covered != 0 {
            let lane = covered.trailing_zeros() as usize;
            covered &= covered - 1;
            self.sample((block * LANES + tile) * LANES + lane, nearness[lane], id);
        }
    }

    #[inline(always)]
    fn sample(&mut self, at: usize, nearness: f32, id: Id) {
        let (block, tile, lane) = (at / BLOCK_PIXELS, at / LANES % LANES, at % LANES);
        if nearness >= self.opaque[block].0[tile][lane] {
            self.seen[id.call as usize / 64] |= 1 << (id.call % 64);
        }
        if nearness >= self.depth[block].0[tile][lane] {
            // The order of rasterisation is not that of the ids; the least id is always the same.
            let owner = &mut self.owners[at];
            *owner = (*owner).min((id.call, id.triangle));
        }
    }
}
