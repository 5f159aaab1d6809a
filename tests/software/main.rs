//! The software backend against slow, independent references.

mod clipping;
mod coverage;
mod oracle;
mod questions;
mod support;
