//! Sweeps: one question about many objects, answered object by object.

use crate::geom::{Frustum, View};
use crate::scene::{ObjectId, Scene};
use crate::tree::NodeId;

/// How a sweep tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepTest {
    /// Each object's own proxy, sample by sample (*ROC*).
    Raster,
    /// A group's proxy first: each sample of it that passes casts a ray through the group's subtree,
    /// and finds the objects whose own proxies pass there (*HROC*). Loose objects are tested as by
    /// [`SweepTest::Raster`], and the answer is the very same.
    Rays,
    /// Each object's rectangle and nearest point against a pyramid of farthest depths (*Hi-Z*). A
    /// superset of what [`SweepTest::Raster`] finds.
    HiZ,
    /// No proxies: which of the loose objects own a sample of what has been drawn so far in this frame
    /// (an item buffer, ties included)? Only a backend that was told whose draws are whose
    /// ([`QueryBackend::draw_objects`](super::QueryBackend::draw_objects)) can say. No groups.
    Owners,
}

/// What a sweep looks at: the objects at and below groups, and loose ones.
///
/// No group lies below another. An object that is loose is tested by itself, and not looked for
/// below a group.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    /// Whose objects they are.
    pub scene: &'a Scene,
    /// The camera.
    pub view: &'a View,
    /// Its frustum.
    pub frustum: &'a Frustum,
    /// Nodes: every object at or below them is meant.
    pub groups: &'a [NodeId],
    /// Objects beside those.
    pub loose: &'a [ObjectId],
    /// How to test them.
    pub test: SweepTest,
}
