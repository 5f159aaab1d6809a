//! Policies by hand: scripted answers and times, and the exact sequence of actions that each paper's rules
//! ask for.

mod chc;
mod gate;
mod hierarchy;
