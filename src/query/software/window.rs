//! The few tiles that a small proxy meets, and its samples in them.

use super::count::{LARGEST, value};
use super::depth::Depth;
use super::isa::{ALL, Isa, LANES, Mask, magnitude};
use super::layout::{LANE_X, LANE_Y, TILE, TILE_BITS};
use super::simd::prefetch;
use crate::geom::{PixelRect, Proxy};

/// Tiles along each side of a block.
const BLOCK_TILES: u32 = 1 << TILE_BITS;

/// The most tiles along each side of a window. No more than a block has: it meets two blocks at most.
const MOST_TILES: u32 = BLOCK_TILES;

/// Proxies of upright boxes in an upright view mostly have no more edges that cut them, and no more planes.
pub(crate) const FEW: usize = 2;

/// The tiles that a proxy meets, and which of their pixels are its.
#[derive(Clone, Copy, Default)]
pub(super) struct Window {
    /// The first tile.
    first: [u32; 2],
    /// The proxy's columns of pixels, a bit each, counted from the first tile's first.
    columns: u32,
    /// The same for rows.
    rows: u32,
    /// The blocks of 2 × 2 from the first on; where there is none, some other.
    pub(super) blocks: [u32; 4],
    /// The tiles of each; none of some other.
    tiles: [Mask; 4],
    /// Edges of the proxy in use.
    pub(super) edges: usize,
    /// Planes of the proxy in use.
    pub(super) planes: usize,
}

impl Window {
    /// The window of a proxy whose pixels in the viewport are `rect`; none if it is too large.
    #[inline(always)]
    pub(super) fn new(rect: &PixelRect, [edges, planes]: [usize; 2], depth: &Depth) -> Option<Self> {
        let first = [rect.x0 >> TILE_BITS, rect.y0 >> TILE_BITS];
        let last = [(rect.x1 - 1) >> TILE_BITS, (rect.y1 - 1) >> TILE_BITS];
        if last[0] - first[0] >= MOST_TILES || last[1] - first[1] >= MOST_TILES {
            return None;
        }
        let bits = |from: u32, len: u32| ((1 << len) - 1) << (from % TILE as u32);
        let (columns, rows) = (bits(rect.x0, rect.width()), bits(rect.y0, rect.height()));
        let across = depth.across() as u32;
        let block = first[1] / BLOCK_TILES * across + first[0] / BLOCK_TILES;
        let (right, below) = (
            u32::from(last[0] / BLOCK_TILES != first[0] / BLOCK_TILES),
            last[1] / BLOCK_TILES != first[1] / BLOCK_TILES,
        );
        let below = if below { across } else { 0 };
        // From the first block's first tile.
        let tile_columns = ((2 << (last[0] - first[0])) - 1) << (first[0] % BLOCK_TILES);
        let tile_rows = ((2 << (last[1] - first[1])) - 1) << (first[1] % BLOCK_TILES);
        Some(Self {
            first,
            columns,
            rows,
            blocks: [block, block + right, block + below, block + below + right],
            tiles: [
                quarter(tile_columns, tile_rows),
                quarter(tile_columns >> 4, tile_rows),
                quarter(tile_columns, tile_rows >> 4),
                quarter(tile_columns >> 4, tile_rows >> 4),
            ],
            edges,
            planes,
        })
    }

    /// Whether all pixels of all tiles are nearer than what is `nearest` of the proxy.
    #[inline(always)]
    pub(super) fn is_hidden<I: Isa>(&self, farthest: &[[f32; LANES]], nearest: f32) -> bool {
        let (nearest, mut left) = (I::splat_f(nearest), 0);
        for (&block, &tiles) in self.blocks.iter().zip(&self.tiles) {
            left |= tiles & !I::gt_f(I::load_f(&farthest[block as usize]), nearest);
        }
        left == 0
    }

    /// Whether no pixel of any tile is nearer than the proxy's farthest, `least`.
    #[inline(always)]
    pub(super) fn is_clear<I: Isa>(&self, nearest: &[[f32; LANES]], least: f32) -> bool {
        let (least, mut left) = (I::splat_f(least), 0);
        for (&block, &tiles) in self.blocks.iter().zip(&self.tiles) {
            left |= tiles & !I::ge_f(least, I::load_f(&nearest[block as usize]));
        }
        left == 0
    }

    /// Asks for the depth of all tiles.
    #[inline(always)]
    pub(super) fn prefetch(&self, depth: &Depth) {
        let [across, down] = self.size();
        for j in 0..down {
            for i in 0..across {
                prefetch(depth.tile(self.first[0] + i, self.first[1] + j));
            }
        }
    }

