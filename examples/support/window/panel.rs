//! The controls beside the picture.

use eframe::egui::{CollapsingHeader, Color32, DragValue, RichText, ScrollArea, Slider, Ui};
use tercet::draw::Detail;
use tercet::policy;

use super::display::Layers;
use super::engine::Engine;
use super::fly::Fly;
use super::{dials, states};
use crate::audits::Audits;
use crate::stage::Stage;
use crate::table::count;

const KEYS: &str = "W A S D, Q E: fly · Shift: faster · wheel: speed
drag: look · P: follow the flight · Space: pause
F: freeze the culling camera · F12: screenshot
1 to 6: the views below";

/// How many frames apart checks are when they are switched on: a second or so.
const AUDIT_EVERY: u32 = 24;

/// Shows the controls and does what they say.
///
/// # Errors
/// What a control was set to and cannot be: that one has changed nothing.
pub fn show(ui: &mut Ui, engine: &mut Engine, fly: &mut Fly, layers: &mut Layers) -> anyhow::Result<()> {
    ScrollArea::vertical()
        .show(ui, |ui| {
            figures(ui, engine);
            ui.separator();
            let result = backend(ui, engine).and(policy(ui, engine));
            ui.separator();
            camera(ui, engine, fly);
            view(ui, layers);
            ui.separator();
            audit(ui, engine);
            ui.separator();
            let result = result.and(all_dials(ui, engine));
            CollapsingHeader::new("Keys").show(ui, |ui| ui.small(KEYS));
            result
        })
        .inner
}

fn figures(ui: &mut Ui, engine: &Engine) {
    ui.heading(&engine.scenario.name);
    let Some(last) = engine.records.back() else { return };
    ui.label(format!(
        "{} of {} drawn, {} in the frustum",
        count(last.drawn.into()),
        count(engine.scene.len() as f64),
        count(last.in_frustum.into())
    ));
    ui.label(format!("{} triangles", count(last.drawn_triangles as f64)));
    ui.label(format!("{} questions in {} waves", last.queries, last.waves));
    let seconds = ui.input(|input| input.stable_dt);
    ui.label(format!("engine {:.1} ms; window {:.0} ms", last.frame_ms, seconds * 1e3));
    let tree = engine.scene.tree().stats();
    ui.label(format!("tree: {} nodes, {} deep", count(tree.nodes as f64), tree.depth));
}

fn backend(ui: &mut Ui, engine: &mut Engine) -> anyhow::Result<()> {
    let was = matches!(engine.stage, Stage::Wgpu(_));
    let mut is = was;
    ui.horizontal(|ui| {
        ui.label("Backend");
        ui.radio_value(&mut is, false, "software");
        ui.radio_value(&mut is, true, "wgpu").on_hover_text(engine.gpu().adapter());
    });
    if is != was { engine.use_gpu(is) } else { Ok(()) }
}

fn policy(ui: &mut Ui, engine: &mut Engine) -> anyhow::Result<()> {
    let was = engine.eye.policy().name();
    let is = ui.horizontal(|ui| {
        ui.label("Policy");
        dials::choice(ui, ("policy", "name"), was, policy::NAMES)
    });
    if let Some(why) = engine.eye.policy().explanation() {
        ui.weak(why);
    }
    if is.inner != was { engine.use_policy(&is.inner) } else { Ok(()) }
}

fn camera(ui: &mut Ui, engine: &mut Engine, fly: &mut Fly) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut fly.follows, "follow the flight (P)");
        ui.checkbox(&mut engine.paused, "pause (Space)");
    });
    ui.horizontal(|ui| {
        ui.label("flight").on_hover_text("how far it has got");
        fly.follows |= ui.add(Slider::new(&mut fly.along, 0.0..=fly.end).show_value(false)).changed();
        ui.label("flight_end").on_hover_text("how far the camera flies, 0 to 1");
        ui.add(DragValue::new(&mut fly.end).speed(0.005).range(0.0..=1.0));
    });
    let mut frozen = engine.frozen.is_some();
    if ui.checkbox(&mut frozen, "freeze the culling camera (F), and fly away from it").changed() {
        engine.freeze(fly.pose());
        fly.follows &= !frozen;
    }
    ui.horizontal(|ui| {
        ui.label("speed");
        ui.add(DragValue::new(&mut fly.speed).speed(0.1).range(1e-4..=1e6).suffix(" m/s"));
    });
}

