//! The software backend: exact rasterisation and exact answers on the CPU, in parallel.
//!
//! | file | |
//! |---|---|
//! | `pass` | what the app's closure records |
//! | `bands` | who does what, in which order, on which thread |
//! | `footprint` | a draw call, or a part of one, against the view |
//! | `vertex`, `clip` | object space to snapped screen coordinates |
//! | `winding` | which triangles show the side that is drawn |
//! | `setup`, `raster`, `tiles`, `walk`, `large` | triangles to samples |
//! | `compact` | small meshes that cover few pixels, all at once |
//! | `sink`, `layout`, `depth`, `hi_z` | what is kept, and how it lies in memory |
//! | `seen` | drawing with a note of who showed a sample |
//! | `count` | answers to questions |
//! | `batch`, `window` | many small ones at once |
//! | `stats` | counters |
//! | `kept_frames` | depths of earlier frames, for late questions |
//! | `sweep` | answers to sweeps, object by object |
//! | `visibility` | who owns each pixel of a finished frame |
//! | `isa`, `level`, `simd` | sixteen lanes, for each instruction set |

mod bands;
mod batch;
mod clip;
mod compact;
mod count;
mod depth;
mod footprint;
mod hi_z;
mod isa;
mod kept_frames;
mod large;
mod layout;
mod level;
mod pass;
mod raster;
mod seen;
mod setup;
mod simd;
mod sink;
mod stats;
mod sweep;
mod tiles;
mod vertex;
mod visibility;
mod walk;
mod winding;
mod window;

use std::ops::Range;

use rayon::prelude::*;

pub use depth::DepthImage;
pub use level::SimdLevel;
pub use pass::{DrawCall, Faces, SoftwarePass};
pub(crate) use simd::prefetch;
pub use stats::SoftwareStats;
pub use sweep::{Pyramid, PyramidLevel};
pub(crate) use visibility::Snapshot;
pub use visibility::VisibilityImage;

use super::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use crate::Error;
use crate::geom::{Proxy, View};
use crate::scene::ObjectRef;
use bands::Bands;
use batch::{BATCH, Found};
use depth::Depth;
use hi_z::HiZ;
use kept_frames::{KeptFrame, KeptFrames};
use seen::Seen;
use sweep::{Owned, Sweeps};

/// The software backend: a depth buffer on the CPU and the questions put to it.
///
/// Triangles are rasterised exactly (top-left rule, pixel centres, 1/256 pixel), on the threads of
/// the current rayon pool; results are the same bits for any number of threads and any
/// [`SimdLevel`]. Multisampled views get one sample a pixel, at its centre.
#[derive(Debug)]
pub struct SoftwareQueries {
    simd: SimdLevel,
    view: Option<View>,
    depth: Depth,
    hi_z: HiZ,
    pass: SoftwarePass,
    bands: Bands,
    asked: Vec<Asked>,
    proxies: Vec<Proxy>,
    /// One for each proxy of an answered question.
    found: Vec<Found>,
    /// Questions of `asked` from here on are not answered yet.
    answered: usize,
    kept: KeptFrames,
    /// How many frames ago that depth was that questions see; 0 for this frame's.
    late: usize,
    /// Whether this frame's depth is to be kept.
    keeps: bool,
    sweeps: Sweeps,
    owned: Owned,
    /// Whether what is recorded is what the app shows.
    true_shapes: bool,
    /// Whose draw calls an attempt consists of, and who recorded none.
    seen: Seen,
    stats: SoftwareStats,
}

#[derive(Clone, Debug)]
struct Asked {
    ticket: Ticket,
    want: Want,
    proxies: Range<usize>,
}

impl Default for SoftwareQueries {
    fn default() -> Self {
        Self::new()
    }
}

impl SoftwareQueries {
    /// A backend at the machine's best [`SimdLevel`]. It has no size until a frame begins.
    pub fn new() -> Self {
        Self::with_level(SimdLevel::detect())
    }

