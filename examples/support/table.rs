//! The summary in plain English, printed at the end.

use comfy_table::{Table, presets};

use super::report::Summary;

/// The table, ready to print.
pub fn table(summary: &Summary) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY);
    let mut row = |name: &str, value: String| {
        table.add_row([name, &value]);
    };
    let s = summary;
    let [width, height] = s.viewport;
    row("scene", format!("{}, seed {}", s.scene, s.seed));
    row(
        "in the world",
        format!("{} objects, {} triangles", count(s.objects as f64), count(s.triangles as f64)),
    );
    row("policy, backend", format!("{} on {}, {width} × {height}, {} frames", s.policy, s.backend, s.frames));
    let f = &s.frame_ms;
    row(
        "time a frame",
        format!(
            "{:.2} ms median, {:.2} mean, {:.2} at the 99th percentile, {:.2} worst",
            f.median, f.mean, f.p99, f.max
        ),
    );
    let t = &s.stage_ms;
    row(
        "  of which",
        format!(
            "sync {:.2} · tree {:.2} · policy {:.2} · draw {:.2} · query {:.2} · wait {:.2} ms",
            t.sync, t.tree, t.policy, t.draw, t.query, t.wait
        ),
    );
    row("in the view frustum", format!("{} objects a frame", count(s.in_frustum.mean)));
    let saved = 100.0 * (1.0 - s.drawn.mean / s.in_frustum.mean.max(1.0));
    row(
        "drawn",
        format!(
            "{} objects a frame ({saved:.0} % of the frustum culled), {} triangles",
            count(s.drawn.mean),
            count(s.drawn_triangles.mean)
        ),
    );
    if let (Some(exact), Some(boxes)) = (s.exact_visible, s.box_visible) {
        row(
            "really visible",
            format!("{} objects a frame; {} by their boxes", count(exact.mean), count(boxes.mean)),
        );
    }
    if let (Some(lost), Some(wrong)) = (s.false_culls, s.wrong_pixels) {
        row(
            "wrongly culled",
            format!(
                "{lost} objects in the whole run; {:.1} wrong pixels a frame, {:.0} at worst",
                wrong.mean, wrong.max
            ),
        );
    }
    row(
        "questions asked",
        format!(
            "{:.1} a frame ({:.1} boxes) in {:.1} waves, {:.1} changes between drawing and asking",
            s.queries.mean, s.query_boxes.mean, s.waves.mean, s.state_changes.mean
        ),
    );
    row(
        "tree",
        format!(
            "{} nodes, {} deep; a frame: {:.1} splits, {:.1} merges, {:.1} moves, {:.2} flips; {:.1} % of the time",
            s.tree.nodes,
            s.tree.depth,
            s.tree.splits,
            s.tree.merges,
            s.tree.moves,
            s.tree.flips,
            100.0 * s.tree.maintenance_share
        ),
    );
    table
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
