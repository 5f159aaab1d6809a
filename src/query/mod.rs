//! Is it hidden? A backend owns the depth of one frame and answers questions about boxes.

pub(crate) mod compact;
pub mod fault;
#[cfg(feature = "gpu")]
pub mod gpu;
mod kept;
pub mod oracle;
pub mod software;
mod sweep;

use std::time::Duration;

pub use kept::KeptAnswer;
pub use sweep::{Sweep, SweepTest};

use crate::Error;
use crate::geom::{Proxy, View};
use crate::scene::{ObjectRef, ObjectSet};

/// Names a question until it is answered. A policy's tickets are unique among its open questions;
/// the driver numbers them anew, so that a backend's are unique, from frame to frame as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ticket(pub u32);

/// What to find out about boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Want {
    /// Whether at least one sample of at least one of the boxes passes the depth test.
    Any,
    /// How many samples of exactly one box pass the depth test, and how many it covers.
    Dual,
}

/// An answer to a question.
#[derive(Clone, Copy, Debug)]
pub enum Answer<'a> {
    /// To [`Want::Any`]: whether some sample is visible.
    Any(bool),
    /// To [`Want::Dual`].
    Dual {
        /// Samples that pass the depth test; never more than `total`.
        visible: u32,
        /// Samples that the box covers in the viewport.
        total: u32,
    },
    /// To a sweep: the objects that were found visible.
    Swept(&'a ObjectSet),
    /// The answer was lost: whatever was asked about is drawn.
    Unknown,
}

impl Answer<'_> {
    /// Whether what was asked about must be drawn, when up to `ignored` visible samples may be
    /// given up (0 for exact).
    pub fn is_visible(&self, ignored: u32) -> bool {
        match *self {
            Self::Any(visible) => visible,
            Self::Dual { visible, .. } => visible > ignored,
            Self::Swept(_) | Self::Unknown => true,
        }
    }
}

/// How long to wait for answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// Deliver what has arrived.
    Poll,
    /// Deliver everything asked so far.
    Block,
}

/// What a device took to draw a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct DeviceTimes {
    /// All drawing of the frame.
    pub total: Duration,
    /// The part of it that came before the frame's last question: waiting for answers was waiting for this,
    /// too. What was drawn after it kept nobody waiting.
    pub awaited: Duration,
}

/// Where the time of drawing goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawTime {
    /// [`QueryBackend::draw`] takes it.
    AtOnce,
    /// A device draws while answers are waited for.
    Device {
        /// Of a frame not long ago.
        times: DeviceTimes,
        /// Which of the backend's frames has begun: [`QueryBackend::device_times`] knows them by this number. It grows
        /// from frame to frame, whoever's they are.
        now: u64,
    },
    /// The same, and nobody knows how long it takes.
    Unknown,
}

/// Owns the depth of the frame: draws go in, questions are answered against what was drawn so
/// far. Nothing drawn later changes an answer to a question asked earlier.
pub trait QueryBackend {
    /// What the app's draw closure records into.
    type Pass;

    /// For statistics and messages.
    fn name(&self) -> &'static str;

    /// Whether [`Wait::Block`] works; false in a browser.
    fn can_block(&self) -> bool;

    /// Starts a frame: depth is cleared, questions of earlier frames are forgotten.
    ///
    /// # Errors
    /// What the device reports.
    fn begin(&mut self, view: &View) -> Result<(), Error>;

    /// The same for a frame whose questions see the finished depth of `frames` frames ago, seen with that
    /// frame's view, which is returned: proxies are to be made with it. None if there is no such depth,
    /// because the backend keeps none, or frames begun in this way are too few yet: then questions see
    /// this frame's, as ever. Sweeps always do. Frames are the backend's own:
    /// one that several views share has no past of any. [`QueryBackend::begin`] lets go of what was kept.
    ///
    /// # Errors
    /// What the device reports.
    fn begin_late(&mut self, view: &View, _frames: u32) -> Result<Option<View>, Error> {
        self.begin(view).map(|()| None)
    }

    /// Whether depth is the backend's own, so that it may be coarser than what the app shows.
    fn owns_depth(&self) -> bool {
        false
    }

    /// Draws: `record` fills one pass.
    ///
    /// # Errors
    /// What the device reports.
    fn draw(&mut self, record: impl FnOnce(&mut Self::Pass)) -> Result<(), Error>;

    /// Draws objects, so that a later [`SweepTest::Owners`] can tell which of them own samples: a
    /// backend that can keep the record calls `record` as often as it takes, with some of the
    /// objects each time. Others draw as ever, and answer such a sweep with [`Answer::Unknown`].
    ///
    /// # Errors
    /// What the device reports.
    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        mut record: impl FnMut(&mut Self::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.draw(|pass| record(pass, objects))
    }

    /// Whether it can leave out of a drawing what does not show ([`QueryBackend::draw_if_seen`]), and that is
    /// as exact as the app's own picture. Of the frame that has begun.
    fn draws_if_seen(&self) -> bool {
        false
    }

    /// Draws those of the objects of which something shows, by their geometry: `record` is called for all of
    /// them, but one counts as drawn only if some sample of it is in sight of all that was drawn before,
    /// ties included; also of what comes before it in `objects`, if the backend goes one by one. Answered by
    /// [`Answer::Swept`] with those, or not at all: then all of them are drawn.
    ///
    /// It is called only if [`QueryBackend::draws_if_seen`].
    ///
    /// # Errors
    /// What the device reports.
    fn draw_if_seen(
        &mut self,
        _ticket: Ticket,
        objects: &[ObjectRef],
        record: impl FnMut(&mut Self::Pass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.draw_objects(objects, record)
    }

    /// Asks about boxes, against everything drawn before. [`Want::Dual`] takes exactly one.
    ///
    /// # Errors
    /// What the device reports.
    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error>;

    /// Asks about many objects at once, against everything drawn before: which of those that meet the
    /// frustum may own a sample of what would be drawn now? Answered by [`Answer::Swept`], or by
    /// [`Answer::Unknown`]. An object that no proxy stands for (it crosses the near plane, or holds
    /// the eye) is found.
    ///
    /// # Errors
    /// What the device reports.
    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error>;

    /// Delivers answers, in any order; one a ticket. With [`Wait::Block`], all that are due.
    ///
    /// # Errors
    /// What the device reports. Answers that an error swallowed are delivered as
    /// [`Answer::Unknown`] first.
    fn answers(&mut self, wait: Wait, deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error>;

    /// Where the time of drawing goes: what drawing costs is learnt from it.
    fn draw_time(&self) -> DrawTime {
        DrawTime::AtOnce
    }

    /// What a device took to draw one of the last frames, by its number ([`DrawTime::Device`]), if that is known by
    /// now.
    fn device_times(&self, _frame: u64) -> Option<DeviceTimes> {
        None
    }

    /// Ends the frame.
    ///
    /// # Errors
    /// What the device reports.
    fn end(&mut self) -> Result<(), Error>;
}
