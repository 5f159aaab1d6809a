//! The GPU backend, on every adapter that there is, against its twin on the CPU.

mod adapters;
mod conservative;
mod failures;
#[path = "../support/geometry.rs"]
mod geometry;
mod indirect;
mod indirect_filter;
mod indirect_renderer;
mod late;
mod lifecycle;
mod mutations;
mod openings;
mod owners;
mod parallel;
#[path = "../support/proxies.rs"]
mod proxies;
mod rasteriser;
mod renderer;
#[path = "../support/stage.rs"]
mod stage;
mod support;
mod sweep;
mod sweep_mutations;
mod twin;
mod wgsl;
