//! The frustum of the culling camera, seen from elsewhere.

use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, pos2};
use glam::{DVec3, DVec4};
use tercet::geom::View;

const INK: Color32 = Color32::from_rgb(255, 210, 60);

/// Draws the edges of what `culled` sees, up to a distance in metres, over the picture of `view`.
pub fn draw(painter: &Painter, rect: Rect, view: &View, culled: &View, reach: f64) {
    let eye = culled.eye().as_dvec4();
    let eye = eye.truncate() / eye.w;
    // Where the corners of the screen lie, at that distance.
    let corner = |x: f64, y: f64| {
        let p = culled.world_from_clip() * DVec4::new(x, y, 0.5, 1.0);
        eye + (p.truncate() / p.w - eye).normalize_or_zero() * reach
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    for i in 0..4 {
        for (a, b) in [(eye, corners[i]), (corners[i], corners[(i + 1) % 4])] {
            if let Some(line) = on_screen(view, rect, a, b) {
                painter.line_segment(line, Stroke::new(1.5, INK));
            }
        }
    }
}

/// A line as the screen shows it; None where all of it lies behind the eye.
fn on_screen(view: &View, rect: Rect, a: DVec3, b: DVec3) -> Option<[Pos2; 2]> {
    const AHEAD: f64 = 1e-3;
    let [a, b] = [a, b].map(|p| view.clip_from_world() * p.extend(1.0));
    let (a, b) = if a.w < b.w { (a, b) } else { (b, a) };
    if b.w < AHEAD {
        return None;
    }
    // What lies behind is cut off.
    let a = if a.w < AHEAD { a + (b - a) * ((AHEAD - a.w) / (b.w - a.w)) } else { a };
    Some([a, b].map(|clip| {
        let (x, y) = (clip.x / clip.w, clip.y / clip.w);
        let at = |ndc: f64, low: f32, side: f32| low + (ndc * 0.5 + 0.5) as f32 * side;
        pos2(at(x, rect.left(), rect.width()), at(-y, rect.top(), rect.height()))
    }))
}