    /// A backend at a given level, or at the best that the machine has if that is less.
    pub fn with_level(level: SimdLevel) -> Self {
        Self {
            simd: level.min(SimdLevel::detect()),
            view: None,
            depth: Depth::default(),
            hi_z: HiZ::default(),
            pass: SoftwarePass::default(),
            bands: Bands::default(),
            asked: Vec::new(),
            proxies: Vec::new(),
            found: Vec::new(),
            answered: 0,
            kept: KeptFrames::default(),
            late: 0,
            keeps: false,
            sweeps: Sweeps::default(),
            owned: Owned::default(),
            true_shapes: false,
            seen: Seen::default(),
            stats: SoftwareStats::default(),
        }
    }

    /// The level in use.
    pub fn level(&self) -> SimdLevel {
        self.simd
    }

    /// Says whether what the closures record is the picture: of each object all that it is, no stand-ins, such
    /// as an [`OccluderMesh`](crate::scene::OccluderMesh), and shown as rasterised here, to the bit. Then
    /// whoever records something, of which nothing shows, can be left out
    /// ([`QueryBackend::draws_if_seen`]). False at first: boxes have the last word, which allow for another
    /// renderer's rounding. An app that culls here and draws on a GPU leaves it so.
    pub fn set_true_shapes(&mut self, true_shapes: bool) {
        self.true_shapes = true_shapes;
    }

    /// The depth of the frame so far.
    pub fn depth(&self) -> DepthImage<'_> {
        self.depth.image()
    }

    /// Counters since the frame began.
    pub fn stats(&self) -> SoftwareStats {
        self.stats
    }

    /// Memory held by the depth buffer and its hierarchy, in bytes; by those of earlier frames, too, if
    /// questions are late.
    pub fn bytes(&self) -> usize {
        self.depth.bytes() + self.hi_z.bytes() + self.kept.bytes()
    }

    /// Draws into the depth of the frame that has begun.
    pub(crate) fn rasterise(&mut self, view: &View, calls: &[DrawCall]) {
        let work = self.bands.rasterise(self.simd, view, calls, self.depth.sinks(&mut self.hi_z));
        self.stats.add(calls.len(), work);
    }

    /// Draws what was recorded.
    fn draw_pass(&mut self) {
        if let Some(view) = self.view.take() {
            let pass = std::mem::take(&mut self.pass);
            self.rasterise(&view, pass.calls());
            (self.view, self.pass) = (Some(view), pass);
        }
    }

    /// Records what objects draw, and whose it is; returns how many draw calls were there before.
    fn record_objects(
        &mut self,
        objects: &[ObjectRef],
        mut record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> usize {
        // What was asked before must not see what is drawn now.
        self.answer();
        self.pass.clear();
        let before = self.owned.calls.len();
        for object in objects {
            record(&mut self.pass, std::slice::from_ref(object));
            self.owned.owners.resize(before + self.pass.calls().len(), object.id);
        }
        before
    }

    /// Takes a frame's size; what the last one held is gone.
    fn start(&mut self, view: &View) {
        let (viewport, cleared) = (view.viewport(), view.depth().cleared());
        self.depth.reset(viewport.width, viewport.height, cleared);
        self.hi_z.reset(&self.depth, cleared);
        self.view = Some(view.clone());
        self.late = 0;
        self.forget();
        self.owned.clear();
        self.stats = SoftwareStats::default();
    }

    /// Answers everything asked so far, against the depth as it is now, or as it was.
    fn answer(&mut self) {
        if self.answered == self.asked.len() || self.view.is_none() {
            return;
        }
        let scene = match self.kept.ago(self.late).filter(|_| self.late > 0) {
            Some(past) => count::Scene { depth: &past.depth, hi_z: &past.hi_z },
            None => {
                self.depth.settle();
                self.hi_z.refresh(self.simd, &self.depth);
                count::Scene { depth: &self.depth, hi_z: &self.hi_z }
            }
        };
        let (simd, proxies) = (self.simd, &self.proxies);
        let first = self.found.len();
        for asked in &self.asked[self.answered..] {
            let wanted = match asked.want {
                Want::Any => Found::Any(false),
                Want::Dual => Found::Dual { visible: 0, total: 0 },
            };
            self.found.resize(asked.proxies.end, wanted);
        }
        let batches = self.found[first..].par_chunks_mut(BATCH).zip(proxies[first..].par_chunks(BATCH));
        batches.for_each(|(found, proxies)| simd::answer(simd, scene, proxies, found));
        self.answered = self.asked.len();
    }
}

