//! Raster culling: the stages of sweeps, and the policies that sweep.

#[path = "../support/faulty.rs"]
mod faulty;
#[path = "../support/mod.rs"]
mod support;

mod policies;
