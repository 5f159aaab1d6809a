//! What is where.

pub mod mesh;
mod object;

pub use object::{ObjectId, ObjectRef, ObjectSet};
