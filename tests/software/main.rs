//! The software backend against slow, independent references.

mod clipping;
mod coverage;
mod faces;
mod oracle;
mod parts;
#[path = "../support/proxies.rs"]
mod proxies;
mod questions;
mod support;