    /// How many samples the proxy covers, by its first `EDGES` edges.
    #[inline(always)]
    pub(super) fn covered<I: Isa, const EDGES: usize>(&self, proxy: &Proxy) -> u32 {
        let (zero, [left, top]) = (I::splat_f(0.0), self.first_offsets::<I>(proxy));
        let [across, down] = self.size();
        let (mut total, mut dy) = (0, top);
        for j in 0..down {
            let rows = SPREAD[(self.rows >> (4 * j) & 15) as usize];
            let mut dx = left;
            for i in 0..across {
                let outer = outer::<I, EDGES>(proxy, dx, dy);
                let columns = (self.columns >> (4 * i) & 15) * 0x1111;
                let covered = columns & rows & I::ge_f(outer, zero);
                total += covered.count_ones();
                dx = I::add_f(dx, I::splat_f(TILE as f32));
            }
            dy = I::add_f(dy, I::splat_f(TILE as f32));
        }
        total
    }

    /// How many samples are in sight and how many the proxy covers, by its first `EDGES` edges and
    /// `PLANES` planes.
    #[inline(always)]
    pub(super) fn compared<I: Isa, const EDGES: usize, const PLANES: usize>(
        &self,
        depth: &Depth,
        proxy: &Proxy,
    ) -> (u32, u32) {
        let (zero, [left, top]) = (I::splat_f(0.0), self.first_offsets::<I>(proxy));
        let [across, down] = self.size();
        let (mut visible, mut total, mut dy) = (0, 0, top);
        for j in 0..down {
            let rows = SPREAD[(self.rows >> (4 * j) & 15) as usize];
            let mut dx = left;
            for i in 0..across {
                let outer = outer::<I, EDGES>(proxy, dx, dy);
                let columns = (self.columns >> (4 * i) & 15) * 0x1111;
                let covered = columns & rows & I::ge_f(outer, zero);
                let mut entry = I::splat_f(proxy.nearest);
                for plane in &proxy.planes[..PLANES] {
                    entry = I::min_f(value::<I>(plane, dx, dy), entry);
                }
                let kept = I::load_f(depth.tile(self.first[0] + i, self.first[1] + j));
                total += covered.count_ones();
                visible += (covered & I::ge_f(entry, kept)).count_ones();
                dx = I::add_f(dx, I::splat_f(TILE as f32));
            }
            dy = I::add_f(dy, I::splat_f(TILE as f32));
        }
        (visible, total)
    }

    /// Columns and rows of tiles.
    #[inline(always)]
    fn size(&self) -> [u32; 2] {
        [self.columns, self.rows].map(|bits| (32 - bits.leading_zeros()).div_ceil(TILE as u32))
    }

    /// The contract's `dx` and `dy` in the first tile. These, and steps of a tile, are small
    /// numbers and halves, so all sums are exact.
    #[inline(always)]
    fn first_offsets<I: Isa>(&self, proxy: &Proxy) -> [I::F; 2] {
        let from = |axis: usize| (self.first[axis] * TILE as u32) as i32 - proxy.origin()[axis] as i32;
        let (x, y) = (I::splat(from(0)), I::splat(from(1)));
        let half = I::splat_f(0.5);
        [
            I::add_f(I::to_f(I::add(I::load(&LANE_X), x)), half),
            I::add_f(I::to_f(I::add(I::load(&LANE_Y), y)), half),
        ]
    }
}

/// The least of zero and of the first edges' functions.
#[inline(always)]
fn outer<I: Isa, const EDGES: usize>(proxy: &Proxy, dx: I::F, dy: I::F) -> I::F {
    let mut outer = I::splat_f(0.0);
    for edge in &proxy.edges[..EDGES] {
        outer = I::min_f(value::<I>(edge, dx, dy), outer);
    }
    outer
}

/// Four lanes for each bit of four: rows of a tile or of a block.
const SPREAD: [Mask; LANES] = [
    0x0000, 0x000F, 0x00F0, 0x00FF, 0x0F00, 0x0F0F, 0x0FF0, 0x0FFF, 0xF000, 0xF00F, 0xF0F0, 0xF0FF, 0xFF00,
    0xFF0F, 0xFFF0, 0xFFFF,
];

/// The tiles of a block, by the lowest four bits of columns and rows.
#[inline(always)]
fn quarter(columns: u32, rows: u32) -> Mask {
    let columns = (columns & 15) * 0x1111;
    columns & SPREAD[(rows & 15) as usize]
}

