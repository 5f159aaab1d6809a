//! The summary in plain English, printed at the end. Figures are means per frame,
//! unless they say otherwise.

use comfy_table::{Table, presets};

use super::report::Summary;

/// The table, ready to print, less than 100 columns wide.
pub fn table(summary: &Summary) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY);
    for (name, value) in rows(summary) {
        table.add_row([name, &value]);
    }
    table
}

/// What a figure is, and the figure.
fn rows(s: &Summary) -> Vec<(&'static str, String)> {
    let [width, height] = s.viewport;
    let (f, t) = (&s.frame_ms, &s.stage_ms);
    let saved = 100.0 * (1.0 - s.drawn.mean / s.in_frustum.mean.max(1.0)).max(0.0);
    let mut rows = vec![
        ("scene", format!("{}, seed {}", s.scene, s.seed)),
        ("", format!("{} objects, {} triangles", count(s.objects as f64), count(s.triangles as f64))),
        ("policy", format!("{} on {}, {width} × {height}, {} frames", s.policy, s.backend, s.frames)),
        ("time a frame", format!("{:.2} ms median, {:.2} at the 99th percentile", f.median, f.p99)),
        ("", format!("{:.2} mean, {:.2} to {:.2}", f.mean, f.min, f.max)),
        ("mean by stage", format!("draw {:.2}, query {:.2}, wait {:.2}", t.draw, t.query, t.wait)),
        ("", format!("sync {:.2}, tree {:.2}, policy {:.2}", t.sync, t.tree, t.policy)),
        ("in the frustum", format!("{} objects", count(s.in_frustum.mean))),
        (
            "drawn",
            format!(
                "{} objects ({saved:.1} % of the frustum culled), {} triangles",
                count(s.drawn.mean),
                count(s.drawn_triangles.mean)
            ),
        ),
    ];
    if let (Some(exact), Some(boxes)) = (s.exact_visible, s.box_visible) {
        let boxes = count(boxes.mean);
        rows.push(("really visible", format!("{} objects; {boxes} by their boxes", count(exact.mean))));
    }
    if let (Some(lost), Some(wrong)) = (s.false_culls, s.wrong_pixels) {
        rows.push(("wrongly culled", format!("{lost} objects in the whole run")));
        rows.push(("wrong pixels", format!("{:.1}, {:.0} at worst", wrong.mean, wrong.max)));
    }
    if let Some(audit) = &s.audit {
        let names = ["audited"].into_iter().chain(std::iter::repeat(""));
        rows.extend(names.zip(audit.lines()));
    }
    rows.extend([
        (
            "questions",
            format!(
                "{:.1} in {:.1} waves, about {:.1} boxes",
                s.queries.mean, s.waves.mean, s.query_boxes.mean
            ),
        ),
        ("state changes", format!("{:.1} between drawing and asking", s.state_changes.mean)),
    ]);
    rows.extend(
        counters(s).into_iter().enumerate().map(|(i, line)| (if i == 0 { "the policy" } else { "" }, line)),
    );
    rows.extend([
        ("tree", format!("{} nodes, {} deep", s.tree.nodes, s.tree.depth)),
        (
            "tree's events",
            format!(
                "{:.1} splits, {:.1} merges, {:.2} flips, {:.1} objects moved",
                s.tree.splits, s.tree.merges, s.tree.flips, s.tree.moves
            ),
        ),
        ("tree's share", format!("{:.1} % of the frame's time", 100.0 * s.tree.maintenance_share)),
    ]);
    rows
}

/// What the policy counted itself, a few to a line.
fn counters(s: &Summary) -> Vec<String> {
    let each = s.counters.iter().map(|(key, count)| format!("{:.1} {}", count.mean, key.replace('_', " ")));
    each.collect::<Vec<_>>().chunks(3).map(|few| few.join(", ")).collect()
}

/// A whole number with thin groups of three: 18 200 413.
pub fn count(x: f64) -> String {
    let digits = format!("{:.0}", x);
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::count;

    #[test]
    fn digits_are_grouped_by_three() {
        assert_eq!(count(0.0), "0");
        assert_eq!(count(999.4), "999");
        assert_eq!(count(1000.0), "1 000");
        assert_eq!(count(18_200_413.0), "18 200 413");
    }
}
