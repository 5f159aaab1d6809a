//! Boxes by what became of them in the last frame.

use eframe::egui::{Color32, Sense, Ui, vec2};
use tercet::geom::{Aabb, Frustum};
use tercet::policy::Fate;

use super::display::Layers;
use super::engine::Engine;

/// A colour, with alpha.
pub type Color = [u8; 4];

const VISIBLE: Color = [90, 220, 100, 255];
const REMEMBERED: Color = [80, 190, 230, 255];
const HIDDEN: Color = [235, 70, 60, 255];
const STRADDLE_VISIBLE: Color = [235, 225, 60, 255];
const STRADDLE_REMEMBERED: Color = [150, 140, 230, 255];
const STRADDLE_HIDDEN: Color = [225, 80, 220, 255];
const CULLED: Color = [160, 40, 35, 170];
const AWAKE: Color = [255, 160, 40, 255];
/// What is under the cursor.
pub const MARKED: Color = [255, 255, 255, 255];

/// What the colours mean.
const LEGEND: [(Color, &str); 9] = [
    (VISIBLE, "node: asked, visible"),
    (REMEMBERED, "node: not asked, visible"),
    (HIDDEN, "node: asked, hidden"),
    (STRADDLE_VISIBLE, "straddle node: asked, visible"),
    (STRADDLE_REMEMBERED, "straddle node: not asked, visible"),
    (STRADDLE_HIDDEN, "straddle node: asked, hidden"),
    (CULLED, "object: culled inside the frustum"),
    (AWAKE, "object: awake (has moved)"),
    (MARKED, "under the cursor"),
];

/// Gathers the boxes that the layers call for. O(1) without a layer, O(objects) with those of
/// objects; that of nodes is as slow as [`Culler::fates`](tercet::Culler::fates).
pub fn boxes(engine: &Engine, layers: &Layers, boxes: &mut Vec<(Aabb, Color)>) {
    let Some(view) = &engine.culled else { return };
    if layers.nodes {
        for (node, fate) in engine.eye.fates(&engine.scene, view) {
            let color = of_fate(fate, node.is_straddle);
            // An open node says nothing that those below it do not.
            if node.own > 0 || fate == Fate::Hidden {
                boxes.extend(color.map(|color| (node.bounds, color)));
            }
        }
    }
    if layers.culled {
        let frustum = Frustum::new(view);
        let mut drawn = vec![false; engine.scene.slot_bound()];
        engine.eye.visible().iter().for_each(|object| drawn[object.id.slot()] = true);
        let culled = engine.scene.objects().filter(|o| !drawn[o.object.id.slot()]);
        let inside = culled.filter_map(|o| o.bounds).filter(|bounds| frustum.intersects(bounds));
        boxes.extend(inside.map(|bounds| (bounds, CULLED)));
    }
    if layers.awake {
        boxes.extend(engine.moved().map(|bounds| (bounds, AWAKE)));
    }
}

/// The colour of a question's proxy.
pub fn of_answer(visible: Option<bool>) -> Color {
    let [r, g, b, _] = match visible {
        Some(true) => VISIBLE,
        Some(false) => HIDDEN,
        None => MARKED,
    };
    [r, g, b, 40]
}

fn of_fate(fate: Fate, is_straddle: bool) -> Option<Color> {
    match (fate, is_straddle) {
        (Fate::Hidden, false) => Some(HIDDEN),
        (Fate::Hidden, true) => Some(STRADDLE_HIDDEN),
        (Fate::Visible { .. }, false) => Some(VISIBLE),
        (Fate::Visible { .. }, true) => Some(STRADDLE_VISIBLE),
        (Fate::Remembered { .. } | Fate::Near, false) => Some(REMEMBERED),
        (Fate::Remembered { .. } | Fate::Near, true) => Some(STRADDLE_REMEMBERED),
        (Fate::Unknown | Fate::Unasked | Fate::Given | Fate::Swept | Fate::Outside | Fate::NotReached, _) => {
            None
        }
    }
}

/// Says what the colours mean.
pub fn legend(ui: &mut Ui) {
    for ([r, g, b, _], meaning) in LEGEND {
        ui.horizontal(|ui| {
            let (square, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(square, 2.0, Color32::from_rgb(r, g, b));
            ui.label(meaning);
        });
    }
}
