//! Tercet: a dynamic-scene occlusion-culling engine.

#![warn(unreachable_pub)]

mod culler;
mod dial;
mod error;
mod stats;
mod tradeoff;

pub mod draw;
pub mod geom;
pub mod policy;
pub mod query;
pub mod scene;
pub mod tree;
pub mod worlds;

pub use culler::{Culler, Voter};
pub use dial::Dial;
pub use error::Error;
pub use stats::FrameStats;
pub use tradeoff::Tradeoff;
