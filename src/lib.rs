//! Tercet: a dynamic-scene occlusion-culling engine.

mod error;

pub mod geom;
pub mod query;
pub mod scene;

pub use error::Error;
