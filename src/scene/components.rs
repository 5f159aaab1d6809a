//! What an app attaches to its entities.

use crate::geom::Aabb;

/// Where an entity is: the only component that the scene needs. Metres, relative to the scene's
/// origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds(pub Aabb);
