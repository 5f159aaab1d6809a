//! The demos' window: fly about, change everything while it runs, and see what the engine does.
//!
//! | file | |
//! |---|---|
//! | `app` | one frame of the window: input, engine, picture, panels |
//! | `engine` | the scene, the eye and the backend |
//! | `fly` | the camera |
//! | `display` | what is drawn over and instead of the engine's own picture |
//! | `pyramid` | a level of the culling depth's pyramid |
//! | `frozen` | the culling camera's frustum, seen from elsewhere |
//! | `states` | nodes and objects by what became of them |
//! | `pick` | what is under the cursor, and why it is drawn or not |
//! | `panel`, `dials`, `plots` | controls and curves |
//! | `screenshot` | the window as a PNG |

mod app;
mod dials;
mod display;
mod engine;
mod fly;
mod frozen;
mod panel;
mod pick;
mod plots;
mod pyramid;
mod screenshot;
mod states;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};

use super::flags::Flags;
use super::scenario::Scenario;
use super::stage::{Gpu, Stage};
use app::App;
use display::Display;
use engine::Engine;

/// A window that could not be opened.
pub struct NotShown {
    /// Why.
    pub why: anyhow::Error,
    /// What was to be shown.
    pub scenario: Scenario,
}

/// Points beside and below the picture for controls and plots.
const PANELS: (f32, f32) = (300.0, 190.0);

/// Shows a scenario in a window until it is closed. Returns it if no window can be opened, to be run
/// without one.
///
/// # Errors
/// What closed the window.
pub fn show(flags: &Flags, scenario: Scenario) -> anyhow::Result<Option<NotShown>> {
    let size = [flags.size.0 as f32 + PANELS.0, flags.size.1 as f32 + PANELS.1];
    let setup = WgpuSetupCreateNew {
        device_descriptor: Arc::new(Gpu::descriptor),
        ..WgpuSetupCreateNew::without_display_handle()
    };
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default().with_inner_size(size).with_title(scenario.name.clone()),
        wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() },
        ..Default::default()
    };
    // The window takes the scenario when everything else is there; until then it can be had back.
    let waiting = Rc::new(RefCell::new(Some(scenario)));
    let taken = waiting.clone();
    let created = Box::new(move |cx: &eframe::CreationContext<'_>| {
        let state = cx.wgpu_render_state.as_ref().context("it has no wgpu device")?;
        let gpu = Gpu::new(&state.adapter, state.device.clone(), state.queue.clone());
        let display = Display::new(&gpu)?;
        let stage = Stage::on_one_of(flags, || Ok(Some(gpu.clone())))?;
        let scenario = taken.borrow_mut().take().context("it was opened twice")?;
        let engine = Engine::new(flags, scenario, stage, gpu)?;
        Ok(Box::new(App::new(flags, engine, display)?) as Box<dyn eframe::App>)
    });
    let result = eframe::run_native(flags.example, options, created).map_err(|error| anyhow!("{error}"));
    match (result, waiting.take()) {
        (Err(why), Some(scenario)) => Ok(Some(NotShown { why, scenario })),
        (result, _) => result.map(|()| None),
    }
}
