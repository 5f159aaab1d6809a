//! Sweeps: each stage against the plain loop over samples, and the hybrid's movers.

mod hybrid;
mod owners;
mod pyramid;
mod seen;
mod table;
mod tests;
