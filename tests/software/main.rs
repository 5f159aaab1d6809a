//! The software backend against slow, independent references.

mod clipping;
mod coverage;
mod faces;
mod oracle;
#[path = "../support/painter.rs"]
mod painter;
mod parts;
#[path = "../support/proxies.rs"]
mod proxies;
mod questions;
#[path = "../support/stage.rs"]
mod stage;
mod support;
mod sweep;
