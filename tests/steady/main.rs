//! A steady frame allocates nothing.

mod drawing;
mod following;
mod policies;

use std::alloc::System;

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One test: allocations are counted for the whole process. The short parts come first, since the
/// harness takes memory to say that a test has been running for a minute.
#[test]
fn a_steady_frame_allocates_nothing() {
    drawing::check();
    policies::check();
    following::check();
}
