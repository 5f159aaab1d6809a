//! The GPU backend, on every adapter that there is, against its twin on the CPU.

mod adapters;
mod conservative;
mod failures;
#[expect(dead_code, reason = "the slow rasteriser in it is for the proxies' own tests")]
#[path = "../support/geometry.rs"]
mod geometry;
mod indirect;
mod indirect_renderer;
mod lifecycle;
mod mutations;
mod parallel;
#[path = "../support/proxies.rs"]
mod proxies;
mod rasteriser;
mod renderer;
#[path = "../support/stage.rs"]
mod stage;
mod support;
mod sweep;
mod twin;
mod wgsl;
