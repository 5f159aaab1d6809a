//! Drawing what is in sight: the depth buffer, with a note of who showed a sample.
//!
//! A draw call *shows* if a sample of it is not behind what was drawn before it; what is equally near
//! counts. One that does not show changes no depth: to draw it is to test it, by the very bits that drawing
//! yields, and both are one pass over its triangles. Calls come in order, each tested against all before.
//! What shows in the end was not behind anything before it either, so nothing of it is missed.

use rayon::prelude::*;

use super::SoftwareQueries;
use super::depth::{DepthSink, REFRESH_CALL, REFRESH_TRIANGLE};
use super::isa::{Isa, Mask};
use super::sink::{Id, Rows, Sink};
use crate::geom::View;
use crate::query::Ticket;
use crate::scene::ObjectRef;

/// Room to note who shows.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// A bit a draw call, a row of words a band.
    bits: Vec<u64>,
}

impl SoftwareQueries {
    /// Draws what objects have recorded, the owned calls from `first` on, and answers which of them show.
    /// Of who recorded nothing, nobody knows: it counts as shown.
    pub(super) fn draw_seen(&mut self, ticket: Ticket, view: &View, first: usize, objects: &[ObjectRef]) {
        let (pass, mut found) = (std::mem::take(&mut self.pass), self.sweeps.new_set());
        let (calls, owners) = (pass.calls(), &self.owned.owners[first..]);
        let words = calls.len().div_ceil(64).max(1);
        let bits = &mut self.seen.bits;
        bits.clear();
        bits.resize(words * self.depth.rows().len(), 0);
        let bands = self.depth.sinks(&mut self.hi_z).zip(bits.par_chunks_mut(words));
        let sinks = bands.map(|(depth, seen)| SeenSink { depth, seen, call: 0, is_seen: false });
        let work = self.bands.rasterise(self.simd, view, calls, sinks);
        self.stats.add(calls.len(), work);

        let shows = |call: usize| bits.chunks(words).any(|band| band[call / 64] & (1 << (call % 64)) != 0);
        let mut next = 0;
        for object in objects {
            let own = owners[next..].iter().take_while(|&&owner| owner == object.id).count();
            if own == 0 || (next..next + own).any(shows) {
                found.insert(object.id);
            }
            next += own;
        }
        self.sweeps.answer(ticket, found);
        self.pass = pass;
    }
}

/// The depth of a band of rows, with a bit a draw call: it showed a sample there.
struct SeenSink<'a> {
    depth: DepthSink<'a>,
    seen: &'a mut [u64],
    /// The draw call that is under way: ids are not kept apart where small ones are put together.
    call: u32,
    /// Whether it has shown one.
    is_seen: bool,
}

impl Sink for SeenSink<'_> {
    const WANTS_IDS: bool = false;

    #[inline(always)]
    fn begin(&mut self) {
        self.depth.begin();
    }

    #[inline(always)]
    fn rows(&self) -> Rows {
        self.depth.rows()
    }

    #[inline(always)]
    fn wants(&mut self, call: u32) -> bool {
        self.call = call;
        self.is_seen = self.seen[call as usize / 64] & (1 << (call % 64)) != 0;
        true
    }

    #[inline(always)]
    fn hides_tiles<I: Isa>(&mut self, block: usize, tiles: Mask, nearest: I::F) -> bool {
        if self.is_seen {
            return self.depth.hides_tiles::<I>(block, tiles, nearest);
        }
        tiles & self.depth.tiles_in_reach::<I>(block, nearest, REFRESH_CALL) == 0
    }

    #[inline(always)]
    fn open_tiles<I: Isa>(&mut self, block: usize, greatest: I::F) -> Mask {
        if self.is_seen {
            return self.depth.open_tiles::<I>(block, greatest);
        }
        self.depth.tiles_in_reach::<I>(block, greatest, REFRESH_TRIANGLE)
    }

    #[inline(always)]
    fn tile<I: Isa>(&mut self, block: usize, tile: usize, covered: Mask, nearness: I::F, id: Id) {
        if !self.is_seen && covered & I::ge_f(nearness, self.depth.kept::<I>(block, tile)) != 0 {
            self.see();
        }
        self.depth.tile::<I>(block, tile, covered, nearness, id);
    }

    #[inline(always)]
    fn sample(&mut self, at: usize, nearness: f32, id: Id) {
        if !self.is_seen && nearness >= self.depth.kept_at(at) {
            self.see();
        }
        self.depth.sample(at, nearness, id);
    }
}

impl SeenSink<'_> {
    #[inline(always)]
    fn see(&mut self) {
        self.is_seen = true;
        self.seen[self.call as usize / 64] |= 1 << (self.call % 64);
    }
}
