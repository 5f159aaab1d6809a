//! What is where.

mod components;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod mesh;
mod object;

pub use components::Bounds;
pub use object::{ObjectId, ObjectRef, ObjectSet};
