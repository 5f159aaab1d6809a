//! The GPU backend, on every adapter that there is, against its twin on the CPU.

#[expect(dead_code, reason = "the slow rasteriser in it is for the proxies' own tests")]
#[path = "../support/geometry.rs"]
mod geometry;
mod lifecycle;
mod support;
mod twin;
mod wgsl;
