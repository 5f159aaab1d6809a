//! Sweeps: each stage against the plain loop over samples, and the hybrid's movers.

#[path = "../support/stage.rs"]
mod stage;

mod hybrid;
mod owners;
mod pyramid;
mod seen;
mod table;
mod tests;
