//! Everything that can go wrong, each with what to do next.

use crate::scene::{Batch, ObjectRef};

/// An error of the engine. Bad *edits* are not errors: they are reported by
/// `SyncReport`, and the object is drawn always.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A viewport with a side of 0 or beyond the limit.
    #[error("a viewport of {width} × {height} pixels cannot be drawn: each side must be 1 to 16384")]
    Viewport {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A matrix that no view can be made of.
    #[error("the matrix {name} {why}; check the camera's position, field of view and planes")]
    Matrix {
        /// Which matrix.
        name: &'static str,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A mesh whose arrays do not fit together.
    #[error("mesh {name}: {why}")]
    Mesh {
        /// The mesh, as far as it has a name.
        name: String,
        /// The element at fault and what is wrong with it.
        why: String,
    },
    /// A file that could not be read.
    #[error("{path}: {why}")]
    File {
        /// The file.
        path: String,
        /// What is wrong with it.
        why: String,
    },
    /// The scene was edited and not brought up to date before a frame.
    #[error(
        "the scene has {0} edits that no update has placed yet: call Scene::update (or sync) before Culler::frame"
    )]
    PendingEdits(usize),
    /// A policy that needs answers within the frame, on a backend that cannot block.
    #[error(
        "policy {policy} needs answers within the frame, and backend {backend} cannot wait for them: choose `frustum`, or a backend that can wait"
    )]
    CannotBlock {
        /// The policy.
        policy: &'static str,
        /// The backend.
        backend: &'static str,
    },
    /// Attachments that cannot be drawn into and asked about.
    #[error("the frame's targets cannot be used: {why}")]
    Target {
        /// What is wrong, and what would be right.
        why: String,
    },
    /// The graphics device failed, or did not answer in time.
    #[error("the device failed: {why}; what was asked counts as visible, and the next frame starts anew")]
    Device {
        /// What it reported.
        why: String,
    },
    /// A recording that cannot be made, or cannot be replayed.
    #[error("the recording: {why}")]
    Recording {
        /// What is wrong, and what would be right.
        why: String,
    },
    /// An object that the device is to draw, and does not know how.
    #[error(
        "{object:?} cannot be drawn by the device: its Batch is {batch:?}, and there are {meshes} meshes"
    )]
    Batch {
        /// The object.
        object: ObjectRef,
        /// Its component.
        batch: Option<Batch>,
        /// How many meshes were handed in.
        meshes: usize,
    },
    /// A policy of a name that does not exist.
    #[error("there is no policy {name:?}; the policies are {known}")]
    UnknownPolicy {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A dial that a policy or the tree does not have, or a value that it does not take.
    #[error("cannot set {key}={value}: {why}")]
    Dial {
        /// The dial.
        key: String,
        /// The value asked for.
        value: String,
        /// What is wrong, and what would be right.
        why: String,
    },
}
