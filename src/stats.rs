//! Plain counters and stage times of a frame.

use std::time::Duration;

/// What a policy counted of a frame beyond what the driver sees
/// ([`Policy::counters`](crate::policy::Policy::counters)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter {
    /// What was counted, in snake case: a key of statistics.
    pub key: &'static str,
    /// How often.
    pub count: u32,
}

/// What one frame of one view did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStats {
    /// Objects drawn: handed to the draw closure, and not found to show nothing, at once or in the end.
    pub drawn: u32,
    /// Objects handed to the draw closure of which nothing showed
    /// ([`Action::DrawIfSeen`](crate::policy::Action::DrawIfSeen)), or nothing is left in the picture
    /// ([`SweepTest::Owners`](crate::query::SweepTest::Owners)): they cost what their triangles do.
    pub left_out: u32,
    /// Questions asked.
    pub queries: u32,
    /// Boxes in them.
    pub query_boxes: u32,
    /// Questions for which the budget had no room: what they were about was drawn.
    pub refused: u32,
    /// Times that answers to questions were waited for. A draw that answers by itself
    /// ([`Action::DrawIfSeen`](crate::policy::Action::DrawIfSeen)) is no question, and keeps nobody waiting.
    pub waves: u32,
    /// Changes between drawing and asking.
    pub state_changes: u32,
    /// 1 if the view has jumped: it was announced ([`Culler::cut`](crate::Culler::cut)), or found out.
    pub cuts: u32,
    /// Time in the policy and in the driver's own work.
    pub policy: Duration,
    /// Time in the backend's and the app's drawing.
    pub draw: Duration,
    /// Time in handing questions to the backend.
    pub query: Duration,
    /// Time in waiting for answers, what is computed meanwhile included.
    pub wait: Duration,
    /// What a device took to draw in a frame not long ago; zero where that is not known, and where
    /// draws are done at once.
    pub device_draw: Duration,
    /// The part of it that came before the frame's last question, so that answers waited for it.
    pub awaited_draw: Duration,
}
