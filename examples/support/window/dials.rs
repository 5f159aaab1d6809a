//! A control for every dial that `--set` reaches.

use eframe::egui::{ComboBox, DragValue, Grid, TextEdit, Ui};
use tercet::{Dial, DialKind};

/// Shows dials, and returns those that the user turned: name and new value.
pub fn show(ui: &mut Ui, id: &str, dials: &[Dial]) -> Vec<(&'static str, String)> {
    let mut turned = Vec::new();
    Grid::new(id).num_columns(2).show(ui, |ui| {
        for dial in dials {
            ui.label(dial.key).on_hover_text(&dial.about);
            let value = one(ui, id, dial).filter(|value| *value != dial.value);
            turned.extend(value.map(|value| (dial.key, value)));
            ui.end_row();
        }
    });
    turned
}

/// The control that fits what the dial takes.
fn one(ui: &mut Ui, id: &str, dial: &Dial) -> Option<String> {
    let Dial { key, value, .. } = dial;
    match &dial.kind {
        DialKind::Choice(choices) => Some(choice(ui, (id, key), value, choices)),
        DialKind::Switch => {
            let mut on = value == "true";
            ui.checkbox(&mut on, "").changed().then(|| on.to_string())
        }
        DialKind::Whole => {
            let mut whole: i64 = value.parse().ok()?;
            ui.add(DragValue::new(&mut whole)).changed().then(|| whole.to_string())
        }
        DialKind::Real => {
            let mut real: f64 = value.parse().ok()?;
            let drag = DragValue::new(&mut real).speed(0.005).max_decimals(4);
            ui.add(drag).changed().then(|| real.to_string())
        }
        DialKind::Text => text(ui, (id, key), value),
    }
}

/// One of a few names.
pub fn choice(ui: &mut Ui, id: (&str, &str), value: &str, choices: &[&str]) -> String {
    let mut chosen = value;
    ComboBox::from_id_salt(id).selected_text(value).show_ui(ui, |ui| {
        for &choice in choices {
            ui.selectable_value(&mut chosen, choice, choice);
        }
    });
    chosen.to_owned()
}

/// Text is taken when it is finished: half a word is no value.
fn text(ui: &mut Ui, id: (&str, &str), value: &str) -> Option<String> {
    let id = ui.scope_id().with(id);
    let mut edited = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| value.to_owned());
    let response = ui.add(TextEdit::singleline(&mut edited).desired_width(80.0));
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        return Some(edited);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, edited));
    }
    None
}