/// How many edges and planes a proxy uses: those at the end that say nothing do not count. None if
/// the proxy cannot be evaluated: [`is_usable`](super::count::is_usable).
#[inline(always)]
pub(super) fn used<I: Isa>(proxy: &Proxy) -> Option<[usize; 2]> {
    const A: f32 = LARGEST;
    const C: f32 = f32::MAX;
    let edges = proxy.edges.as_flattened();
    // Two registers that overlap: the first sixteen of eighteen coefficients, and the last.
    let mut parts = [[0.0; LANES]; 3];
    parts[0].copy_from_slice(&edges[..LANES]);
    parts[1].copy_from_slice(&edges[edges.len() - LANES..]);
    parts[2][..9].copy_from_slice(proxy.planes.as_flattened());
    let limits = [
        [A, A, C, A, A, C, A, A, C, A, A, C, A, A, C, A],
        [C, A, A, C, A, A, C, A, A, C, A, A, C, A, A, C],
        [A, A, C, A, A, C, A, A, C, C, C, C, C, C, C, C],
    ];
    let unused = [0.0, 0.0, C, 0.0, 0.0, C, 0.0, 0.0, C, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (mut fit, mut says) = (ALL, [0; 3]);
    for k in 0..3 {
        let v = I::load_f(&parts[k]);
        fit &= I::ge_f(I::load_f(&limits[k]), magnitude::<I>(v));
        let nothing = if k < 2 { I::splat_f(0.0) } else { I::load_f(&unused) };
        says[k] = I::gt_f(v, nothing) | I::gt_f(nothing, v);
    }
    let count = |says: u32| (32 - says.leading_zeros()).div_ceil(3) as usize;
    let fits = fit == ALL && !proxy.nearest.is_nan();
    fits.then(|| [count(says[0] | says[1] << (edges.len() - LANES)), count(says[2])])
}

/// The entry nearness of no sample is below this.
#[inline(always)]
pub(super) fn entry_least(proxy: &Proxy) -> f32 {
    let last = [proxy.rect.width() as f32 - 0.5, proxy.rect.height() as f32 - 0.5];
    let mut entry = proxy.nearest;
    for [a, b, c] in proxy.planes {
        let dx = if a >= 0.0 { 0.5 } else { last[0] };
        let dy = if b >= 0.0 { 0.5 } else { last[1] };
        let least = (a * dx + b * dy) + c;
        entry = if least < entry { least } else { entry };
    }
    entry
}

#[cfg(test)]
mod tests {
    use super::super::count::is_usable;
    use super::super::isa::Portable;
    use super::*;

    fn proxy(edges: usize, planes: usize) -> Proxy {
        let rect = PixelRect { x0: 0, y0: 0, x1: 4, y1: 4 };
        let mut proxy = Proxy { rect, edges: [[0.0; 3]; 6], planes: [[0.0, 0.0, f32::MAX]; 3], nearest: 0.5 };
        proxy.edges[..edges].fill([1.0, -2.0, 3.0]);
        proxy.planes[..planes].fill([0.0, 0.0, 0.25]);
        proxy
    }

    #[test]
    fn unused_edges_and_planes_at_the_end_are_told() {
        for (edges, planes) in (0..=6).flat_map(|edges| (0..=3).map(move |planes| (edges, planes))) {
            assert_eq!(used::<Portable>(&proxy(edges, planes)), Some([edges, planes]));
            let mut gap = proxy(edges, planes);
            gap.edges[0] = [0.0; 3];
            gap.planes[0] = [0.0, 0.0, f32::MAX];
            let rest = |count: usize| if count == 1 { 0 } else { count };
            assert_eq!(used::<Portable>(&gap), Some([rest(edges), rest(planes)]));
        }
    }

    #[test]
    fn what_cannot_be_evaluated_is_told_as_elsewhere() {
        let mut unusable = 0;
        for value in [0.0, -1.0, 1e33, -1e34, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            for at in 0..28 {
                let mut proxy = proxy(6, 3);
                let (edges, planes) = (proxy.edges.as_flattened_mut(), proxy.planes.as_flattened_mut());
                *edges.iter_mut().chain(planes).chain([&mut proxy.nearest]).nth(at).unwrap() = value;
                assert_eq!(used::<Portable>(&proxy).is_some(), is_usable(&proxy), "{value} at {at}");
                unusable += usize::from(!is_usable(&proxy));
            }
        }
        assert!(unusable > 80, "{unusable}");
    }
}
