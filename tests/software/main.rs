//! The software backend against slow, independent references.

mod clipping;
mod coverage;
mod questions;
mod support;