fn view(ui: &mut Ui, layers: &mut Layers) {
    for (n, (on, what)) in layers.each().into_iter().enumerate() {
        ui.checkbox(on, format!("{} {what}", n + 1));
    }
    ui.horizontal(|ui| {
        ui.label("level of the depth pyramid")
            .on_hover_text("farthest depths, as Hi-Z compares with; 0: none");
        ui.add(DragValue::new(&mut layers.pyramid).speed(0.05).range(0..=14));
    });
    CollapsingHeader::new("What the colours mean").show(ui, states::legend);
}

/// Whether frames are checked against the oracle, and what that has found.
fn audit(ui: &mut Ui, engine: &mut Engine) {
    let every = engine.audits().map(Audits::every);
    let (mut on, mut n) = (every.is_some(), every.unwrap_or(AUDIT_EVERY));
    ui.horizontal(|ui| {
        ui.checkbox(&mut on, "audit every")
            .on_hover_text("checks frames against the exact visible set: slow");
        ui.add_enabled(on, DragValue::new(&mut n).range(1..=1000));
        ui.label("frames");
    });
    if on.then_some(n) != every {
        engine.audit(on.then_some(n));
    }
    if let Some(audits) = engine.audits() {
        audits.figures().lines().iter().for_each(|line| drop(ui.label(line)));
    }
}

fn all_dials(ui: &mut Ui, engine: &mut Engine) -> anyhow::Result<()> {
    let (policy, tree) = (policy_dials(ui, engine), tree_dials(ui, engine));
    section(ui, "Detail", |ui| {
        let mut error = engine.detail.max_error_px;
        ui.horizontal(|ui| {
            ui.label("max_error_px")
                .on_hover_text("how far a coarser mesh may lie from the true one, pixels");
            if ui.add(DragValue::new(&mut error).speed(0.02).range(0.0..=100.0)).changed() {
                engine.use_detail(Detail { max_error_px: error });
            }
        });
    });
    policy.and(tree)
}

fn policy_dials(ui: &mut Ui, engine: &mut Engine) -> anyhow::Result<()> {
    let known = engine.eye.policy().dials();
    if known.is_empty() {
        return Ok(());
    }
    let name = engine.eye.policy().name();
    let turned = section(ui, "Dials of the policy", |ui| dials::show(ui, name, &known));
    for (key, value) in turned.into_iter().flatten() {
        engine.eye.policy_mut().set(key, &value)?;
        engine.audit_anew();
    }
    Ok(())
}

fn tree_dials(ui: &mut Ui, engine: &mut Engine) -> anyhow::Result<()> {
    let mut tree = engine.tree.clone();
    let turned = section(ui, "Dials of the tree", |ui| {
        let mut turned = dials::show(ui, "tree", &tree.dials());
        ui.horizontal(|ui| {
            for preset in ["stable", "paper"] {
                if ui.button(format!("preset {preset}")).clicked() {
                    turned.push(("preset", preset.to_owned()));
                }
            }
        });
        turned
    });
    for (key, value) in turned.into_iter().flatten() {
        tree.set(key, &value)?;
        engine.use_tree(tree.clone());
    }
    Ok(())
}

/// What is in a section, if it is open.
fn section<R>(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    CollapsingHeader::new(RichText::new(title).strong()).default_open(true).show(ui, contents).body_returned
}

/// Why each object under the cursor is drawn or not.
pub fn why(ui: &mut Ui, lines: &[(bool, String)]) {
    ui.set_min_width(460.0);
    ui.strong("Under the cursor, nearest first");
    for (is_drawn, line) in lines {
        let color = if *is_drawn { Color32::LIGHT_GREEN } else { Color32::LIGHT_RED };
        ui.colored_label(color, line);
    }
}
