//! The components that [`Scene::sync`](super::Scene::sync) reads from the app's world. Only
//! [`Bounds`] (or [`BoundsF64`]) is mandatory.

use glam::DVec3;

use super::mesh::Mesh;
use crate::geom::Aabb;

/// Where the object is: a box around everything that it draws, in metres relative to the scene's
/// origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds(pub Aabb);

/// As [`Bounds`], in f64 and absolute: the scene subtracts its origin, rounding outward. Where an
/// entity has both, [`Bounds`] counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundsF64 {
    /// The corner with the least coordinates, metres.
    pub min: DVec3,
    /// The corner with the greatest coordinates, metres.
    pub max: DVec3,
}

/// How the app expects the object to move: a hint, which no algorithm here needs so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum Mobility {
    /// Not known.
    #[default]
    Unknown,
    /// Rarely moves.
    Static,
    /// Moves most of the time.
    Dynamic,
}

/// Drawn in every frame, whatever the view: a sky, a heads-up display, something huge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NeverCull;

/// Never hides anything, and is drawn after the questions: transparent or alpha-tested objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NotOccluder;

/// Metres by which what is drawn may leave the bounds (skinning, displacement). The scene grows
/// the box by it, rounded outward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slack(pub f32);

/// Which mesh the object is an instance of. The scene keeps it for the app's draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Batch(pub u32);

/// A simplified mesh *inside* the object, in the object's own space, which the app's closure may
/// draw in its place on the software backend. The engine itself does not read it.
#[derive(Clone, Debug)]
pub struct OccluderMesh(pub Mesh);

/// The optional components of one object, for apps without a hecs world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Traits {
    /// See [`Mobility`].
    pub mobility: Mobility,
    /// See [`NeverCull`].
    pub never_cull: bool,
    /// See [`NotOccluder`].
    pub not_occluder: bool,
    /// See [`Slack`].
    pub slack: f32,
    /// See [`Batch`].
    pub batch: Option<Batch>,
}