impl QueryBackend for SoftwareQueries {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "software"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.kept.clear();
        self.keeps = false;
        self.start(view);
        Ok(())
    }

    fn begin_late(&mut self, view: &View, frames: u32) -> Result<Option<View>, Error> {
        let late = frames.max(1) as usize;
        if let (true, Some(last)) = (self.keeps, self.view.take()) {
            let (depth, hi_z) = (std::mem::take(&mut self.depth), std::mem::take(&mut self.hi_z));
            let kept = KeptFrame { view: Some(last), depth, hi_z };
            let spare = self.kept.keep(kept, late, self.simd);
            (self.depth, self.hi_z) = (spare.depth, spare.hi_z);
        }
        self.keeps = true;
        self.start(view);
        let past = self.kept.ago(late).and_then(|past| past.view.clone());
        self.late = if past.is_some() { late } else { 0 };
        Ok(past)
    }

    fn owns_depth(&self) -> bool {
        true
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        // What was asked before must not see what is drawn now.
        self.answer();
        self.pass.clear();
        record(&mut self.pass);
        self.draw_pass();
        Ok(())
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.record_objects(objects, record);
        self.draw_pass();
        self.pass.drain_into(&mut self.owned.calls);
        Ok(())
    }

    /// If it is told true shapes, and the app's picture has its samples where this one has.
    fn draws_if_seen(&self) -> bool {
        self.true_shapes && self.view.as_ref().is_some_and(|view| view.samples() == 1)
    }

    fn draw_if_seen(
        &mut self,
        ticket: Ticket,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        let first = self.record_objects(objects, record);
        if let Some(view) = self.view.take() {
            self.draw_seen(ticket, &view, first, objects);
            self.view = Some(view);
        }
        self.pass.drain_into(&mut self.owned.calls);
        Ok(())
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        let first = self.proxies.len();
        self.proxies.extend_from_slice(boxes);
        self.asked.push(Asked { ticket, want, proxies: first..self.proxies.len() });
        self.stats.boxes += boxes.len() as u64;
        Ok(())
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.sweep_now(ticket, sweep);
        Ok(())
    }

    fn answers(&mut self, _: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.answer();
        for (ticket, found) in self.sweeps.answers() {
            deliver(ticket, found.map_or(Answer::Unknown, Answer::Swept));
        }
        if self.view.is_none() {
            // No frame has begun: there is nothing to ask about.
            self.asked.iter().for_each(|asked| deliver(asked.ticket, Answer::Unknown));
            self.forget();
            return Ok(());
        }
        for asked in &self.asked {
            let found = &self.found[asked.proxies.clone()];
            let answer = match (asked.want, found) {
                (Want::Any, found) => Answer::Any(found.iter().any(|f| !matches!(f, Found::Any(false)))),
                (Want::Dual, &[Found::Dual { visible, total }]) => Answer::Dual { visible, total },
                (Want::Dual, _) => Answer::Unknown,
            };
            deliver(asked.ticket, answer);
        }
        self.forget();
        Ok(())
    }

    fn end(&mut self) -> Result<(), Error> {
        self.forget();
        self.pass.clear();
        Ok(())
    }
}

impl SoftwareQueries {
    fn forget(&mut self) {
        self.sweeps.forget();
        self.asked.clear();
        self.proxies.clear();
        self.found.clear();
        self.answered = 0;
    }
}
