//! A demo: in a window where there is one to be had, and else without.

use std::env;

use super::flags::Flags;
use super::scenario::Scenario;
use super::stage::Gpu;
use super::window::NotShown;
use super::{headless, window};

/// Shows a scenario.
///
/// # Errors
/// What went wrong, and what to do about it.
pub fn run(flags: &Flags, scenario: Scenario) -> anyhow::Result<()> {
    if flags.is_headless() {
        return headless::run(flags, scenario);
    }
    if !has_display() {
        println!("There is no display: running without a window (as with --headless).");
        return headless::run(flags, scenario);
    }
    let Some(NotShown { why, scenario }) = window::show(flags, scenario)? else { return Ok(()) };
    println!("No window could be opened ({why:#}): running without one (as with --headless).");
    println!("If that is for want of a graphics adapter: {}.", Gpu::remedy());
    headless::run(flags, scenario)
}

/// Whether this session has a screen to open a window on.
fn has_display() -> bool {
    let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}
