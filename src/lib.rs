//! Tercet: a dynamic-scene occlusion-culling engine.

mod error;

pub mod draw;
pub mod geom;
pub mod query;
pub mod scene;
pub mod worlds;

pub use error::Error;
