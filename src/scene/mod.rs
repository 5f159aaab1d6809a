//! What is where.

#[cfg(any(feature = "gltf", feature = "lod"))]
mod compact;
mod components;
#[cfg(feature = "gltf")]
pub mod gltf;
#[cfg(feature = "lod")]
pub mod lod;
pub mod mesh;
mod object;

pub use components::Bounds;
pub use object::{ObjectId, ObjectRef, ObjectSet};
