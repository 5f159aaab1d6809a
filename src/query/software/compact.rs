//! Draw calls of few triangles that cover few pixels: all vertices are one register, all triangles
//! another, and what they do to a tile is put together before the tile is touched.

use glam::Mat4;

use super::isa::{ALL, Isa, LANES, add_each, of_lane, store_each};
use super::layout::{TILE_BITS, within};
use super::raster::{Bounds, Ids};
use super::setup::{Corners, Setup, TileSteps};
use super::sink::{Id, Sink};
use super::tiles::Room;
use super::vertex::{Image, Screen};
use super::winding::Winding;
use crate::geom::PixelRect;
use crate::scene::meshlets::Single;
/// A draw call that is drawn as a whole; see [`Footprint::compact`](super::footprint::Footprint).
pub(crate) struct Whole<'a> {
    pub(crate) matrix: &'a Mat4,
    pub(crate) single: &'a Single,
    /// Its pixels in the band.
    pub(crate) rect: PixelRect,
    pub(crate) winding: Winding,
    /// Index of the call.
    pub(crate) call: u32,
}

impl Whole<'_> {
    /// Draws the call; returns how many of its triangles begin in the band.
    #[inline(always)]
    pub(crate) fn draw<I: Isa, S: Sink>(&self, screen: &Screen, room: &mut Room, sink: &mut S) -> u32 {
        let (rows, rect) = (sink.rows(), &self.rect);
        let corners = self.corners::<I>(screen);
        let lanes = ALL >> (LANES - self.single.count.min(LANES));
        let Bounds { kept, begin_here, .. } = Bounds::new(&corners, lanes, rows);
        let first = [rect.x0 >> TILE_BITS, rect.y0 >> TILE_BITS];
        let last = [(rect.x1 - 1) >> TILE_BITS, (rect.y1 - 1) >> TILE_BITS];
        let column = (first[0] << TILE_BITS) as i32;
        let row = (first[1] << TILE_BITS) as i32;
        let setup = Setup::new(&corners, I::splat(column), I::splat(row));
        let kept = kept & self.winding.drawn(setup.turned);
        room.kept.keep(&setup, kept);
        let ids = Ids {
            call: self.call,
            triangles: if S::WANTS_IDS { Some(&self.single.triangles) } else { None },
        };
        let tiles = TileSteps::new(&setup);
        let mut row_edge = setup.edge;
        for tile_y in first[1]..=last[1] {
            let mut edge = row_edge;
            for tile_x in first[0]..=last[0] {
                let mut met = kept & tiles.met(&edge);
                if met != 0 {
                    let (x, y) = (tile_x << TILE_BITS, tile_y << TILE_BITS);
                    let block = rows.block(x as i32, y as i32);
                    let (tile, _) = within(x, y);
                    let edges = store_each::<I, 2>([edge[1], edge[2]]);
                    let mut nearest = I::splat_f(f32::NEG_INFINITY);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let (covered, nearness) = room.kept.sample::<I>(lane, of_lane(&edges, lane));
                        if S::WANTS_IDS {
                            sink.tile::<I>(block, tile, covered, nearness, ids.of(lane));
                        } else {
                            nearest = I::blend_f(covered, nearest, I::max_f(nearness, nearest));
                        }
                    }
                    if !S::WANTS_IDS {
                        sink.tile::<I>(block, tile, ALL, nearest, Id::default());
                    }
                }
                edge = add_each::<I, 3>(edge, tiles.step_x);
            }
            row_edge = add_each::<I, 3>(row_edge, tiles.step_y);
        }
        begin_here.count_ones()
    }

    /// The corners of all triangles.
    #[inline(always)]
    fn corners<I: Isa>(&self, screen: &Screen) -> Corners<I> {
        let [x, y, z] = &self.single.positions;
        let image = Image::<I>::new(screen, self.matrix, [x, y, z]);
        let (xs, ys, ns) = (I::store(image.x), I::store(image.y), I::store_f(image.nearness));
        let mut corners = Corners { x: [image.x; 3], y: [image.y; 3], nearness: [image.nearness; 3] };
        for k in 0..3 {
            let at = I::load(&self.single.corners[k]);
            corners.x[k] = I::pick(&xs, at);
            corners.y[k] = I::pick(&ys, at);
            corners.nearness[k] = I::pick_f(&ns, at);
        }
        corners
    }
}
