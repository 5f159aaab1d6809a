//! Every extreme that the engine promises to bear, a named test each; and what it says about boxes
//! against exact arithmetic, and against every sample of what is in them.

mod boxes;
mod check;
mod dice;
mod differential;
mod edits;
mod exact;
mod flight;
mod frames;
mod geometry;
mod large;
mod proxy;
#[path = "../support/geometry.rs"]
mod samples;
mod strategies;
mod tally;

/// A number from the environment, for runs that are longer or are to be repeated.
fn setting(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name}={text}: a whole number, please")),
        Err(_) => default,
    }
}
