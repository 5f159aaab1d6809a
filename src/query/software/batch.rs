//! Many questions at once: most cover few pixels, and are answered in steps that go through all of
//! a batch. What a later step reads is asked of the memory in time, and what nobody can foretell
//! (is it hidden, do edges cut it) sorts questions into lists instead of making branches.
//!
//! 1. Where does the proxy lie, which edges and planes does it use, can it be evaluated?
//! 2. Is it behind the farthest of all tiles that it meets? Then nothing of it is in sight.
//! 3. Else, is it before the nearest of all of them? Then all that it covers is.
//! 4. What it covers is counted, and compared with the depth where neither holds.
//!
//! Every answer is that of the plain loop, to the sample: see `count` for why the extremes of a
//! rectangle hold for each of its samples, rounding included. What is larger than a [`Window`] is
//! left to the walk there.

use super::count::{self, Scene};
use super::isa::Isa;
use super::simd::prefetch;
use super::window::{FEW, Window, entry_least, used};
use crate::geom::{PixelRect, Proxy};

/// Questions that are answered together: the tiles that they read fit the first-level cache.
pub(crate) const BATCH: usize = 32;

/// What is found about a proxy; at first, what is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    /// Whether a sample is in sight.
    Any(bool),
    /// How many samples are in sight, and how many it covers.
    Dual { visible: u32, total: u32 },
    /// It cannot be evaluated, and must be taken as visible.
    Unknown,
}

/// Answers questions, each by what `found` wants to know of it.
#[inline(always)]
pub(crate) fn answer<I: Isa>(scene: Scene<'_>, proxies: &[Proxy], found: &mut [Found]) {
    for (proxies, found) in proxies.chunks(BATCH).zip(found.chunks_mut(BATCH)) {
        let mut batch = Batch { windows: [Window::default(); BATCH], visible: [0; BATCH], total: [0; BATCH] };
        batch.answer::<I>(scene, proxies, found);
    }
}

/// Some questions of a batch.
struct List {
    which: [u8; BATCH],
    len: usize,
}

impl List {
    const EMPTY: Self = Self { which: [0; BATCH], len: 0 };

    /// Adds a question if it is wanted, without a branch.
    #[inline(always)]
    fn push_if(&mut self, wanted: bool, question: usize) {
        self.which[self.len % BATCH] = question as u8;
        self.len += usize::from(wanted);
    }

    #[inline(always)]
    fn get(&self, at: usize) -> usize {
        self.which[at % BATCH] as usize % BATCH
    }
}

/// What is known of the questions of a batch.
struct Batch {
    windows: [Window; BATCH],
    visible: [u32; BATCH],
    total: [u32; BATCH],
}

impl Batch {
    #[inline(always)]
    fn answer<I: Isa>(&mut self, scene: Scene<'_>, proxies: &[Proxy], found: &mut [Found]) {
        let (farthest, nearest) = (scene.hi_z.farthest(), scene.hi_z.nearest());
        let small = self.place::<I>(scene, proxies, found);
        let mut open = List::EMPTY;
        // Those of few and those of many functions: loops of a fixed length.
        let (mut covering, mut mixed) = ([List::EMPTY; 2], [List::EMPTY; 2]);
        for at in 0..small.len {
            let i = small.get(at);
            let window = &self.windows[i];
            let hidden = window.is_hidden::<I>(farthest, proxies[i].nearest);
            open.push_if(!hidden, i);
            covering[usize::from(window.edges > FEW)].push_if(hidden & (window.edges > 0), i);
        }
        for at in 0..open.len {
            for block in self.windows[open.get(at)].blocks {
                prefetch(&nearest[block as usize]);
            }
        }
        for at in 0..open.len {
            let i = open.get(at);
            let window = &self.windows[i];
            let clear = window.is_clear::<I>(nearest, entry_least(&proxies[i]));
            // As many as it covers.
            self.visible[i] = if clear { u32::MAX } else { 0 };
            let more = window.edges > FEW;
            covering[usize::from(more)].push_if(clear & (window.edges > 0), i);
            mixed[usize::from(more | (window.planes > FEW))].push_if(!clear, i);
        }
        for list in &mixed {
            for at in 0..list.len {
                self.windows[list.get(at)].prefetch(scene.depth);
            }
        }
        for at in 0..covering[0].len {
            let i = covering[0].get(at);
            self.total[i] = self.windows[i].covered::<I, FEW>(&proxies[i]);
        }
        for at in 0..covering[1].len {
            let i = covering[1].get(at);
            self.total[i] = self.windows[i].covered::<I, 6>(&proxies[i]);
        }
        for at in 0..mixed[0].len {
            let i = mixed[0].get(at);
            (self.visible[i], self.total[i]) =
                self.windows[i].compared::<I, FEW, FEW>(scene.depth, &proxies[i]);
        }
        for at in 0..mixed[1].len {
            let i = mixed[1].get(at);
            (self.visible[i], self.total[i]) = self.windows[i].compared::<I, 6, 3>(scene.depth, &proxies[i]);
        }
        for at in 0..small.len {
            let i = small.get(at);
            let (visible, total) = (self.visible[i].min(self.total[i]), self.total[i]);
            found[i] = match found[i] {
                Found::Any(_) => Found::Any(visible > 0),
                _ => Found::Dual { visible, total },
            };
        }
    }

    /// Lists the questions that have a window. Answers the others.
    #[inline(always)]
    fn place<I: Isa>(&mut self, scene: Scene<'_>, proxies: &[Proxy], found: &mut [Found]) -> List {
        let (image, farthest) = (scene.depth.image(), scene.hi_z.farthest());
        let mut small = List::EMPTY;
        for (i, (proxy, found)) in proxies.iter().zip(found.iter_mut()).enumerate() {
            let rect = PixelRect {
                x1: proxy.rect.x1.min(image.width()),
                y1: proxy.rect.y1.min(image.height()),
                ..proxy.rect
            };
            let Some(used) = used::<I>(proxy) else {
                *found = Found::Unknown;
                continue;
            };
            if rect.x0 >= rect.x1 || rect.y0 >= rect.y1 {
                continue;
            }
            let Some(window) = Window::new(&rect, used, scene.depth) else {
                *found = walk::<I>(scene, proxy, *found);
                continue;
            };
            for block in window.blocks {
                prefetch(&farthest[block as usize]);
            }
            self.windows[i] = window;
            // If no edge cuts it.
            self.total[i] = rect.width() * rect.height();
            small.push_if(true, i);
        }
        small
    }
}

/// The answer about a proxy of any size.
#[inline(always)]
fn walk<I: Isa>(scene: Scene<'_>, proxy: &Proxy, wanted: Found) -> Found {
    if let Found::Any(_) = wanted {
        return Found::Any(count::any::<I>(scene, proxy));
    }
    let (visible, total) = count::dual::<I>(scene, proxy);
    Found::Dual { visible, total }
}
