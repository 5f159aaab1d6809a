//! The reference renderer, on every adapter that there is.

mod by_slot;
mod frames;
mod ids;
mod looks;
mod pixels;
#[path = "../support/stage.rs"]
mod stage;
#[expect(dead_code, reason = "what draws loose triangles in it is for the backend's own tests")]
#[path = "../gpu/support.rs"]
mod support;
mod uploads;
