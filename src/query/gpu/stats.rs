//! What the backend counts of a frame.

use std::time::Duration;

/// Counters since [`QueryBackend::begin`](crate::query::QueryBackend::begin), and times of an earlier frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuStats {
    /// Passes opened for the app's draws.
    pub draw_passes: u64,
    /// Passes that count.
    pub question_passes: u64,
    /// Boxes asked about.
    pub boxes: u64,
    /// Sweeps.
    pub sweeps: u64,
    /// Objects that they looked at.
    pub swept: u64,
    /// Groups among them that the device looked at by way of the tree: by rays, or object by object where that is
    /// less.
    pub groups: u64,
    /// Bytes of boxes, and for rays of the tree, that were uploaded for them: of what has changed since
    /// the last sweep.
    pub uploaded: u64,
    /// Submissions to the queue.
    pub submits: u64,
    /// What the device took for the app's draw passes, of the last frame whose timestamps had
    /// arrived when this one began: seldom the one before this. None if none have, if the device
    /// has not [`Features::TIMESTAMP_QUERY`](wgpu::Features::TIMESTAMP_QUERY), and after a frame of more than
    /// 1024 passes, or one that failed, until the timestamps of a later one arrive.
    pub draw_time: Option<Duration>,
    /// The part of it that came before the last pass that answers questions: what answers had to
    /// wait for.
    pub awaited_draw_time: Option<Duration>,
    /// The same for the passes that answer questions.
    pub question_time: Option<Duration>,
}
